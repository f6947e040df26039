#!/usr/bin/env bash
# A pipeline that diptych-gen made with --sanitize tells its host what its shaders did wrong, on OpenGL and on Vulkan. TAP.
. "$(dirname "$0")/../lib/tap.sh"
cd "$work" || exit
cat >wrong.yaml <<'EOT'
pipeline: wrong
buffers: {taps: {of: float, count: 8}, part: {of: float, count: frame.width}, sums: {of: float, count: frame.width}}
passes:
  - {name: fill, dispatch: 8, writes: [taps], shader: fill.glsl}
  - {name: some, dispatch: 16, writes: [part], shader: some.glsl}
  - {name: gather, dispatch: 16, reads: [taps, part], writes: [sums], shader: gather.glsl}
  - {name: meant, dispatch: 16, updates: [sums], shader: meant.glsl, allow: {arithmetic: "log(0) is dropped"}}
EOT
echo 'void main() { int i = invocation().x; if (i < 8) taps[i] = float(i); }' >fill.glsl
echo 'void main() { int i = invocation().x; if (i < 16 && i != 5) part[i] = 1.0; }' >some.glsl
echo 'void main() { int i = invocation().x; if (i < 16) sums[i] = taps[i / 2 + 1] + part[i]; }' >gather.glsl
echo 'void main() { int i = invocation().x; if (i < 16) sums[i] = max(log(float(i)), 0.0); }' >meant.glsl

includes=("-I$work/made" "-I$root" "-I$root/templates/c" "-I$root/runtime_gl" "-I$root/runtime_vk" "-I$root/tests/hosts/examples" -I"$build/glad/include")
host() { # gl|vk define library...
    local backend=$1 define=$2
    shift 2
    cc -std=c11 -D_GNU_SOURCE -Wall -Wextra -Werror "$define" "${includes[@]}" "$root/tests/hosts/reports_host.c" "$root/tests/hosts/examples/renderer_$backend.c" \
        made/wrong.c "made/wrong_${backend}_shaders.c" "$build/library/libdiptych_$backend.a" -o "host_$backend" "$@" -lm -lpthread
}
tells() { # gl|vk
    "./host_$1" | sed "s#$work/##" >told || return
    cat told
    # shellcheck disable=SC2016
    [ "$(wc -l <told)" = 2 ] &&
        grep -qxF 'gather.glsl:1:61: undefined: index 8 of `taps`, which has 8 elements; pass gather, invocation (14, 0, 0), 6 times; first in frame 0' told &&
        grep -qxF 'gather.glsl:1:79: undefined: element 5 of `part` was never written in this frame; pass gather, invocation (5, 0, 0), 3 times; first in frame 0' told
}
refused() {
    ! "$build/diptych-gen" wrong.yaml -o made --sanitize=odd 2>told && grep -qF 'unknown kind "odd"; there are index' told
}

check "an unknown kind is refused" refused
check "generated with --sanitize" "$build/diptych-gen" wrong.yaml -o made --sanitize
check "a host of OpenGL is built" host gl -DHOST_GL -lEGL -lGL
check "... and hears what is wrong" tells gl
check "a host of Vulkan is built" host vk -DHOST_VK -lvulkan
check "... and hears what is wrong" tells vk
check "generated with the kind race alone" "$build/diptych-gen" wrong.yaml -o made --sanitize=race
check "... a host is built" host vk -DHOST_VK -lvulkan
silent() { ! "./host_vk" >told && [ ! -s told ]; }
check "... and hears nothing" silent
finish
