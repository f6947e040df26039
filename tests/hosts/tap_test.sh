#!/usr/bin/env bash
# diptych_tap.h in two small engines, and arrays of NumPy: what they leave is compared. TAP.
. "$(dirname "$0")/../lib/tap.sh"
cd "$root" || exit 1
warn=(-Wall -Wextra -Werror -pedantic -Itemplates/c)

check_header() { # header include language...
    local header=$1 include=$2
    shift 2
    printf '#include <%s>\n#include "%s"\nint main(void) { return tap_close(tap_open("x", "y", NULL)); }\n' "$include" "$header" |
        "$@" "${warn[@]}" -DGL_GLEXT_PROTOTYPES -fsyntax-only -
}
for header in "diptych_tap.h stdio.h" "diptych_tap_gl.h GL/glcorearb.h" "diptych_tap_vk.h vulkan/vulkan.h"; do
    read -ra names <<<"$header"
    check "${names[0]} is C99" check_header "${names[@]}" cc -std=c99 -x c
    check "... and C++11" check_header "${names[@]}" c++ -std=c++11 -Wshadow -x c++
done
# The header stands alone in other programs, so it has a list of its own.
knows_all_formats() {
    printf '%s\n' '#include "diptych_tap.h"' '#include "formats.h"' 'int main(void) { int bad = 0;' \
        '#define DT_FORMAT(e, name, channels, bytes, ...) if (tap_texel_size(name) != (bytes)) { bad = 1; puts(name); }' \
        '#include "formats.def"' 'return bad; }' |
        cc -std=c11 -D_GNU_SOURCE -Itemplates/c -x c - -o "$work/formats" && "$work/formats"
}
check "the tap knows all formats of specs" knows_all_formats
for header in diptych_tap_gl.h diptych_tap_vk.h; do
    check "$header has less than 400 lines" test "$(wc -l <templates/c/$header)" -lt 400
done

# What a caller gets wrong is told by name, and leaves no dump.
cat >"$work/wrong.c" <<'END'
#include "diptych_tap.h"
int main(int count, char **words)
{
    struct tap_field field = {"light", words[1], (unsigned)atoi(words[2]), 0, 0};
    struct tap_texels texels = {0};
    float numbers[8] = {0};
    struct tap *tap = tap_open(words[3], "gl", NULL);
    texels.format = "r32f", texels.width = 4, texels.height = 2;
    texels.bytes = count > 4 ? NULL : numbers;
    tap_image(tap, "shade", "radiance", &texels);
    tap_buffer(tap, "shade", "lights", numbers, 2, 16, &field, 1);
    return !tap_close(tap);
}
END
is_refused() { # text, type of a field, its offset, [no bytes]
    local text=$1
    shift
    ! "$work/wrong" "$1" "$2" "$work/refused" "${@:3}" 2>"$work/heard" && grep -qF "$text" "$work/heard" && [ ! -e "$work/refused/manifest.json" ]
}
check "a program of wrong calls builds" cc -std=c99 "${warn[@]}" "$work/wrong.c" -o "$work/wrong"
check "... and does right" "$work/wrong" vec4 0 "$work/right"
check "a field beyond its element is refused" is_refused "light: a field beyond the stride" vec4 4
check "... one of an unknown type" is_refused "light: a field of an unknown type" mat3 0
check "... an image without bytes" is_refused "radiance: has no bytes" vec4 0 NULL

flags=(-std=c11 -D_GNU_SOURCE "${warn[@]}" -Itests/hosts/examples)
check "the OpenGL engine builds" cc "${flags[@]}" tests/hosts/examples/tap_gl.c tests/hosts/examples/renderer_gl.c -lEGL -lGL -o "$work/tap_gl"
check "the Vulkan engine builds" cc "${flags[@]}" tests/hosts/examples/tap_vk.c tests/hosts/examples/renderer_vk.c -lvulkan -lpthread -o "$work/tap_vk"
silent() { # command...
    VK_INSTANCE_LAYERS=VK_LAYER_KHRONOS_validation HOST_DEBUG=1 \
        VK_LAYER_ENABLES=VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT \
        "$@" >"$work/heard" 2>&1
    local status=$?
    cat "$work/heard"
    [ "$status" = 0 ] && [ ! -s "$work/heard" ]
}
check "it runs" silent "$work/tap_gl" "$work/gl"
check "so does the other, and validation is silent" silent "$work/tap_vk" "$work/vk"
check "and the faulty one" silent "$work/tap_vk" "$work/faulty" faulty

says() { # status, pattern, arguments...
    local want=$1 pattern=$2
    shift 2
    "$diptych" compare "$@" >"$work/said" 2>&1
    local got=$?
    cat "$work/said"
    [ "$got" = "$want" ] && grep -Eq -- "$pattern" "$work/said"
}
check "the engines agree" says 0 '^all 4 resources that both have agree$' "$work/gl" "$work/vk"
check "rows are turned over" grep -q 'row 0 is the bottom here, the top there' "$work/said"
check "the planted difference is in downsample" says 1 '^first pass that differs: downsample, resource small$' "$work/gl" "$work/faulty"
check "... and is a flip" grep -q '^why: small: equal after a flip in y' "$work/said"
check_status 1 "a folder that cannot be made fails" "$work/tap_gl" /proc/none

if /usr/bin/python3 -c 'import numpy' 2>"$work/output"; then
    check "the same from Python" /usr/bin/python3 -B tests/hosts/tap.py "$work/gl" "$work/python"
    check "... agrees" says 0 '^all 3 resources that both have agree$' "$work/python" "$work/gl"
else
    skip "arrays of NumPy" "needs python3-numpy"
fi
if /usr/bin/python3 -c 'import jsonschema' 2>"$work/output"; then
    for dump in gl vk; do
        check "the manifest of $dump is valid by its schema" /usr/bin/python3 -c '
import json, sys, jsonschema
jsonschema.validate(json.load(open(sys.argv[2])), json.load(open(sys.argv[1])))' templates/dump.schema.json "$work/$dump/manifest.json"
    done
fi
finish
