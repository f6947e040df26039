#!/usr/bin/env bash
# The seeds of `ninja fuzz` and the inputs that it has found (fuzz.c, fuzz.sh) neither crash nor hang. TAP.
. "$(dirname "$0")/../lib/tap.sh"
cd "$root" || exit 1
survives() { # kind file: status 1 also passes: glslang took too long, with a message
    local status=0
    limited 60 "$build/tests/fuzz" "$1" "$2" || status=$?
    [ "$status" -le 1 ]
}
for kind in spec body scene input evidence cache preset module; do
    for file in tests/tools/fuzz/"$kind"/*; do
        [ ! -e "$file" ] || check "$file" survives "$kind" "$file"
    done
done
entry=$work/entry
cp tests/tools/fuzz/cache/entry "$entry"
printf 'X' | dd of="$entry" bs=1 seek=30 conv=notrunc status=none
check "a damaged cache entry is a miss" "$build/tests/fuzz" cache "$entry"
finish
