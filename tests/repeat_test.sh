#!/usr/bin/env bash
# The same bits on every run and for every number of driver threads: three runs with 1, 2 and 8 threads each, one hash per
# backend over everything that every pass wrote.
. "$(dirname "$0")/tap.sh"
scene=$root/scenes/cornell.yaml
for backend in gl vk; do
    for threads in 1 2 8; do
        for run in 1 2 3; do
            check "$backend renders with $threads threads, run $run" \
                env LP_NUM_THREADS=$threads "$diptych" render --scene "$scene" --backend $backend --size 61x35 --frames 2 \
                --dump "$work/$backend" -o "$work/picture.png"
            find "$work/$backend" -type f ! -name manifest.json -exec sha256sum {} + | sed 's| .*/| |' | sort | sha256sum >>"$work/hashes"
            rm -rf "${work:?}/$backend"
        done
    done
done
check "18 runs, one hash" bash -c "[ \$(wc -l <'$work/hashes') = 18 ] && [ \$(sort -u '$work/hashes' | wc -l) = 1 ]"
finish
