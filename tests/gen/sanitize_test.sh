#!/usr/bin/env bash
# --sanitize finds undefined behaviour of bodies that are wrong in one place, there, on every driver; bodies that come near stay
# silent and keep their bits. lavapipe gets all bodies, and one other driver a sixth, both drawn by SEED. Long: all drivers get all,
# and all mutants of the checks. TAP.
. "$(dirname "$0")/../lib/tap.sh"
. "$root/tests/lib/drivers.sh"
seed=${SEED:-$RANDOM}
tool() { /usr/bin/python3 -B "$root/tests/gen/sanitize.py" "$@"; }
tool make "$work" "$seed" || exit 1

# The kinds that each table is about: checks of all kinds take the drivers' compilers several times as long.
declare -A kinds=([wrong]="index,arithmetic,loop,variable" [wrong_memory]="content,race,flow" [wrong_draw]="")
kinds[fine]=${kinds[wrong]} kinds[fine_memory]=${kinds[wrong_memory]} kinds[fine_draw]=""
sanitized() { # table backend folder
    "$planted" render --spec "$work/$1.yaml" --size 16x16 --backend "$2" --dump "$work/$3" --poison 7 "--sanitize${kinds[${1#some_}]:+=${kinds[${1#some_}]}}" --json "$work/found.json"
}
finds() { # table backend
    sanitized "$1" "$2" dump
    [ $? = 1 ] && tool found "$work/found.json" "$work/$1.yaml"
}
silent() { # table backend
    sanitized "$1" "$2" checked
    local status=$?
    tool silent "$work/found.json" "$work/$1.yaml" && [ "$status" = 0 ] &&
        "$planted" render --spec "$work/$1.yaml" --size 16x16 --backend "$2" --dump "$work/plain" --poison 7 &&
        tool equal "$work/plain" "$work/checked"
}

others=(gl "${strangers[@]}")
[ -n "${DIPTYCH_LONG:-}" ] || others=("${others[seed / 7 % ${#others[@]}]}")
for backend in vk@llvmpipe "${others[@]}"; do
    some='' whom=$backend
    [ "$backend" = vk@llvmpipe ] || [ -n "${DIPTYCH_LONG:-}" ] || { some=some_ && whom="$backend, seed $seed:"; }
    check "$whom finds each undefined operation in its line" finds ${some}wrong "$backend"
    check "$whom is silent about what comes near, and changes no bit" silent ${some}fine "$backend"
    check "$whom finds unwritten content, races and diverging barriers in their line" finds ${some}wrong_memory "$backend"
    check "$whom is silent about memory that is used as it may be, and changes no bit" silent ${some}fine_memory "$backend"
    check "$whom finds derivatives of parted quads in their line" finds ${some}wrong_draw "$backend"
    check "$whom is silent about derivatives of whole quads, and changes no bit" silent ${some}fine_draw "$backend"
done
[ ${#strangers[@]} -gt 0 ] || skip "another driver finds each undefined operation in its line" "$no_strangers"

# What a vertex shader leaves out, and the fragment shader reads.
printf '%s\n' 'pipeline: vary' 'images: {picture: {format: rgba32f, size: [8, 8]}}' 'passes:' \
    '  - {name: show, draw: {vertices: 3}, writes: [picture], shader: vary.glsl}' >"$work/vary.yaml"
varies() { # what the fragment shader reads; condition of the position; finding...
    local read=$1 when=$2
    shift 2
    cat >"$work/vary.glsl" <<END
#ifdef VERTEX
layout(location = 0) out vec4 tint;
layout(location = 1) flat out uint kind;
void main()
{
    if ($when) gl_Position = vec4(4.0 * vec2(gl_VertexIndex & 1, gl_VertexIndex >> 1) - 1.0, 0.5, 1.0);
    tint.rgb = vec3(0.5);
    kind = 2u;
}
#else
layout(location = 0) in vec4 tint;
layout(location = 1) flat in uint kind;
void main() { picture = vec4($read, float(kind)); }
#endif
END
    for backend in gl vk@llvmpipe; do
        "$diptych" render --spec "$work/vary.yaml" --size 8x8 --backend "$backend" --sanitize --dump "$work/vary" >"$work/found"
        [ $? = $# ] || return
        cat "$work/found"
        [ "$(grep -c undefined: "$work/found")" = $# ] && { [ $# = 0 ] || grep -qF "$1" "$work/found"; } || return
    done
}
# shellcheck disable=SC2016
check "a varying with a part that nothing wrote is found where it is read" varies "tint.gba" true 'vary.glsl:13:30: undefined: `tint` is read before'
# shellcheck disable=SC2016
check "... and a position" varies "tint.rgb" "gl_VertexIndex != 5 && gl_VertexIndex != 1" 'vary.glsl:6:53: undefined: `gl_Position` is not written'
check "... and no part that nothing reads" varies "tint.bgr" true

refused() {
    "$diptych" compare --spec "$work/fine.yaml" --size 16x16 --sanitize=index,numbers 2>&1 |
        grep -q 'unknown kind "numbers"; there are index, arithmetic'
}
check "an unknown kind is refused" refused
compared() {
    limited 60 "$diptych" compare --spec "$work/few.yaml" --size 16x16 --backend gl,vk@llvmpipe --sanitize=index,loop >"$work/compared"
# shellcheck disable=SC2016
    [ $? = 1 ] && grep -qF 'w_0.glsl:5:9: undefined: index 8 of `taps`, which has 8 elements' "$work/compared" &&
        grep -qF '  pass w_0, invocation (32, 0, 0), 32 times; first in frame 0; gl, vk@llvmpipe' "$work/compared" &&
        ! grep -q 'sqrt' "$work/compared"
}
check "compare tells the kinds that it is asked for, and the sides" compared

# What is found goes everywhere that results go; `allow` silences it, and is told where it silences nothing.
specs=$root/tests/specs
cp "$specs"/meant* "$work"
sed '/meant_rest/,$d; s/, allow: .*}}/}/; /name: rest/,$d' "$specs/meant.yaml" >"$work/bare.yaml"
meant() {
    "$diptych" render --spec "$specs/meant.yaml" --size 16x16 --backend vk@llvmpipe --dump "$work/meant" --sanitize >"$work/told" 2>&1 || return
    cat "$work/told"
    [ ! -s "$work/told" ] || return
    "$diptych" render --spec "$specs/meant.yaml" --size 16x16 --backend gl --dump "$work/meant" --sanitize --set turns=9 >"$work/told" 2>&1 || return
    cat "$work/told"
    # shellcheck disable=SC2016
    grep -qF 'meant.yaml:19:49: warning: `allow: loop` of the pass `rest` has silenced nothing in this run' "$work/told" &&
        [ "$(grep -c warning: "$work/told")" = 1 ]
}
check "allow silences what is meant, and is told where it silences nothing" meant
# Findings that are allowed take no room from others, in one invocation and in one call of a generated function.
cat >"$work/rooms.yaml" <<'END'
pipeline: rooms
buffers: {taps: {of: float, count: 4}, sums: {of: float, count: 8}}
passes:
  - {name: fill, dispatch: 4, writes: [taps], shader: rooms_fill.glsl}
  - name: look
    dispatch: 8
    reads: [taps]
    writes: [sums]
    allow: {arithmetic: "logs of zero are dropped", loop: "never needed", index: "the last one is repeated"}
    shader: rooms.glsl
END
echo 'void main() { int i = invocation().x; if (i < 4) taps[i] = 1.0; }' >"$work/rooms_fill.glsl"
cat >"$work/rooms.glsl" <<'END'
void main()
{
    int i = invocation().x;
    float x = float(i) * 0.0, u, r = log(x) + log(x) + log(x) + log(x) + log(x) + log(x) + log(x) + log(x);
    r += taps[i]; if (i < 8) sums[i] = max(r + u, 0.0);
}
END
rooms() { # backend
    "$diptych" render --spec "$work/rooms.yaml" --size 8x8 --backend "$1" --dump "$work/rooms" --sanitize >"$work/found" 2>"$work/told"
    [ $? = 1 ] || return
    cat "$work/found" "$work/told"
    # shellcheck disable=SC2016
    [ "$(grep -c undefined: "$work/found")" = 1 ] && grep -qF 'rooms.glsl:5:48: undefined: `u` is read before it has a value' "$work/found" &&
        [ "$(grep -c 'silenced nothing' "$work/told")" = 1 ] && grep -qF '`allow: loop` of the pass `look` has silenced nothing' "$work/told"
}
for backend in gl vk@llvmpipe; do
    check "$backend: what is allowed hides nothing else, and is not called idle" rooms "$backend"
done
everywhere() {
    "$planted" compare --spec "$work/bare.yaml" --size 16x16 --backend gl,vk@llvmpipe --sanitize --fault gl:logs:bit --bisect "$work/case" \
        --junit "$work/junit.xml" --html "$work/page" --json "$work/pair.json" >/dev/null
    [ $? = 1 ] && grep -qF 'meant_logs.glsl:4:20"><failure message="log(0)"/>' "$work/junit.xml" &&
        grep -qF 'meant_logs.glsl:4:20</code>: undefined: log(0)</p>' "$work/page/index.html" &&
        json_holds "$work/pair.json" 'd["undefined"] == [{"file": d["undefined"][0]["file"], "line": 4, "column": 20, "kind": "arithmetic",
            "message": "log(0)", "pass": "logs", "invocation": [0, 0, 0], "count": 1, "frame": 0, "sides": ["gl", "vk@llvmpipe"]}]'
}
check "JUnit, the page and JSON of compare have the findings" everywhere
replayed() {
    "$diptych" replay "$work/case" --backend vk@llvmpipe --sanitize --json "$work/replay.json" >"$work/told"
    cat "$work/told"
    grep -qF 'meant_logs.glsl:4:20: undefined: log(0)' "$work/told" && json_holds "$work/replay.json" 'len(d["undefined"]) == 1' &&
        "$diptych" replay "$work/case" --backend gl --sanitize=loop --json "$work/replay.json" >/dev/null
    json_holds "$work/replay.json" 'd["undefined"] == []'
}
check "replay has them, too" replayed

# A reduction without one of its barriers, and an atomic that became a store: found by every run, for every number of threads.
cat >"$work/seeded.yaml" <<'END'
pipeline: seeded
buffers: {sums: {of: uint, count: 16}, total: {of: uint, count: 1}}
passes:
  - {name: clear, dispatch: 1, local: 1, writes: [total], shader: seeded_clear.glsl}
  - {name: reduce, dispatch: 1024, local: 64, updates: [total], writes: [sums], shader: seeded.glsl}
END
echo 'void main() { total[0] = 0u; }' >"$work/seeded_clear.glsl"
cat >"$work/seeded.glsl" <<'END'
shared uint part[64];
void main()
{
    int l = invocation().x % 64;
    part[l] = 1u;
    barrier();
    for (int k = 32; k > 0; k /= 2)
        if (l < k) part[l] += part[l + k];
    barrier();
    if (l == 0) sums[invocation().x / 64] = part[0];
    if (l == 0) total[0] = total[0] + part[0];
}
END
seeded() { # threads
    for _ in 1 2; do
        LP_NUM_THREADS=$1 "$diptych" render --spec "$work/seeded.yaml" --size 8x8 --backend vk@llvmpipe --dump "$work/seeded" --sanitize=race >"$work/found"
        [ $? = 1 ] || return
        cat "$work/found"
        # shellcheck disable=SC2016
        [ "$(grep -c undefined: "$work/found")" = 2 ] &&
            grep -qF 'seeded.glsl:8:20: undefined: element 1 of `part` is also touched by invocation (1, 0, 0), and no barrier' "$work/found" &&
            grep -qF 'seeded.glsl:11:17: undefined: element 0 of `total` is also touched by invocation (64, 0, 0), and no barrier' "$work/found" || return
    done
}
for threads in 1 2 8; do
    check "seeded races are found in every run with $threads threads" seeded "$threads"
done

mkdir "$work/mutants"
cd "$root" || exit
check "each check that is left out is missed (seed $seed)" env SEED="$seed" /usr/bin/python3 -B "$root/tests/gen/sanitize_mutants.py" "$build" "$work/mutants" "${DIPTYCH_LONG:+long}"
finish
