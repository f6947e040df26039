#!/usr/bin/env bash
# Moves the files of `ninja install` to another folder and uses them there, with the source tree hidden: the command, and foreign
# renderers (tests/hosts/examples). Two renderers run the pipelines and get the command's bits; two pass their own G-buffer to a pipeline.
# CMake and Meson build a project with the installed files. TAP.
. "$(dirname "$0")/../lib/tap.sh"
cd "$root" || exit
size=(76 46)
frames=2
rsm=(--set rsm_size=64 --set samples=8)
ssvp=(--set rsm_size=64 --set map_size=32 --set first_vpls=32 --set second_vpls=32) # drivers compile fewer VPLs sooner
version=$(sed -n 's/^version = //p' build.ninja)
soversion=$(sed -n 's/^soversion = //p' build.ninja)
scene=share/diptych/scenes/cornell.yaml

installs() {
    DESTDIR=$work/dest PREFIX=/opt/diptych sh app/install.sh "$version"
}
# ninja would run the same command line as this test.
ninja_runs_it() {
    ninja -t commands -s install | grep -Fx "sh app/install.sh $version"
}
refuses_relative() {
    ! DESTDIR='' PREFIX=somewhere sh app/install.sh "$version" && [ ! -e somewhere ]
}
modes_are_right() { # programs 755, folders 755, all else 644
    find "$work/dest" \( -type f -path '*/bin/*' ! -perm 755 \) -o \( -type d ! -perm 755 \) -o \
        \( -type f ! -path '*/bin/*' ! -perm 644 \) -o -name '*.new.*' | tee "$work/odd" && [ ! -s "$work/odd" ]
}
names_no_dest() {
    ! grep -rl "$work/dest" "$work/dest"
}

check "install puts everything under DESTDIR" installs
check "... as ninja install does" ninja_runs_it
check "... with the modes that belong" modes_are_right
check "... and no file names DESTDIR" names_no_dest
check "... nor does it install to a relative path" refuses_relative
check "the license is installed" cmp LICENSE "$work/dest/opt/diptych/share/doc/diptych/LICENSE"
check "... and the reference of specs" cmp <("$build/diptych-gen" --reference) \
    "$work/dest/opt/diptych/share/doc/diptych/reference.md"

uninstalls() {
    cp -a "$work/dest" "$work/away" && DESTDIR=$work/away PREFIX=/opt/diptych sh app/install.sh "$version" uninstall && find "$work/away" ! -type d | tee "$work/odd" && [ ! -s "$work/odd" ]
}
check "uninstall leaves no file" uninstalls

installed=$work/moved
mv "$work/dest/opt/diptych" "$installed"
export MESA_SHADER_CACHE_DIR=${MESA_SHADER_CACHE_DIR:-${XDG_CACHE_HOME:-$HOME/.cache}} # Mesa need not compile again what other tests compile
export PKG_CONFIG_PATH=$installed/lib/pkgconfig XDG_CACHE_HOME=$work/cache LD_LIBRARY_PATH=$installed/lib

# ---- Symbols ----

only_own_symbols() { # nothing defined but dt_..., no function of the graphics APIs needed
    local file
    for file in "$installed"/lib/libdiptych_{gl,vk,scene}.so; do
        nm -D --defined-only "$file" | awk '{ print $3 }' | grep -v '^dt_' && return 1
        nm -D --undefined-only "$file" | grep -E ' U (vk|gl|egl)[A-Z]' && return 1
        readelf -d "$file" | grep -E 'NEEDED.*(stdc|vulkan|libGL|libEGL|glfw)' && return 1
        readelf -d "$file" | grep -q "SONAME.*$(basename "$file").$soversion\]" || return
    done
    for file in "$installed"/lib/libdiptych_*.a; do
        nm -g --defined-only "$file" | awk 'NF == 3 { print $3 }' | grep -v '^dt_' && return 1
        nm -u "$file" | grep -E ' U ((vk|gl|egl)[A-Z]|exit|abort|puts|printf|stdout|stderr|setenv)' && return 1
        size -A "$file" | awk '($1 == ".data" || $1 == ".bss") && $2 != 0 { print; bad = 1 } END { exit bad }' || return
    done
    return 0
}
check "libraries define dt_ names alone, need no loader, keep no state and print nothing" only_own_symbols

player_exports() { # exports no names of the libraries inside; names that begin with _ are the linker's
    nm -D --defined-only "$installed/lib/libdiptych_play.so" | awk '$3 !~ /^_/ { print $3 }' | grep -v '^dt_play_' && return 1
    readelf -d "$installed/lib/libdiptych_play.so" | grep -q "SONAME.*libdiptych_play.so.$soversion\]"
}
check "the player defines dt_play_ names alone" player_exports

# ---- The command, from another folder ----

# Mounts an empty file system over the source tree, where the kernel permits that.
hidden=(unshare -rm sh -c "mount -t tmpfs none '$root' && cd '$work' && exec \"\$@\"" sh)
"${hidden[@]}" true 2>"$work/output" || hidden=()
hide() { # command...
    if [ ${#hidden[@]} = 0 ]; then (cd "$work" && "$@"); else "${hidden[@]}" "$@"; fi
}
if [ ${#hidden[@]} = 0 ]; then skip "the source tree is out of sight" "unshare cannot mount here"; fi

installed_diptych() { # verb...
    hide "$installed/bin/diptych" "$@" --size "${size[0]}x${size[1]}"
}
in_cache() {
    [ -d "$work/cache/diptych" ] && [ ! -e "$installed/bin/cache" ]
}
no_ego() { # the cache was compiled from installed files alone
    ! grep -rl --include='*.d' "$root/" "$work/cache"
}
for backend in gl vk; do
    check "the installed command renders with $backend" installed_diptych render --scene "$installed/$scene" \
        --backend $backend --frames $frames --dump "$work/$backend" "${ssvp[@]}"
done
check "... a second time without a compiler" env PATH= "$(command -v env)" -u CC "$installed/bin/diptych" render \
    --scene "$installed/$scene" --backend vk --size "${size[0]}x${size[1]}" "${ssvp[@]}" -o "$work/small.png"
check "... caches where the user's files are" in_cache
check "... made of what is installed" no_ego
python_renders() { # the module's bits are the command's
    hide env "PYTHONPATH=$installed/lib/python3/dist-packages" /usr/bin/python3 -c "
import diptych
pipeline = diptych.open('$installed/share/diptych/templates/ssvp.yaml', scene='$installed/$scene', size=(${size[0]}, ${size[1]}),
    sets=dict(word.split('=') for word in '${ssvp[*]}'.split() if '=' in word))
pipeline.render()
pipeline.render('display')['display'].tofile('$work/display.raw')" && cmp "$work/display.raw" "$work"/vk/*.display.raw
}
check "the headers of the tap are installed" cc -std=c99 -fsyntax-only -include stdio.h -include vulkan/vulkan.h "-I$installed/include/diptych" \
    -x c "$installed/include/diptych/diptych_tap_vk.h"
if /usr/bin/python3 -c 'import numpy' 2>"$work/output"; then
    check "the installed Python module renders, too" python_renders
else
    skip "the installed Python module" "needs python3-numpy"
fi
check "the installed command compares, another pipeline" installed_diptych compare --scene "$installed/$scene" \
    --spec "$installed/share/diptych/templates/rsm.yaml" "${rsm[@]}"
check "... and measures, limits included" installed_diptych bench --scene "$installed/$scene" --frames 1 --warmup 1 \
    --spec "$installed/share/diptych/templates/rsm.yaml" "${rsm[@]}" --json "$work/bench.json"
check "rsm for the hosts" installed_diptych render --scene "$installed/$scene" --backend vk --frames $frames \
    --spec "$installed/share/diptych/templates/rsm.yaml" "${rsm[@]}" --dump "$work/rsm"

# ---- Manual pages and completion ----

options_in_help() { # command...: a line each
    "$@" --help | sed -n 's/^  \(-[^ ]*\).*/\1/p' | sort -u
}
completed() { # word...: bash's completions of the last word
    bash -c 'source "$1" && shift && COMP_WORDS=("$@") && COMP_CWORD=$(($# - 1)) &&
        "_${1//-/_}" && printf "%s\n" "${COMPREPLY[@]}"' bash \
        "$installed/share/bash-completion/completions/$1" "$@" | sort -u
}
completes_all() { # every verb and every option that --help lists, and no other
    local verb verbs
    verbs=$("$installed/bin/diptych" --help | sed -n 's/^  \([a-z]*\)  .*/\1/p' | sort)
    diff <(echo "$verbs") <(completed diptych "" | grep -v -e --help -e --version) || return
    for verb in $verbs; do
        diff <(options_in_help "$installed/bin/diptych" "$verb") <(completed diptych "$verb" -) || return
    done
    diff <(options_in_help "$installed/bin/diptych-gen") <(completed diptych-gen -)
}
completes_arguments() {
    [ "$(completed diptych render --context o)" = osmesa ] &&
        [ "$(completed diptych view --backend bo)" = both ] &&
        [ "$(cd "$installed" && completed diptych render --scene sha)" = share ] &&
        [ "$(cd "$installed" && completed diptych-gen --templates inc)" = include ]
}
manual_has_all() { # the pages have every option, and groff reports no error
    local page="$installed/share/man/man1" verb
    for verb in $("$installed/bin/diptych" --help | sed -n 's/^  \([a-z]*\)  .*/\1/p'); do
        diff <(options_in_help "$installed/bin/diptych" "$verb") \
            <(sed -n "/^\.SS $verb\$/,/^\.S[SH]/s/^\.BI \"\([^\"]*\)\".*/\1/p" "$page/diptych.1" | tr -d '\134' |
                grep '^-' | sort -u) || return
    done
    ! command -v groff >/dev/null || groff -man -ww -z "$page"/diptych{,-gen}.1 2>&1 | tee "$work/groff"
    [ ! -s "$work/groff" ]
}
check "bash completes every verb and option that --help lists" completes_all
check "... and their arguments" completes_arguments
check "manual pages have every option, and are well formed" manual_has_all
versions_agree() {
    for name in gl vk scene play; do
        for program in diptych diptych-gen; do
            [ "$program $(pkg-config --modversion "diptych-$name")" = "$("$installed/bin/$program" --version)" ] || return
        done
    done
    printf '%s\n' "#include <diptych.h>" DT_VERSION_MAJOR.DT_VERSION_MINOR.DT_VERSION_PATCH |
        cc -E -P "-I$installed/include/diptych" - | tail -n 1 | tr -d ' ' | grep -Fx "$version"
}
check "all say the same version" versions_agree
has_prefix() { # every tag of the headers begins with dt_, or with tap_
    ! cat "$installed"/include/diptych/*.h | cc -fpreprocessed -dD -E -P -x c - | grep -oE '\b(struct|enum) [a-z_]+' | grep -vE ' (dt_.*|tap(_.*)?)$'
}
check "names of structs and enums have the prefix of the project" has_prefix

# ---- Hosts ----

gen=$(pkg-config --variable=generator diptych-vk)
templates=$(pkg-config --variable=templates diptych-vk)
mkdir "$work/host"
cp tests/hosts/examples/*.{c,h,cpp,yaml,glsl} "$work/host"

generate() {
    hide "$gen" "$templates/ssvp.yaml" -o "$work/host" "${ssvp[@]}" && hide "$gen" "$templates/rsm.yaml" -o "$work/host" "${rsm[@]}" &&
        hide "$gen" "$work/host/lit.yaml" --glsl -o "$work/host"
}
build_host() { # gl|vk library...
    local api=$1 cflags sources=()
    shift
    read -ra cflags < <(pkg-config --cflags "diptych-$api" diptych-scene)
    for name in "host_$api" "renderer_$api" ssvp "ssvp_${api}_shaders" rsm "rsm_${api}_shaders"; do sources+=("$work/host/$name.c"); done
    hide cc -std=c11 -D_GNU_SOURCE -Wall -Wextra -Werror "-I$work/host" "${cflags[@]}" "${sources[@]}" \
        -o "$work/host/host_$api" "$@"
}
build_inputs_vk() { # library...
    local flags
    read -ra flags < <(pkg-config --cflags diptych-vk)
    flags+=(-O1 -Wall -Wextra -Werror "-I$work/host")
    for name in renderer_vk lit lit_vk_shaders; do
        hide cc -std=c11 -D_GNU_SOURCE "${flags[@]}" -c "$work/host/$name.c" -o "$work/host/$name.o" || return
    done
    hide c++ -std=c++17 "${flags[@]}" "$work/host/host_inputs_vk.cpp" "$work"/host/{renderer_vk,lit,lit_vk_shaders}.o \
        -o "$work/host/host_inputs_vk" "$@"
}
build_inputs_gl() { # library...
    local flags
    read -ra flags < <(pkg-config --cflags diptych-gl)
    hide cc -std=c11 -D_GNU_SOURCE -Wall -Wextra -Werror "-I$work/host" "${flags[@]}" \
        "$work"/host/{host_inputs_gl,renderer_gl,lit,lit_gl_shaders}.c -o "$work/host/host_inputs_gl" "$@"
}
run_silent() { # host argument...; a word of validation or KHR_debug fails it
    local host=$1
    shift
    VK_INSTANCE_LAYERS=VK_LAYER_KHRONOS_validation HOST_DEBUG=1 \
        VK_LAYER_ENABLES=VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT:VALIDATION_CHECK_ENABLE_SYNCHRONIZATION_VALIDATION_QUEUE_SUBMIT \
        hide "$work/host/$host" "$@" && [ ! -s "$work/output" ]
}
run_host() { # gl|vk picture-of-a-second-ssvp...
    local api=$1
    shift
    run_silent "host_$api" "$installed/$scene" "${size[@]}" "$frames" "$work/host/$api.ssvp.ppm" \
        "$work/host/$api.rsm.ppm" "$@"
}
same_picture() { # PPM dump
    /usr/bin/python3 - "$@" <<'END'
import json, sys
lines, pixels = open(sys.argv[1], "rb").read().split(b"255\n", 1)
manifest = json.load(open(sys.argv[2] + "/manifest.json"))
entry = [e for e in manifest["entries"] if e["resource"] == "display"][-1]
texels, width = open(sys.argv[2] + "/" + entry["file"], "rb").read(), entry["width"]
rows = [texels[at:at + 4 * width] for at in range(0, len(texels), 4 * width)]
wanted = b"".join(row[i:i + 3] for row in reversed(rows) for i in range(0, 4 * width, 4))
sys.exit(pixels != wanted or len(set(pixels)) < 50)
END
}
same_pictures() { # gl|vk
    same_picture "$work/host/$1.ssvp.ppm" "$work/$1" && same_picture "$work/host/$1.rsm.ppm" "$work/rsm" &&
        { [ "$1" = gl ] || cmp "$work/host/$1.ssvp.ppm" "$work/host/$1.second.ppm"; }
}
read -ra shared < <(pkg-config --libs diptych-vk diptych-scene)
read -ra private < <(pkg-config --static --libs-only-l --libs-only-other diptych-gl diptych-scene | sed 's/-ldiptych_[a-z]*//g')
check "the installed generator generates" generate
takes_version() { # MAJOR|MINOR|PATCH number: compiles a host against a diptych.h with this part of the version
    mkdir -p "$work/version"
    sed "s/^#define DT_VERSION_$1 .*/#define DT_VERSION_$1 $2/" "$installed/include/diptych/diptych.h" >"$work/version/diptych.h"
    grep -qx "#define DT_VERSION_$1 $2" "$work/version/diptych.h" || return 2
    cc -std=c11 -fsyntax-only "-I$work/version" "-I$installed/include/diptych" -x c "$work/host/ssvp.h"
}
other_version() {
    takes_version "$@" >"$work/version.log" 2>&1
    [ $? = 1 ] && [ "$(grep -c 'error: #error "diptych.h is of another version' "$work/version.log")" = 1 ]
}
check "its headers take a newer patch of diptych.h" takes_version PATCH 9
check "... and no other minor version" other_version MINOR 9
check "... nor another major one" other_version MAJOR 9

stays_small() { # folder bytes
    local api
    for api in gl vk; do
        hide cc -std=c11 -O0 -fPIC "-I$installed/include/diptych" -c "$1/ssvp_${api}_shaders.c" -o "$work/${api}_shaders.o" || return
    done
    wc -c "$work"/{gl,vk}_shaders.o
    [ "$(cat "$work"/{gl,vk}_shaders.o | wc -c)" -le "$2" ]
}
check "ssvp for CPU drivers alone" hide "$gen" "$templates/ssvp.yaml" -o "$work/alone" --set target=software
check "... its shaders for both APIs are 890 KB at most" stays_small "$work/alone" 890000
check "... and with those for GPUs" hide "$gen" "$templates/ssvp.yaml" -o "$work/both"
check "... 1620 KB" stays_small "$work/both" 1620000
check "a Vulkan renderer builds with shared libraries" build_host vk "${shared[@]}" -lvulkan
check "... runs two pipelines and a second view on its own threads, and validation is silent" \
    run_host vk "$work/host/vk.second.ppm"
check "... to the bits that the command has" same_pictures vk
check "a C++ renderer with a G-buffer of its own builds with shared libraries" build_inputs_vk "${shared[@]}" -lvulkan
check "... has it lit in two views, and validation is silent" run_silent host_inputs_vk
check "an OpenGL renderer builds with static libraries" build_host gl "$installed"/lib/libdiptych_{gl,scene}.a \
    "${private[@]}" -lEGL -lGL
check "... runs two pipelines in its own context, whose state is as it was" run_host gl
check "... to the bits that the command has" same_pictures gl

check "an OpenGL renderer with a G-buffer of its own builds with static libraries" build_inputs_gl \
    "$installed"/lib/libdiptych_gl.a "${private[@]}" -lEGL -lGL
check "... has it lit in two views, of SPIR-V and of GLSL" run_silent host_inputs_gl

# A wall whose texture is a picture rendered above, in the host's own texture array.
mkdir "$work/wall"
cat >"$work/wall/wall.obj" <<'END'
mtllib wall.mtl
usemtl wall
v -1 -1 0
v 1 -1 0
v 1 1 0
v -1 1 0
vt 0 0
vt 1 0
vt 1 1
vt 0 1
f 1/1 2/2 3/3
f 1/1 3/3 4/4
END
printf '%s\n' "newmtl wall" "Kd 1 1 1" "map_Kd wall.png" >"$work/wall/wall.mtl"
cp "$work/small.png" "$work/wall/wall.png"
printf '%s\n' "mesh: wall.obj" "camera: {eye: [0, 0, 2], target: [0, 0, 0], fov_y: 50}" \
    "light: {kind: spot, position: [0.5, 0.5, 2], target: [0, 0, 0], cone: [30, 40], intensity: [9, 9, 9]}" \
    >"$work/wall/wall.yaml"
run_textured() {
    hide "$work/host/host_gl" "$work/wall/wall.yaml" "${size[@]}" 1 "$work/wall/wall.ppm" &&
        [ ! -s "$work/output" ] && installed_diptych render --scene "$work/wall/wall.yaml" --backend gl --dump "$work/wall/gl" "${ssvp[@]}"
}
check "... and with textures" run_textured
check "... to the bits that the command has" same_picture "$work/wall/wall.ppm" "$work/wall/gl"

both_static() { # libraries in one program, from C++
    cat >"$work/host/both.cpp" <<'END'
#include <diptych_gl.h>
#include <diptych_scene.h>
#include <diptych_vk.h>

#include "ssvp.h"

int main()
{
    dt_vk_host vk = {};
    dt_gl_host gl = {};
    ssvp_live live = {};
    return dt_vk_open(&vk) || dt_gl_open(&gl) || live.bounces || dt_scene_open("", nullptr, &vk.log);
}
END
    # Names of a loader's variables and of a renderer's functions, which must not clash with the libraries.
    echo "void *vkCreateBuffer, *glad_glBindBuffer; int vk_check, gl_check, scene_load;" >"$work/host/names.c"
    read -ra cflags < <(pkg-config --cflags diptych-vk)
    hide cc -c "$work/host/names.c" -o "$work/host/names.o" && hide c++ -std=c++17 -Wall -Wextra -Werror \
        "-I$work/host" "${cflags[@]}" "$work/host/both.cpp" "$work/host/names.o" -o "$work/host/both" "$installed"/lib/libdiptych_{gl,vk,scene}.a "${private[@]}" && hide "$work/host/both"
}
check "all three libraries go into one C++ program, beside its own names" both_static

# ---- Build systems ----

# Builds tests/hosts/examples/project with one build system: each step does the necessary work and no more.
built() { # least pattern command...: at least this number of the build's lines match the pattern; 0: none match
    local least=$1 pattern=$2 count
    shift 2
    hide "$@" >"$work/built" 2>&1 || { cat "$work/built" && return 1; }
    count=$(grep -cE "$pattern" "$work/built")
    cat "$work/built"
    if [ "$least" = 0 ]; then [ "$count" = 0 ]; else [ "$count" -ge "$least" ]; fi
}
set_up() { # command...
    hide "$@" && [ -e "$project/build" ]
}
says_stripe() {
    "$project/build/wave" | grep -q '^pass stripe' && "$project/build/wave" | grep -q '^log: struct dt_vk_host'
}
build_system() { # name set-up-command -- build-command
    local name=$1 setup=() work_done='Generating|Building|Linking|Compiling'
    shift
    project=$work/project-$name
    cp -r tests/hosts/examples/project "$project"
    while [ "$1" != -- ]; do setup+=("${1//PROJECT/$project}") && shift; done
    shift
    check "$name sets up a project with a pipeline" set_up "${setup[@]}"
    check "... builds it" built 2 "$work_done" "$@" "$project/build"
    check "... which runs" says_stripe
    check "... does nothing when nothing was touched" built 0 "$work_done" "$@" "$project/build"
    echo '/* no other words */' >>"$project/wave.glsl"
    check "... generates anew when a body was touched" built 1 'Generating' "$@" "$project/build"
    check "... and that once" built 0 "$work_done" "$@" "$project/build"
    [ "$name" != make ] || return # make cannot know that a new file equals the old one
    sed -i 's/0\.5 + 0\.5/0.4 + 0.6/' "$project/wave.glsl"
    check "... compiles one file when a body has changed" compiles wave_vk_shaders "$@" "$project/build"
    echo '/* no other words, again */' >>"$project/wave.glsl"
    check "... and none for a comment" compiles '' "$@" "$project/build"
}
compiles() { # file command...: the build compiles this file alone; an empty name: no file
    local file=$1
    shift
    hide "$@" --verbose >"$work/built" 2>&1 || { cat "$work/built" && return 1; }
    diff <(printf '%s' "${file:+$file
}") <(grep -oE ' -c [^ ]*\.c' "$work/built" | sed 's|.*[/ ]||; s|\.c$||') || { cat "$work/built" && return 1; }
}
build_system cmake cmake -S PROJECT -B PROJECT/build -G Ninja "-DCMAKE_PREFIX_PATH=$installed" -- cmake --build
[ -z "${DIPTYCH_LONG:-}" ] || build_system make cmake -S PROJECT -B PROJECT/build -G "Unix Makefiles" "-DCMAKE_PREFIX_PATH=$installed" -- cmake --build
build_system meson meson setup PROJECT/build PROJECT -- ninja -C

# ---- Debian's folders ----

triplet=$(/usr/bin/python3 -c 'import sysconfig; print(sysconfig.get_config_var("MULTIARCH"))')
apart=$work/apart
unset PKG_CONFIG_PATH LD_LIBRARY_PATH
installs_apart() {
    DESTDIR=$work/dest PREFIX=/usr LIBDIR=lib/$triplet sh app/install.sh "$version" && mv "$work/dest/usr" "$apart"
}
# A library hands its pipeline on to the program, with static libraries.
passes_on() {
    cp -r "$apart/share/doc/diptych/examples/hosts/project" "$work/public" && cat >"$work/public/CMakeLists.txt" <<'END'
cmake_minimum_required(VERSION 3.21)
project(wave C)
find_package(diptych 0.1 REQUIRED)
file(WRITE "${CMAKE_CURRENT_BINARY_DIR}/part.c" "int part;")
add_library(pipelines STATIC "${CMAKE_CURRENT_BINARY_DIR}/part.c")
diptych_generate(pipelines wave.yaml PUBLIC STATIC BACKENDS vk gl)
add_executable(wave main.c)
target_link_libraries(wave PRIVATE pipelines diptych::scene_static)
add_executable(again main.c)
diptych_generate(again wave.yaml)
END
    hide cmake -S "$work/public" -B "$work/public/build" -G Ninja "-DCMAKE_PREFIX_PATH=$apart" &&
        hide cmake --build "$work/public/build" && "$work/public/build/wave" | grep '^pass stripe' &&
        ! ldd "$work/public/build/wave" | grep diptych
}
python_finds_it() {
    PYTHONPATH=$apart/lib/python3/dist-packages hide /usr/bin/python3 -B "$apart/share/doc/diptych/examples/play.py"
}
package_finds_it() {
    local flags
    flags=$(PKG_CONFIG_PATH=$apart/lib/$triplet/pkgconfig pkg-config --cflags --libs diptych-vk) && read -ra flags <<<"$flags"
    echo '#include <diptych_vk.h>
int main(void) { return dt_vk_open(&(struct dt_vk_host){0}) != 0; }' >"$work/one.c" && hide cc "$work/one.c" "${flags[@]}" -o "$work/one"
}
finds_by_name() {
    hide "$apart/bin/diptych-gen" rsm --check && hide "$apart/bin/diptych-gen" rsm --graph "$work/rsm.dot" &&
        hide "$apart/bin/diptych" render --spec rsm --scene cornell --size 24x16 --backend vk -o "$work/a.png" --set rsm_size=16 --set samples=4
}
check "libraries may be in a folder of their own" installs_apart
check "... where CMake finds them, a library hands its pipeline on, and another target has the same" passes_on
check "... and Python, for the installed example" python_finds_it
check "... and pkg-config" package_finds_it
check "a bare name is that of a shipped spec or scene" finds_by_name

finish
