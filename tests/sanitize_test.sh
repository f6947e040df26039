#!/usr/bin/env bash
# --sanitize finds undefined behaviour of bodies that are wrong in one place, there, on every driver; bodies that come near stay
# silent and keep their bits. TAP.
. "$(dirname "$0")/tap.sh"
. "$root/tests/drivers.sh"
tool() { /usr/bin/python3 "$root/tests/sanitize.py" "$@"; }
tool make "$work" || exit 1

# shellcheck disable=SC2317 # called through check
finds() { # backend
    "$diptych" render --spec "$work/wrong.yaml" --size 16x16 --backend "$1" --dump "$work/dump" --sanitize --json "$work/found.json"
    [ $? = 1 ] && tool found "$work/found.json"
}
# shellcheck disable=SC2317
silent() { # backend
    "$diptych" render --spec "$work/fine.yaml" --size 16x16 --backend "$1" --dump "$work/checked" --sanitize --json "$work/silent.json"
    local status=$?
    tool silent "$work/silent.json" && [ "$status" = 0 ] &&
        "$diptych" render --spec "$work/fine.yaml" --size 16x16 --backend "$1" --dump "$work/plain" &&
        tool equal "$work/plain" "$work/checked"
}

for backend in gl vk@llvmpipe "${strangers[@]}"; do
    check "$backend finds each undefined operation in its line" finds "$backend"
    check "$backend is silent about what comes near, and changes no bit" silent "$backend"
done
[ ${#strangers[@]} -gt 0 ] || skip "another driver finds each undefined operation in its line" "$no_strangers"

# shellcheck disable=SC2317
refused() {
    "$diptych" compare --spec "$work/fine.yaml" --size 16x16 --sanitize=index,numbers 2>&1 |
        grep -q 'unknown kind "numbers"; there are index, arithmetic'
}
check "an unknown kind is refused" refused
# shellcheck disable=SC2317
compared() {
    limited 60 "$diptych" compare --spec "$work/wrong.yaml" --size 16x16 --backend gl,vk@llvmpipe --sanitize=index,loop >"$work/compared"
# shellcheck disable=SC2016
    [ $? = 1 ] && grep -qF 'w0.glsl:5:9: undefined: index 8 of `taps`, which has 8 elements' "$work/compared" &&
        grep -qF '  pass w0, invocation (32, 0, 0), 32 times; first in frame 0; gl, vk@llvmpipe' "$work/compared" &&
        ! grep -q 'sqrt' "$work/compared"
}
check "compare tells the kinds that it is asked for, and the sides" compared
finish
