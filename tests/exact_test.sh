#!/usr/bin/env bash
# Exact mode function by function: tests/specs/exact.yaml runs everything that it replaces, and what it leaves, over some
# thousand inputs with special values among them. exact_accuracy_test.c holds the same results against double precision.
. "$(dirname "$0")/tap.sh"
scene=$root/scenes/cornell.yaml
specs=$root/tests/specs

exact=(--scene "$scene" --spec "$specs/exact.yaml" --size 9x5)

check "every function gives the same bits, validation silent" "$diptych" compare "${exact[@]}" --debug
check "... and over other inputs" "$diptych" compare "${exact[@]}" --set cases=20000
# vector * matrix and matrix * matrix: Mesa's GLSL compiler has an order of its own for them, which `precise` does not reach.
check "every function gives the same bits with OpenGL fed GLSL text" "$diptych" compare "${exact[@]}" --glsl --set with_rows=false
for spec in "$specs/features.yaml" "$root/templates/ssvp.yaml" "$root/templates/rsm.yaml"; do
    for name in cornell atrium; do
        check "$(basename "$spec" .yaml) agrees on $name with OpenGL fed GLSL text" \
            "$diptych" compare --scene "$root/scenes/$name.yaml" --spec "$spec" --size 37x23 --glsl
    done
done

# A control: the comparison sees what exact mode removes.
for backend in gl vk; do
    check "fast mode renders with $backend" "$diptych" render "${exact[@]}" --backend $backend --set exactness=fast -o "$work/fast.png"
done
check_status 1 "fast mode differs" "$diptych" compare "${exact[@]}" --set exactness=fast
cp "$work/output" "$work/table"
check "... in a pass whose functions exact mode replaces" grep -qE '^pass (measure|turn|multiply) is the first' "$work/table"
finish
