#!/usr/bin/env bash
# Groups and repeats, tests/specs/groups.yaml: the backends agree, a spec expanded and unrolled by hand gives the same bytes, and
# the radix sort sorts. --set, tables, drawings and faults name the instances. TAP.
. "$(dirname "$0")/../lib/tap.sh"
gen=$build/diptych-gen
cd "$root" || exit 1
spec=tests/specs/groups.yaml

check "the backends agree, validation silent" "$diptych" compare --spec $spec --debug --backend gl,vk,gl+glsl
cp "$work/output" "$work/table"
for levels in 1 5; do
    check "... with $levels mips" "$diptych" compare --spec $spec --set levels=$levels --set bars=3
done

dump() { # spec backend
    "$diptych" render --spec "tests/specs/$1.yaml" --backend "$2" --dump "$work/$1.$2" || return
    local file
    for file in "$work/$1.$2"/*.raw; do # first.light.sum is first_light_sum
        file=${file##*/}
        mv "$work/$1.$2/$file" "$work/$1.$2/$(tr . _ <<<"${file%.raw}")" || return
    done
    rm "$work/$1.$2/manifest.json"
}
same_bytes() { # backend
    dump groups "$1" && dump groups_flat "$1" && diff -r "$work/groups.$1" "$work/groups_flat.$1" &&
        [ "$(find "$work/groups.$1" -type f | wc -l)" = 31 ]
}
for backend in gl vk; do
    check "expanded and unrolled by hand it leaves the same bytes: $backend" same_bytes $backend
done
sorts() {
    /usr/bin/python3 - "$work/groups.vk" <<'PYTHON'
import glob, struct, sys
first, last = (struct.unpack("<64I", open(glob.glob(f"{sys.argv[1]}/*_{name}_keys_0")[0], "rb").read()) for name in ("fill", "move_3"))
assert last != first and list(last) == sorted(first, key=lambda key: key % 256)
PYTHON
}
check "the repeated passes sort, and keep the order of equal keys" sorts

# Checks that --set changes the shaders of exactly these passes.
changes() { # PATH=VALUE passes
    rm -rf "$work/set"
    "$gen" "$spec" -o "$work/set" --set "$1" || return
    local found
    found=$(diff -rq "$work/generated/vk" "$work/set/vk" | sed -n 's/^Files.*groups\.\(.*\)\.comp and.*/\1/p' | paste -sd ' ')
    echo "changes $found"
    [ "$found" = "$2" ]
}
check "generates" "$gen" $spec -o "$work/generated" --graph "$work/graph.dot"
check "--set of a pass of an instance" changes passes.second.make.local=32 second.make
check "... of a group in a group" changes passes.first.light.add.local=32 first.light.add
check "... of a repeat" changes passes.down.3.defines.LEVEL=7 down.3
check "... of an instance's constant" changes constants.second.few=3 "second.light.add second.make"
check "... of its image" changes images.second.canvas.format=r16ui "light second.paint show"
says() { # text command...
    local text=$1
    shift
    "$@" 2>&1 | grep -F -- "$text"
}
wrong() { # path text
    check "--set $1 says: $2" says "$2" "$gen" $spec --check --set "$1"
}
wrong passes.secnd.make.local=8 "did you mean \`second.make\`?"
wrong passes.down.4.local=8 "did you mean \`down.1\`?"
wrong constants.second.fw=8 "did you mean \`second.few\`?"
wrong passes.0.as=third 'element 0 is a use or a repeat'
wrong groups.marks.args=[a] 'groups cannot be set'

check "the drawing names instances" grep -q 'first.light.add</b>' "$work/graph.dot"
check "the table does" grep -qE '^second\.paint +second\.canvas +768 +0 +equal' "$work/table"
check "list does" says '  part.2.sum        buffer' "$diptych" list --spec $spec
fault=("$planted" compare --spec "$spec" --fault vk:second.paint:bit:1)
check "a fault in an instance is found" says 'guilty: pass second.paint (shader groups_paint.glsl): resource second.canvas' \
    "${fault[@]}" --bisect "$work/guilty"
check "... and replayed" "$diptych" replay "$work/guilty" --backend vk
check "... and in a repeat" says 'guilty: pass down.2 ' "$planted" compare --spec $spec --fault gl:down.2:texel:1
check_status 1 "the contract of an instance's resource holds" "${fault[@]}" --set 'contracts.default={abs: 5e9}'
check "... and --set finds it" "${fault[@]}" --set 'contracts.default={abs: 5e9}' --set 'contracts.second.canvas={abs: 5e9}'
finish
