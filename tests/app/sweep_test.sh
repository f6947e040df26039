#!/usr/bin/env bash
# Sweeps: a workflow of Snakemake in a folder, with a file per run. An interrupted sweep goes on, also on a cluster; runs that differ
# or cannot run are told; what is measured is right. TAP.
. "$(dirname "$0")/../lib/tap.sh"
spot=$root/tests/specs/spot.yaml

# The folder's name has characters that are special to a shell, to Snakemake and to patterns of frames.
# shellcheck disable=SC2016
folder=$work/'it'\''s $HOME: a folder'
mkdir "$folder"
cp -r "$root"/tests/specs/mips* "$root"/tests/specs/grey* "$folder/"
sed "s|^mesh: .*|mesh: $root/scenes/cornell.obj|" "$spot" >"$folder/a & scene.yaml"
cp "$folder/a & scene.yaml" "$work/scene.yaml"

last_line() { # text command...: the last line of stdout begins with a text
    local text=$1 status
    shift
    "$@" >"$work/said"
    status=$?
    cat "$work/said"
    tail -n 1 "$work/said" | grep -qF -- "$text" || return 9
    return "$status"
}
refused() { # text command...: exit status 2, one error with that text, and no folder
    local text=$1 status
    shift
    "$@" >"$work/said" 2>&1
    status=$?
    cat "$work/said"
    [ "$status" = 2 ] && [ "$(grep -c 'error:' "$work/said")" = 1 ] && grep -qF -- "$text" "$work/said" && [ ! -e "$work/none" ]
}

# ---- What is wrong ----------------------------------------------------------------------------------------------------

small=("$diptych" sweep --scene "$work/scene.yaml" --spec "$root/tests/specs/mips.yaml")
grey=("$diptych" sweep --scene "$folder/a & scene.yaml" --spec "$folder/grey.yaml" --size 16x9 --spp 4 -o "$work/none")
check "a sweep of nothing" refused "give --grid" "${small[@]}" -o "$work/none"
check "a grid of no values" refused "--grid clusters: must be PATH=V1,V2" "${small[@]}" --grid clusters -o "$work/none"
check "a name that the spec does not know" refused "did you mean \`shrink\`?" "${small[@]}" --grid shrinks=true -o "$work/none"
check "a folder with other files" refused "holds files, but no sweep" "${small[@]}" --grid shrink=true -o "$folder"
check "nothing to measure" refused "must be some of agree,time,error,own" "${grey[@]}" --measure speed
check "an axis that is none" refused "--x tile: must be the path of a --grid" "${grey[@]}" --measure time --x tile --grid level=0.1
check "errors of every frame need frames" refused "needs two --frames at least" "${grey[@]}" --measure error --every-frame
check "a pipeline without a scene has no reference" refused "--measure error needs at least one --scene FILE" "$diptych" sweep \
    --spec "$folder/grey.yaml" --measure error -o "$work/none"
check "Snakemake is asked for before the work" refused "install the package snakemake" env PATH= "${grey[@]}" --grid level=0.1
check "a folder to collect that is none" refused "is no folder of diptych sweep" "$diptych" sweep --collect -o "$folder"
# shellcheck disable=SC2016 # Python
check "points of a grid go by its last axis, and compare with the last value of x" env PYTHONPATH="$root/app/python" /usr/bin/python3 -Bc '
from diptych import grid
from diptych.console import Console
request = {"output": "x", "program": "", "sides": ["gl"], "templates": "", "measure": "own", "x": "b",
           "grid": ["a=1,2", "b=[3,4],{5: [6,7]},8", "c=9,10"]}
sweep = grid.Sweep(Console("sweep", []), request)
assert sweep.axes["b"] == ["[3,4]", "{5: [6,7]}", "8"], sweep.axes
scene = grid.Scene("", "here", "")
points = [grid.Point(scene, "1x1", {"a": a, "b": b, "c": c}, [], set()) for a in "12" for b in sweep.axes["b"] for c in ("9", "10")]
sweep.set_last(points)
for point in points:
    assert points[point.last].values == {**point.values, "b": "8"}, point
assert sweep.line_title(points[-1], "gl") == "here, a 2, c 10, gl"'

if ! command -v snakemake >/dev/null; then
    skip "sweeps" "snakemake is missing"
    finish
fi

# ---- The folder -------------------------------------------------------------------------------------------------------

# shellcheck disable=SC2054 # the commas are the grid's
check "a grid over two values and two frame sizes is 4 runs" last_line "4 agree, 0 differ" "${small[@]}" \
    --grid images.picture.format=rgba8,rgba16f --size 5x3 --size 1x1 -o "$work/sweep" --jobs 1
pasted() { # the last command, in another folder
    local command
    command=$(/usr/bin/python3 -c 'import json, sys; print(json.load(open(sys.argv[1]))["runs"][-1]["command"])' "$work/sweep/summary.json")
    cd / && rm "$work/sweep/scene/1x1_images.picture.format_rgba16f.compare.json" && sh -c "$command" &&
        grep -q '"width":.1,' "$work/sweep/scene/1x1_images.picture.format_rgba16f.compare.json"
}
check "a command can be pasted, and is the run that it says" pasted
check "the CSV has a line per run" [ "$(grep -c ',agree,' "$work/sweep/summary.csv")" = 4 ]
times() { # of the results
    stat -c '%n %y' "$work/sweep"/*/*.json | sort
}
times >"$work/before"
rm "$work/sweep/scene/5x3"*.json
check_status 2 "runs without a result are told" last_line "2 agree, 0 differ, 2 not run" "$diptych" sweep --collect -o "$work/sweep"
# The site's command to submit a job: here it runs in a process of its own, beside the other one.
# shellcheck disable=SC2016 # these are the script's own
printf '#!/bin/sh\nsh "$1" >>%s/cluster.log 2>&1 &\necho $! | tee -a %s/jobs\n' "$work" "$work" >"$work/submit"
chmod 755 "$work/submit"
check "two workers of a cluster make up for them" timeout 300 snakemake -s "$work/sweep/Snakefile" --cluster "$work/submit" --jobs 2 --latency-wait 30
check "... by a job each" [ "$(wc -l <"$work/jobs")" = 2 ]
check "... which the sweep then collects" last_line "4 agree, 0 differ" "$diptych" sweep --collect -o "$work/sweep"
times >"$work/after"
check "... and no other run was done again" [ "$(comm -13 "$work/before" "$work/after" | grep -c '5x3.*json')$(comm -13 "$work/before" "$work/after" | wc -l)" = 22 ]

# ---- What does not agree ----------------------------------------------------------------------------------------------

mkdir "$work/faulty" && cp "$folder"/mips* "$work/faulty/"
sed -i 's/vec4(vec2(p)/vec4(\n#ifdef VULKAN\n    0.1 +\n#endif\n    vec2(p)/' "$work/faulty/mips_fill.glsl"
check_status 2 "a run that differs and one that cannot be" last_line "0 agree, 1 differ, 1 failed" "$diptych" sweep --scene "$spot" \
    --spec "$work/faulty/mips.yaml" --size 4x4 --grid passes.show.local=8,5000 -o "$work/fault"
check "... are told with the pass and the reason" json_holds "$work/fault/summary.json" \
    '(d["runs"][0]["pass"], d["runs"][0]["verdict"]) == ("fill", "differ") and "workgroup" in d["runs"][1]["error"]'
reads_well "... on a page that reads well" "$work/fault/index.html"
check "... and says first how it went" grep -q '<p class="verdict differ">' "$work/fault/index.html"

# ---- What is measured -------------------------------------------------------------------------------------------------

# Sweeps the level of a grey picture. The errors between constant levels a and b follow from a formula: the exposure takes b to
# 0.18, so the RMSE is 0.18 |a/b - 1|.
# shellcheck disable=SC2016 # Python
rows='
import csv, json, sys
folder, levels = sys.argv[1], sys.argv[2].split()
rows = list(csv.DictReader(open(folder + "/rows.csv", newline="")))
assert [(r["scene"], r["backend"], r["level"]) for r in rows] == [("a & scene", b, v) for v in levels for b in ("gl", "vk")], rows
for row in rows:
    assert (row["width"], row["height"], row["status"], row["reason"], row["agree"]) == ("16", "9", "done", "", "yes"), row
    name = folder + "/a___scene/16x9_level_" + row["level"]
    told = json.load(open(name + "_" + row["backend"] + ".metrics.json"))
    for column, value in (("relative_mse", told["hdr"]["relative_mse"]), ("rmse", told["hdr"]["rmse"]),
                          ("psnr", told["ldr"]["psnr"]), ("flip", told["ldr"]["flip"]["mean"]), ("smape", told["hdr"]["smape"]),
                          ("ratio", told["hdr"]["ratio"]), ("darker", told["hdr"]["darker"]), ("brighter", told["hdr"]["brighter"])):
        assert abs(float(row[column]) - value) <= 1e-5 * abs(value), (row, column, value)
    assert told["hdr"]["flip"] is None
    assert abs(float(row["mean_test"]) / told["exposure"] / float(row["level"]) - 1) < 1e-5, row
    side = json.load(open(name + ".bench.json"))["sides"][row["backend"] == "vk"]
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
# shellcheck disable=SC2054
measured=("${grey[@]}" --measure agree,time,error,own --grid level=0.1,0.4 --frames 2 --warmup 1 -o "$folder/measured")
check "times and errors of two levels and two backends are 4 rows" \
    last_line "4 rows in $folder/measured/rows.csv: 4 done, 0 failed" "${measured[@]}" --json "$folder/measured.json"
check "... which are right" /usr/bin/python3 -c "$rows" "$folder/measured" "0.1 0.4"
reads_well "... on a page that reads well" "$folder/measured/index.html"
check "... with its plots" grep -q '<img src="relative_mse.svg"' "$folder/measured/index.html"
check "... and JSON" grep -q '"own_relative_mse"' "$folder/measured.json"
# shellcheck disable=SC2016
check "... and plots along the levels, with a line for each backend, and their numbers" /usr/bin/python3 -c '
import csv, sys, xml.etree.ElementTree
for name in "frame_ms", "relative_mse", "smape", "flip", "ratio", "darker", "brighter", "own_relative_mse":
    text = " ".join(xml.etree.ElementTree.parse(f"{sys.argv[1]}/{name}.svg").getroot().itertext())
    assert "level" in text and all(f"a & scene, {b}" in text for b in ("gl", "vk")), (name, text)
    rows = {(r["line"], r["level"]): r for r in csv.DictReader(open(f"{sys.argv[1]}/{name}.csv"))}
    for row in csv.DictReader(open(sys.argv[1] + "/rows.csv")):
        plotted = list(rows["a & scene, " + row["backend"], row["level"]].values())[2]
        assert plotted == "nan" and not row[name] or abs(float(plotted) - float(row[name])) <= 1e-5 * float(plotted), (name, row)' "$folder/measured"
# shellcheck disable=SC2016
check "a notebook gets the rows" env PYTHONPATH="$root/app/python" /usr/bin/python3 -Bc 'import diptych, sys
rows = diptych.sweep(sys.argv[1], collect=True)
assert len(rows) == 4 and list(rows if isinstance(rows, list) else rows.to_dict("records"))[0]["status"] == "done"' "$folder/measured"

# A folder with a percent sign, which patterns must not take for a frame number. Grey is the same in every frame; 7 cannot be.
# shellcheck disable=SC2054
check_status 2 "a value that cannot be is a row, and stops no other" last_line "2 rows in $folder/50%/rows.csv: 1 done, 1 failed" \
    "${grey[@]}" --measure error --backend vk --grid level=0.4,7 --every-frame --frames 3 -o "$folder/50%"
# shellcheck disable=SC2016
check "... with its reason; the other has errors of all frames, and standard errors" /usr/bin/python3 -c 'import csv, json, sys
good, bad = csv.DictReader(open(sys.argv[1] + "/rows.csv", newline=""))
assert good["status"] == "done" and good["flip"] and bad["status"] == "failed" and not bad["flip"], (good, bad)
assert "level" in bad["reason"] and "," not in bad["level"], bad
told = json.load(open(sys.argv[1] + "/a___scene/16x9_level_0.4_vk.metrics.json"))
error = told["standard_errors"]["hdr"]["smape"]
assert told["pictures"] == 3 and abs(float(good["smape_standard_error"]) - error) < 1e-12 and error < 1e-9, good
assert abs(float(good["smape"]) / told["hdr"]["smape"] - 1) < 1e-5, good' "$folder/50%"

# ---- Interrupted ------------------------------------------------------------------------------------------------------

# So many samples take minutes.
held=("${grey[@]}" --measure error --backend vk --grid level=0.1 -o "$work/held")
held_up() {
    local pid
    "${held[@]}" --spp 400000 --jobs 2 2>"$work/said" &
    pid=$!
    wait_until [ -e "$work/held/a___scene/16x9.reference.txt" ]
    kill -INT "$pid"
    wait "$pid"
}
check_status 130 "an interrupt ends a sweep" held_up
no_trace() { # no rows, no process, no half of a file
    [ ! -e "$work/held/rows.csv" ] && ! pgrep -f "$work/held" && [ -z "$(find "$work/held" -name '*.diptych-tmp*')" ]
}
check "... without rows, and leaves nobody" no_trace
check "the same command goes on" last_line "1 rows in $work/held/rows.csv: 1 done, 0 failed" "${held[@]}"
finish
