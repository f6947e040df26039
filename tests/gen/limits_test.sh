#!/usr/bin/env bash
# What passes need of a device's limits: --needs lists it, and each runtime names the pass and both numbers, in the same words,
# before it creates anything. tests/specs/limits.yaml; runtime_test.c has the limits that depend on the size of the frame. TAP.
. "$(dirname "$0")/../lib/tap.sh"
gen=$build/diptych-gen
spec=$root/tests/specs/limits.yaml
. "$root/tests/lib/drivers.sh"

for backend in gl vk@llvmpipe "${strangers[@]}"; do
    check "what the standards promise is enough, $backend" "$diptych" render --spec "$spec" --size 8x8 --backend "$backend" -o "$work/a.png"
done
[ ${#strangers[@]} -gt 0 ] || skip "... on another driver" "$no_strangers"

refused() { # words option...: by all, without a file
    local want=$1 backend
    shift
    for backend in gl gl+glsl vk@llvmpipe "${strangers[@]}"; do
        "$diptych" render --spec "$spec" --size 8x8 --backend "$backend" -o "$work/none.png" "$@" 2>"$work/said"
        [ $? = 1 ] && [ ! -e "$work/none.png" ] || return
        grep 'error:' "$work/said" | sed -E 's/; the device .* has [0-9,]+$/; the device has less/' >"$work/words"
        grep -qFx "diptych: error: $want; the device has less" "$work/words" || { echo "$backend" && cat "$work/said" && return 1; }
    done
}
check "shared memory, in bytes" refused "pass share needs 80,000 bytes of shared memory" --set words=20000
check "... in megabytes" refused "pass share needs 20,000,000 bytes of shared memory" --set words=5000000
check "components from vertices to fragments" refused "pass vary needs 256 components between vertices and fragments" --set varyings=64
few_invocations() { # SwiftShader has 256
    ! "$diptych" render --spec "$spec" --size 8x8 --backend "${strangers[0]}" --set across=1024 -o "$work/none.png" 2>"$work/said" &&
        grep 'pass gather needs 1,024 invocations in a workgroup; the device SwiftShader .* has 256$' "$work/said"
}
if [ ${#strangers[@]} -gt 0 ]; then
    check "invocations, where a device has few" few_invocations
else
    skip "invocations, where a device has few" "$no_strangers"
fi
check_status 2 "compare does not run, either" "$diptych" compare --spec "$spec" --size 8x8 --set words=20000

lists() { # need passes option...
    local need=$1 passes=$2
    shift 2
    "$gen" "$spec" --needs "$@" >"$work/table" || return
    grep -F "| $need | $passes |" "$work/table" || { cat "$work/table" && return 1; }
}
check "--needs lists shared memory" lists "maxComputeSharedMemorySize: 80000" share --set words=20000
check "... also what many devices have" lists "maxComputeSharedMemorySize: 20000" "share" --set words=5000
check "... invocations" lists "maxComputeWorkGroupInvocations: 1024" gather --set across=64 --set high=16
check "... invocations along an axis" lists "maxComputeWorkGroupSize[1]: 256" gather --set across=1 --set high=256
check "... components" lists "maxVertexOutputComponents: 256" vary --set varyings=64
check "... and those that fragments read" lists "maxFragmentInputComponents: 256" vary --set varyings=64
check "... sides of images" lists "maxImageDimension2D: 8192" pile --set side=8192
check "... layers" lists "maxImageArrayLayers: 1024" pile --set layers=1024
no_limit() { # of what every Vulkan 1.3 has
    "$gen" "$spec" --needs >"$work/table" && cat "$work/table" && ! grep 'max' "$work/table"
}
check "... and nothing that every device has" no_limit
# Three, one, twelve and seven components of four bytes.
cat >"$work/shared.yaml" <<'EOF'
pipeline: shared_bytes
buffers: {out_0: {of: uint, count: 64}}
passes:
  - {name: sum, groups: 1, local: 64, writes: [out_0], shader: shared.glsl}
EOF
cat >"$work/shared.glsl" <<'EOF'
struct Pair { vec4 a; vec3 b; };
shared vec3 lines[4096];
shared bool flags[3];
shared mat4x3 turn;
shared Pair pairs[2][5];
void main()
{
    int i = int(gl_LocalInvocationIndex);
    lines[i] = vec3(float(i));
    flags[i % 3] = true;
    turn[i % 4] = lines[i];
    pairs[i % 2][i % 5] = Pair(vec4(1.0), vec3(2.0));
    barrier();
    out_0[i] = uint(lines[63 - i].x + turn[0].x + pairs[0][0].a.x) + uint(flags[0]);
}
EOF
spec=$work/shared.yaml
check "arrays, structs and matrices are counted without padding" \
    lists "maxComputeSharedMemorySize: $((12 * 4096 + 4 * 3 + 12 * 4 + 2 * 5 * (16 + 12)))" sum
finish
