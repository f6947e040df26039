#!/usr/bin/env bash
# `diptych-gen --shader-cache` changes nothing but time: what it takes from the file is what it would have made, whatever was edited,
# and whatever has become of the file. TAP.
# shellcheck source=tests/tap.sh
. "$(dirname "$0")/tap.sh"
cp -r "$root/templates" "$work/templates"
spec=$work/templates/rsm.yaml
body=$work/templates/shared/tonemap.glsl
cache=$work/shaders

generate() { # folder option...
    local folder=$work/$1
    shift
    rm -rf "$folder"
    "$build/diptych-gen" "$spec" -o "$folder" --templates "$work/templates" "$@" >/dev/null
}
# shellcheck disable=SC2317,SC2120 # called through check
is_as_without() { # option...: with the cache the same is made as without it, and the cache is then of use
    generate plain "$@" && generate cached --shader-cache "$cache" "$@" && diff -r "$work/plain" "$work/cached" &&
        cp "$cache" "$work/left" && generate again --shader-cache "$cache" "$@" && diff -r "$work/plain" "$work/again" &&
        cmp "$cache" "$work/left"
}
# shellcheck disable=SC2317
is_mended() { # command...: which spoils the file
    cp "$work/good" "$cache"
    # shellcheck disable=SC2119
    "$@" && ! cmp -s "$cache" "$work/good" && is_as_without && cmp "$cache" "$work/good"
}
# shellcheck disable=SC2317
spoil() { # offset: one byte
    local byte
    byte=$(od -An -tu1 -j "$1" -N 1 "$cache")
    # shellcheck disable=SC2059 # the byte as an escape
    printf "$(printf '\\%03o' $((byte ^ 1)))" | dd of="$cache" bs=1 seek="$1" conv=notrunc status=none
}
# shellcheck disable=SC2317
cut_to() { # bytes
    truncate -s "$1" "$cache"
}
# shellcheck disable=SC2317
poison() { # the words of one shader are another's, and nobody has signed for it
    python3 - "$cache" "$work/plain/gl/tonemap.comp.spv" <<'SWAP'
import sys
data, words = open(sys.argv[1], "rb").read(), open(sys.argv[2], "rb").read()
assert data.count(words) == 1
open(sys.argv[1], "wb").write(data.replace(words, words[:20] + words[24:] + words[20:24]))
SWAP
}

check "a first time" is_as_without
cp "$cache" "$work/good"
size=$(stat -c %s "$cache")
check "an edited body is seen" sed -i 's/display_store(p, vec4(/&0.5 * /' "$body"
check "... by what is made of it" is_as_without
generate before && cp "$work/before/vk/tonemap.comp.spv" "$work/edited.spv"
cp "$root/templates/shared/tonemap.glsl" "$body"
generate before && cp "$work/before/vk/tonemap.comp.spv" "$work/before.spv"
check "... which is other code" test "$(cmp -s "$work/edited.spv" "$work/before.spv" && echo same)" != same
check "what was there before the edit is still there" is_as_without
check "so is another value of a parameter" is_as_without --set rsm_size=64
check "and the other way to compile" is_as_without --set exactness=fast

generate plain && cp "$cache" "$work/kept" && rm "$cache" && generate cached --shader-cache "$cache" && cp "$cache" "$work/good"
for offset in 0 8 20 $((size / 2)) $((size - 1)); do
    check "byte $offset is another: the file is made anew" is_mended spoil "$offset"
done
for length in 0 16 $((size / 2)) $((size - 1)); do
    check "only $length bytes are left: the file is made anew" is_mended cut_to "$length"
done
check "words that are another's: the file is made anew" is_mended poison

# Errors come in order and with their carets, as often as one asks, though shaders are compiled side by side.
cat >>"$body" <<'BROKEN'
int broken_first() { return 1.5; }
BROKEN
sed -i 's/^void main() {$/&/; 1s/^/int broken_second() { return nothing; }\n/' "$work/templates/shared/gbuffer.glsl"
# shellcheck disable=SC2317
tells_the_same() {
    generate wrong 2>"$work/told"
    [ $? = 1 ] && grep -q "broken_first() { return 1.5; }" "$work/told" && grep -q "broken_second() { return nothing; }" "$work/told" || return
    for _ in 1 2 3 4 5; do
        generate wrong --shader-cache "$cache" 2>"$work/again.told"
        [ $? = 1 ] && diff "$work/told" "$work/again.told" || return
    done
    [ ! -e "$work/wrong" ]
}
check "errors of two bodies are told in order" tells_the_same
finish
