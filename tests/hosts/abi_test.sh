#!/usr/bin/env bash
# abidiff compares the libraries' ABI with that of the last release with the same soname; tags are v0.1.0, and so on. Runs only
# with DIPTYCH_LONG, as the test builds that release. DIPTYCH_ABI_BASE selects another commit to compare with. The comparison
# itself is always tested, with libraries of changed sources. TAP.
. "$(dirname "$0")/../lib/tap.sh"
cd "$root" || exit 1
public=(templates/c/{diptych,panel,device_limits}.h templates/c/{formats,types}.def runtime_gl/diptych_gl.h runtime_vk/diptych_vk.h scenes/diptych_scene.h
    app/play/diptych_play.h)

if ! command -v abidiff >/dev/null; then
    skip "the ABI is that of the last release" "abidiff is not installed (abigail-tools)"
    finish
fi

# Types of the public headers must stay the same; new functions may appear. Types outside the public headers are private.
same_abi() { # tree library tree library
    local side
    for side in 1 3; do
        rm -rf "$work/headers$side"
        mkdir "$work/headers$side"
        (cd "${!side}" && cp "${public[@]}" "$work/headers$side") || return 2
    done
    abidiff --hd1 "$work/headers1" --hd2 "$work/headers3" --no-added-syms "$2" "$4"
}

# Compares a library of two of the sources with that of a copy in which sed has changed a file.
same_after() { # file sed-script
    rm -rf "$work/changed"
    mkdir "$work/changed"
    cp -r app base gen runtime_gl runtime_vk scenes templates "$work/changed"
    [ $# = 0 ] || sed -i "$2" "$work/changed/$1"
    [ $# = 0 ] || ! cmp -s "$1" "$work/changed/$1" || return 2
    library "$work/changed" && same_abi "$root" "$work/library.so" "$work/changed" "$work/changed/library.so"
}
library() { # tree
    (cd "$1" && cc -std=c11 -D_GNU_SOURCE -g -fPIC -fvisibility=hidden -shared -I. -Iapp -Itemplates/c \
        "-I$root/build/glad/include" -o "${2:-.}/library.so" runtime_vk/host.c app/play/player.c)
}
library "$root" "$work" || exit
check "abidiff accepts the same sources" same_after
check "... another member of a private struct" same_after runtime_vk/internal.h 's/^struct dt_vk_runtime {/& int added;/'
check "... another function" same_after app/play/diptych_play.h \
    's/^#pragma GCC visibility push.*/&\nvoid dt_play_added(void);\nvoid dt_play_added(void) {}/'
while read -r name file; do
    check_status 4 "... not another member of $name" same_after "$file" "s/^struct $name {/& int added;/"
done <<'END_OF_STRUCTS'
dt_vk_host runtime_vk/diptych_vk.h
dt_vk_image runtime_vk/diptych_vk.h
dt_resource templates/c/diptych.h
dt_panel templates/c/panel.h
dt_play_options app/play/diptych_play.h
END_OF_STRUCTS
check_status 4 "... not another enumerator before the others" same_after templates/c/diptych.h 's/^enum dt_kind {/& DT_NONE,/'

soversion=$(sed -n 's/^soversion = //p' build.ninja)
base=${DIPTYCH_ABI_BASE:-$(git tag --list "v$soversion*" --sort=version:refname 2>/dev/null | tail -n 1)}
reason=
[ -n "$base" ] || reason="no release has the soname $soversion"
[ -n "${DIPTYCH_LONG:-}" ] || reason="only with DIPTYCH_LONG"
if [ -n "$reason" ]; then
    skip "the ABI is that of the last release" "$reason"
    finish
fi
git worktree add -q --detach "$work/base" "$base" &&
    ninja -C "$work/base" libraries build/libdiptych_play.so >"$work/output" 2>&1
tap_result $? "the libraries of $base are built"
for library in build/library/libdiptych_{vk,gl,scene}.so.*.*.* build/libdiptych_play.so; do
    then=("$work/base/${library%.so*}".so*)
    check "$(basename "${library%.so*}") has the ABI of $base" same_abi "$work/base" "${then[0]}" "$root" "$library"
done
git worktree remove --force "$work/base"
finish
