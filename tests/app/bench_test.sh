#!/usr/bin/env bash
# `bench` on the command line: checks its counts and its output, but no times. TAP.
. "$(dirname "$0")/../lib/tap.sh"
tiny=(--size 64x48 --set first_vpls=16 --set second_vpls=16 --set clusters=2 --set rsm_size=32 --set map_size=32)
bench=("$diptych" bench --scene "$root/scenes/cornell.yaml" "${tiny[@]}")

refuses() { # status text argument...
    local want=$1 text=$2 got
    shift 2
    "${bench[@]}" "$@" >"$work/said" 2>&1 </dev/null
    got=$?
    cat "$work/said"
    [ "$got" = "$want" ] && [ "$(grep -c 'error:' "$work/said")" = 1 ] && grep -qF -- "$text" "$work/said"
}

check "knows its backends" refuses 2 'metal' --backend metal
check "looks at the folder before it works" refuses 1 'absent/b.json: cannot be written' --json "$work/absent/b.json"
check "wants at least one frame" refuses 2 '--frames 0: must be a whole number' --frames 0

check "runs both backends" "${bench[@]}" --frames 4 --warmup 1 --json "$work/both.json"
cp "$work/output" "$work/table"

check "ends well though threads of OpenMP never sleep" env OMP_WAIT_POLICY=active GOMP_SPINCOUNT=infinity \
    "${bench[@]}" --frames 1 --warmup 1 --backend vk

holds() { # json statement...: Python that looks at the parsed file as `b`
    /usr/bin/python3 - "$@" <<'PYTHON'
import json, sys
b = json.load(open(sys.argv[1]))
def at(name):
    return [p["pass"] for p in b["passes"]].index(name)
for statement in sys.argv[2:]:
    assert eval(statement), statement
PYTHON
}

check "tells what ran" holds "$work/both.json" 'b["pipeline"] == "ssvp"' '(b["width"], b["height"]) == (64, 48)' \
    'b["frames"] == 4 and b["warmup"] == 1' '"first_vpls=16" in b["sets"]' '[s["side"] for s in b["sides"]] == ["gl", "vk"]'
check "every pass has a time per measured frame" holds "$work/both.json" \
    'all(len(s["passes"]) == len(b["passes"]) > 18 for s in b["sides"])' \
    'all(p["ms"]["count"] == 4 for s in b["sides"] for p in s["passes"])' \
    'all(p["ms"]["p5"] <= p["ms"]["median"] <= p["ms"]["p95"] for s in b["sides"] for p in s["passes"])' \
    'all(s["frame_ms"]["count"] == 4 and s["frame_ms"]["median"] > 0 for s in b["sides"])'
check "recording is timed where it can be told from running" holds "$work/both.json" \
    'b["sides"][0]["record_ms"] is None' 'b["sides"][1]["record_ms"]["median"] > 0'
check "the table names passes and backends" grep -qE '^milliseconds +gl +p5 +p95 +vk +p5 +p95$' "$work/table"
check "one backend is enough, and a pass that does not run has no time" \
    "${bench[@]}" --backend vk --frames 2 --warmup 1 --set bounces=0 --json "$work/one.json"
check "a skipped pass is null" holds "$work/one.json" \
    '{p["pass"]: p["ms"] for p in b["sides"][0]["passes"]}["shade"] is None' \
    '{p["pass"]: p["ms"] for p in b["sides"][0]["passes"]}["composite"]["count"] == 2'

# The bytes of the passes of tests/specs/work.yaml, counted by hand: 1000 vec3s of 16 bytes, 64 x 48 texels of 4 bytes.
counted=("$diptych" bench --spec "$root/tests/specs/work.yaml" --scene "$root/scenes/cornell.yaml" --size 32x16)
check "counts what a pass has to do" "${counted[@]}" --set rows=5 --frames 1 --warmup 1 --json "$work/work.json"
check "bytes are those of what is read and written, once" holds "$work/work.json" \
    '[(p["bytes_read"], p["bytes_written"]) for p in b["passes"]] == [(16000, 4000), (0, 64 * 48 * 4), (4000, 16000), (4000, 4000)]'
check "rates are amounts by time" holds "$work/work.json" \
    'all(abs(p["gb_s"] * p["ms"]["median"] * 1e6 - w["bytes_read"] - w["bytes_written"]) < 1 for s in b["sides"] for p, w in zip(s["passes"], b["passes"]))' \
    'all(s["machine"]["gb_s"] > 0 for s in b["sides"])' 'b["memcpy_gb_s"] > 0' \
    'all(p["floor_ms"] > 0 for s in b["sides"] for p in s["passes"])'
# A scene draw counts the texels of its targets, here triangle numbers and depths of 4 bytes each.
check "a draw counts the texels of its targets" holds "$work/both.json" \
    '{p["pass"]: p["bytes_written"] for p in b["passes"]}["gbuffer_triangles"] == 64 * 48 * 8'

# ---- tune ----------------------------------------------------------------------------------------------------------

# On a CPU a loop over a range is several times as fast if it does not read a storage buffer. --set fixes the workgroups.
cat >"$work/sums.yaml" <<'END'
pipeline: sums
structs: {Lamp: {place: vec3, size: float, light: vec3, fall: float}}
buffers: {lamps: {of: Lamp, count: 32}}
images: {picture: {format: rgba32f, size: [256, 256]}}
passes:
  - {name: place, dispatch: 32, writes: [lamps], shader: place.glsl}
  - name: light
    dispatch: picture
    reads: [lamps]
    writes: [picture]
    ranges: {each: {of: lamps, count: 32, storage: buffer, loop: roll}}
    shader: light.glsl
output: {linear: picture}
END
cat >"$work/place.glsl" <<'END'
void main()
{
    int i = invocation().x;
    if (i < 32) {
        lamps[i].place = vec3(float(i), 3.0, 7.0);
        lamps[i].size = 0.5;
        lamps[i].light = vec3(1.0, 2.0, float(i));
        lamps[i].fall = 0.25;
    }
}
END
cat >"$work/light.glsl" <<'END'
void main()
{
    ivec2 p = min(invocation().xy, ivec2(255));
    vec3 sum = vec3(0.0);
    for (Lamp lamp : each) {
        vec3 away = lamp.place - vec3(vec2(p), 0.0);
        sum += lamp.light * (lamp.size / (lamp.fall + away.x * away.x + away.y * away.y + away.z * away.z));
    }
    picture_store(p, vec4(sum, 1.0));
}
END
sums=(--spec "$work/sums.yaml" --set "passes.light.local=[16,8]" --set passes.place.local=64)
# Other work on the machine disturbs frames, and tune then rather keeps nothing: it has more than one try.
finds() {
    local try
    for try in 1 2 3 4 5; do
        "$diptych" tune "${sums[@]}" --backend vk --frames 5 -o "$work/tuned.yaml" --json "$work/tuned.json" >"$work/told" || return
        ! grep '^- ' "$work/tuned.yaml" || return 0
        echo "try $try kept nothing"
    done
    cat "$work/told"
    return 1
}
check "tune finds what is known to be faster" finds
check "... by its own numbers" holds "$work/tuned.json" 'b["ratio"] < 1' 'any(t["kept"] for t in b["tried"])' \
    'all(t["ratio"] < 1 for t in b["tried"] if t["kept"])' \
    'all("light.ranges.each" in t["set"] for t in b["tried"])' 'len(b["tried"]) == 3'
check "... with the same bits" grep -q '^all 2 resources of 2 passes have the same bits' "$work/told"
check "diptych takes the overlay" "$diptych" list "${sums[@]}" --with "$work/tuned.yaml"
check "diptych-gen takes it" "$diptych-gen" "$work/sums.yaml" --check --with "$work/tuned.yaml"
echo '- passes.light.ranges.each.storage=none' >"$work/wrong.yaml"
check_status 1 "what an overlay sets is checked" "$diptych-gen" "$work/sums.yaml" --check --with "$work/wrong.yaml"
check "--set wins over it" "$diptych-gen" "$work/sums.yaml" --check --with "$work/wrong.yaml" --set passes.light.ranges.each.storage=shared
echo 'passes: {}' >>"$work/wrong.yaml"
bench=("$diptych" list --spec "$work/sums.yaml")
check "other lines are refused, with their place" refuses 2 'wrong.yaml:2:1: error: this is no line' --with "$work/wrong.yaml"
finish
