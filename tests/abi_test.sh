#!/usr/bin/env bash
# The libraries' ABI is that of the last release with the same soname, by abidiff: tags are v0.1.0, and so on. Only with DIPTYCH_LONG,
# as the release is built for it. DIPTYCH_ABI_BASE is another commit to compare with. TAP.
. "$(dirname "$0")/tap.sh"
cd "$root" || exit 1
soversion=$(sed -n 's/^soversion = //p' build.ninja)
base=${DIPTYCH_ABI_BASE:-$(git tag --list "v$soversion*" --sort=version:refname 2>/dev/null | tail -n 1)}
reason=
[ -n "$base" ] || reason="no release has the soname $soversion"
command -v abidiff >/dev/null || reason="abidiff is not installed (abigail-tools)"
[ -n "${DIPTYCH_LONG:-}" ] || reason="only with DIPTYCH_LONG"
if [ -n "$reason" ]; then
    skip "the ABI is that of the last release" "$reason"
    finish
fi
git worktree add -q --detach "$work/base" "$base" && ninja -C "$work/base" libraries >"$work/output" 2>&1
tap_result $? "the libraries of $base are built"
for name in vk gl scene; do
    libraries=(build/library/libdiptych_"$name".so.*.*.*)
    then=("$work/base/${libraries[0]%.so.*}".so.*.*.*)
    public=(--drop-private-types)
    for header in templates/c/diptych.h templates/c/panel.h runtime_*/diptych_*.h scenes/diptych_scene.h; do
        public+=(--hf1 "$work/base/$header" --hf2 "$root/$header")
    done
    # 4: changed, 8: incompatible; additions are compatible
    abidiff "${public[@]}" --no-added-syms "${then[0]}" "${libraries[0]}" >"$work/output" 2>&1
    (($? & 8 ? 0 : 1))
    tap_result $? "libdiptych_$name is compatible with $base"
done
git worktree remove --force "$work/base"
finish
