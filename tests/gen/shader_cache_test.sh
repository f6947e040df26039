#!/usr/bin/env bash
# `diptych-gen --cache` changes the time and nothing else: outputs with and without the cache are equal, after any edit and with
# damaged cache entries. TAP.
# shellcheck source=tests/lib/tap.sh
. "$(dirname "$0")/../lib/tap.sh"
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
is_as_without() { # option...: the output with the cache equals the output without it
    generate plain "$@" && is_as_plain "$@"
}
# shellcheck disable=SC2120
is_as_plain() { # option...: the output equals the folder `plain`, and the next generation writes no entry
    generate cached --cache "$cache" "$@" && diff -r "$work/plain" "$work/cached" &&
        entries >"$work/left" && generate again --cache "$cache" "$@" && diff -r "$work/plain" "$work/again" &&
        entries | diff "$work/left" -
}
entries() { # with their inodes: a rewritten entry has a new inode
    find "$cache" -type f -printf '%p %i\n' | sort
}
is_mended() { # command...: the command spoils the entry $entry; the generator repairs it
    cp "$work/good" "$entry"
    "$@" && { [ ! -f "$entry" ] || ! cmp -s "$entry" "$work/good"; } && is_as_plain && cmp "$entry" "$work/good"
}
spoil() { # offset: changes one byte
    local byte
    byte=$(od -An -tu1 -j "$1" -N 1 "$entry")
    # shellcheck disable=SC2059 # the byte as an escape
    printf "$(printf '\\%03o' $((byte ^ 1)))" | dd of="$entry" bs=1 seek="$1" conv=notrunc status=none
}
cut_to() { # bytes
    truncate -s "$1" "$entry"
}
another() { # the entry of another shader
    cp "$other" "$entry"
}
by_pipe() {
    rm "$entry"
    mkfifo "$entry"
}

check "a first time" is_as_without
check "an edited body is seen" sed -i 's/display_store(p, vec4(/&0.5 * /' "$body"
check "... by what is made of it" is_as_without
generate before && cp "$work/before/vk/rsm.tonemap.comp.spv" "$work/edited.spv"
cp "$root/templates/shared/tonemap.glsl" "$body"
generate before && cp "$work/before/vk/rsm.tonemap.comp.spv" "$work/before.spv"
check "... which is other code" test "$(cmp -s "$work/edited.spv" "$work/before.spv" && echo same)" != same
check "what was there before the edit is still there" is_as_without
echo "#define max min" >>"$work/templates/shared/space.glsl"
check "an edited file that a body with ranges includes is seen" is_as_without
cp "$root/templates/shared/space.glsl" "$work/templates/shared"
check "so is another value of a parameter" is_as_without --set samples=16
check "and the other way to compile" is_as_without --set exactness=fast

rm -rf "$cache"
spec=$root/tests/specs/mips.yaml # any, and a small one
generate plain && generate cached --cache "$cache"
mapfile -t entries < <(find "$cache" -name '*.spv' | sort)
entry=${entries[0]} other=${entries[1]}
cp "$entry" "$work/good"
size=$(stat -c %s "$entry")
for offset in 0 8 16 $((size / 2)) $((size - 1)); do
    check "byte $offset is another: the entry is made anew" is_mended spoil "$offset"
done
for length in 0 16 $((size / 2)) $((size - 1)); do
    check "only $length bytes are left: the entry is made anew" is_mended cut_to "$length"
done
check "another shader's entry under its name is a miss, and made anew" is_mended another
check "an entry that is a pipe is a miss, and made anew" is_mended by_pipe
check "an entry that is missing is made anew" is_mended rm "$entry"

spec=$work/templates/rsm.yaml
# An entry larger than the default limit, last used two days ago: a new entry evicts it, unless DIPTYCH_CACHE_MIB is large.
keeps_old() { # samples, which makes new entries
    truncate -s 65M "$cache/old.spv" && touch -d '2 days ago' "$cache/old.spv" &&
        generate sized --cache "$cache" --set "samples=$1" && [ -e "$cache/old.spv" ]
}
env_keeps_old() { # DIPTYCH_CACHE_MIB samples
    DIPTYCH_CACHE_MIB=$1 keeps_old "$2"
}
check_status 1 "without DIPTYCH_CACHE_MIB the cache keeps to 64 MiB" keeps_old 8
check "a larger DIPTYCH_CACHE_MIB is heeded" env_keeps_old 100 32
check_status 1 "so is a smaller" env_keeps_old 1 48
check_status 1 "one that is no number is ignored" env_keeps_old 100x 80

# Errors come in order and with carets on every run, although shaders compile in parallel.
cat >>"$body" <<'BROKEN'
int broken_first() { return 1.5; }
BROKEN
sed -i 's/^void main() {$/&/; 1s/^/int broken_second() { return nothing; }\n/' "$work/templates/shared/gbuffer.glsl"
tells_the_same() {
    generate wrong 2>"$work/told"
    [ $? = 1 ] && grep -q "broken_first() { return 1.5; }" "$work/told" && grep -q "broken_second() { return nothing; }" "$work/told" || return
    for _ in 1 2 3 4 5; do
        generate wrong --cache "$cache" 2>"$work/again.told"
        [ $? = 1 ] && diff "$work/told" "$work/again.told" || return
    done
    [ ! -e "$work/wrong" ]
}
check "errors of two bodies are told in order" tells_the_same
finish
