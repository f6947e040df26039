#!/usr/bin/env bash
# --json of every verb: the same shape on success and on failure, errors with their places, and never a partial file.
# report_test.sh checks the JSON of report. TAP.
. "$(dirname "$0")/../lib/tap.sh"
python=/usr/bin/python3
scene=(--scene "$root/scenes/cornell.yaml")
small=("${scene[@]}" --size 16x16 --spec "$root/templates/rsm.yaml" --set samples=4 --set rsm_size=16)

tells() { # status expression verb option...: the verb writes JSON of the shape; the expression about this JSON, `it`, holds
    local want=$1 expression=$2 tool=("$diptych" "$3")
    [ "$3" != check ] || tool=("$build/diptych-gen" --check)
    shift 3
    rm -f "$work/it.json"
    "${tool[@]}" "$@" --json "$work/it.json" >"$work/table" 2>"$work/said" </dev/null
    local got=$?
    cat "$work/said"
    echo "exit status $got, expected $want"
    [ "$got" = "$want" ] || return
    cat "$work/it.json"
    $python - "$work/it.json" "$want" "$expression" <<'PYTHON'
import json, sys
it = json.load(open(sys.argv[1]))
status, errors = int(sys.argv[2]), [error for error in it["errors"] if error["severity"] == "error"]
assert list(it)[:4] == ["verb", "format", "exit_status", "errors"] and it["format"] == 1, list(it)
assert it["exit_status"] == status, it["exit_status"]
for error in it["errors"]:
    assert error["message"] and "\n" not in error.get("file", ""), error
    assert ("line" in error) == ("column" in error) == ("file" in error), error
assert eval(f"({sys.argv[3]})"), sys.argv[3]
PYTHON
}

fine() { # expression verb option...
    check "$2" tells 0 "not errors and it['verb'] == '$2' and ($1)" "${@:2}"
}

fails() { # reason status expression verb option...
    check "$4: $1" tells "$2" "errors and it['verb'] == '$4' and ($3)" "${@:4}"
}

# Names, types and sizes as tests/specs/features.yaml has them; kept_size is 17 * 9 + 300000.
features=(list --spec "$root/tests/specs/features.yaml" --size 17x9)
fine "[p['name'] for p in it['params']] == ['bins', 'tile', 'blur', 'weight'] and
    [p['value'] for p in it['params']] == [16, [3, 2], False, 0.3] and
    [p['live'] for p in it['params']] == [False, False, True, True] and it['params'][0]['doc'] == 'histogram bins' and
    (it['params'][0]['min'], it['params'][0]['max']) == (2, 64) and it['output'] == {'linear': 'hdr', 'display': 'shown'}" \
    "${features[@]}" --set blur=false --set weight=0.3
fine "(lambda r: (r['kept']['kind'], r['kept']['count'], r['kept']['fields'][0]['type']) == ('buffer', 300153, 'uint') and
    [f['name'] for f in r['histogram']['fields']] == ['count', 'mean', 'square', 'polar', 'concentric', 'apart'] and
    (r['half_color']['format'], r['half_color']['width'], r['half_color']['height']) == ('rgba16f', 8, 4) and
    r['slices']['layers'] == 3 and r['trail']['history'] and not r['hdr']['history'])({r['name']: r for r in it['resources']})" \
    "${features[@]}"
fine "(lambda p: len(p) == 12 and p['blur']['kind'] == 'draw fullscreen' and p['scene']['kind'] == 'draw scene' and
    set(p['count']['reads']) == {'color', 'label'} and set(p['count']['writes']) == {'histogram', 'pattern', 'arguments'} and
    p['count']['shader'] == 'features_count.glsl' and p['mark']['kind'] == 'dispatch indirect' and
    p['keep']['arguments'] == {'x': -(-300153 // 64), 'y': 1, 'z': 1} and p['slice']['arguments'] == {'layers': 3} and
    p['halves']['arguments'] == {'layers': 1, 'indices': 'kept', 'arguments': 'draw_arguments'})({p['name']: p for p in it['passes']})" "${features[@]}"
table_has() { # in this order
    "$diptych" "${features[@]}" >"$work/table" && grep -A1 '^  histogram *buffer' "$work/table" | grep 'mean: vec3' &&
        grep -E '^  slices +image +rgba32f +8x8x3$' "$work/table" && grep -E '^  bins +int +16 +2 to 64 +histogram bins$' "$work/table"
}
check "list prints a table" table_has
check "... with what passes call" grep -E '^  follow +dispatch 3 2 1 +features_follow.glsl$' "$work/table"
fine "it['width'] == 16 and it['output'].endswith('a.exr') and it['resource'] == 'radiance' and it['backend'] == 'vk'" \
    render "${small[@]}" --backend vk -o "$work/a.exr"
fine "it['agree'] and it['guilty'] is None and it['devices']" compare "${small[@]}"
# The fault flips one bit of one element, so the region is that element, wherever it is.
diptych=$planted check "compare with a fault" tells 1 "not errors and not it['agree'] and it['guilty']['pass'] == 'denoise_rows' and
    it['guilty']['case'].endswith('/case') and it['guilty']['region']['failing'] == 1 and
    it['guilty']['region']['low'] == it['guilty']['region']['high'] == it['guilty']['region']['smallest'] and
    len(it['guilty']['region']['low']) == 2 and max(it['guilty']['region']['low']) < 16" \
    compare "${small[@]}" --fault vk:denoise_rows:bit --bisect "$work/case"
fine "it['as_expected'] and it['pass'] == 'denoise_rows'" replay "$work/case" --backend gl
fine "len(it['sides']) == 1 and it['frames'] == 2" bench "${small[@]}" --backend vk --frames 2 --warmup 1
fine "it['samples'] == 2 and len(it['mean']) == 3" reference "${scene[@]}" --size 16x16 --spp 2 -o "$work/truth.exr"
fine "it['hdr']['rmse'] > 0" metrics --reference "$work/truth.exr" --test "$work/a.exr"
fine "it['agree'] == 2 and len(it['runs']) == 2 and {run['verdict'] for run in it['runs']} == {'agree'}" \
    sweep -o "$work/sweep" "${scene[@]}" --size 16x16 --spec "$root/templates/rsm.yaml" --set rsm_size=16 --grid samples=2,4
check "diptych-gen --check" tells 0 "not errors and it['verb'] == 'check' and it['pipeline'] == 'rsm' and
    it['passes'] == 14 and any(path.endswith('rsm/gather.glsl') for path in it['inputs'])" check "$root/templates/rsm.yaml"

cp -r "$root/templates" "$work/templates"
wrong=$work/templates/rsm.yaml
sed -i '0,/rgba32f/s//rgba32g/' "$wrong"
line=$(grep -n rgba32g "$wrong" | cut -d: -f1)
place="errors[0]['file'].endswith('rsm.yaml') and errors[0]['line'] == $line and errors[0]['column'] == 30 and 'did you mean' in errors[0]['message']"
fails "a wrong spec" 1 "$place" list --spec "$wrong"
for verb in render compare bench; do
    backend=gl,vk status=2 output=()
    [ $verb = compare ] || { backend=vk status=1; }
    [ $verb != render ] || output=(-o "$work/b.exr")
    fails "a wrong spec" $status "$place" $verb "${scene[@]}" --size 16x16 --spec "$wrong" --backend $backend "${output[@]}"
done
fails "a wrong spec" 1 "$place and errors[0]['length'] == 7" check "$wrong"
echo 'float wrong = sampels;' >>"$work/templates/rsm/gather.glsl"
sed -i 's/rgba32g/rgba32f/' "$wrong"
fails "wrong GLSL" 1 "errors[-1]['file'].endswith('rsm/gather.glsl') and 'sampels' in errors[-1]['message']" render "${scene[@]}" --spec "$wrong" --size 8x8 \
    --backend vk -o "$work/b.exr"
printf 'mesh: cornell.obj\ncamra: {}\nlight: [1]\n' >"$work/scene.yaml"
fails "a wrong scene" 1 "[(error['line'], error['column']) for error in errors] == [(1, 7), (2, 1), (3, 9)]" \
    reference --scene "$work/scene.yaml" -o "$work/b.exr"
printf 'mesh: %s\ncamera: absent\n' "$root/scenes/cornell.obj" >"$work/wish.yaml"
fails "no such camera, which a child process says" 1 "errors[0]['file'].endswith('wish.yaml') and (errors[0]['line'], errors[0]['column']) == (2, 9)" \
    reference --scene "$work/wish.yaml" -o "$work/b.exr"
printf -- '- include=a.yaml\n' >"$work/overlay.yaml"
fails "a wrong overlay" 2 "(errors[0]['line'], errors[0]['column']) == (1, 3)" render --with "$work/overlay.yaml" -o "$work/b.exr"
# freed memory is overwritten: messages must not point into it
MALLOC_PERTURB_=165 fails "a grid of no parameter" 2 "errors[0]['file'] == '--set' and 'no \`sampels\`' in errors[0]['message']" \
    sweep -o "$work/sweep3" "${scene[@]}" --spec "$root/templates/rsm.yaml" --grid sampels=2,4
fails "no picture" 1 "'file' not in errors[0] and 'absent.exr' in errors[0]['message']" metrics --reference "$work/absent.exr" --test "$work/a.exr"
fails "no folder" 2 "'absent' in errors[0]['message']" replay "$work/absent" --backend vk
fails "nothing to vary" 2 "'grid' in errors[0]['message'] or 'random' in errors[0]['message']" sweep -o "$work/sweep2" "${scene[@]}"
fails "no outline" 2 "'report.yaml' in errors[0]['message']" report -o "$work/report" --spec "$root/tests/specs/mips.yaml"
fails "a wrong option" 2 "'did you mean' in errors[0]['message']" render "${scene[@]}" --backendd vk
check_status 1 "a file that cannot be written" "$diptych" reference "${scene[@]}" -o "$work/c.exr" --json "$work/absent/c.json"
check "... is told before the work" [ ! -e "$work/c.exr" ]
mkfifo "$work/pipe"
for verb in check reference; do
    limited 20 cat "$work/pipe" >"$work/piped.json" &
    if [ $verb = check ]; then
        "$build/diptych-gen" --check "$wrong" --json "$work/pipe" 2>"$work/said"
    else
        "$diptych" reference --scene "$work/scene.yaml" -o "$work/b.exr" --json "$work/pipe" 2>"$work/said"
    fi
    check "$verb: into a pipe" wait $!
    check "... that stays one" [ -p "$work/pipe" ]
    check "... with all that it tells" $python -c 'import json, sys; sys.exit(json.load(open(sys.argv[1]))["exit_status"] != 1)' "$work/piped.json"
done
finish
