#!/usr/bin/env bash
# The two drawings of a pipeline: Graphviz accepts them without a message, and they match the spec (graph.py). For known
# pipelines the test checks sizes, barriers, and passes that a baked `when` leaves out. TAP.
. "$(dirname "$0")/../lib/tap.sh"
gen=$build/diptych-gen
cd "$root" || exit 1
python=/usr/bin/python3

draw() { # name spec [option...]
    local name=$1 spec=$2
    shift 2
    "$gen" "$spec" --graph "$work/$name.dot" --lifetimes "$work/${name}_lifetimes.dot" "$@"
}

accepted() { # name
    local file
    for file in "$1" "$1_lifetimes"; do
        dot -Tplain "$work/$file.dot" -o "$work/$file.plain" 2>"$work/words" || return
        [ ! -s "$work/words" ] || { cat "$work/words" && return 1; }
    done
}

has() { # file text...
    local file=$1 text
    shift
    for text in "$@"; do
        grep -qF -- "$text" "$work/$file" || { echo "no: $text" && return 1; }
    done
}

for spec in templates/ssvp.yaml templates/rsm.yaml tests/specs/{features,mips,racing,contracts,unwritten}.yaml tests/gen/golden/small.yaml; do
    name=$(basename "$spec" .yaml)
    check "$name is drawn" draw "$name" "$spec"
    if ! command -v dot >/dev/null; then
        skip "Graphviz takes $name" "dot is missing: install graphviz"
        continue
    fi
    check "Graphviz takes it without a word" accepted "$name"
    if $python -c 'import yaml' 2>/dev/null; then
        check "it tells what the spec says" $python tests/gen/graph.py "$spec" "$work/$name.dot" "$work/$name.plain" \
            "$work/${name}_lifetimes.dot"
    else
        skip "it tells what the spec says" "python3-yaml is missing"
    fi
done

# 1920 * 1080 * 16 bytes are 31.64 MiB; 8 maps of 256 * 256 * 8 bytes are 4 MiB; 240 * 8 is 1920, and 135 * 8 is 1080
check "sizes of resources and dispatches" has ssvp.dot 'rgba32f 1920×1080' '31.6 MiB' 'r32ui 256×256×8' '4.0 MiB' \
    'dispatch 240×135 workgroups of 8×8' 'draw of the scene, 8 instances'
check "what waits for what" has ssvp.dot 'colour attachment → compute storage read'
check "without maps of the second bounce and without bounces" draw none templates/ssvp.yaml --set second_clusters=0 --set bounces=0
check "... what a baked when leaves out" has none.dot ' d_second_map_test [' \
    '<b>second.map.test</b>&nbsp; left out: when bounces &gt; 1 &amp;&amp; second_clusters &gt; 0'
check "... passes are skipped by default" has none.dot ' p_shade [' 'SKIPPED by default: when bounces &gt; 0'
touch "$work/file"
check_status 2 "a place that cannot be written to" \
    "$gen" templates/rsm.yaml --graph "$work/one.dot" --lifetimes "$work/file/two.dot"
check "... and neither drawing is written" [ ! -e "$work/one.dot" ]
finish
