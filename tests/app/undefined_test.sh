#!/usr/bin/env bash
# compare tells what drivers at hand agree on by luck: memory that no pass has written, also where the last owner's content hides
# it, results that vary with the number of threads, and limits that others do not have. TAP.
. "$(dirname "$0")/../lib/tap.sh"
. "$root/tests/lib/drivers.sh"
cd "$work" || exit

# `three` writes every other element of `second`, which shares the memory of `first`; `one` leaves the same content there.
cat >images.yaml <<'EOF'
pipeline: images
images:
  first: {format: rgba16f, size: [16, 16]}
  mid: {format: rgba16f, size: [16, 16]}
  second: {format: rgba16f, size: [16, 16]}
  last: {format: rgba16f, size: [16, 16]}
passes:
  - {name: one, dispatch: first, writes: [first], shader: image_one.glsl}
  - {name: two, dispatch: mid, reads: [first], writes: [mid], shader: image_two.glsl}
  - {name: three, dispatch: second, reads: [mid], writes: [second], shader: image_three.glsl}
  - {name: four, dispatch: last, reads: [second], writes: [last], shader: image_four.glsl}
EOF
echo 'void main() { ivec2 p = invocation().xy; first_store(p, vec4(vec2(p), 1.0, 2.0)); }' >image_one.glsl
echo 'void main() { ivec2 p = invocation().xy; mid_store(p, first(p) - 1.0); }' >image_two.glsl
echo 'void main() { ivec2 p = invocation().xy; if (p.x != 3 || p.y > 1) second_store(p, mid(p) + 1.0); }' >image_three.glsl
echo 'void main() { ivec2 p = invocation().xy; last_store(p, second(p)); }' >image_four.glsl
cat >buffers.yaml <<'EOF'
pipeline: buffers
structs:
  Pair: {weight: float, number: uint}
buffers:
  first: {of: Pair, count: 64}
  mid: {of: Pair, count: 64}
  second: {of: Pair, count: 64}
  last: {of: Pair, count: 64}
passes:
  - {name: one, dispatch: 64, writes: [first], shader: one.glsl}
  - {name: two, dispatch: 64, reads: [first], writes: [mid], shader: two.glsl}
  - {name: three, dispatch: 64, reads: [mid], writes: [second], shader: three.glsl}
  - {name: four, dispatch: 64, reads: [second], writes: [last], shader: four.glsl}
EOF
echo 'void main() { int i = invocation().x; first[i] = Pair(float(i), 1000u + uint(i)); }' >one.glsl
echo 'void main() { int i = invocation().x; mid[i] = first[i]; }' >two.glsl
echo 'void main() { int i = invocation().x; second[i].number = mid[i].number; if (i != 3) second[i].weight = mid[i].weight; }' >three.glsl
echo 'void main() { int i = invocation().x; last[i] = second[i]; }' >four.glsl

told() { # spec sides message option...
    local spec=$1 sides=$2 message=$3
    shift 3
    "$diptych" compare --spec "$spec.yaml" --size 16x16 --backend "$sides" --json told.json --junit told.xml "$@" >told 2>&1
    [ $? = 1 ] || return
    cat told
    [ "$(grep -cF "$message" told)" = 2 ] && grep -qF 'pass three is the first to break: second' told && ! grep -q '^why:' told &&
        json_holds told.json "d['first_break']['unwritten'] == '''$message'''" && grep -qF "$message" told.xml
}
# shellcheck disable=SC2016
texel='texel (3, 0) of `second` was never written in this frame, like 1 others' element='`second[3].weight` was never written in this frame'
for sides in gl,vk@llvmpipe vk@llvmpipe,"${strangers[0]:-gl}"; do
    check "$sides: a texel that no pass has written is named" told images "$sides" "$texel" --frames 2
    check "... and a number of a buffer" told buffers "$sides" "$element"
done
sanitized() { # backend: no driver shows what is read, since the other content is the same
    "$diptych" render --spec images.yaml --size 16x16 --frames 2 --backend "$1" --sanitize=content --dump "$1" >found
    # shellcheck disable=SC2016
    [ $? = 1 ] && grep -qF 'image_four.glsl:1:56: undefined: texel (3, 0) of `second` was never written in this frame' found &&
        grep -qF '  pass four, invocation (3, 0, 0), 4 times; first in frame 0' found && [ "$(wc -l <found)" = 2 ]
}
for backend in gl vk@llvmpipe; do
    check "$backend: --sanitize finds it in its line" sanitized "$backend"
done
agrees() {
    sed -i 's/if (p.x.*1) //' image_three.glsl
    sed -i 's/if (i != 3) //' three.glsl
    "$diptych" compare --spec images.yaml --size 16x16 --backend gl,vk@llvmpipe --debug && "$diptych" compare --spec buffers.yaml --size 16x16 --debug
}

poisoned() { # backend
    for byte in 17 85; do
        "$planted" render --spec images.yaml --size 16x16 --backend "$1" --dump "$1-$byte" --poison "$byte" --frames 2 || return
    done
    ! cmp "$1-17/02.three.second.raw" "$1-85/02.three.second.raw" && cmp "$1-17/01.two.mid.raw" "$1-85/01.two.mid.raw"
}
for backend in gl vk@llvmpipe; do
    check "$backend: memory is filled before each owner" poisoned "$backend"
done

replayed() { # backend
    "$diptych" replay case --backend "$1" --json replay.json >told 2>&1
    [ $? = 1 ] || return
    cat told
    grep -qF "pass three on $1: $texel" told && json_holds replay.json "d['results'][0]['unwritten'] == '''$texel'''"
}
check "--bisect keeps it" told images gl,vk@llvmpipe "$texel" --bisect case
for backend in gl vk@llvmpipe "${strangers[@]}"; do
    check "$backend: replay says that no side is right" replayed "$backend"
done
check "what is written as a whole agrees" agrees

cat >sum.yaml <<'EOF'
pipeline: sums
buffers: {total: {of: uint, count: 1}, much: {of: uint, count: 1}}
passes:
  - {name: start, dispatch: 1, writes: [total], shader: start.glsl}
  - {name: sum, dispatch: 262144, updates: [total], shader: sum.glsl}
  - {name: big, dispatch: 64, writes: [much], shader: big.glsl}
EOF
echo 'void main() { total[0] = 0u; }' >start.glsl
echo 'void main() { atomicAdd(total[0], 1u); }' >sum.glsl
echo 'shared uint pool[5000]; void main() { pool[invocation().x] = 1u; barrier(); if (invocation().x == 0) much[0] = pool[63]; }' >big.glsl
repeats() {
    "$diptych" compare --spec sum.yaml --size 16x16 --backend gl,vk@llvmpipe --repeat 3 --json told.json --junit told.xml --html page >told || return
    cat told
    grep -qF "elsewhere: big: 20000 bytes of shared memory, where Vulkan's Roadmap 2022 promises 16384" told &&
        json_holds told.json 'd["elsewhere"][0]["kind"] == "limit" and d["elsewhere"][0]["pass"] == "big"' && grep -q 'pass big: 20000 bytes' page/index.html &&
        grep -qF 'all runs are equal' told.xml && ! "$diptych" compare --spec sum.yaml --size 16x16 --sanitize=flow | grep elsewhere
}
check "runs with other numbers of threads agree; a limit is told, not of the checks of --sanitize" repeats
races() {
    "$diptych" compare --spec "$root/tests/specs/racing.yaml" --size 16x16 --backend gl,vk@llvmpipe --repeat 3 --json told.json --junit told.xml >told
    [ $? = 1 ] || return
    cat told
    grep -qE 'elsewhere: arrive: [23] distinct results in 3 runs, on gl$' told && ! grep -q 'never written' told &&
        json_holds told.json 'all(e["kind"] == "repeat" and e["pass"] == "arrive" and e["distinct"] > 1 and e["runs"] == 3 for e in d["elsewhere"])' &&
        grep -qE 'name="arrive"><failure message="[23] distinct results in 3 runs, on vk@llvmpipe"' told.xml
}
check "a race gives distinct results" races

cat >scene.yaml <<'EOF'
pipeline: arrays
buffers: {sum: {of: float, count: 1}}
passes: [{name: go, dispatch: 1, local: 1, reads: [scene_vertices, scene_indices], writes: [sum], shader: scene.glsl}]
EOF
echo 'void main() { sum[0] = scene_vertices[invocation().x + 99].px + float(scene_indices[invocation().x + 99]); }' >scene.glsl
arrays() {
    ! "$diptych" compare --spec scene.yaml --scene "$root/scenes/cornell.yaml" --size 16x16 --sanitize --json told.json >told && cat told &&
        json_holds told.json '[(u["column"], u["message"][:9], u["message"][-11:]) for u in d["undefined"]] == [(24, "index 99 ", "76 elements"), (71, "index 99 ", "90 elements")]'
}
check "an index beyond the scene's arrays is told once, at its place" arrays
finish
