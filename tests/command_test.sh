#!/usr/bin/env bash
# The command line says what is wrong, once, by the exit status that scripts rely on, and leaves nothing half-written. TAP.
. "$(dirname "$0")/tap.sh"
scene=$root/scenes/cornell.yaml
render=("$diptych" render --scene "$scene" --size 8x8)
compare=("$diptych" compare --scene "$scene" --size 8x8)

# shellcheck disable=SC2317 # called through check
says() { # status text command...: one error in all, which contains the text
    local want=$1 text=$2 got
    shift 2
    "$@" >"$work/said" 2>&1 </dev/null
    got=$?
    cat "$work/said"
    echo "exit status $got, expected $want, with: $text"
    [ "$got" = "$want" ] && [ "$(grep -c 'error:' "$work/said")" = 1 ] && grep -qF -- "$text" "$work/said"
}

refused() { # status text command...
    check "$1: $2" says "$@"
}

refused 2 'did you mean "render"?' "$diptych" rendre
refused 2 'did you mean "--scene"?' "$diptych" render --scen x
refused 2 '--scene FILE is missing' "$diptych" compare
refused 2 '--backend gx: unknown backend "gx"; did you mean "gl"?' "${render[@]}" --backend gx
refused 2 '--size 0x0' "${render[@]}" --backend gl --size 0x0 -o "$work/a.png"
refused 2 '--size 99999x99999' "${render[@]}" --backend gl --size 99999x99999 -o "$work/a.png"
refused 2 'must end in .exr' "${render[@]}" --backend gl -o "$work/a.jpg"
refused 2 '-o FILE is missing' "${render[@]}" --backend gl
refused 2 '--set bounces: must be PATH=VALUE' "${render[@]}" --backend gl --set bounces
refused 1 '--set bounces=9: must be of type int, from 0 to 2' "${render[@]}" --backend vk -o "$work/a.png" --set bounces=9
# shellcheck disable=SC2016 # these are no commands
refused 1 'did you mean `bounces`?' "${render[@]}" --backend vk -o "$work/a.png" --set bouncez=1
refused 1 "$work/absent/a.png: cannot be written" "${render[@]}" --backend vk -o "$work/absent/a.png"
refused 1 "absent.yaml" "$diptych" render --scene "$work/absent.yaml" --backend vk -o "$work/a.png"
refused 1 "--device none: no such Vulkan device" "${render[@]}" --backend vk -o "$work/a.png" --device none
refused 1 "did you mean" "${render[@]}" --backend vk -o "$work/a.png" --show displai
refused 1 "choose another --size" "${render[@]}" --backend vk -o "$work/a.png" --size 32768x32768
refused 2 "absent.yaml" "${compare[@]}" --spec "$work/absent.yaml"
refused 2 "cannot be written" "${compare[@]}" --json "$work/absent/a.json"

# What is wrong in a file is told with its place, as compilers tell it, and without a word before it: editors match that.
cat >"$work/scene.yaml" <<END
mesh: $root/scenes/cornell.obj
camra: {}
camera: {eye: [0, 0, 0], target: [0, 0], fov_y: 40}
light: {kind: spott}
END
echo 'mesh: [' >"$work/broken.yaml"
printf 'keys:\n  - {at: 0, camera: {eye: [0, 0]}}\n' >"$work/motion.yaml"
printf 'tittle: x\npictures: []\nreference: {bounces: 1}\nsweep: {parameter: tile, values: [1]}\n' >"$work/outline.yaml"
sed 's/rgba8,/rgba9,/' "$root/templates/rsm.yaml" >"$work/spec.yaml"
ln -s "$root/templates/shared" "$root/templates/rsm" "$work/"
# shellcheck disable=SC2317
placed() { # places command...: one for each line that tells an error, in order, and nothing else of the kind
    local places=$1
    shift
    ! "$@" >"$work/said" 2>&1 </dev/null || return
    cat "$work/said"
    [ "$(sed -nE 's/^.*\/([a-z.]+:[0-9]+:[0-9]+): error: .+$/\1/p' "$work/said" | xargs)" = "$places" ] && ! grep -q '^diptych:' "$work/said"
}
check "a scene's errors have places" placed "scene.yaml:2:1 scene.yaml:3:34 scene.yaml:4:15" \
    "$diptych" render --scene "$work/scene.yaml" --backend vk -o "$work/a.png"
check "... and one that is no YAML" placed "broken.yaml:2:1" \
    "$diptych" reference --scene "$work/broken.yaml" -o "$work/a.exr"
check "a motion's" placed "motion.yaml:2:27" "${compare[@]}" --motion "$work/motion.yaml"
check "a report outline's" placed "outline.yaml:1:1 outline.yaml:2:11" \
    "$diptych" report --outline "$work/outline.yaml" --scene "$scene" -o "$work/report"
check "a spec's" placed "spec.yaml:$(grep -n rgba9 "$work/spec.yaml" | cut -d: -f1):30" \
    "${render[@]}" --backend vk -o "$work/a.png" --spec "$work/spec.yaml"

# Each of these two is refused without the other: a block of 16 KiB holds few lights, and there are 256 to begin with.
check "values that are valid only together are" \
    "${render[@]}" --backend vk -o "$work/a.png" --set passes.shade.ranges.first_range.storage=uniform \
    --set 'tile=[1,1]' --set first_vpls=64
# Pictures against a reference.
"$diptych" render --scene "$scene" --size 16x8 --backend vk -o "$work/a.exr"
"$diptych" render --scene "$scene" --size 16x8 --backend vk -o "$work/a.png"
"$diptych" render --scene "$scene" --size 8x8 --backend vk -o "$work/b.exr"
metrics=("$diptych" metrics --reference "$work/a.exr")
refused 2 '--test FILE is missing' "${metrics[@]}"
refused 2 '--exposure 0: must be a number above 0' "${metrics[@]}" --test "$work/a.exr" --exposure 0
refused 1 'has 16x8 pixels and' "${metrics[@]}" --test "$work/b.exr"
refused 1 'one holds light and the other 8-bit codes' "${metrics[@]}" --test "$work/a.png"
refused 1 'absent.exr' "${metrics[@]}" --test "$work/absent.exr"
refused 1 'must be from 1 to 4096' "${metrics[@]}" --test "$work/a.exr" --pixels-per-degree 5000
# shellcheck disable=SC2317
no_error() {
    "${metrics[@]}" --test "$work/a.exr" -o "$work/maps" --json "$work/metrics.json" &&
        [ -s "$work/maps/flip_ldr.png" ] && [ -s "$work/maps/flip_hdr.png" ] &&
        python3 -c 'import json, sys
m = json.load(open(sys.argv[1]))
for kind in m["ldr"], m["hdr"]:
    assert kind["rmse"] == 0 and kind["psnr"] is None and kind["flip"]["max"] == 0 and kind["mean_test"] > 0
assert m["ldr"]["yee"]["failing"] == 0' "$work/metrics.json"
}
check "a picture has no error against itself" no_error

# A pipeline of one's own is compiled on the spot. Its cache is its own, too: a copy of the tools without sources beside them.
mkdir -p "$work/project/build/glad" "$work/spec"
cp "$build/diptych" "$build/diptych-gen" "$work/project/build/"
cp "$build"/libdiptych_image.so "$work/project/build/"
cp -r "$build/glad/include" "$work/project/build/glad/"
ln -s "$root/templates" "$root/runtime_gl" "$root/runtime_vk" "$root/scenes" "$work/project/"
cp "$root"/tests/specs/mips* "$work/spec/"
own=("$work/project/build/diptych" render --scene "$scene" --size 8x8 --spec "$work/spec/mips.yaml" --backend vk -o "$work/own.png")

# shellcheck disable=SC2317
nothing_left() {
    ! find "$work" -mindepth 1 -name '*tmp*' | grep .
}
refused 1 "install a C compiler, or name one in the environment variable CC" env CC=no-such-compiler "${own[@]}"
check "a compiler that cannot be started leaves nothing" nothing_left
refused 1 "compiling the generated C failed" env CC=false "${own[@]}"
check "a compiler that fails leaves nothing" nothing_left

# A compiler that takes its time, and goes on writing if nobody ends it.
cat >"$work/slow" <<'SLOW'
#!/bin/sh
for i in 1 2 3 4 5 6 7 8 9 10; do
    sleep 0.3
    for word; do case $word in *.o) mkdir -p "$(dirname "$word")" && echo >"$word.$i" ;; esac done
done
exit 1
SLOW
chmod +x "$work/slow"
# shellcheck disable=SC2317
interrupted() { # signal
    local began=$SECONDS
    CC=$work/slow "${own[@]}" &
    local child=$!
    for _ in $(seq 100); do
        compgen -G "$work/project/build/cache/*/tmp-*/*.o.1" >/dev/null && break
        sleep 0.1
    done
    kill "-$1" "$child"
    wait "$child"
    echo "exit status $? after $((SECONDS - began)) s"
    sleep 0.7
    nothing_left
}
for signal in INT TERM HUP; do
    check "SIG$signal ends the compiler and leaves nothing" interrupted $signal
done

# What a killed process left is removed by the next one.
# shellcheck disable=SC2317
swept() {
    local made folder
    "${own[@]}" || return
    for made in "$work"/project/build/cache/*/*/panels.so; do # one: no other compiler has got so far
        folder=$(dirname "$(dirname "$made")")
        mkdir "$folder/tmp-999999999"
    done
    echo "# changed" >>"$work/spec/mips.yaml"
    "${own[@]}" && nothing_left
}
check "what a killed process left half built is swept" swept
# shellcheck disable=SC2317
at_once() {
    echo "# changed" >>"$work/spec/mips.yaml"
    "${own[@]}" &
    local first=$!
    "${own[@]}" && wait "$first" && nothing_left
}
check "two processes build one pipeline at once" at_once
# The cache stays within its size: what was used last goes last, and what is in use not at all.
versions() {
    find "$work/project/build/cache" -mindepth 3 -maxdepth 3 -name panels.so -printf '%h\n' 2>/dev/null
}
variant() { # number option...: the folder of its version, which nothing else has; 2 MiB more than it was
    local before
    before=$(versions)
    "${own[@]}" --set "images.picture.doc=version $1" >/dev/null || return
    comm -13 <(sort <<<"$before") <(versions | sort)
}
rm -rf "$work/project/build/cache"
for number in 1 2 3; do
    folders[number]=$(variant $number)
    head -c 2M /dev/zero >"${folders[number]}/spare"
done
# shellcheck disable=SC2317
first_in_first_out() {
    DIPTYCH_CACHE_MIB=6 variant 1 && DIPTYCH_CACHE_MIB=6 variant 4 &&
        [ -d "${folders[1]}" ] && [ ! -d "${folders[2]}" ] && [ -d "${folders[3]}" ]
}
check "the cache is kept within its size: what was not used for longest goes" first_in_first_out
# shellcheck disable=SC2317
in_use_stays() {
    DIPTYCH_CACHE_MIB=0 flock --shared "${folders[1]}" "${own[@]}" --set 'images.picture.doc=version 5' &&
        [ -d "${folders[1]}" ] && [ ! -d "${folders[3]}" ] && [ "$(versions | wc -l)" = 2 ]
}
check "... but nothing that a process holds" in_use_stays

# An edit compiles the C that it changes: shaders always, panels where their commands change.
cat >"$work/counting" <<'COUNTING'
#!/bin/sh
for word; do case $word in *.c) basename "$word" >>"$0.log" ;; esac done
exec cc "$@"
COUNTING
chmod +x "$work/counting"
# shellcheck disable=SC2317
compiles() { # file... after whatever was edited, and the picture is what a new cache makes of it
    rm -f "$work/counting.log"
    CC=$work/counting "${own[@]}" && diff <(printf '%s\n' "$@" | sort) <(sort "$work/counting.log") &&
        cp "$work/own.png" "$work/kept.png" && rm -rf "$work/fresh" && mkdir "$work/fresh" &&
        cp -r "$work/project" "$work/fresh/" && rm -rf "$work/fresh/project/build/cache" &&
        "$work/fresh/project/build/diptych" "${own[@]:1}" >/dev/null && cmp "$work/own.png" "$work/kept.png"
}
mapfile -t sources < <(printf '%s\n' mips.c mips_{gl,vk}{,_shaders}.c)
check "a new pipeline compiles everything" compiles "${sources[@]}"
sed -i 's/rgb, count/bgr, count/' "$work/spec/mips_show.glsl"
check "an edited body compiles shaders, and no panel" compiles mips_{gl,vk}_shaders.c
sed -i 's/\[32, 32, 1\]/[16, 32, 1]/' "$work/spec/mips.yaml"
check "another dispatch compiles the panels" compiles "${sources[@]}"
sed -i 's/bgr, count/rgb, count/' "$work/spec/mips_show.glsl"
find "$work/project/build/cache" -name object.o -delete
check "objects that are gone are made again" compiles "${sources[@]}"
check "what is gone is made again" variant 3

# A body of the templates, then one of that name beside the spec.
rm "$work/project/templates"
cp -r "$root/templates" "$work/project/"
mv "$work/spec/mips_show.glsl" "$work/project/templates/"
check "a body below the templates" "${own[@]}"
mv "$work/own.png" "$work/below.png"
sed 's/rgb, count/bgr, count/' "$work/project/templates/mips_show.glsl" >"$work/spec/mips_show.glsl"
# shellcheck disable=SC2317
other() { # picture than with that body
    "${own[@]}" && ! cmp -s "$work/own.png" "$work/below.png"
}
check "one that comes beside the spec is taken, though what was made without it is kept" other
rm "$work/spec/mips_show.glsl"
check "... as long as it is there" "${own[@]}"
check "... and no longer" cmp "$work/own.png" "$work/below.png"
finish
