#!/usr/bin/env bash
# `cost` and `tune --gpu`, and the figures of the shipped pipelines in tests/gen/golden/cost.txt, of one version of Mesa. UPDATE=1 writes them
# for the installed version. DIPTYCH_LONG: all pipelines on all three chips. TAP.
. "$(dirname "$0")/../lib/tap.sh"

says() { # status text command...
    local want=$1 text=$2 got
    shift 2
    "$@" >"$work/said" 2>&1 </dev/null
    got=$?
    cat "$work/said"
    [ "$got" = "$want" ] && grep -qF -- "$text" "$work/said"
}
cost=("$diptych" cost --spec "$work/two.yaml" --size 130x64)
cat >"$work/two.yaml" <<'END'
pipeline: two
params: {rows: {value: 8, min: 1, max: 4096, doc: "n"}}
buffers:
  sums: {of: float, count: 256}
  arguments: {of: uint, count: 3}
images: {picture: {format: rgba32f, size: frame}}
passes:
  - {name: fill, dispatch: picture, local: [8, 8], writes: [picture], shader: fill.glsl}
  - {name: share, groups: 2, local: 256, reads: [picture], writes: [sums], shader: share.glsl}
  - {name: ask, dispatch: 1, local: 32, writes: [arguments], shader: ask.glsl}
  - {name: some, indirect: arguments, local: 64, reads: [arguments], updates: [sums], shader: some.glsl}
output: {linear: picture}
END
echo 'void main() { ivec2 p = invocation().xy; if (all(lessThan(p, picture_size()))) picture_store(p, vec4(p.x, p.y, 0.0, 1.0)); }' >"$work/fill.glsl"
cat >"$work/share.glsl" <<'END'
shared float all_of[4096];
void main()
{
    int i = int(gl_LocalInvocationIndex);
    for (int k = 0; k < 16; k++)
        all_of[k * 256 + i] = picture(ivec2(k, i / 4)).x * float(rows);
    barrier();
    float sum = 0.0;
    for (int k = 0; k < 4096; k += 64)
        sum += all_of[(k + i) % 4096];
    sums[i] = sum;
}
END
echo 'void main() { if (invocation().x < 3) arguments[invocation().x] = 1u; }' >"$work/ask.glsl"
echo 'void main() { sums[invocation().x] += 1.0; }' >"$work/some.glsl"

# ---- Without RADV --------------------------------------------------------------------------------------------------------

hidden=()
for folder in /etc/vulkan/icd.d /usr/share/vulkan/icd.d /usr/local/share/vulkan/icd.d; do
    [ ! -d "$folder" ] || hidden+=(--tmpfs "$folder")
done
if command -v bwrap >/dev/null && bwrap --dev-bind / / true 2>/dev/null; then
    check "without RADV it says what to install" says 2 'install mesa-vulkan-drivers' bwrap --dev-bind / / "${hidden[@]}" "${cost[@]}"
else
    skip "without RADV it says what to install" "bubblewrap cannot run here"
fi
check "an unknown chip has a hint" says 2 'did you mean "navi21"' "${cost[@]}" --gpu navi10,nav21
check "more chips than fit are refused" says 2 'at most 16 chips' "${cost[@]}" --gpu "$(yes navi21 | head -n 17 | paste -sd,)"
check "a limit is a percentage" says 2 'must be a percentage' "${cost[@]}" --limit 5k
check "a device whose driver tells nothing says so" says 2 'has no VK_KHR_pipeline_executable_properties' "${cost[@]}" --device llvmpipe
if ! ls /usr/share/vulkan/icd.d/radeon_icd*.json >/dev/null 2>&1; then
    skip "what a GPU's compiler says" "RADV is not installed"
    finish
fi

# ---- Counts and arithmetic -----------------------------------------------------------------------------------------------

check "costs a pipeline on two chips" "${cost[@]}" --gpu navi21,polaris10 --json "$work/two.json"
cp "$work/output" "$work/table"
holds=(/usr/bin/python3 "$root/tests/app/cost.py" holds "$work/two.json")
# Workgroups of 8 x 8 are one wave of 64; 17 x 8 of them cover 130 x 64 pixels. Two groups of 256 are 8 waves.
check "waves are the plan's" "${holds[@]}" 'stage("navi21", "fill", "compute")["subgroup"] == 64' \
    'stage("navi21", "fill", "compute")["started"] == 17 * 8' 'stage("navi21", "share", "compute")["started"] == 8' \
    'stage("polaris10", "ask", "compute")["started"] == 1'
check "what a shader decides is open" "${holds[@]}" 'stage("navi21", "some", "compute")["started"] is None' \
    'p["navi21", "some"]["bound_ms"] is None' 'c["gpus"][0]["open_passes"] == 1'
check "shared memory is that of the body" "${holds[@]}" 'stage("navi21", "share", "compute")["lds"] == 16384' \
    'stage("navi21", "fill", "compute")["lds"] == 0'
# By hand: 144 SIMDs at 1.266 GHz and 256 GB/s; the picture has 130 x 64 x 16 bytes.
check "times are arithmetic" "${holds[@]}" \
    'abs(p["polaris10", "fill"]["arithmetic_ms"] - 17 * 8 * stage("polaris10", "fill", "compute")["cycles"] / 144 / 1.266e6) < 1e-9' \
    'abs(p["polaris10", "fill"]["wave_ms"] - stage("polaris10", "fill", "compute")["latency"] / 1.266e6) < 1e-9' \
    'abs(p["polaris10", "fill"]["bytes_ms"] - 130 * 64 * 16 / 256e6) < 1e-9' \
    'p["polaris10", "fill"]["bound_ms"] == max(p["polaris10", "fill"][k] for k in ("arithmetic_ms", "wave_ms", "bytes_ms"))'
check "the table names the device and what is not known" grep -qE 'RX 480: Null hardware \(RADV POLARIS10\)' "$work/table"
check "our own drivers are not touched" "$diptych" render --spec "$work/two.yaml" --size 16x16 --backend vk -o "$work/two.exr"

# The same work 64 times: written down, in loops of known turns, and in one whose turns a buffer tells.
cat >"$work/turns.yaml" <<'END'
pipeline: turns
params: {rows: {value: 64, min: 1, max: 4096, doc: "n"}}
buffers: {x: {of: uint, count: 64, history: true}}
images: {picture: {format: rgba32f, size: frame}}
passes:
  - {name: straight, dispatch: 1, local: 64, updates: [x], shader: straight.glsl}
  - {name: around, dispatch: 1, local: 64, updates: [x], shader: around.glsl}
  - {name: nested, dispatch: 1, local: 64, updates: [x], shader: nested.glsl}
  - {name: called, dispatch: 1, local: 64, updates: [x], shader: called.glsl}
  - {name: told, dispatch: 1, local: 64, updates: [x], shader: told.glsl}
  - {name: pair, dispatch: 1, local: 64, updates: [x], shader: pair.glsl}
  - {name: fill, dispatch: picture, local: [8, 8], writes: [picture], shader: fill.glsl}
output: {linear: picture}
END
once='n = n * 1664525u + 1013904223u; n ^= n >> 13; n = n * 22695477u + (n >> 3);'
body() { # name statements functions
    echo "${3:-} void main() { uint n = x[invocation().x]; $2 x[invocation().x] = n; }" >"$work/$1.glsl"
}
body straight "$(printf '%64s' '' | sed "s/ /$once/g")"
body around "for (int i = 0; i < rows; i++) { $once }"
body nested "for (int i = rows; i > 0; i -= 8) for (uint k = 128u; k > 0u; k /= 2u) { $once }"
body called "for (int i = 0; i * 8 < rows; i++) turn(n);" "void turn(inout uint n) { for (int k = 16; k > 0; k -= 2) { $once } }"
body told "for (uint i = n; i < n + uint(rows); i++) { $once }"
each='for (int i = invocation().x; i < 128; i += 64)'
body pair "$each held[i] = 0u; barrier(); atomicAdd(held[n % 128u], 1u); barrier(); $each if (held[i] > 0u) atomicAdd(x[i % 64], held[i]);" \
    "shared uint held[128];"
turns=("$diptych" cost --spec "$work/turns.yaml" --gpu navi21)
cycles='lambda name: stage("navi21", name, "compute")["cycles"]'
check "costs loops" "${turns[@]}" --json "$work/turns.json"
check "loops of known turns cost what they do" /usr/bin/python3 "$root/tests/app/cost.py" holds "$work/turns.json" \
    "all(1 <= ($cycles)(name) / ($cycles)('straight') < 1.5 for name in ('around', 'nested', 'called'))" "($cycles)('told') < ($cycles)('around') / 4" \
    'stage("navi21", "pair", "compute")["latency"] > 0'
check "costs more turns" "${turns[@]}" --set rows=640 --json "$work/turns.json"
check "ten times the turns cost ten times as much" /usr/bin/python3 "$root/tests/app/cost.py" holds "$work/turns.json" \
    "all(9 < ($cycles)(name) / ($cycles)('straight') < 17 for name in ('around', 'nested', 'called'))"

# ---- Changes -------------------------------------------------------------------------------------------------------------

check "nothing has changed" says 0 '0 passes are worse' "${cost[@]}" --gpu navi21,polaris10 --against "$work/two.json"
sed -i 's/sum += all_of/sum += sin(sum) * all_of/' "$work/share.glsl"
check "a dearer pass is named" says 1 'share, compute: cycles' "${cost[@]}" --against "$work/two.json"
check "... and no other" [ "$(grep -c WORSE "$work/said")" = 1 ]
check "... within a limit" says 0 '0 passes are worse' "${cost[@]}" --against "$work/two.json" --limit 100000%
check "other pipelines are not compared" says 2 'of the pipeline two, not of rsm' "$diptych" cost --spec rsm --against "$work/two.json"
echo '{"sides": [{"device": "AMD Radeon RX 6800 XT (RADV NAVI21)", "passes": [{"pass": "fill", "ms": {"median": 0.25}}]}]}' >"$work/bench.json"
check "times of the same chip stand beside" "${cost[@]}" --bench "$work/bench.json" --json "$work/beside.json"
check "... by pass" /usr/bin/python3 "$root/tests/app/cost.py" holds "$work/beside.json" 'p["navi21", "fill"]["measured_ms"] == 0.25' \
    'p["navi21", "share"]["measured_ms"] is None'
check "times of other devices do not" says 2 'has no times of' "${cost[@]}" --gpu vega10 --bench "$work/bench.json"

# A workgroup of 32 leaves half of each wave of 64 empty.
sed -i 's/local: \[8, 8\]/local: [8, 4]/' "$work/two.yaml"
check "tune goes by a chip" "$diptych" tune --gpu polaris10 --spec "$work/two.yaml" --size 1300x640 -o "$work/tuned.yaml"
check "... finds what is better there" grep -qE '^- passes.fill.local=\[(8,8|16,8|32,4|64,2|16,16|32,8|64,4)\]' "$work/tuned.yaml"
check "... by the tables of diptych-gen" "$diptych-gen" "$work/two.yaml" --check --with "$work/tuned.yaml"
check "... and is told to tune for something" says 2 'or --gpu NAME' "$diptych" tune --spec "$work/two.yaml" -o "$work/tuned.yaml"

# ---- The shipped pipelines -----------------------------------------------------------------------------------------------

kept=$root/tests/gen/golden/cost.txt
version=$(sed -n 's/.*; radv, \(Mesa [0-9.]*\).*/\1/p' "$work/table" | head -n 1)
specs=()
for spec in "$root"/templates/*.yaml; do
    specs+=("$(basename "$spec" .yaml)")
done
figures() { # chips pipeline...
    /usr/bin/python3 "$root/tests/app/cost.py" kept "$diptych" "$@"
}
if [ -n "${UPDATE:-}" ]; then
    {
        echo "# $version: pipeline, pass, stage | chip, VGPRs, waves, spills, bytes of code, cycles of a wave. UPDATE=1 tests/app/cost_test.sh"
        figures navi21,polaris10,gfx1100 "${specs[@]}"
    } >"$kept"
fi
same() { # chips pattern pipeline...: the first chips of the kept lines that match
    local count=${1//[^,]/}
    figures "$1" "${@:3}" >"$work/now"
    grep -E "$2" "$kept" | cut -d '|' -f "1-$((${#count} + 2))" | sed 's/ $//' | diff - "$work/now"
}
if [ -z "$version" ] || ! grep -qF "# $version:" "$kept"; then
    skip "the shipped pipelines cost what is kept" "kept are figures of $(sed -n 's/^# \(Mesa [0-9.]*\).*/\1/p' "$kept"), here is $version"
elif [ -n "${DIPTYCH_LONG:-}" ]; then
    check "the shipped pipelines cost what is kept" same navi21,polaris10,gfx1100 '^[^#]' "${specs[@]}"
else
    check "the shipped pipelines cost what is kept, on one chip" same navi21 '^[^#]' "${specs[@]}"
    check "... ssvp on all" same navi21,polaris10,gfx1100 '^ssvp ' ssvp
fi
finish
