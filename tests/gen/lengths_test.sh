#!/usr/bin/env bash
# `.length()` of a buffer is the count that the spec declares, and of the scene's buffers what the mesh has: on every backend, with
# storage, uniform and texel buffers (`target`). tests/specs/lengths.yaml has short buffers, and the scene here has one triangle.
. "$(dirname "$0")/../lib/tap.sh"
spec=$root/tests/specs/lengths.yaml
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >"$work/triangle.obj"
cat >"$work/triangle.yaml" <<'EOF'
mesh: triangle.obj
camera: {eye: [0, 0, 4], target: [0, 0, 0], fov_y: 45}
light: {kind: directional, direction: [0.3, -1, -0.4], irradiance: [3, 3, 3]}
EOF
. "$root/tests/lib/drivers.sh"

told() { # backend few target
    local dump=$work/dump want
    rm -rf "$dump"
    "$diptych" render --spec "$spec" --scene "$work/triangle.yaml" --size 8x8 --backend "$1" --set "few=$2" --set "target=$3" \
        --dump "$dump" || return
    # one, three, wide, lamps, pairs; few; vertices, indices and objects of a triangle; all counts; last elements
    want="1 3 1 3 5 $2 3 3 1 $((13 + $2)) $((1 + 2 + 3 + 6)) $((7 + 8)) 2 0 0 0"
    [ "$(od -A n -v -t u4 "$dump"/*.tell.told.raw | xargs)" = "$want" ] || { od -A n -v -t u4 "$dump"/*.tell.told.raw && return 1; }
    [ "$(od -A n -t u4 "$dump"/*.sum.summed.raw | xargs)" = "$(($2 * 100 + 8 * $2))" ]
}
for backend in gl gl+glsl vk@llvmpipe "${strangers[@]}"; do
    check "lengths are what the spec and the mesh have, $backend" told "$backend" 7 software
    check "... with another count from a uniform parameter" told "$backend" 1 software
    check "... and with storage buffers alone" told "$backend" 7 gpu
done
[ ${#strangers[@]} -gt 0 ] || skip "... on another driver" "$no_strangers"
check "validation is silent" "$diptych" compare --spec "$spec" --scene "$work/triangle.yaml" --size 8x8 --debug --backend gl,vk
finish
