#!/usr/bin/env bash
# Pipelines of ours do nothing undefined, of any kind that --sanitize knows, or say why: specs of the tests and shipped ones, whose
# `allow` is of use. SEED draws four. Long: all of them, on two scenes and in two motions. TAP.
. "$(dirname "$0")/../lib/tap.sh"
scenes=("--scene $root/scenes/cornell.yaml")
seed=${SEED:-$RANDOM}
specs=("$root"/tests/specs/{atomics,bloom,features,layouts,parts,proof_open,shapes,whole,work}.yaml "$root"/templates/{machine,post,taa}.yaml)
if [ -n "${DIPTYCH_LONG:-}" ]; then
    scenes+=("${scenes[0]} --motion $root/scenes/cornell_light.yaml" "${scenes[0]} --motion $root/scenes/cornell_walk.yaml"
        "--scene $root/scenes/white_box.yaml")
    mapfile -t specs < <(grep -L '^inputs:\|input: true' "$root"/tests/specs/*.yaml)
    specs+=("$root"/templates/*.yaml)
else
    mapfile -t specs < <(printf '%s\n' "${specs[@]}" | shuf -n 4 --random-source=<(yes "$seed"))
fi
is_silent() { # spec scene
    local options
    read -ra options <<<"$2"
    case $1 in
    */post.yaml) options+=(--size 256x16 --input "photo=$root/templates/post/table.png") ;;
    */taa.yaml) options+=(--set rsm_size=64) ;;
    esac
    "$diptych" render --spec "$1" --size 48x27 --backend vk@llvmpipe --frames 2 --dump "$work/dump" \
        --sanitize "${options[@]}" >"$work/told" 2>"$work/errors"
    local status=$?
    cat "$work/told"
    grep -E "error:|silenced nothing" "$work/errors"
    [ "$status" = 0 ] && ! grep -q "silenced nothing" "$work/errors"
}
for scene in "${scenes[@]}"; do
    for spec in "${specs[@]}"; do
        grep -q '^pipeline:' "$spec" || continue
        check "$(basename "$spec" .yaml) (seed $seed) does nothing undefined with ${scene//"$root"\/scenes\//}, or says why" is_silent "$spec" "$scene"
    done
done
check "ssvp fits the memory of CPU drivers at its defaults, and reads no content of maps that it leaves out" \
    env -u GALLIVM_PERF "$diptych" render --scene "$root/scenes/cornell.yaml" --size 37x23 --backend gl -o "$work/small.png" --sanitize=content --set second_clusters=0
finish
