#!/usr/bin/env bash
# tests/lib/adversary.c makes a Vulkan driver as inaccurate as the standards allow; it does not change OpenGL. Exact pipelines on that
# driver give the bits of OpenGL. With exactness: fast compare finds differences. TAP.
. "$(dirname "$0")/../lib/tap.sh"
cd "$root" || exit 1
adversary=(env "ADVERSARY=$work/modules" "LD_PRELOAD=$build/tests/adversary.so" "$diptych")

meets() { # pattern: matches the numbers of open operations, samplings and stores in all modules since the last call
    awk '{ open += $1; samples += $2; stores += $3 } END { print open, samples, stores }' "$work/modules" >"$work/sums"
    rm "$work/modules"
    grep -xE "$1" "$work/sums" || { cat "$work/sums"; false; }
}

small=(--scene scenes/cornell.yaml --size 32x18 --set rsm_size=32)
post=(--spec templates/post.yaml --input photo=templates/post/table.png)
for name in rsm ${DIPTYCH_LONG:+ssvp}; do
    check "$name: no bit differs" "${adversary[@]}" compare "${small[@]}" --spec "templates/$name.yaml"
    check "... nothing is open but how stores round" meets '0 0 [1-9][0-9]*'
done

differs() { # options...: a dump of the driver equals the driver's results, and differs from those with the adversary
    rm -rf "$work/dump"
    "$diptych" render --backend vk "$@" --dump "$work/dump" && "$diptych" compare --backend vk "$@" --against "$work/dump" || return
    "${adversary[@]}" compare --backend vk "$@" --against "$work/dump" >"$work/table"
    [ $? = 1 ] && grep '^guilty: ' "$work/table"
}
check "exactness: fast: bits differ" differs "${small[@]}" --spec templates/rsm.yaml --set exactness=fast
check "... by open operations" meets '[1-9][0-9]* [0-9]+ [1-9][0-9]*'
check "... also of a picture" differs "${post[@]}" --set exactness=fast
check "... which are filtered" meets '[1-9][0-9]* [1-9][0-9]* [1-9][0-9]*'
finish
