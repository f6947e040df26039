#!/usr/bin/env bash
# The command line reports each error once, with the exit status that scripts rely on, and leaves no half-written file. TAP.
. "$(dirname "$0")/../lib/tap.sh"
scene=$root/scenes/cornell.yaml
render=("$diptych" render --scene "$scene" --size 37x23)
compare=("$diptych" compare --scene "$scene" --size 37x23)

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
refused 2 'did you mean "render"?' "$diptych" help rendre
refused 2 'did you mean "--scene"?' "$diptych" render --scen x
refused 2 '--scene FILE is missing' "$diptych" compare
refused 2 '--scene: FILE is missing' "$diptych" compare --scene --help
refused 2 '--graph: FILE.dot is missing' "${diptych}-gen" "$root/templates/rsm.yaml" --graph --help
refused 2 '--backend gx: unknown backend "gx"; did you mean "gl"?' "${render[@]}" --backend gx
refused 2 '--size 0x0' "${render[@]}" --backend gl --size 0x0 -o "$work/a.png"
refused 2 '--size 99999x99999' "${render[@]}" --backend gl --size 99999x99999 -o "$work/a.png"
refused 2 'must end in .exr' "${render[@]}" --backend gl -o "$work/a.jpg"
refused 2 '-o FILE is missing' "${render[@]}" --backend gl
refused 2 '--set bounces: must be PATH=VALUE' "${render[@]}" --backend gl --set bounces
refused 1 'is 9, above its max of 2' "${render[@]}" --backend vk -o "$work/a.png" --set bounces=9
# shellcheck disable=SC2016 # these are no commands
refused 1 'did you mean `bounces`?' "${render[@]}" --backend vk -o "$work/a.png" --set bouncez=1
refused 1 "$work/absent/a.png: cannot be written" "${render[@]}" --backend vk -o "$work/absent/a.png"
refused 1 "absent.yaml" "$diptych" render --scene "$work/absent.yaml" --backend vk -o "$work/a.png"
refused 1 "no Vulkan device is called \`none\`" "${render[@]}" --backend vk -o "$work/a.png" --device none
refused 1 "did you mean" "${render[@]}" --backend vk -o "$work/a.png" --show displai
refused 1 "choose another size" "${render[@]}" --backend vk -o "$work/a.png" --size 32768x32768
refused 2 "absent.yaml" "${compare[@]}" --spec "$work/absent.yaml"
refused 2 "cannot be written" "${compare[@]}" --json "$work/absent/a.json"

# With RenderDoc, the capture begins with RDOC. Without RenderDoc, the error says what to install.
grey=("$diptych" render --spec "$root/tests/specs/grey.yaml" --size 8x8 --backend gl --capture "$work/frame.rdc")
if /sbin/ldconfig -p | grep -q librenderdoc.so; then
    check "a capture for RenderDoc" "${grey[@]}"
    check "... is one" [ "$(head -c 4 "$work/frame.rdc")" = RDOC ]
else
    refused 1 'install RenderDoc' "${grey[@]}"
fi

# `help` is another word for --help.
same_help() { # [verb]
    diff <("$diptych" help "$@") <("$diptych" "$@" --help) && "$diptych" help "$@" | grep -q '^usage: diptych'
}
check "drivers that are found and asked, not named" \
    env -u VK_DRIVER_FILES -u VK_ICD_FILENAMES \
    "$diptych" compare --spec "$root/tests/specs/mips.yaml" --scene "$scene" --size 37x23

# Mesa reports 4.5 by itself.
check "OpenGL 4.5 with the extensions of 4.6, from SPIR-V and from text" \
    "$diptych" compare --spec "$root/tests/specs/mips.yaml" --scene "$scene" --size 37x23 --backend gl,gl+glsl
check "OpenGL 4.6" env MESA_GL_VERSION_OVERRIDE=4.6 MESA_GLSL_VERSION_OVERRIDE=460 \
    "$diptych" compare --spec "$root/tests/specs/mips.yaml" --scene "$scene" --size 37x23 --backend gl,gl+glsl

check "help is --help" same_help
for verb in list render sweep; do
    check "help $verb is $verb --help" same_help $verb
done

# Errors in files begin with their place, as those of compilers do, so that editors find the place.
cat >"$work/scene.yaml" <<END
mesh: $root/scenes/cornell.obj
camra: {}
camera: {eye: [0, 0, 0], target: [0, 0], fov_y: 40}
light: {kind: spott}
END
echo 'mesh: [' >"$work/broken.yaml"
printf 'keys:\n  - {at: 0, camera: {eye: [0, 0]}}\n' >"$work/motion.yaml"
printf 'tittle: x\npictures: []\nreference: {bounces: 1}\nsweep: {parameter: tile, values: [1]}\n' >"$work/outline.yaml"
sed '/rsm_flux: /s/rgba32f,/rgba9,/' "$root/templates/rsm.yaml" >"$work/spec.yaml"
ln -s "$root/templates/shared" "$root/templates/rsm" "$work/"
placed() { # places command...: the places of all errors, in order; no error lacks a place
    local places=$1
    shift
    ! "$@" >"$work/said" 2>&1 </dev/null || return
    cat "$work/said"
    [ "$(sed -nE 's/^.*\/([a-z.]+:[0-9]+:[0-9]+): error: .+$/\1/p' "$work/said" | xargs)" = "$places" ] && ! grep -q '^diptych:' "$work/said"
}
check "a scene's errors have places" placed "scene.yaml:2:1 scene.yaml:3:35 scene.yaml:4:15" \
    "$diptych" render --scene "$work/scene.yaml" --backend vk -o "$work/a.png"
check "... and one that is no YAML" placed "broken.yaml:2:1" \
    "$diptych" reference --scene "$work/broken.yaml" -o "$work/a.exr"
check "a motion's" placed "motion.yaml:2:28" "${compare[@]}" --motion "$work/motion.yaml"
check "a report outline's" placed "outline.yaml:1:1 outline.yaml:2:1" \
    "$diptych" report --outline "$work/outline.yaml" --scene "$scene" -o "$work/report"
check "a spec's" placed "spec.yaml:$(grep -n rgba9 "$work/spec.yaml" | cut -d: -f1):30" \
    "${render[@]}" --backend vk -o "$work/a.png" --spec "$work/spec.yaml"

# A uniform block of 16 KiB holds few lights, so storage, tile and first_vpls must be checked together.
check "values that are valid only together are" \
    "${render[@]}" --backend vk -o "$work/a.png" --set passes.shade.ranges.first_range.storage=uniform \
    --set 'tile=[1,1]' --set first_vpls=64
# Pictures against a reference.
pictured=("$diptych" render --scene "$scene" --spec "$root/templates/rsm.yaml" --set rsm_size=32 --set samples=4 --backend vk)
"${pictured[@]}" --size 37x23 -o "$work/a.exr"
"${pictured[@]}" --size 37x23 -o "$work/a.png"
"${pictured[@]}" --size 39x23 -o "$work/b.exr"
metrics=("$diptych" metrics --reference "$work/a.exr")
refused 2 '--test FILE is missing' "${metrics[@]}"
refused 2 '--exposure 0: must be a number above 0' "${metrics[@]}" --test "$work/a.exr" --exposure 0
refused 1 'has 37x23 pixels and' "${metrics[@]}" --test "$work/b.exr"
refused 1 'one holds light and the other 8-bit codes' "${metrics[@]}" --test "$work/a.png"
refused 1 'absent.exr' "${metrics[@]}" --test "$work/absent.exr"
refused 1 'must be from 1 to 4096' "${metrics[@]}" --test "$work/a.exr" --pixels-per-degree 5000
no_error() {
    "${metrics[@]}" --test "$work/a.exr" -o "$work/maps" --json "$work/metrics.json" &&
        [ -s "$work/maps/flip_ldr.png" ] && [ -s "$work/maps/flip_hdr.png" ] &&
        /usr/bin/python3 -c 'import json, sys
m = json.load(open(sys.argv[1]))
for kind in m["ldr"], m["hdr"]:
    assert kind["rmse"] == 0 and kind["psnr"] is None and kind["flip"]["max"] == 0 and kind["mean_test"] > 0' "$work/metrics.json"
}
check "a picture has no error against itself" no_error
mkdir -p "$work/venv/bin"
ln -s /usr/bin/python3 "$work/venv/bin"
printf 'home = /usr/bin\ninclude-system-site-packages = false\n' >"$work/venv/pyvenv.cfg"
check "... in a virtual environment of Python" env PATH="$work/venv/bin:$PATH" "${metrics[@]}" --test "$work/a.exr"
refused 1 'names one picture' "${metrics[@]}" --test "$work/a.exr" --frames 2
refused 1 'needs exactly one %d' "${metrics[@]}" --test "$work/%d%d.exr" --frames 2
cp "$work/a.exr" "$work/absent_0.exr"
refused 1 'absent_1.exr' "${metrics[@]}" --test "$work/absent_%d.exr" --frames 2
several() { # the metrics of two pictures are the means and standard errors of each picture's metrics
    local frame
    "${pictured[@]}" --size 37x23 --frames 2 --set reuse_pattern=0 -o "$work/several_%d.exr" || return
    for frame in 0 1; do
        "${metrics[@]}" --test "$work/several_$frame.exr" --json "$work/several_$frame.json" || return
    done
    "${metrics[@]}" --test "$work/several_%d.exr" --frames 2 --json "$work/several.json" &&
        /usr/bin/python3 -c 'import json, statistics, sys
both, one, two = (json.load(open(name)) for name in sys.argv[1:])
assert both["pictures"] == 2 and "standard_errors" not in one
for kind in "hdr", "ldr":
    for key, value in both[kind].items():
        if key in ("flip", "not_finite"):
            continue
        pair = [one[kind][key], two[kind][key]]
        if None in pair:  # of a picture that equals the reference
            continue
        for got, right in (value, statistics.mean(pair)), (both["standard_errors"][kind][key], statistics.stdev(pair) / 2 ** 0.5):
            assert abs(got - right) <= 1e-9 * max(map(abs, pair)), (key, got, right)
    assert abs(both[kind]["flip"]["mean"] - (one[kind]["flip"]["mean"] + two[kind]["flip"]["mean"]) / 2) < 1e-9
assert both["standard_errors"]["hdr"]["mean_reference"] == 0 < both["standard_errors"]["hdr"]["smape"]' \
            "$work/several.json" "$work/several_0.json" "$work/several_1.json"
}
check "several pictures are averaged" several

# A user's pipeline is planned at run time, without a C compiler. A copy of the tools gives this test its own cache.
mkdir -p "$work/project/build" "$work/spec"
cp "$build/diptych" "$build/diptych-gen" "$build"/libdiptych_image.so "$work/project/build/"
ln -s "$root/templates" "$root/scenes" "$work/project/"
cp "$root"/tests/specs/mips* "$work/spec/"
cache=$work/project/build/cache
own=(env CC=/bin/false "$work/project/build/diptych" render --scene "$scene" --size 8x8 --spec "$work/spec/mips.yaml" --backend vk -o "$work/own.png")

check "no C compiler is needed" "${own[@]}"
only_spirv() {
    [ "$(find "$cache" -type f | wc -l)" -gt 0 ] && ! find "$cache" -mindepth 1 ! -name '*.spv' | grep .
}
check "the cache holds SPIR-V alone" only_spirv
at_once() {
    rm -rf "$cache"
    "${own[@]}" &
    local first=$!
    "${own[@]}" && wait "$first" && only_spirv
}
check "two processes fill it at once" at_once
unused() { # mode of the cache folder: the run does not use the folder, and warns once
    rm -rf "$cache"
    mkdir -m "$1" "$cache"
    "${own[@]}" 2>"$work/said" && [ "$(grep -c 'not used as a cache: other users may write to the folder' "$work/said")" = 1 ] &&
        [ -z "$(ls -A "$cache")" ]
}
check "a cache that everybody may write to is not used" unused 777
check "nor one that the group may" unused 770
rm -rf "$cache"
within_size() { # evicts the least recently used entry
    "${own[@]}" && head -c 2M /dev/zero >"$cache/old.spv" && touch -d '2 days ago' "$cache/old.spv" &&
        echo killed >"$cache/.1-0" && touch -d '2 days ago' "$cache/.1-0" &&
        sed -i 's/rgb, count/bgr, count/' "$work/spec/mips_show.glsl" && DIPTYCH_CACHE_MIB=1 "${own[@]}" &&
        [ ! -e "$cache/old.spv" ] && only_spirv && sed -i 's/bgr, count/rgb, count/' "$work/spec/mips_show.glsl"
}
check "the cache is kept within its size, and what a killed process left is removed" within_size

# First a body below the templates, then a body of the same name beside the spec.
rm "$work/project/templates"
cp -r "$root/templates" "$work/project/"
mv "$work/spec/mips_show.glsl" "$work/project/templates/"
check "a body below the templates" "${own[@]}"
mv "$work/own.png" "$work/below.png"
sed 's/rgb, count/bgr, count/' "$work/project/templates/mips_show.glsl" >"$work/spec/mips_show.glsl"
other() { # the picture differs from that of the body below the templates
    "${own[@]}" && ! cmp -s "$work/own.png" "$work/below.png"
}
check "one that comes beside the spec is taken, though what was made without it is kept" other
rm "$work/spec/mips_show.glsl"
check "... as long as it is there" "${own[@]}"
check "... and no longer" cmp "$work/own.png" "$work/below.png"
finish
