#!/usr/bin/env bash
# Folders and files of others: dumps, goldens, results of a bundle, overlays. They name files inside themselves only, cost no more than
# is asked for, and write no control characters to a terminal. TAP.
. "$(dirname "$0")/../lib/tap.sh"
cd "$root" || exit 1
grey=(--spec tests/specs/grey.yaml --size 16x8)

refuses() { # text command...: exit status 1 or 2, with that message, within 20 s of processor time and 4 GB
    local text=$1 status
    shift
    (ulimit -v 4000000 && limited 20 "$@") >"$work/said" 2>&1
    status=$?
    cat -v "$work/said"
    [[ $status = [12] ]] && grep -qF -- "$text" "$work/said"
}
edit() { # file expression: changes a JSON file by a Python expression of m
    /usr/bin/python3 -c 'import json, sys
m = json.load(open(sys.argv[1]))
exec(sys.argv[2])
json.dump(m, open(sys.argv[1], "w"))' "$@"
}

# ---- Dumps ----------------------------------------------------------------------------------------------------------

"$diptych" render "${grey[@]}" --backend vk --dump "$work/dump" || exit 1
raw=$(cd "$work/dump" && echo 00.*.raw)
against=("$diptych" compare "${grey[@]}" --backend vk --against)
again() { # the dump as it was written
    rm -rf "$work/theirs"
    cp -r "$work/dump" "$work/theirs"
}
again
check "a dump compares" "${against[@]}" "$work/theirs"
mkdir "$work/outside"
mv "$work/theirs/$raw" "$work/outside/"
ln -s "../outside/$raw" "$work/theirs/$raw"
check "a file that is a link" refuses "$raw: cannot be read: is a symbolic link" "${against[@]}" "$work/theirs"
again
edit "$work/theirs/manifest.json" "m['entries'][0]['file'] = '../outside/$raw'"
check "a file outside the folder" refuses "cannot be read: is outside the folder" "${against[@]}" "$work/theirs"
edit "$work/theirs/manifest.json" "m['entries'][0]['file'] = '/etc/passwd'"
check "... by an absolute path" refuses "cannot be read: is outside the folder" "${against[@]}" "$work/theirs"
again
rm "$work/theirs/$raw"
mkfifo "$work/theirs/$raw"
check "a pipe" refuses "is no file" "${against[@]}" "$work/theirs"
again
truncate -s 3G "$work/theirs/$raw"
check "a file of 3 GB is not read" refuses "has 3221225472 bytes, more than 2048" "${against[@]}" "$work/theirs"
truncate -s 3G "$work/theirs/manifest.json"
check "... a manifest" refuses "manifest.json: has 3221225472 bytes" "${against[@]}" "$work/theirs"
again
edit "$work/theirs/manifest.json" "m['device'] = '\x1b]0;owned\x07'"
shows_no_escape() {
    "${against[@]}" "$work/theirs" --json "$work/a.json" >"$work/said" 2>&1
    cat -v "$work/said"
    grep -qF '\x1b]0;owned\x07' "$work/said" && ! grep -q $'[\x1b\x07]' "$work/said" "$work/a.json"
}
check "control characters are escaped" shows_no_escape
json_is_utf8() { # names that are none
    local spec=$work/$'gr\xffy.yaml'
    mkdir -p "$work/grey"
    cp tests/specs/grey/* "$work/grey/"
    sed 's/level: {value: 0.2/level: {value: nothing/' tests/specs/grey.yaml >"$spec"
    "$diptych" compare --spec "$spec" --size 16x8 --json "$work/b.json" --junit "$work/b.xml" >"$work/said" 2>&1
    cp tests/specs/grey.yaml "$spec"
    "$diptych" compare --spec "$spec" --size 16x8 --json "$work/c.json" --junit "$work/c.xml" || return
    /usr/bin/python3 -c 'import json, sys, xml.dom.minidom
for file in sys.argv[1:]:
    text = open(file, "rb").read().decode()
    json.loads(text) if file.endswith("json") else xml.dom.minidom.parseString(text)' "$work/b.json" "$work/c.json" "$work/c.xml"
}
check "JSON and XML are UTF-8, whatever bytes a path has" json_is_utf8

# ---- Goldens --------------------------------------------------------------------------------------------------------

kept=("$diptych" compare "${grey[@]:0:2}" --golden "$work/kept")
"${kept[@]}" --size 16x8 --update >/dev/null || exit 1
cp -r "$work/kept" "$work/whole"
check "a golden folder compares" "${kept[@]}"
edit "$work/kept/manifest.json" "m['frame'] = 899999"
check "many frames are asked for" refuses "ask for as many: --frames 900000" "${kept[@]}"
edit "$work/kept/manifest.json" "m['frame'] = 0; m['pipeline'] = 'black'"
check "another pipeline" refuses "is of the pipeline black, this is grey" "${kept[@]}"
edit "$work/kept/manifest.json" "m['pipeline'] = 'grey'"
echo '{}' >>"$work/kept/manifest.json"
check "junk behind the manifest" refuses "manifest.json: is no JSON" "${kept[@]}"

# Ends the process after the N-th file that it removes.
cat >"$work/kill.c" <<'END'
#define _GNU_SOURCE
#include <dlfcn.h>
#include <signal.h>
#include <stdlib.h>
#include <unistd.h>
int remove(const char *path)
{
    static int count;
    int (*real)(const char *) = (int (*)(const char *))dlsym(RTLD_NEXT, "remove"), result = real(path);
    if (++count == atoi(getenv("KILL_AT")))
        kill(getpid(), SIGKILL);
    return result;
}
END
cc -shared -fPIC -o "$work/kill.so" "$work/kill.c" -ldl || exit 1
old_or_new() {
    local at
    for at in 1 2 3 4; do
        rm -rf "$work/kept"
        cp -r "$work/whole" "$work/kept"
        KILL_AT=$at LD_PRELOAD=$work/kill.so "${kept[@]}" --size 16x8 --set level=0.7 --update >/dev/null 2>&1
        [ $? = 137 ] || [ "$at" -gt 3 ] || return
        diff -rq "$work/whole" "$work/kept" >/dev/null || "${kept[@]}" --set level=0.7 || return
    done
    "${kept[@]}" --size 16x8 --set level=0.7 --update && [ -z "$(find "$work" -maxdepth 1 -name 'kept.*')" ]
}
check "an update that is killed leaves the old or the new folder" old_or_new

# ---- Bundles --------------------------------------------------------------------------------------------------------

mkdir "$work/bundle"
results='{"sides": [], "errors": []}'
echo "$results" >"$work/bundle/grey.bench.json"
echo "$results" >"$work/bundle/javascript:alert(1);x.bench.json"
echo 'a machine' >"$work/bundle/machine.txt"
echo 'a victim' >"$work/victim"
collect=("$diptych" report "$work/bundle" --collect)
page_is_safe() {
    "${collect[@]}" && grep -q 'href="grey.bench.txt"' "$work/bundle/index.html" &&
        ! grep -q 'javascript:' "$work/bundle/index.html"
}
check "no file name becomes a script" page_is_safe
ln -sf ../victim "$work/bundle/index.html"
check "a page that is a link" refuses "index.html: is a symbolic link" "${collect[@]}"
check "... keeps what it leads to" grep -qx 'a victim' "$work/victim"
rm "$work/bundle/index.html"
ln -sf ../victim "$work/bundle/machine.txt"
check "a text that is a link" refuses "machine.txt: cannot be read: is a symbolic link" "${collect[@]}"
check "... makes no page" [ ! -e "$work/bundle/index.html" ]

# Scripts run by their hash alone.
policy_holds() {
    /usr/bin/python3 -c 'import base64, glob, hashlib, re
script = re.search("<script>(.*?)</script>", open("templates/report/stack.html").read(), re.S)[1]
policy = "sha256-" + base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
for file in glob.glob("templates/report/*.html"):
    text = open(file).read()
    if "<head>" in text:
        source = re.search("Content-Security-Policy\" content=\"script-src .([^;]*).;", text)[1]
        assert source == (policy if "stack.html" in text else "none"), file'
}
check "pages run their own scripts alone" policy_holds

# ---- Limits and replays --------------------------------------------------------------------------------------------------

# A Vulkan driver tells what the process that loads it may do; a shader could do no more.
"$planted" compare "${grey[@]}" --fault vk:paint:bit --bisect "$work/case" >/dev/null 2>&1
mkdir "$work/driver" "$work/home"
machine=$(($(getconf _PHYS_PAGES) * $(getconf PAGESIZE) >> 30)) # GiB of memory
echo secret >"$work/home/secret"
cat >"$work/driver/spy.c" <<'END'
#include <net/if.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <unistd.h>
__attribute__((constructor)) static void spy(void)
{
    struct if_nameindex *names = if_nameindex();
    int count = 0;
    while (names && names[count].if_index)
        count++;
    struct rlimit memory, seconds;
    getrlimit(RLIMIT_DATA, &memory);
    getrlimit(RLIMIT_CPU, &seconds);
    fprintf(stderr, "limits: %d GiB, %d s\n", (int)(memory.rlim_cur >> 30), (int)seconds.rlim_cur);
    fprintf(stderr, "spy: file %s, variable %s, written %s, networks %d\n", access(SECRET, R_OK) ? "no" : "yes",
            getenv("SPY_SECRET") ? "yes" : "no", access(FOLDER, W_OK) ? "no" : "yes", count);
}
END
cc -shared -fPIC -DSECRET="\"$work/home/secret\"" -DFOLDER="\"$work/case\"" -o "$work/driver/spy.so" "$work/driver/spy.c" || exit 1
echo '{"file_format_version": "1.0.0", "ICD": {"library_path": "'"$work"'/driver/spy.so", "api_version": "1.3.0"}}' \
    >"$work/driver/spy.json"
spied() { # text option...: replays with that driver
    local text=$1
    shift
    env -u VK_ICD_FILENAMES VK_DRIVER_FILES="$work/driver/spy.json" SPY_SECRET=1 "$diptych" replay "$work/case" --backend vk "$@" \
        >"$work/said" 2>&1
    cat "$work/said"
    grep -q "spy: $text" "$work/said"
}
if bwrap --unshare-all --ro-bind / / --proc /proc --dev /dev true 2>/dev/null; then
    check "a replay sees no files, no variables, no network, and writes nothing" \
        spied "file no, variable no, written no, networks [01]$"
    check "... and has limits of memory and time" grep -q "^limits: $((machine < 16 ? machine : 16)) GiB, 1800 s$" "$work/said"
    # shellcheck disable=SC2016
    check "... but as JSON what it found" \
        bash -c '"$1" replay "$2/case" --backend gl --json "$2/replay.json" && grep -q as_expected "$2/replay.json"' - "$diptych" "$work"
else
    skip "a replay is confined" "bubblewrap makes no sandbox here"
fi
check "--trust lets it" spied "file yes, variable yes, written yes" --trust
check "... within the same limits" grep -q "^limits: $((machine < 16 ? machine : 16)) GiB, 1800 s$" "$work/said"
has_machine() { # a process that renders
    VK_DRIVER_FILES="$work/driver/spy.json" "$diptych" render "${grey[@]}" --backend vk -o "$work/a.png" 2>&1 | tee "$work/said"
    grep -q "^limits: $machine GiB, " "$work/said"
}
check "a render may take the memory of the machine" has_machine
tool_has_limit() { # Python, which explains a difference
    mkdir "$work/site" && echo 'import os, resource
open(os.environ["LIMIT"], "w").write(str(0 < resource.getrlimit(resource.RLIMIT_DATA)[0] <= 16 << 30))' >"$work/site/sitecustomize.py"
    "$diptych" render "${grey[@]}" --set level=0.7 --backend vk --dump "$work/brighter"
    LIMIT=$work/limit PYTHONPATH=$work/site "$diptych" compare "$work/dump" "$work/brighter"
    [ "$(cat "$work/limit")" = True ]
}
check "a tool has a limit of memory" tool_has_limit
warns_without() { # without bwrap in PATH
    mkdir -p "$work/bin" && ln -sf "$(command -v env)" "$work/bin/env"
    PATH=$work/bin "$diptych" replay "$work/case" --backend vk 2>&1 | grep "run without a sandbox: bubblewrap is not installed"
}
check "without bubblewrap it warns" warns_without

# ---- Models ---------------------------------------------------------------------------------------------------------

mkdir -p "$work/models/ship" "$work/models/shared"
cp tests/specs/outside_grade.png "$work/models/shared/t.png"
cp tests/specs/outside_grade.png "$work/t.png"
cp tests/specs/outside_grade.png "$work/models/ship/t.png"
printf 'newmtl m\nKd 1 0 0\n' >"$work/m.mtl"
ln -s ../../t.png "$work/models/ship/link.png"
scene() { # folder mesh: a scene file
    local light='{kind: directional, direction: [0, -1, 0], irradiance: [1, 1, 1]}'
    printf 'mesh: %s\ncamera: {eye: [0, 0, 5], target: [0, 0, 0], fov_y: 40}\nlight: %s\n' "$2" "$light" >"$work/models/$1/scene.yaml"
    show=("$diptych" render "${grey[@]}" --backend vk -o "$work/a.png" --scene "$work/models/$1/scene.yaml")
}
obj() { # library texture: a model that names them
    printf 'newmtl m\nmap_Kd %s\n' "$2" >"$work/models/ship/m.mtl"
    printf 'mtllib %s\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n' "$1" >"$work/models/ship/m.obj"
}
gltf() { # buffer image
    printf '{"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}], "buffers": [{"byteLength": 36, "uri": "%s"}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}], "bufferViews": [{"buffer": 0, "byteLength": 36}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}], "textures": [{"source": 0}],
"materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}], "images": [{"uri": "%s"}]}' "$1" "$2" >"$work/models/ship/m.gltf"
}
/usr/bin/python3 -c 'import struct, sys
open(sys.argv[1], "wb").write(struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0))' "$work/models/ship/m.bin"
outside="names this file, which is outside the folders of the mesh and of the scene file"
scene ship m.obj
obj m.mtl t.png
check "a model names files beside it" "${show[@]}"
obj ../../m.mtl t.png
check "... no materials outside its folder" refuses "$outside" "${show[@]}"
for name in /etc/passwd ../../t.png ../shared/t.png link.png; do
    obj m.mtl "$name"
    check "... and not the picture $name" refuses "$outside" "${show[@]}"
done
scene . ship/m.obj
obj m.mtl ../shared/t.png
check "... unless the scene file's folder has it" "${show[@]}"
scene ship m.gltf
gltf m.bin t.png
check "glTF" "${show[@]}"
for name in /etc/passwd file:///etc/passwd ../../../../../../../../etc/passwd %2e%2e/%2E%2E/t.png link.png; do
    gltf "$name" t.png
    check "... and not the buffer $name" refuses "$outside" "${show[@]}"
    gltf m.bin "$name"
    check "... and not the picture $name" refuses "$outside" "${show[@]}"
done

# ---- Overlays -------------------------------------------------------------------------------------------------------

overlay=("$diptych" list "${grey[@]:0:2}" --with "$work/tuned.yaml")
for path in passes.paint.limit passes.paint.shader images.radiance.format include pipeline doc origin exactness params.level.max; do
    printf -- '# tuned\n- %s=%s\n' "$path" "$work/evil.c" >"$work/tuned.yaml"
    check "an overlay sets no $path" refuses "tuned.yaml:2:3: error: an overlay sets parameters" "${overlay[@]}"
done
printf -- '- level=0.5\n- passes.paint.local=[16,8]\n' >"$work/tuned.yaml"
check "... but parameters and workgroups" "${overlay[@]}"
printf -- '- params.level.value=0.5\n- params.level=0.4\n' >"$work/tuned.yaml"
check "... by their paths, too" "${overlay[@]}"
printf -- '- level=0.5\n\0- level=7\n' >"$work/tuned.yaml"
check "an overlay is text to its end" refuses "it has a byte of zero" "${overlay[@]}"
finish
