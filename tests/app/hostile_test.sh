#!/usr/bin/env bash
# Hostile input breaks nothing: huge specs, pipes and devices in place of files, full streams. Each run ends soon, with a message
# and the right exit status. TAP.
. "$(dirname "$0")/../lib/tap.sh"
gen=$build/diptych-gen
cd "$root" || exit 1

# ---- Sizes ----------------------------------------------------------------------------------------------------------

/usr/bin/python3 tests/app/hostile.py "$work"
ends() { # spec status text: within 10 s of processor time, five times the need of a loaded machine
    "$gen" --check --limit "${4:-10}" --templates templates "$work/$1.yaml" >"$work/said" 2>&1
    local status=$?
    cut -c 1-200 "$work/said" | head -n 3
    [ "$status" = "$2" ] && grep -qF -- "$3" "$work/said"
}
refuses_path() {
    local path
    printf -v path 'a.%.0s' $(seq 50000)
    (ulimit -v 500000 && "$gen" tests/specs/grey.yaml --check --set "${path}b=1") >"$work/said" 2>&1
    [ $? = 1 ] && head -c 200 "$work/said" && grep -q "the path is too long" "$work/said"
}
refuses_set() { # text set: in words of ours alone
    "$gen" tests/specs/grey.yaml --check --set "$2" >"$work/said" 2>&1
    [ $? = 1 ] && cat "$work/said" && grep -qF -- "$1" "$work/said" && ! grep -qE "<memory|\[ERR\]" "$work/said"
}
check "5,000 parameters" ends parameters 0 "4000 more of them are not shown"
check "5,000 equal keys" ends duplicates 1 "the key \`a\` stands twice"
check "10,000 errors" ends errors 1 "error: 9000 more of them are not shown"
check "a name of 1 MB" ends name 1 "has 1000000 characters; at most 100"
check "a text of 10 MB" ends doc 0 "1 passes"
check "1,000 passes" ends passes 0 "1000 passes"
check "an expression of 100,000 terms" ends terms 1 "error: more than 1000 terms in the expression \`1+1+"
check "... of 100,000 levels" ends nesting 1 "error: more than 64 nested levels"
check "constants that double" ends doubling 1 "the value of \`c9\` has more than 1000 terms with those of its constants"
check "2,000 constants of each other, backwards" ends chain 1 "more than 1000 terms"
check "a path of 50,000 levels" refuses_path
check "a path that is no name" refuses_set "no \`\"level\` in \`params\`" '"level=1'
check "... whose start is none" refuses_set "no \`\"a\` in the spec" '"a.b=1'
check "... of a part that the spec lacks" refuses_set "the spec has no \`local\` here" passes.paint.local.x=1
check "macros that double" ends macros 1 "more processor time than the limit" 1
check "... name the pass" grep -q "while compiling the pass fill ([^ ]*/macros.yaml:[0-9]*: macros.glsl)" "$work/said"
check "20,000 cases" ends cases 1 "more processor time than the limit" 1
check "20,000 blocks" ends braces 1 "memory exhausted"
check "a sum of 100,000 terms" ends sum 1 "nested too deeply, while compiling the pass"
not_compared() {
    "$diptych" compare --spec "$work/sum.yaml" >"$work/said" 2>&1
    [ $? = 2 ] && grep -qF "nested too deeply, while compiling the pass" "$work/said"
}
check "... which no comparison calls a difference" not_compared

# ---- Pipes and devices in place of files ----------------------------------------------------------------------------

mkfifo "$work/pipe"
ln -s /dev/zero "$work/zero"
sed "s|shader: fill.glsl|shader: pipe|" "$work/fill.yaml" >"$work/body_pipe.yaml"
sed "s|shader: fill.glsl|shader: zero|" "$work/fill.yaml" >"$work/body_zero.yaml"
refuses() { # text command...
    local text=$1 status
    shift
    limited 20 "$@" >"$work/said" 2>&1
    status=$?
    cat "$work/said"
    [[ $status = [12] ]] && grep -qF -- "$text" "$work/said"
}
check "a spec that is a pipe" refuses "it is no regular file" "$gen" --check "$work/pipe"
check "... a device" refuses "it is no regular file" "$gen" --check /dev/zero
check "a body that is a pipe" refuses "it is no regular file" "$gen" --check --templates templates "$work/body_pipe.yaml"
check "... a device" refuses "it is no regular file" "$gen" --check --templates templates "$work/body_zero.yaml"
scene=("$diptych" render --backend vk -o "$work/a.png" --spec "$work/fill.yaml")
check "a scene that is a pipe" refuses "it is no regular file" "${scene[@]}" --scene "$work/pipe"
check "a motion that is a device" refuses "it is no regular file" "${scene[@]}" --scene scenes/cornell.yaml --motion /dev/zero
check "an overlay that is a device" refuses "it is no regular file" "${scene[@]}" --scene scenes/cornell.yaml --with /dev/zero

# ---- Names ----------------------------------------------------------------------------------------------------------

check "every word of C23, C++20 and GLSL 4.60 and macros of <windows.h> as names" /usr/bin/python3 tests/gen/keywords.py "$gen" templates "$work"

# ---- Calls that fail, kills -----------------------------------------------------------------------------------------

samples=1 render=2
[ -z "${DIPTYCH_LONG:-}" ] || samples=20 render=0
failing=(/usr/bin/python3 tests/lib/failing.py "$build/tests/failing.so")
out=$work/out
generate=("$gen" tests/specs/features.yaml -o "$out" --depfile "$out/depfile")
if [ -n "${DIPTYCH_LONG:-}" ]; then # every call, for a small pipeline; a large one would take days
    small=("$gen" "$work/fill.yaml" --templates templates -o "$out")
    check "a small generation when any call fails" env "OLD=--set exactness=fast" FOREIGN=1 "${failing[@]}" 0 "$out" -- "${small[@]}"
fi
check "generation when a call fails" env "OLD=--set bins=8" FOREIGN=1 "${failing[@]}" $((samples * 3)) "$out" -- "${generate[@]}"
sweeps_its_own() { # removes temporary files of a killed run, but no file with a similar name
    mkdir -p "$out"
    touch "$out/notes.tmp-99999999" "$out/old.h.diptych-tmp-99999999"
    "${generate[@]}" && [ -e "$out/notes.tmp-99999999" ] && [ ! -e "$out/old.h.diptych-tmp-99999999" ]
}
check "a file of the user's own stays, what a killed run left goes" sweeps_its_own
check "generation that is killed" env KILL=1 "${failing[@]}" $samples "$out" -- "${generate[@]}"
mkdir "$work/picture"
cp tests/specs/features* "$work/picture/"
check "a picture when a file cannot be read or written" env "OLD=--set bins=8" "KINDS=open write rename" "FAIL_UNDER=$work" \
    "${failing[@]}" $render "$work/a.png" -- "$diptych" render --backend vk --scene scenes/cornell.yaml \
    --spec "$work/picture/features.yaml" --size 16x8 -o "$work/a.png"

# First, calls of diptych itself fail. Then calls of any library fail, where a driver may crash.
samples=2
[ -z "${DIPTYCH_LONG:-}" ] || samples=0
for backend in gl vk; do
    command=("$diptych" render --backend "$backend" --scene scenes/cornell.yaml --spec "$work/picture/features.yaml"
        --size 16x8 -o "$work/b.png")
    check "a picture with $backend when a call of diptych fails" env "OLD=--set bins=8" FAIL_OWN=1 FOREIGN=1 \
        "${failing[@]}" $samples "$work/b.png" -- "${command[@]}"
    [ -z "${DIPTYCH_LONG:-}" ] || check "... when any call fails" env "OLD=--set bins=8" FOREIGN=1 \
        "KINDS=malloc calloc realloc mmap write" "${failing[@]}" 40 "$work/b.png" -- "${command[@]}"
done

has_children() { # pid
    pgrep -f "$work/orphans" | grep -vqx "$1"
}
are_gone() {
    ! pgrep -f "$work/orphans" >/dev/null
}
leaves_nobody() { # command...: killed once its children run
    "$@" >"$work/said" 2>&1 &
    local pid=$! began=no
    wait_until has_children "$pid" && began=yes
    sleep 0.5
    kill -KILL "$pid"
    wait_until are_gone && [ "$began" = yes ] && return
    cat "$work/said"
    pgrep -af "$work/orphans"
    return 1
}
check "a killed sweep leaves no children" leaves_nobody "$diptych" sweep --scene scenes/cornell.yaml --size 320x180 \
    --grid bounces=1,2 -o "$work/orphans"
check "... a killed comparison" leaves_nobody "$diptych" compare --scene scenes/cornell.yaml --size 640x360 --frames 100 \
    --json "$work/orphans.json"

# ---- Scenes ---------------------------------------------------------------------------------------------------------

warns() { # text command...: prints the warning and succeeds
    local text=$1
    shift
    limited 60 "$@" >"$work/said" 2>&1 || { cat "$work/said"; return 1; }
    cat "$work/said"
    grep -qF -- "$text" "$work/said"
}
crash_is_told() { # command...: assimp 5.2 crashes, 5.4 does not
    local status=0
    "$@" >"$work/said" 2>&1 || status=$?
    cat "$work/said"
    [ "$status" = 0 ] || { [ "$status" = 1 ] && grep -q "early_map.mtl: the library that reads this file crashed" "$work/said"; }
}
check "materials at which a library crashes" crash_is_told "${scene[@]}" --scene "$work/early_map.yaml"
check "a mesh that is a device" refuses "/dev/zero: it is no regular file" "${scene[@]}" --scene "$work/zero_mesh.yaml"
check "materials" refuses "pipe: it is no regular file" "${scene[@]}" --scene "$work/pipe_mtl.yaml"
check "nodes that double" refuses "doubling.dae: reading it takes more memory than there is" "${scene[@]}" --scene "$work/doubling_nodes.yaml"
printf 'ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n' >"$work/cut.ply"
sed 's|^mesh: .*|mesh: cut.ply|' "$work/zero_mesh.yaml" >"$work/cut_ply.yaml"
ends_soon() { # assimp 5.2 does not see the end of the file, others do
    timeout 400 "$@" >"$work/said" 2>&1
    [ $? = 1 ] && cat "$work/said" && grep -q "cut.ply: " "$work/said"
}
[ -z "${DIPTYCH_LONG:-}" ] || check "a header without an end" ends_soon "${scene[@]}" --scene "$work/cut_ply.yaml"
check "too few open files" refuses "this process may not open so many" bash -c 'ulimit -n 7 && exec "$@"' bash "${scene[@]}" --scene scenes/cornell.yaml
printf 'newmtl red one\r\nKd 1 0 0\n' >"$work/named.mtl"
printf 'mtllib named.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red one\nf 1 2 3\nusemtl rde\nf 1 3 2\n' >"$work/named.obj"
sed 's|^mesh: .*|mesh: named.obj|' scenes/cornell.yaml >"$work/named.yaml"
check "a material that no library has" warns "named.obj: no material library has \`rde\`, which" "${scene[@]}" --scene "$work/named.yaml"
check "... and no other" [ "$(grep -c 'no material library' "$work/said")" = 1 ]
printf 'newmtl a\nKd 5 0 0\nd 0.5\nmap_Bump b.png\nmap_Kd -s 2 2 2 b.png\nnewmtl a\nd 0.5\n' >"$work/more.mtl"
sed 's/named.mtl/more.mtl/; s/red one/a/; s/rde/a/' "$work/named.obj" >"$work/more.obj"
sed 's|^mesh: .*|mesh: more.obj|' scenes/cornell.yaml >"$work/more.yaml"
check "what a library of materials has beyond a scene's" warns "more.mtl:5: \`map_Kd -s 2 2 2 b.png\`: options" "${scene[@]}" --scene "$work/more.yaml"
check "... each kind once" [ "$(grep -c 'more.mtl:' "$work/said")" = 5 ]
check "a texture" warns "pipe: it is no regular file; plain colour instead" "${scene[@]}" --scene "$work/pipe_map.yaml"
check "a texture of 900 million pixels" warns "30000x30000 pixels are too many" "${scene[@]}" --scene "$work/huge_map.yaml"

has_limit() { # the process that reads a scene has one of memory
    cat >"$work/limit.c" <<'END'
#include <stdio.h>
#include <sys/resource.h>
#include <unistd.h>
__attribute__((visibility("default"))) int setrlimit(__rlimit_resource_t kind, const struct rlimit *limit)
{
    if (kind == RLIMIT_AS || kind == RLIMIT_DATA)
        fprintf(stderr, "limit %d\n", limit->rlim_cur != RLIM_INFINITY);
    return 0;
}
END
    cc -shared -fPIC -D_GNU_SOURCE -o "$work/limit.so" "$work/limit.c" && LD_PRELOAD=$work/limit.so "$@" 2>&1 | grep -q "limit 1"
}
check "who reads a mesh has a limit of memory" has_limit "${scene[@]}" --scene scenes/cornell.yaml
check "... who reads a spec" has_limit "$gen" tests/specs/grey.yaml --check
# A driver that maps its cache dies of a full disk.
full_disk() {
    # shellcheck disable=SC2016
    unshare -rm sh -c 'mount -t tmpfs -o size=8k none "$1" && shift && MESA_SHADER_CACHE_DIR=$0 "$@"' "$work/full" "$work/full" "$diptych" render \
        --backend gl+glsl -o "$work/a.png" --spec tests/specs/mips.yaml --scene scenes/cornell.yaml --size 16x8 2>&1 | tee "$work/said"
    grep -q "Mesa keeps no shaders" "$work/said" && [ -s "$work/a.png" ]
}
mkdir "$work/full"
if unshare -rm mount -t tmpfs none "$work/full" 2>/dev/null; then
    rm -f "$work/a.png"
    check "a full disk under Mesa's cache" full_disk
else
    skip "a full disk under Mesa's cache" "the kernel allows no file system of its own"
fi

# ---- Evidence -------------------------------------------------------------------------------------------------------

mkdir "$work/spec"
cp tests/specs/features* "$work/spec/"
sed -i 's/histogram\[bin\].count = n;/&\n#ifdef VULKAN\n    histogram[bin].count += 1u;\n#endif/' "$work/spec/features_count.glsl"
"$diptych" compare --scene scenes/cornell.yaml --spec "$work/spec/features.yaml" --size 17x9 --bisect "$work/good" >"$work/said" 2>&1
damaged() { # text sed-script-for-the-manifest
    rm -rf "$work/evil" # as long as `good`: the check must not compare only as many first bytes of the path
    cp -r "$work/good" "$work/evil"
    sed -i "$2" "$work/evil/manifest.json"
    refuses "$1" "$diptych" replay "$work/evil" --backend vk --trust
}
check "a replay of a block outside the folder" damaged "outside the folder" 's#"frame_block":\s*"[^"]*"#"frame_block": "../good/frame.raw"#'
check "... of a device" damaged "outside the folder" 's#"frame_block":\s*"[^"]*"#"frame_block": "../../../../../../dev/zero"#'
check "... of a spec outside" damaged "outside the folder" 's#"spec":\s*"[^"]*"#"spec": "../good/spec/features.yaml"#'
rm -rf "$work/evil"
cp -r "$work/good" "$work/evil"
cp "$work/evil/spec/features_count.glsl" "$work/elsewhere.glsl"
ln -sf "$work/elsewhere.glsl" "$work/evil/spec/features_count.glsl"
check "... of a body outside" refuses "outside the folder that may be read" "$diptych" replay "$work/evil" --backend vk --trust

# ---- Streams --------------------------------------------------------------------------------------------------------

is_full() { # command...: with a full standard output
    "$@" >/dev/full 2>"$work/said"
    local status=$?
    cat "$work/said"
    [ "$status" = 2 ] && grep -q "standard output" "$work/said"
}
for words in --help --version --schema --reference --describe "--check templates/rsm.yaml"; do
    # shellcheck disable=SC2086 # words
    check "diptych-gen $words on a full disk" is_full "$gen" $words
done
for words in --help --version "help render" "render --help" list; do
    # shellcheck disable=SC2086
    check "diptych $words on a full disk" is_full "$diptych" $words
done
# ---- Paths ----------------------------------------------------------------------------------------------------------

ninja_reads_depfile() ( # in a shell of its own, for cd
    local odd="$work/deps/a b#c\$d\\ e\\f"
    mkdir -p "$odd" && cp "$work/fill.yaml" "$work/fill.glsl" "$odd/" && cd "$work/deps" || return
    cat >build.ninja <<END
rule gen
  command = '$gen' --templates '$root/templates' 'a b#c\$\$d\\ e\\f/fill.yaml' -o out --depfile out/d && touch \$out
  depfile = out/d
build out/big.h: gen
END
    ninja && ninja | grep "no work to do" && sleep 0.01 && touch "$odd/fill.glsl" && ninja -n | grep '^.1/1'
)
check "depfiles name paths with spaces, #, \$ and backslashes as ninja reads them" ninja_reads_depfile
mkdir "$work/broken
line" && cp "$work/fill.yaml" "$work/fill.glsl" "$work/broken
line/"
check "... and no line break" refuses "which has a line break" "$gen" --templates templates "$work/broken
line/fill.yaml" -o "$work/broken" --depfile "$work/broken.d"
finish
