#!/usr/bin/env bash
# Pipelines with `target: auto` in the renderers of tests/hosts/examples: which shaders the runtime takes, by the device, by the
# scene's length against texel buffers, and as the host says. Both give the same pictures. TAP.
. "$(dirname "$0")/../lib/tap.sh"
. "$(dirname "$0")/../lib/drivers.sh"
cd "$root" || exit
generate() { # small pipelines: what is compiled and drawn does not matter here
    "$build/diptych-gen" templates/rsm.yaml -o "$work" --set rsm_size=64 --set samples=4 &&
        "$build/diptych-gen" templates/ssvp.yaml -o "$work" --set rsm_size=64 --set map_size=32 --set first_vpls=16 --set second_vpls=16 \
            --set clusters=2 --set second_clusters=2
}
build_host() { # api -DAPI
    local flags=(-std=c11 -D_GNU_SOURCE -O1 -Wall -Wextra -Werror -I. -Iscenes -Itemplates/c -Iruntime_gl -Iruntime_vk "-I$work")
    cc "${flags[@]}" "$2" -c tests/hosts/target.c -o "$work/target_$1.o" &&
        cc "${flags[@]}" -Ddt_"$1"_open=open_for_target -Ddt_"$1"_create=create_and_tell -Ddt_vk_need_features=need_features "tests/hosts/examples/host_$1.c" \
            "tests/hosts/examples/renderer_$1.c" "$work/target_$1.o" "$work"/{ssvp,rsm}{,_"$1"_shaders}.c "$build/library/libdiptych_$1.a" \
            "$build/library/libdiptych_scene.a" -lvulkan -lEGL -lGL -lpng -lassimp -lmeshoptimizer -lfyaml -lcjson -lpthread -ldl \
            -lstdc++ -lm -o "$work/host_$1"
}
takes() { # api target wanted scene picture...
    local api=$1 target=$2 wanted=$3 scene=$4
    shift 4
    TARGET=$target "$work/host_$api" "$scene" 37 23 2 "$@" >"$work/told" 2>&1
    cat "$work/told"
    [ "$(sort "$work/told")" = "$(printf '%s\n' "rsm: $wanted" "ssvp: $wanted")" ]
}
refuses() {
    ! TARGET=1 "$work/host_vk" scenes/atrium.yaml 37 23 1 "$work/none.ppm" 2>"$work/told" && cat "$work/told" && grep -qF "$1" "$work/told"
}

same_pictures() { # api picture
    cmp "$work/$1.$2.0.ppm" "$work/$1.$2.2.ppm" && cmp "$work/$1.$2.0.ppm" "$work/$1.$2.3.ppm"
}

[ ${#strangers[@]} = 0 ] || export VK_ICD_FILENAMES=${mesa[0]} VK_DRIVER_FILES=${mesa[0]}
check "two pipelines" generate
for api in gl vk; do
    check "the $api renderer builds" build_host $api "-DHOST_${api^^}"
    for target in 0:software 2:gpu 3:gpu; do
        wanted=${target#*:} target=${target%:*}
        check "$api: target $target takes the shaders for $wanted" takes $api "$target" "$wanted" scenes/cornell.yaml \
            "$work/$api.ssvp.$target.ppm" "$work/$api.rsm.$target.ppm"
    done
    check "... with the same pictures" same_pictures $api ssvp
    check "... of both pipelines" same_pictures $api rsm
done
if [ ${#strangers[@]} = 0 ]; then
    skip "where a scene is too long for texel buffers" "$no_strangers"
else
    export VK_ICD_FILENAMES=$icd VK_DRIVER_FILES=$icd
    check "SwiftShader gets its own for a small scene" takes vk 0 software scenes/cornell.yaml "$work/own.ppm" "$work/own.rsm.ppm"
    check "... those for GPUs for a scene too long for its texel buffers" takes vk 0 gpu scenes/atrium.yaml "$work/long.ppm" "$work/long.rsm.ppm"
    check "... and refuses others, if the host wants them" refuses 'elements, but SwiftShader'
fi
finish
