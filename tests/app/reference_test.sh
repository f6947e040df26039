#!/usr/bin/env bash
# `reference` on the command line: refused options, output files, and the same bits for any threads and interruptions. TAP.
. "$(dirname "$0")/../lib/tap.sh"
reference=("$diptych" reference --scene "$root/scenes/cornell.yaml" --size 24x16)

refuses() { # status text argument...
    local want=$1 text=$2 got
    shift 2
    "${reference[@]}" "$@" >"$work/said" 2>&1 </dev/null
    got=$?
    cat "$work/said"
    [ "$got" = "$want" ] && [ "$(grep -c 'error:' "$work/said")" = 1 ] && grep -qF -- "$text" "$work/said"
}

check "wants a place for the picture" refuses 2 '-o FILE.exr is missing'
check "writes linear pictures only" refuses 2 'must end in .exr' -o "$work/a.png"
check "wants a number of bounces" refuses 2 '--bounces many: must be a whole number' -o "$work/a.exr" --bounces many
check "wants the first bounce before the last" refuses 2 '--from-bounce 3' -o "$work/a.exr" --from-bounce 3 --bounces 2
check "wants a noise below one" refuses 2 '--noise 2: must be a number between 0 and 1' -o "$work/a.exr" --noise 2
check "looks at the folder before it works" refuses 1 'absent/a.exr: cannot be written' -o "$work/absent/a.exr"

threads_leave_no_trace() {
    "${reference[@]}" --spp 9 --threads 1 -o "$work/one.exr" && "${reference[@]}" --spp 9 --threads 7 -o "$work/seven.exr" &&
        cmp "$work/one.exr" "$work/seven.exr"
}
check "one thread and seven write the same file" threads_leave_no_trace

# Compares a run that goes on from its checkpoint after an interruption with an uninterrupted run.
interruption_leaves_no_trace() {
    local pid got samples
    local one=("${reference[@]}" --threads 1) # the first checkpoint comes after 2 s, in which two would trace twice as much
    "${one[@]}" --noise 0.00001 --checkpoint "$work/sums" -o "$work/cut.exr" &
    pid=$!
    wait_until [ -e "$work/sums" ]
    kill -INT "$pid"
    wait "$pid"
    got=$?
    [ "$got" = 130 ] || { echo "ended with $got, not 130"; return 1; }
    [ ! -e "$work/cut.exr" ] || { echo "an interrupted run wrote a picture"; return 1; }
    ! compgen -G "$work/*tmp*" || return 1
    samples=$(($(sed -n 3p "$work/sums") + 3))
    "${one[@]}" --spp "$samples" --checkpoint "$work/sums" -o "$work/cut.exr" && "${reference[@]}" --spp "$samples" -o "$work/whole.exr" &&
        cmp "$work/cut.exr" "$work/whole.exr"
}
check "an interruption leaves no trace" interruption_leaves_no_trace
check "a checkpoint of another seed is refused" refuses 1 'is a checkpoint with other settings' \
    -o "$work/a.exr" --checkpoint "$work/sums" --spp 1000000 --seed 2
check "a checkpoint that knows more is refused" refuses 1 'give more than --spp 1' -o "$work/a.exr" --checkpoint "$work/sums" --spp 1

# The Cornell Box with a texture on every surface.
sed "s|^mesh: .*|mesh: box.obj|" "$root/scenes/cornell.yaml" >"$work/box.yaml"
sed "s|^mtllib .*|mtllib box.mtl|" "$root/scenes/cornell.obj" >"$work/box.obj"
sed "s|^newmtl.*|&\nmap_Kd view.png|" "$root/scenes/cornell.mtl" >"$work/box.mtl"
cp "$root/scenes/view.png" "$work"
# Compares the shipped pipelines' own filter with the driver's: levels 0 to 3, over the edges; white without a texture.
cat >"$work/filtered.yaml" <<'END'
pipeline: filtered
exactness: fast
images:
  ours:   {format: rgba32f, size: frame}
  theirs: {format: rgba32f, size: frame}
passes:
  - {name: texture_filter, dispatch: ours, reads: [scene_textures], writes: [ours, theirs], shader: filtered.glsl}
output: {linear: ours}
END
cat >"$work/filtered.glsl" <<'END'
#include "shared/texture.glsl"

void main()
{
    ivec2 p = invocation().xy;
    if (any(greaterThanEqual(p, ours_size())))
        return;
    vec2 uv = vec2(p) * vec2(0.037, -0.053);
    float level = 3.0 * float(p.y) / float(frame.height);
    bool white = p.x == 0;
    ours_store(p, vec4(texture_linear(uv - floor(uv), white ? -1 : 0, int(level), fract(level)), 1.0));
    theirs_store(p, white ? vec4(1.0) : textureLod(scene_textures, vec3(uv, 0.0), level));
}
END
filters_as_the_driver() {
    for image in ours theirs; do
        "$diptych" render --spec "$work/filtered.yaml" --scene "$work/box.yaml" --backend vk@llvmpipe --size 96x64 --show "$image" \
            -o "$work/$image.exr" || return
    done
    "$diptych" metrics --reference "$work/theirs.exr" --test "$work/ours.exr" --json "$work/filtered.json" &&
        /usr/bin/python3 -c 'import json, sys; sys.exit(json.load(open(sys.argv[1]))["hdr"]["rmse"] > 1e-5)' "$work/filtered.json"
}
check "textures are filtered as the driver does" filters_as_the_driver

filters() { # filter scene argument...
    local filter=$1 scene=$2
    shift 2
    "${reference[@]}" --scene "$scene" --spp 1 --json "$work/filter.json" -o "$work/filter.exr" "$@" &&
        grep -q "filter=$filter " "$work/filter.json"
}
check "radiance of a scene with textures is filtered over the pixel" filters box "$work/box.yaml"
check "... unless the option says otherwise" filters centre "$work/box.yaml" --filter centre
check "irradiance is sampled at the pixel's centre" filters centre "$work/box.yaml" --quantity irradiance
check "so is a scene without textures" filters centre "$root/scenes/cornell.yaml"

noise_is_reached() {
    "${reference[@]}" --noise 0.05 --json "$work/a.json" -o "$work/a.exr" &&
        /usr/bin/python3 -c '
import json, sys
a = json.load(open(sys.argv[1]))
assert 0.02 < a["noise"] <= 0.05 and 16 < a["samples"] < 4096 and all(x > 0 for x in a["mean"]), a
' "$work/a.json"
}
check "stops at the noise that is asked for" noise_is_reached
finish
