#!/usr/bin/env bash
# Exact mode, function by function: tests/specs/exact.yaml and arithmetic.yaml run every function that exact mode replaces, over
# some thousand inputs, special values included. exact_accuracy.py compares the same results with double precision.
. "$(dirname "$0")/../lib/tap.sh"
scene=$root/scenes/cornell.yaml
specs=$root/tests/specs

exact=(--scene "$scene" --spec "$specs/exact.yaml" --size 9x5)

# Compares the files of the dumps: the inputs include NaN and infinity, which `compare` never accepts as equal.
dumps() { # options...: the files of both backends that differ, in the order of the passes
    rm -rf "$work/gl" "$work/vk"
    "$planted" render "${exact[@]}" --backend gl --poison 90 --dump "$work/gl" "$@" || return 2
    "$planted" render "${exact[@]}" --backend vk --poison 165 --dump "$work/vk" "$@" || return 2
    diff -rq --exclude=manifest.json "$work/gl" "$work/vk" >"$work/table"
}
same_bits() { # files options...: that many files, all equal
    local files=$1
    shift
    dumps "$@" || {
        cat "$work/table"
        return 1
    }
    [ "$(find "$work/vk" -type f ! -name manifest.json -size +0 | wc -l)" = "$files" ]
}

same_bits_of_text() {
    dumps || return
    rm -rf "$work/gl"
    "$planted" render "${exact[@]}" --backend gl+glsl --poison 90 --dump "$work/gl" &&
        diff -rq --exclude=manifest.json "$work/gl" "$work/vk"
}

check "every function gives the same bits, validation silent" same_bits 8 --debug
check "... and over other inputs" same_bits 8 --set cases=20000
check "every function gives the same bits with OpenGL fed GLSL text" same_bits_of_text
# compare_test.sh compares them on cornell.
text_on_atrium() { # spec option...
    check "$(basename "$1" .yaml) agrees on the atrium with OpenGL fed GLSL text" \
        "$diptych" compare --scene "$root/scenes/atrium.yaml" --size 37x23 --glsl --spec "$@"
}
text_on_atrium "$specs/features.yaml"
text_on_atrium "$root/templates/ssvp.yaml" --set rsm_size=128
text_on_atrium "$root/templates/rsm.yaml" --set rsm_size=128

arithmetic=("$diptych" compare --spec "$specs/arithmetic.yaml" --size 8x8 --set finite=true)
check "division and functions agree over all exponents" "${arithmetic[@]}"
check "... with OpenGL fed GLSL text" "${arithmetic[@]}" --glsl
check "arithmetic in arguments agrees with OpenGL fed GLSL text" \
    "$diptych" compare --spec "$root/templates/machine.yaml" --scene "$scene" --size 32x32 --glsl
# A control: the same comparison finds the differences that exact mode removes.
check_status 1 "fast mode differs" dumps --set exactness=fast
check "... in a pass whose functions exact mode replaces" grep -qE '/[0-9]+\.(measure|turn|multiply)\.' "$work/table"
check "... and not in its inputs" [ "$(grep -c draw_inputs "$work/table")" = 0 ]

# NVIDIA's linker for OpenGL needs this. The library's functions come last in what Vulkan takes.
calls_look_back() { # backend
    "$build/diptych-gen" "$root/templates/rsm.yaml" -o "$work/modules" && /usr/bin/python3 - "$work/modules/$1"/*.spv <<'END'
import struct, sys
FUNCTION, CALL = 54, 57
forward = set()
for path in sys.argv[1:]:
    data = open(path, "rb").read()
    words = struct.unpack(f"<{len(data) // 4}I", data)
    at, seen = 5, set()
    while at < len(words):
        if words[at] & 0xFFFF == FUNCTION:
            seen.add(words[at + 2])
        elif words[at] & 0xFFFF == CALL and words[at + 3] not in seen:
            forward.add(path)
        at += words[at] >> 16
assert len(sys.argv) > 9, sys.argv
sys.exit(f"calls of functions that follow: {sorted(forward)}" if forward else 0)
END
}
check "in OpenGL's modules functions stand before their calls" calls_look_back gl
check_status 1 "... in Vulkan's they do not" calls_look_back vk

# Subgroup operations run with exactness: fast, on devices that have them.
reduces() { # backend
    rm -rf "$work/subgroups"
    "$diptych" render --spec "$specs/subgroups.yaml" --size 16x16 --backend "$1" --dump "$work/subgroups" >"$work/told" 2>&1 ||
        grep -E 'pass reduce: needs (GL_KHR_shader_subgroup|VK_SUBGROUP_FEATURE_[A-Z]*_BIT)' "$work/told" || return
    [ ! -e "$work/subgroups" ] || [ "$(od -An -v -tu4 -w4 "$work"/subgroups/00.reduce.sums.raw | awk '{ sum += $1 } END { print sum }')" = 32640 ]
}
for backend in gl vk; do
    check "subgroups reduce, or $backend tells what it lacks" reduces $backend
done
check "exact, the body takes the other way" "$diptych" compare --spec "$specs/subgroups.yaml" --size 16x16 --set exactness=exact

# More declarations than a table of them begins with.
/usr/bin/python3 - "$work" <<'END'
import sys
lines = "".join(f"    r += float(i) * {k}.5;\n" for k in range(1500))
with open(sys.argv[1] + "/many.glsl", "w", encoding="utf-8") as file:
    file.write("void main()\n{\n    int i = invocation().x;\n    float r = 0.0;\n" + lines + "    result[i] = r;\n}\n")
with open(sys.argv[1] + "/many.yaml", "w", encoding="utf-8") as file:
    file.write("pipeline: many\nbuffers:\n  result: {of: float, count: 64}\n"
               "passes:\n  - {name: many, dispatch: 64, writes: [result], shader: many.glsl}\n")
END
check "a shader with 1,500 constants compiles" limited 60 "$build/diptych-gen" "$work/many.yaml" --check

. "$root/tests/lib/drivers.sh"
if [ ${#strangers[@]} -gt 0 ]; then
    check "division and functions agree on ${strangers[*]}" "${arithmetic[@]}" --backend "vk@llvmpipe,${strangers[0]}"
else
    skip "division and functions agree on another driver" "$no_strangers"
fi
finish
