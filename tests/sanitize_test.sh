#!/usr/bin/env bash
# --sanitize finds undefined behaviour of bodies that are wrong in one place, there, on every driver; bodies that come near stay
# silent and keep their bits. TAP.
. "$(dirname "$0")/tap.sh"
. "$root/tests/drivers.sh"
tool() { /usr/bin/python3 "$root/tests/sanitize.py" "$@"; }
tool make "$work" || exit 1

# The kinds that each table is about: checks of all kinds take the drivers' compilers several times as long.
declare -A kinds=([wrong]="index,arithmetic,loop,variable" [wrong_memory]="content,race,flow")
kinds[fine]=${kinds[wrong]} kinds[fine_memory]=${kinds[wrong_memory]}
# shellcheck disable=SC2317
sanitized() { # table backend folder
    "$diptych" render --spec "$work/$1.yaml" --size 16x16 --backend "$2" --dump "$work/$3" --poison 7 "--sanitize=${kinds[$1]}" --json "$work/found.json"
}
# shellcheck disable=SC2317 # called through check
finds() { # table backend
    sanitized "$1" "$2" dump
    [ $? = 1 ] && tool found "$work/found.json" "$1"
}
# shellcheck disable=SC2317
silent() { # table backend
    sanitized "$1" "$2" checked
    local status=$?
    tool silent "$work/found.json" "$1" && [ "$status" = 0 ] &&
        "$diptych" render --spec "$work/$1.yaml" --size 16x16 --backend "$2" --dump "$work/plain" --poison 7 &&
        tool equal "$work/plain" "$work/checked"
}

for backend in gl vk@llvmpipe "${strangers[@]}"; do
    check "$backend finds each undefined operation in its line" finds wrong "$backend"
    check "$backend is silent about what comes near, and changes no bit" silent fine "$backend"
    check "$backend finds unwritten content, races and diverging barriers in their line" finds wrong_memory "$backend"
    check "$backend is silent about memory that is used as it may be, and changes no bit" silent fine_memory "$backend"
done
[ ${#strangers[@]} -gt 0 ] || skip "another driver finds each undefined operation in its line" "$no_strangers"

# The second of two images that share memory holds equal texels of the first where it was not written: no driver shows it.
cat >"$work/shares.yaml" <<'END'
pipeline: shares
images:
  first: {format: rgba16f, size: [8, 8]}
  middle: {format: rgba16f, size: [8, 8]}
  second: {format: rgba16f, size: [8, 8]}
  last: {format: rgba16f, size: [8, 8]}
passes:
  - {name: one, dispatch: first, writes: [first], shader: one.glsl}
  - {name: two, dispatch: middle, reads: [first], writes: [middle], shader: two.glsl}
  - {name: three, dispatch: second, reads: [middle], writes: [second], shader: three.glsl}
  - {name: four, dispatch: last, reads: [second], writes: [last], shader: four.glsl}
END
echo 'void main() { first_store(invocation().xy, vec4(1)); }' >"$work/one.glsl"
echo 'void main() { middle_store(invocation().xy, first(invocation().xy)); }' >"$work/two.glsl"
echo 'void main() { ivec2 p = invocation().xy; if (p.y != 5) second_store(p, middle(p)); }' >"$work/three.glsl"
echo 'void main() { last_store(invocation().xy, second(invocation().xy)); }' >"$work/four.glsl"
# shellcheck disable=SC2317
shares() { # backend
    "$diptych" render --spec "$work/shares.yaml" --size 8x8 --frames 2 --backend "$1" --sanitize=content --dump "$work/shared" >"$work/found"
    # shellcheck disable=SC2016
    [ $? = 1 ] && grep -qF 'four.glsl:1:43: undefined: texel (0, 5) of `second` was never written in this frame' "$work/found" &&
        grep -qF '  pass four, invocation (0, 5, 0), 16 times; first in frame 0' "$work/found" && [ "$(wc -l <"$work/found")" = 2 ]
}
for backend in gl vk@llvmpipe; do
    check "$backend: memory of another resource counts as unwritten" shares "$backend"
done

# shellcheck disable=SC2317
refused() {
    "$diptych" compare --spec "$work/fine.yaml" --size 16x16 --sanitize=index,numbers 2>&1 |
        grep -q 'unknown kind "numbers"; there are index, arithmetic'
}
check "an unknown kind is refused" refused
# shellcheck disable=SC2317
compared() {
    timeout 60 "$diptych" compare --spec "$work/wrong.yaml" --size 16x16 --backend gl,vk@llvmpipe --sanitize=index,loop >"$work/compared"
# shellcheck disable=SC2016
    [ $? = 1 ] && grep -qF 'w_0.glsl:5:9: undefined: index 8 of `taps`, which has 8 elements' "$work/compared" &&
        grep -qF '  pass w_0, invocation (32, 0, 0), 32 times; first in frame 0; gl, vk@llvmpipe' "$work/compared" &&
        ! grep -q 'sqrt' "$work/compared"
}
check "compare tells the kinds that it is asked for, and the sides" compared
finish
