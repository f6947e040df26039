#!/usr/bin/env bash
# The same bits on every run, for every number of driver threads and any old content of memory. Many runs of three frames,
# with history, give one hash per resource and backend, and all backends give the same hash. Two controls must be noticed: a
# pipeline that races, and a pipeline that leaves memory unwritten. One run for each number of threads on two backends, of ssvp (with
# one poison) or rsm, as SEED draws; with DIPTYCH_LONG, twenty runs on five backends.
. "$(dirname "$0")/../lib/tap.sh"
scene=$root/scenes/cornell.yaml
runs=${DIPTYCH_LONG:+20}
runs=${runs:-1}
frames=3
backends=(gl vk)
[ -z "${DIPTYCH_LONG:-}" ] || backends+=(gl+glsl osmesa zink)

# One run; appends "RESOURCE HASH", a line per resource and mip after every pass, to hashes_PIPELINE_BACKEND.
render() { # pipeline backend environment options...
    local pipeline=$1 backend=$2 environment=$3
    shift 3
    rm -rf "$work/dump"
    env "$environment" "$planted" render --scene "$scene" --backend "$backend" --size 37x23 --frames "$frames" --dump "$work/dump" \
        --spec "$root/$pipeline.yaml" "$@" || return
    (cd "$work/dump" && sha256sum -- *.raw | awk '{ print $2, $1 }') >>"$work/hashes_$(basename "$pipeline")_$backend"
}

renders() { # count pipeline backend environment options...
    local count=$1
    shift
    for ((run = 0; run < count; run++)); do
        render "$@" || return
    done
}

# Prints "RUNS runs, RESOURCES resources, HASHES hashes" for the lines of render.
counts() { # file
    awk '{ runs[$1]++; if (!seen[$0]++) hashes++ }
         END { for (name in runs) { resources++; least = !least || runs[name] < least ? runs[name] : least }
               printf "%d runs, %d resources, %d hashes", least, resources, hashes }' "$1"
}

one_hash_each() { # file runs
    local resources
    resources=$(cut -d' ' -f1 "$1" | sort -u | wc -l)
    counts "$1"
    [ "$resources" -gt 0 ] && [ "$(counts "$1")" = "$2 runs, $resources resources, $resources hashes" ] && return
    sort -u "$1" | cut -d' ' -f1 | uniq -d
    return 1
}

same_hashes() { # files...
    diff <(sort -u "$1") <(sort -u "$2")
}

differs() { # file
    ! one_hash_each "$@"
}

small=(--set rsm_size=64 --set tile="[3,2]")
shipped=(templates/ssvp templates/rsm)
seed=${SEED:-$RANDOM}
[ -n "${DIPTYCH_LONG:-}" ] || shipped=("${shipped[seed % 2]}")
for pipeline in "${shipped[@]}" tests/specs/features; do
    name=$(basename "$pipeline")
    options=()
    [ "$name" = features ] || options=("${small[@]}")
    [ "$name" != ssvp ] || options+=(--set first_vpls=64 --set second_vpls=96 --set clusters=3 --set map_size=32 --set map_triangles=300 --set cull_triangles=1024)
    numbers=(1 2 8) bytes=(85 255)
    [ "$name" != ssvp ] || [ -n "${DIPTYCH_LONG:-}" ] || numbers=(1 8) bytes=(255)
    for backend in "${backends[@]}"; do
        for threads in "${numbers[@]}"; do
            check "$name, $backend, $threads threads: $runs runs" \
                renders "$runs" "$pipeline" "$backend" LP_NUM_THREADS="$threads" "${options[@]}"
        done
        for byte in "${bytes[@]}"; do
            check "$name, $backend, memory poisoned with $byte" \
                renders 1 "$pipeline" "$backend" LVP_POISON_MEMORY=1 "${options[@]}" --poison "$byte"
        done
        check "$name, $backend, memory poisoned by lavapipe alone" \
            renders 1 "$pipeline" "$backend" LVP_POISON_MEMORY=1 "${options[@]}"
        file=$work/hashes_${name}_$backend
        check "$name, $backend: $(counts "$file")" one_hash_each "$file" $((${#numbers[@]} * runs + ${#bytes[@]} + 1))
        [ "$backend" = gl ] || check "$name: the same hashes from gl and $backend" \
            same_hashes "$work/hashes_${name}_gl" "$file"
    done
done

frames=1 # the controls have no history
for backend in gl vk; do
    file=$work/hashes_racing_$backend
    check "racing, $backend, one thread" renders 2 tests/specs/racing $backend LP_NUM_THREADS=1
    check "... is repeatable: $(counts "$file")" one_hash_each "$file" 2
    check "racing, $backend, eight threads" renders 2 tests/specs/racing $backend LP_NUM_THREADS=8
    check "... is not, which is noticed: $(counts "$file")" differs "$file" 4
    file=$work/hashes_unwritten_$backend
    for byte in 85 255; do
        check "unwritten, $backend, memory poisoned with $byte" \
            renders 1 tests/specs/unwritten $backend LVP_POISON_MEMORY=0 --poison "$byte"
    done
    check "... differs, which is noticed: $(counts "$file")" differs "$file" 2
done
rm -f "$work/hashes_unwritten_vk"
for poison in 0 1; do
    check "unwritten, vk, LVP_POISON_MEMORY=$poison" renders 1 tests/specs/unwritten vk LVP_POISON_MEMORY=$poison
done
check "... differs, which is noticed: $(counts "$work/hashes_unwritten_vk")" differs "$work/hashes_unwritten_vk" 2
rm -f "$work/hashes_unwritten_vk"
for poison in 0 1; do
    check "unwritten, vk, LVP_POISON_MEMORY=$poison, memory poisoned with 85" \
        renders 1 tests/specs/unwritten vk LVP_POISON_MEMORY=$poison --poison 85
done
check "... is the same: the driver's poison comes first" one_hash_each "$work/hashes_unwritten_vk" 2
finish
