#!/usr/bin/env bash
# Stores into formats of few bits, from dispatches and as colour targets, round to nearest, ties to even, on every driver. TAP.
. "$(dirname "$0")/../lib/tap.sh"
. "$root/tests/lib/drivers.sh"
spec=$root/tests/specs/stores.yaml
/usr/bin/python3 "$root/tests/gen/stores.py" make "$work" || exit 1
input=(--input values="$work/values.npy" --input fractions="$work/fractions.npy" --size 320x300)

# shellcheck disable=SC2317 # called through check
right() { # backend
    rm -rf "$work/dump"
    "$diptych" render --spec "$spec" "${input[@]}" --backend "$1" --dump "$work/dump" -o "$work/picture.png" &&
        /usr/bin/python3 "$root/tests/gen/stores.py" check "$work/dump" "$work"
}

for backend in gl gl+glsl vk@llvmpipe "${strangers[@]}"; do
    check "$backend rounds every store to the nearest code" right "$backend"
done
[ ${#strangers[@]} -gt 0 ] || skip "another driver rounds every store to the nearest code" "$no_strangers"
finish
