#!/usr/bin/env bash
# `diptych report` makes a small report to the end; report.py reads its page, follows every link and looks up every number. The
# verb reports failed steps, and makes missing results again. sweep_test.sh tests interrupts of the same steps.
# shellcheck source=tests/lib/tap.sh
. "$(dirname "$0")/../lib/tap.sh"

# ---- Results of a bundle's run -----------------------------------------------------------------------------------------

bundle=$work/bundle
mkdir -p "$bundle/bin" "$bundle/lib/own" "$bundle/lib/fallback" "$bundle/share/diptych/templates"
cat >"$bundle/share/diptych/templates/post.yaml" <<'END'
pipeline: post
images:
  photo:   {input: true, format: rgba8}
  picture: {format: rgba8, size: frame}
passes:
  - {name: invert, dispatch: picture, reads: [photo], writes: [picture], shader: negative.glsl}
output: {display: picture}
END
cat >"$bundle/share/diptych/templates/negative.glsl" <<'END'
void main()
{
    ivec2 p = invocation().xy;
    if (all(lessThan(p, picture_size())))
        picture_store(p, vec4(1.0 - photo(p).rgb, 1.0));
}
END
ln -s "$diptych" "$bundle/bin"
cp "$root/app/bundle/run.sh" "$bundle/run"
cp "$root/tests/specs/outside_grade.png" "$bundle/share/photo.png"
same_functions() { # folder folder: their image libraries export the same functions
    local folder
    for folder in "$@"; do
        nm -D --defined-only "$folder/libdiptych_image.so" | awk '$3 ~ /^image_/ {print $3}' >"$work/${folder##*/}.functions"
        [ -s "$work/${folder##*/}.functions" ] || return 1
    done
    diff "$work/${1##*/}.functions" "$work/${2##*/}.functions"
}
check "a bundle reads pictures by the functions that others have" same_functions "$build" "$build/bundle"
check "a bundle's run makes a page of one machine" sh "$bundle/run" "$work/ran"
check "... with its devices, verdicts and times" /usr/bin/python3 "$root/tests/app/report.py" --collected "$work/ran" agree
check_status 1 "a difference" "$planted" compare --spec "$bundle/share/diptych/templates/post.yaml" --input "photo=$bundle/share/photo.png" \
    --backend vk@0,gl --fault gl:invert:bit --json "$work/ran/post-cornell.json"
check "... goes to the page by the same command" "$diptych" report --collect "$work/ran"
check "... with its pass" /usr/bin/python3 "$root/tests/app/report.py" --collected "$work/ran" "differ, pass invert: "
check_status 2 "a folder without results" "$diptych" report --collect "$work"
check_status 2 "a folder without --collect" "$diptych" report "$work/ran"

told_first() { # without snakemake in PATH
    PATH=$work/none "$diptych" report --spec "$root/templates/ssvp.yaml" -o "$work/undone" 2>"$work/said"
    [ $? = 2 ] && [ ! -e "$work/undone" ] && grep "snakemake: cannot be started.*install the package snakemake" "$work/said"
}
check "snakemake is asked for before the work" told_first

if ! command -v snakemake >/dev/null; then
    skip "a report" "snakemake is missing"
    finish
fi

# ---- A pipeline with an outline, in folders with characters that are special to a shell, Snakemake or HTML --------

# shellcheck disable=SC2016
folder=$work/'it'\''s $HOME: <a> & b'
mkdir "$folder"
cp -r "$root"/tests/specs/grey* "$folder"
sed "s|^mesh: .*|mesh: $root/scenes/cornell.obj|" "$root/scenes/cornell.yaml" >"$folder/a & box.yaml"
sed "s|^mesh: .*|mesh: nowhere.obj|" "$root/scenes/cornell.yaml" >"$folder/absent.yaml"
report=$folder/report
# With an input that every step must pass on.
sed -i 's/^images:/buffers: {tone: {input: true, of: float, count: 1}}\n&/; s/writes: \[radiance\]/reads: [tone], &/' "$folder/grey.yaml"
sed -i 's/level/level * tone[0]/' "$folder/grey/paint.glsl"
/usr/bin/python3 -c 'import numpy, sys; numpy.save(sys.argv[1], numpy.ones(1, "f4"))' "$folder/a & tone.npy"
small=("$diptych" report --spec "$folder/grey.yaml" --input "tone=$folder/a & tone.npy" --size 48x27 --spp 16 --frames 3 --warmup 1 -o "$report")

said() { # status text command...: an exit status, and a text on stderr
    local want=$1 text=$2 got
    shift 2
    "$@" >"$work/out" 2>"$work/err"
    got=$?
    cat "$work/out" "$work/err"
    [ "$got" = "$want" ] && grep -qF -- "$text" "$work/err"
}

check "a report is made, without the scene whose mesh is not here" said 0 "absent.yaml is left out" "${small[@]}" --json "$folder/told.json"
# shellcheck disable=SC2016
check "... and told" /usr/bin/python3 -c 'import json, sys
it = json.load(open(sys.argv[1]))
assert it["verb"] == "report" and it["exit_status"] == 0 and it["failures"] == 0 and it["steps"] > 3, it
assert len(it["scenes"]) == 1 and it["scenes"][0].endswith("/a & box.yaml"), it
assert [error["severity"] for error in it["errors"]] == ["warning"] and "left out" in it["errors"][0]["message"], it' "$folder/told.json"
check "the page is well formed, its links lead somewhere, its numbers are those of the results" \
    /usr/bin/python3 "$root/tests/app/report.py" "$report"
# shellcheck disable=SC2016
reads_well "... and it reads well" "$report/index.html"
check "the reference's noise is a band" grep -rq 'id="noise"' "$report/plots"
check "plots are XML" /usr/bin/python3 -c 'import sys, xml.dom.minidom; [xml.dom.minidom.parse(path) for path in sys.argv[1:]]' "$report"/plots/*.svg

# ---- Going on ---------------------------------------------------------------------------------------------------------

times() { # of the results
    (cd "$report/a___box" && stat -c '%n %y' -- *.json)
}
times >"$work/before"
rm "$report/a___box/shown.render.exr"
check "a picture that is gone is made again" "${small[@]}"
check "... with what was measured of it, and nothing else" \
    [ "$(times | comm -13 "$work/before" - | cut -d' ' -f1 | tr '\n' ' ')" = "shown.metrics.json shown.render.json " ]

# ---- What fails -------------------------------------------------------------------------------------------------------

# 7 is above the max of `level`, and `levels` is no parameter. Results of earlier values must not replace the failed ones.
sed -i 's/^sweep: .*/sweep: {parameter: level, values: [0.05, 0.1, 7]}/; s/level=0.1]/levels=0.1]/' "$folder/grey/report.yaml"
check "steps that fail are told, and the rest is done" said 1 "there is no result of: " "${small[@]}"
check "... and the page is there, without their numbers" /usr/bin/python3 "$root/tests/app/report.py" "$report" --incomplete

check "a folder of something else" said 2 "holds files, but no report" "${small[@]}" -o "$folder"
check "an outline that is not there" said 2 "it says what a report of this spec shows" "${small[@]}" --outline "$folder/none.yaml"
printf 'pictures: [{name: ../a, title: A, set: [x=1]}]\n' >"$folder/bad.yaml"
check "an outline that names a file elsewhere" said 2 "\`name\` must be valid as a file name" "${small[@]}" --outline "$folder/bad.yaml"
printf 'pictures: [{name: a, title: A, set: [x=1]}]\nsweep: {parameter: x}\n' >"$folder/bad.yaml"
check "a sweep without values" said 2 "\`sweep\` lacks the key \`values\`" "${small[@]}" --outline "$folder/bad.yaml"
sed 's/total: .*/total: [1, 2]/' "$folder/grey/report.yaml" >"$folder/grey/bad.yaml"
check "numbers of other values" said 2 "as many numbers as the sweep has values" "${small[@]}" --outline "$folder/grey/bad.yaml"
sed 's/frames: 2/frames: 1/' "$folder/grey/report.yaml" >"$folder/grey/bad.yaml"
check "a motion of one frame" said 2 "\`frames\` is out of range: it lies between 2 and" "${small[@]}" --outline "$folder/grey/bad.yaml"
sed 's/quantity: .*/quantity: light/' "$folder/grey/report.yaml" >"$folder/grey/bad.yaml"
check "a motion of another quantity" said 2 "\`quantity\` takes \`radiance\` or \`irradiance\`" "${small[@]}" --outline "$folder/grey/bad.yaml"
sed 's/from_bounce: .*/from_bounce: 2/' "$folder/grey/report.yaml" >"$folder/grey/bad.yaml"
check "a motion of more bounces than the reference has" said 2 "must be at most \`bounces\`" "${small[@]}" --outline "$folder/grey/bad.yaml"
sed '/quantity: /d; /from_bounce: /d' "$folder/grey/report.yaml" >"$folder/grey/default.yaml"
"${small[@]}" --outline "$folder/grey/default.yaml" --collect -o "$work/default" >/dev/null 2>&1
check "by default a motion is of indirect irradiance" \
    grep -q -- '--from-bounce 1 --bounces 1 --quantity irradiance' "$work/default/index.html"
check "... as the page says" grep -q 'the indirect irradiance, changes' "$work/default/index.html"
check "no scene left" said 2 "no scene is left" "${small[@]}" --scene "$folder/absent.yaml"
finish
