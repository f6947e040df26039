#!/usr/bin/env bash
# Sweeps: random variations of shipped pipelines agree. The folder has one edge per run, commands to paste, and a summary. An
# interrupted sweep goes on. The sweep reports runs that differ or cannot run. 23 variations, over 200 with DIPTYCH_LONG.
# TAP.
. "$(dirname "$0")/../lib/tap.sh"
gen=$build/diptych-gen
spot=$root/tests/specs/spot.yaml
sun=$root/tests/specs/directional.yaml
long=${DIPTYCH_LONG:-}

# ---- Variations that agree --------------------------------------------------------------------------------------------

# Two scenes and both kinds of light; the long form has the narrowest and the widest cone that
# a scene may have, and the atrium.
scene_with() { # light: path of a scene with it
    local path
    path=$work/scene$((++scene_count)).yaml
    sed "s|^mesh: .*|mesh: $root/scenes/cornell.obj|; s|^light: .*|light: $1|" "$spot" >"$path"
    scenes+=(--scene "$path")
}
scene_count=0
scenes=(--scene "$root/scenes/cornell.yaml" --scene "$sun")
if [ -n "$long" ]; then
    scene_with '{kind: spot, position: [0.278, 0.5, 0.28], target: [0.278, 0, 0.28], cone: [0, 0.1], intensity: [90, 80, 70]}'
    scene_with '{kind: spot, position: [0.278, 0.27, 0.1], target: [0.278, 0.27, 1], cone: [85, 85], intensity: [1, 1, 1]}'
    scene_with '{kind: directional, direction: [0.1, -0.2, 1], irradiance: [5, 5, 5]}'
    scenes+=(--scene "$root/scenes/atrium.yaml")
fi

agree() { # pipeline count seed memory
    check "$2 variations of $1 with seed $3: all that are exact agree" \
        "$diptych" sweep --random "$2" --seed "$3" --memory "$4" "${scenes[@]}" --spec "$root/templates/$1.yaml" -o "$work/$1-$3"
    grep "s of work" "$work/output" | sed 's/^/# /'
}
if [ -n "$long" ]; then
    for seed in 11 12; do
        agree ssvp 60 $seed 64
        agree rsm 50 $seed 64
    done
else
    agree ssvp 5 17 12
    agree rsm 12 4 12
    for pipeline in ssdo deep clustered taa; do
        agree $pipeline 1 1 12
    done
    check "variations of post agree" "$diptych" sweep --random 2 --seed 1 --memory 12 --spec "$root/templates/post.yaml" \
        --input photo="$root/templates/post/table.png" -o "$work/post"
fi

# Drawn values lie in the ranges of the spec, which another YAML parser reads; every kind of setting is drawn.
# shellcheck disable=SC2016 # Python
drawn='
import json, re, sys
import flat
spec, _ = flat.load(sys.argv[1])
runs = [run for path in sys.argv[2:] for run in json.load(open(path + "/sweep.json"))["runs"]]
seen = {}
for setting in (setting for run in runs for setting in run["sets"]):
    name, value = setting.split("=", 1)
    param = spec["params"].get(name)
    for number in json.loads(value if value[0] == "[" else "[" + value + "]") if param else ():
        assert param["min"] <= number <= param["max"], setting
        seen.setdefault(name, set()).add(number)
ends = sum(spec["params"][name][end] in seen.get(name, ()) for name in spec["params"] for end in ("min", "max"))
print(ends, "ends of", len(spec["params"]), "ranges")
assert ends >= len(spec["params"])
paths = " ".join(setting.split("=")[0] for run in runs for setting in run["sets"])
for kind in ("images\\..*\\.format", "samplers\\..*\\.map", "passes\\..*\\.local", "\\.storage", "\\.loop", "\\.after", "target"):
    assert re.search(kind, paths), kind
sizes = {(run["width"], run["height"]) for run in runs}
assert any(1 in size for size in sizes) and max(max(size) for size in sizes) > 32 and any(size[0] % 4 for size in sizes), sizes
assert len({run["scene"] for run in runs}) > 1 and any(run["frames"] > 1 for run in runs)
assert any(not run["exact"] for run in runs)
'
if /usr/bin/python3 -c 'import yaml' 2>/dev/null; then
    for pipeline in ssvp rsm; do
        check "parameters of $pipeline stay within their ranges and reach the ends, and every kind of thing varies" \
            env PYTHONPATH="$root/tests/gen" PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 -c "$drawn" "$root/templates/$pipeline.yaml" "$work"/$pipeline-*
    done
else
    skip "parameters stay within their ranges" "python3-yaml is missing"
fi
# Rolls loops over hundreds of VPLs: unrolled, they take most of the time, and this check does not need them.
rolled=()
for range in shade.ranges.{first,second}_range {first,second}.map.test.ranges.elements; do
    rolled+=(--set "passes.$range.loop=roll" --set "passes.$range.storage=buffer")
done
# Unwritten memory differs between the backends, so compare notices a k-means that a driver cuts short.
check "k-means ends by itself with every parameter at its max" \
    "$diptych" compare --scene "$sun" --size 8x8 --set first_vpls=2048 --set clusters=64 --set kmeans_iterations=32 \
    --set position_weight=0 --set rsm_size=64 --set map_size=16 --set second_vpls=64 "${rolled[@]}"

# ---- The generator ----------------------------------------------------------------------------------------------------

draw() { # file seed
    "$gen" "$root/tests/specs/mips.yaml" --variations 6 --seed "$2" >"$work/$1"
}
draw a 1 && draw b 1 && draw c 2
check "the same seed draws the same" cmp "$work/a" "$work/b"
check_status 1 "another seed draws something else" cmp "$work/a" "$work/c"

# ---- The folder -------------------------------------------------------------------------------------------------------

# The folder's name has characters that are special to a shell or to ninja.
# shellcheck disable=SC2016
folder=$work/'it'\''s $HOME: a folder'
mkdir "$folder"
cp "$root"/tests/specs/mips* "$folder/"
sed "s|^mesh: .*|mesh: $root/scenes/cornell.obj|" "$spot" >"$folder/a scene.yaml"
small=(--scene "$folder/a scene.yaml" --spec "$folder/mips.yaml" -o "$folder/sweep" --jobs 1)
# shellcheck disable=SC2054 # the commas are the grid's
grid=(--grid images.picture.format=rgba8,rgba16f --grid 'passes.show.local=[8,8],[3,1]' --size 5x3 --size 1x1)

last_line() { # text command...: the last line of stdout begins with a text
    local text=$1 status
    shift
    "$@" >"$work/said"
    status=$?
    cat "$work/said"
    tail -n 1 "$work/said" | grep -qF -- "$text" || return 9
    return "$status"
}

check "a grid over two values, two local sizes and two frame sizes is 8 runs" \
    last_line "8 agree, 0 differ" "$diptych" sweep "${small[@]}" "${grid[@]}"
check "every edge of the ninja file is a run" [ "$(grep -c '^build runs/' "$folder/sweep/build.ninja")" = 8 ]
pasted() { # line: runs this line of `commands` in another folder
    local command
    command=$(sed -n "$1p" "$folder/sweep/commands")
    cd / && [ -n "$command" ] && sh -c "$command"
}
check "a command can be pasted" pasted 8
check "... and is the run that it says" grep -q '"width":.5' "$folder/sweep/runs/1.json"
check "... the last of the grid" grep -q '"width":.1,' "$folder/sweep/runs/8.json"
check "the CSV has a line per run" [ "$(grep -c ',agree,' "$folder/sweep/summary.csv")" = 8 ]

unchanged() {
    [ -s "$work/before" ] && cmp "$work/before" "$work/after"
}
times() { # of the results
    stat -c '%n %y' "$folder/sweep"/runs/*.result
}
times >"$work/before"
check "the same sweep again has nothing to do" last_line "8 agree, 0 differ" "$diptych" sweep "${small[@]}" "${grid[@]}"
times >"$work/after"
check "... and has done nothing" unchanged
rm "$folder/sweep/runs/3.result"
check_status 2 "a run without a result is told" last_line "7 agree, 0 differ, 1 not run" "$diptych" sweep --collect -o "$folder/sweep"
check "... and made up for" last_line "8 agree, 0 differ" "$diptych" sweep "${small[@]}" "${grid[@]}"
check "... alone" [ "$(times | comm -13 "$work/before" - | wc -l)" = 1 ]

refused() { # text command...: exit status 2, one error with that text
    local text=$1 status
    shift
    "$@" >"$work/said" 2>&1
    status=$?
    cat "$work/said"
    [ "$status" = 2 ] && [ "$(grep -c 'error:' "$work/said")" = 1 ] && grep -qF -- "$text" "$work/said"
}
check "another sweep does not get into the folder" \
    refused 'holds another sweep, with --size ["5x3","1x1"]' "$diptych" sweep "${small[@]}" "${grid[@]}" --size 2x2
check "nor does one get among other files" \
    refused "holds files, but no sweep" "$diptych" sweep "${small[@]}" "${grid[@]}" -o "$folder"
check "a sweep of nothing" refused "give --random N or --grid" "$diptych" sweep "${small[@]}"
check "a grid of no values" refused "--grid clusters: must be PATH=V1,V2" "$diptych" sweep "${small[@]}" --grid clusters -o "$work/none"
check_status 1 "... leaves no folder" [ -e "$work/none" ]

# ---- What is measured -------------------------------------------------------------------------------------------------

# Sweeps the level of a grey picture. The errors between constant levels a and b follow from a formula: the exposure takes b to
# 0.18, so the RMSE is 0.18 |a/b - 1|.
# shellcheck disable=SC2016 # Python
rows='
import csv, json, sys
folder, levels = sys.argv[1], sys.argv[2].split()
rows = list(csv.DictReader(open(folder + "/rows.csv", newline="")))
keys = [(r["scene"], r["backend"], r["passes.show.local"], r["level"]) for r in rows]
assert keys == [("a scene", b, l, v) for l in ("[8,8]", "[3,1]") for v in levels for b in ("gl", "vk")], keys
for row in rows:
    assert (row["width"], row["height"], row["status"], row["reason"], row["agree"]) == ("16", "9", "done", "", "yes"), row
    name = folder + "/a scene/16x9_passes.show.local_%s_level_%s_" % (row["passes.show.local"].translate(str.maketrans("[],", "___")), row["level"])
    told = json.load(open(name + row["backend"] + ".json"))
    for column, value in (("relative_mse", told["hdr"]["relative_mse"]), ("rmse", told["hdr"]["rmse"]),
                          ("psnr", told["ldr"]["psnr"]), ("flip", told["ldr"]["flip"]["mean"]), ("smape", told["hdr"]["smape"]),
                          ("ratio", told["hdr"]["ratio"]), ("darker", told["hdr"]["darker"]), ("brighter", told["hdr"]["brighter"])):
        assert abs(float(row[column]) - value) <= 1e-5 * abs(value), (row, column, value)
    assert told["hdr"]["flip"] is None
    ratio = float(row["mean_test"]) / told["exposure"]
    assert abs(ratio / float(row["level"]) - 1) < 1e-5, row
    side = json.load(open(name + "bench.json"))["sides"][row["backend"] == "vk"]
    for column, spread in [("frame_ms", side["frame_ms"])] + [(p["pass"] + "_ms", p["ms"]) for p in side["passes"]]:
        assert spread["count"] == 2 or column != "frame_ms"
        for ending, of in (("", "median"), ("_p5", "p5"), ("_p95", "p95")):
            assert abs(float(row[column + ending]) / spread[of] - 1) < 1e-5, (row, column)
    if row["level"] == levels[-1]:
        assert row["own_rmse"] == "", row
        continue
    error = 0.18 * abs(float(row["level"]) / float(levels[-1]) - 1)
    assert abs(float(row["own_rmse"]) / error - 1) < 1e-4, row
    assert abs(float(row["own_relative_mse"]) / (error ** 2 / (0.18 ** 2 + 0.01)) - 1) < 1e-4, row
'
cp -r "$root"/tests/specs/grey* "$folder/"
grey=("$diptych" sweep --scene "$folder/a scene.yaml" --spec "$folder/grey.yaml" --size 16x9 --spp 4)
# shellcheck disable=SC2054 # the commas are the grid's
measured=("${grey[@]}" -o "$folder/measured" --measure agree,time,error,own --grid 'passes.show.local=[8,8],[3,1]' --grid level=0.1,0.4
    --x level --frames 2 --warmup 1)
if ! command -v gnuplot >/dev/null; then
    skip "times and errors over a grid" "gnuplot is missing, the package gnuplot-nox"
else
    check "times and errors of two levels, two local sizes and two backends are 8 rows" \
        last_line "8 rows in $folder/measured/rows.csv: 8 done, 0 failed" "${measured[@]}" --json "$folder/measured.json"
    check "... which are right" /usr/bin/python3 -c "$rows" "$folder/measured" "0.1 0.4"
    check "... and JSON" grep -q '"own_relative_mse"' "$folder/measured.json"
    for plot in frame_ms relative_mse smape flip ratio darker brighter own_relative_mse; do
        # shellcheck disable=SC2016
        check "... and a plot of $plot, along the levels, with a line for each of the rest" /usr/bin/python3 -c 'import sys, xml.etree.ElementTree
text = " ".join(xml.etree.ElementTree.parse(sys.argv[1]).getroot().itertext())
assert "level" in text and all(f"a scene, passes.show.local {l}, {b}" in text for l in ("[8,8]", "[3,1]") for b in ("gl", "vk")), text' \
            "$folder/measured/$plot.svg"
    done
    check "what is measured already is not measured again" grep -q "no work to do" <("${measured[@]}" 2>&1)
    # shellcheck disable=SC2054
    broken=("${grey[@]}" -o "$folder/measured" --measure error --backend vk --grid level=0.4,7)
    check_status 2 "a value that cannot be is a row, and stops no other" last_line "2 rows in $folder/measured/rows.csv: 1 done, 1 failed" "${broken[@]}"
    # shellcheck disable=SC2016
    check "... with its reason" /usr/bin/python3 -c 'import csv, sys
good, bad = csv.DictReader(open(sys.argv[1], newline=""))
assert good["status"] == "done" and good["flip"] and bad["status"] == "failed" and not bad["flip"], (good, bad)
assert "level" in bad["reason"] and "," not in bad["level"], bad' "$folder/measured/rows.csv"

    # A folder with a percent sign, which patterns must not take for a frame number. Grey is the same in every frame.
    # shellcheck disable=SC2054
    every=("${grey[@]}" -o "$folder/50%" --measure error --backend vk --grid level=0.1,0.4 --every-frame)
    check "errors of every frame" last_line "2 rows in $folder/50%/rows.csv: 2 done, 0 failed" "${every[@]}" --frames 3
    # shellcheck disable=SC2016
    check "... with their standard errors" /usr/bin/python3 -c 'import csv, json, sys
folder = sys.argv[1]
for row in csv.DictReader(open(folder + "/rows.csv", newline="")):
    told = json.load(open("%s/a scene/16x9_level_%s_vk.json" % (folder, row["level"])))
    assert told["pictures"] == 3 and float(row["smape_standard_error"]) == told["standard_errors"]["hdr"]["smape"] < 1e-9, row
    assert abs(float(row["smape"]) / told["hdr"]["smape"] - 1) < 1e-5, row' "$folder/50%"
    check "... of which there must be two" refused "needs two --frames at least" "${every[@]}"

    # So many samples take minutes.
    held_up() {
        local pid
        "${grey[@]}" --spp 400000 --measure error --backend vk --grid level=0.1,0.4 -o "$folder/held" &
        pid=$!
        wait_until [ -e "$folder/held/a scene/reference_16x9.json.txt" ]
        kill -INT "$pid"
        wait "$pid"
    }
    check_status 130 "an interrupt ends measuring" held_up
    check_status 1 "... without rows" [ -e "$folder/held/rows.csv" ]
    # Ninja decides the order of the steps: since 1.12 the reference may come first.
    stat -c '%y %n' "$folder/held/a scene/"*.exr 2>/dev/null | sort >"$work/drawn_then"
    check "it goes on" last_line ": 2 done, 0 failed" "${grey[@]}" --measure error --backend vk --grid level=0.1,0.4 -o "$folder/held"
    stat -c '%y %n' "$folder/held/a scene/"*.exr | sort >"$work/drawn_now"
    check "... where it was" [ -z "$(comm -23 "$work/drawn_then" "$work/drawn_now")" ]
    check "nothing to measure" refused "must be some of agree,time,error,own" "${grey[@]}" --measure speed -o "$work/none"
    check "an axis that is none" refused "--x tile: must be the path of a --grid" "${grey[@]}" --measure time --x tile --grid level=0.1 -o "$work/none"
    check "what is measured runs one at a time" refused "--jobs goes with --measure agree alone" "${grey[@]}" --measure time --jobs 2 -o "$work/none"
    # shellcheck disable=SC2054 # the comma is the grid's
    without=("$diptych" sweep --spec "$root/templates/post.yaml" --input photo="$root/templates/post/table.png" --grid bloom=0,1)
    check "a pipeline without a scene is measured, its input given" last_line "2 rows in $work/scenes/rows.csv: 2 done, 0 failed" \
        "${without[@]}" --measure time,own --show graded --backend vk --frames 1 -o "$work/scenes"
    check "... but has no reference" refused "--measure error needs at least one --scene FILE" "${without[@]}" --measure error -o "$work/none"
    check "a folder of a sweep that measures nothing" refused "holds files, but no sweep that measures" "${grey[@]}" --measure time -o "$folder/sweep"
fi

# ---- What does not agree ----------------------------------------------------------------------------------------------

faulty=("$diptych" sweep --scene "$spot" --spec "$folder/mips.yaml" --size 4x4)
check_status 1 "a fault in one pass makes its run differ" \
    last_line "0 agree, 1 differ" "${faulty[@]}" --grid shrink=true --fault vk:fill:bit -o "$work/fault"
check "... and is named" grep -q '"pass":.*"fill"' "$work/fault/summary.json"
check_status 2 "a run that cannot be does not stop the others" last_line "1 agree, 0 differ, 1 failed" \
    "${faulty[@]}" --grid passes.show.local=8,5000 -o "$work/failed"
check "... and the reason stands in the summary" grep -q '"error":.*mips.yaml\|"error":.*--set' "$work/failed/summary.json"

no_run() { # text command...
    local text=$1
    shift
    ! "$@" >"$work/said" 2>&1 || return
    cat "$work/said"
    grep -qF "$text" "$work/said" && [ ! -e "$work/misspelled/runs" ]
}
check "a grid over a name that the spec does not know starts no run" no_run "did you mean \`shrink\`?" \
    "${faulty[@]}" --grid shrinks=true -o "$work/misspelled"

# ---- Interrupted ------------------------------------------------------------------------------------------------------

# A mesh of two million triangles delays the second of two runs.
held=$work/held
mkdir "$held"
cp "$spot" "$held/one.yaml"
sed -i "s|^mesh: .*|mesh: $root/scenes/cornell.obj|" "$held/one.yaml"
cp "$held/one.yaml" "$held/two.yaml"
sweep=("$diptych" sweep --scene "$held/one.yaml" --scene "$held/two.yaml" --spec "$folder/mips.yaml" --grid shrink=true --size 4x4 --jobs 1
    -o "$held/sweep")
interrupted() {
    local pid
    { printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\n' && yes 'f 1 2 3' | head -n 2000000; } >"$held/heavy.obj"
    sed -i 's|^mesh: .*|mesh: heavy.obj|' "$held/two.yaml"
    "${sweep[@]}" &
    pid=$!
    wait_until [ -e "$held/sweep/runs/1.result" ] && wait_until [ -e "$held/sweep/runs/2.result.txt" ]
    kill -INT "$pid"
    wait "$pid"
}
check_status 130 "an interrupt ends a sweep" interrupted
check "what was over is kept" [ -e "$held/sweep/runs/1.result" ]
check_status 1 "what was not leaves no result" [ -e "$held/sweep/runs/2.result" ]
stat -c %y "$held/sweep/runs/1.result" >"$work/before"
cp -p "$held/one.yaml" "$held/two.yaml"
check "the same command goes on" last_line "2 agree, 0 differ" "${sweep[@]}"
stat -c %y "$held/sweep/runs/1.result" >"$work/after"
check "... where it was" unchanged

finish
