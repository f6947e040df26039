#!/usr/bin/env bash
# Drivers of different makers: passes that compute are exact on equal inputs; scene draws differ only at edges. TAP.
. "$(dirname "$0")/../lib/tap.sh"
. "$root/tests/lib/drivers.sh"
cd "$root" || exit 1
edges=(compare --scene scenes/cornell.yaml --spec tests/specs/edges.yaml --size 160x90)
home=vk@llvmpipe

check "one maker: the contract \`raster\` changes nothing" sh -c '"$@" | grep -c " equal  " | grep -qx 4' - "$diptych" "${edges[@]}" --backend gl,$home
check_status 1 "... a draw that is missing is found" "$planted" "${edges[@]}" --backend gl,$home --fault $home:draw:missing
if [ ${#strangers[@]} = 0 ]; then
    skip "drivers of different makers" "$no_strangers"
    finish
fi

agrees() { # pattern, arguments...: exit status 0, a line that matches, and agreement in the last line
    local want=$1
    shift
    "$diptych" compare "$@" >"$work/table" && grep -E "$want" "$work/table" && tail -n 1 "$work/table" | grep -q 'agree$'
}

# Holes in one triangle that fills the camera's picture, before another one: no edge of a triangle there.
mkdir "$work/holes"
awk 'BEGIN { print "P2 64 64 255"; for (i = 0; i < 4096; i++) print (int(i % 64 / 3) + int(i / 192)) % 2 * 255 }' >"$work/holes/holes.pgm"
printf 'newmtl holes\nmap_Kd holes.pgm\nmap_d holes.pgm\nnewmtl wall\nKd .7 .7 .7\n' >"$work/holes/holes.mtl"
cat >"$work/holes/holes.obj" <<'EOF'
mtllib holes.mtl
v -9 -9 0
v 9 -9 1
v 0 12 2
v -30 -30 9
v 30 -30 9
v 0 40 9
vt 0 0
vt 20 1
vt 9 22
usemtl holes
f 1/1 2/2 3/3
usemtl wall
f 4/1 5/2 6/3
EOF
cat >"$work/holes/holes.yaml" <<'EOF'
mesh: holes.obj
camera: {eye: [0, 0, -3], target: [0.2, 0, 0], fov_y: 45}
light: {kind: spot, position: [1, 2, -3], target: [0, 0, 0], cone: [30, 40], intensity: [9, 9, 9]}
EOF

for driver in "${strangers[@]}"; do
    check "$driver: holes of textures have the same texels" agrees '^gbuffer_triangles +gbuffer_triangle +57600 +0  equal ' \
        --scene "$work/holes/holes.yaml" --spec templates/rsm.yaml --set rsm_size=16 --set samples=2 --size 320x180 --backend "$home,$driver"
    check "$driver: texels differ at edges, what is computed from them is exact" agrees \
        '^on equal inputs [1-9][0-9]* of 43200 drawn texels differ, at edges within the contract$' "${edges[@]:1}" \
        --backend "$home,$driver"
    check "... and against OpenGL" agrees '^on equal inputs' "${edges[@]:1}" --backend "gl,$driver"
    check_status 1 "... a share of 0 allows none" "$diptych" "${edges[@]}" --backend "$home,$driver" \
        --set 'contracts.number={raster: 0}'
    check_status 1 "... a fault in what is computed is found" "$planted" "${edges[@]}" --backend "$home,$driver" \
        --fault "$driver:count:bit"
    # Every pipeline that ships, on both scenes, at the defaults; without DIPTYCH_LONG one, which SEED draws. SwiftShader takes a
    # minute to compile ssvp, whose first bounce clustered has.
    seed=${SEED:-$RANDOM}
    specs=(rsm ssdo taa deep clustered instant_radiosity ssvp)
    [ -n "${DIPTYCH_LONG:-}" ] || specs=("${specs[seed % 6]}")
    for spec in "${specs[@]}"; do
        small=(--size 160x90 --set rsm_size=128)
        case $spec in
        ssvp) small+=(--set map_triangles=3000 --set map_size=64 --set clusters=2 --set second_clusters=2 --set first_vpls=64 --set second_vpls=64) ;;
        clustered) small+=(--set map_size=64 --set clusters=2 --set first_vpls=64) ;;
        instant_radiosity) small+=(--set map_size=32 --set first_vpls=64) ;;
        rsm | deep | ssdo) small+=(--set samples=8) ;; # SwiftShader writes the loop out, which takes it seconds
        esac
        scenes=(cornell)
        [ -z "${DIPTYCH_LONG:-}" ] || { scenes=(cornell atrium) && small=(--size 320x180); }
        for scene in "${scenes[@]}"; do
            # This driver takes an hour for 256 maps of the atrium.
            [ "$spec-$scene" != instant_radiosity-atrium ] || small+=(--set first_vpls=8)
            check "$driver: $spec, $scene (seed $seed): every pass that computes is exact" agrees '^on equal inputs' \
                --spec "templates/$spec.yaml" --scene "scenes/$scene.yaml" --backend "$home,$driver" "${small[@]}"
        done
    done
    atrium=(--scene scenes/atrium.yaml --backend "$home,$driver" --size 160x90 --set rsm_size=128)
    # Triangles so near to the eye of a map that the driver clips texels away, if it clips at the map's border.
    check "$driver: a scene too long for its texel buffers is read from storage buffers" agrees '^on equal inputs' "${atrium[@]}" \
        --spec templates/clustered.yaml --set map_size=128 --set clusters=2 --set first_vpls=64
    # shellcheck disable=SC2016
    check "... which is told" sh -c '"$@" 2>&1 | grep "shaders for GPUs read it from storage buffers"' - "$diptych" render --scene scenes/atrium.yaml --backend "$driver" \
        --spec templates/rsm.yaml --size 16x9 --set rsm_size=16 --set samples=2 -o "$work/atrium.png"
    check "$driver: post" "$diptych" compare --spec templates/post.yaml --input photo=templates/pictures/post.png --backend "$home,$driver"
    check "$driver: machine" "$diptych" compare --spec templates/machine.yaml --size 64x64 --backend "$home,$driver"
done
finish
