#!/usr/bin/env bash
# `exactness` of passes and groups: what decides stays exact, what colours may be fast, and `compare` says how far that is from its exact
# twin on the same inputs. TAP.
. "$(dirname "$0")/../lib/tap.sh"
cd "$root" || exit 1
mkdir "$work/spec"
cat >"$work/spec/two.yaml" <<'END'
pipeline: two
params: {error: {value: 0.0, min: -1.0, max: 1.0, doc: "of the fast body"}}
groups:
  paints:
    args: [from, out]
    exactness: bounded
    passes: [{name: colour, dispatch: from, reads: [{name: from, as: field}], writes: [{name: out, as: colour}], shader: colour.glsl}]
images:
  field:  {format: rgba32f, size: frame}
  first:  {format: rgba16f, size: frame}
  second: {format: rgba16f, size: frame}
  mask:   {format: r32ui, size: frame}
passes:
  - {name: decide, dispatch: field, writes: [field], shader: decide.glsl}
  - {group: paints, as: one, with: {from: field, out: first}}
  - {name: later, exactness: bounded, dispatch: field, reads: [first], writes: [second], shader: later.glsl}
  - {name: count, dispatch: field, reads: [second], writes: [mask], shader: count.glsl}
output: {linear: second}
END
cat >"$work/spec/decide.glsl" <<'END'
void main() { ivec2 p = invocation().xy; field_store(p, vec4(vec2(p) * 0.37 + 0.1, fract(vec2(p) * 0.77))); }
END
cat >"$work/spec/colour.glsl" <<'END'
void main()
{
    ivec2 p = invocation().xy;
    vec4 v = field(p);
    float bright = exp2(v.x * 0.3) / (1.0 + v.y * v.z) + pow(v.y, 2.2);
#ifndef EXACT
    bright *= 1.0 + error;
#endif
    colour_store(p, vec4(bright, v.zw * v.x + v.y, 1.0));
}
END
cat >"$work/spec/later.glsl" <<'END'
void main() { ivec2 p = invocation().xy; second_store(p, sqrt(first(p)) * 0.7 + first(p) / 3.0); }
END
cat >"$work/spec/count.glsl" <<'END'
void main() { ivec2 p = invocation().xy; mask_store(p, uvec4(uint(second(p).x * 1e3))); }
END
compare=("$diptych" compare --spec "$work/spec/two.yaml" --size 61x23)
holds() { # file statement...: Python about the JSON as `c`
    /usr/bin/python3 - "$@" <<'PYTHON'
import json, sys
c = json.load(open(sys.argv[1]))
far = {(r["side"], r["pass"], r["resource"]): r for r in c.get("of_exact", [])}
contracts = {r["resource"]: r["contract"] for r in c["results"]}
for statement in sys.argv[2:]:
    assert eval(statement), statement
PYTHON
}

check "by default all is exact" "${compare[@]}" --json "$work/exact.json"
check "... and nothing has a twin" holds "$work/exact.json" '"of_exact" not in c' 'set(contracts.values()) == {"exact"}'
check "bounded passes agree with their exact twins" "${compare[@]}" --set exactness=bounded --json "$work/bounded.json"
check "... those of groups, too, on each side, and no others" holds "$work/bounded.json" \
    'set(far) == {(s, *r) for s in ("gl", "vk") for r in (("one.colour", "first"), ("later", "second"))}' \
    'contracts == {"field": "exact", "first": "of_exact", "second": "of_exact", "mask": "exact"}' \
    'all(r["verdict"] != "DIFFERS" for r in far.values())'
check_status 1 "a body that errs by more than its contract" "${compare[@]}" --set exactness=bounded --set error=0.004 --json "$work/far.json"
cp "$work/output" "$work/told"
check "... is named, with the side" grep -qF 'too far from exact: pass one.colour (shader colour.glsl): resource first on gl' "$work/told"
check "... by its own error alone" holds "$work/far.json" 'not c["agree"]' 'far["vk", "one.colour", "first"]["verdict"] == "DIFFERS"' \
    '0.003 < far["vk", "one.colour", "first"]["worst"]["error"] < 0.005' 'far["vk", "later", "second"]["verdict"] != "DIFFERS"'
check "a contract allows it" "${compare[@]}" --set exactness=bounded --set error=0.004 --set 'contracts.first={of_exact: 0.005}'
check "... or outliers" "${compare[@]}" --set exactness=bounded --set error=0.004 --set 'contracts.first={of_exact: 0.001, outliers: 1}'
far=("${compare[@]}" --set exactness=bounded --set error=0.004)
check "runs are measured" "${far[@]}" --set 'contracts.first={of_exact: 0.005}' --measure 2 --write-contracts "$work/measured.yaml"
check "... as far as they are from exact" grep -Eq '^first: \{of_exact: 0\.00(39|4)' "$work/measured.yaml"
check "... which is a contract that holds" "${far[@]}" --contracts "$work/measured.yaml"
cp "$work/output" "$work/told"
check "... just" grep -Eq '^one.colour +first .* within +(9[0-9]|100) %' "$work/told"
check_status 1 "... and allows no more" "${compare[@]}" --set exactness=bounded --set error=0.005 --contracts "$work/measured.yaml"
echo 'field: {of_exact: 1}' >"$work/wrong.yaml"
check_status 2 "of_exact is for passes that are left free" "${far[@]}" --contracts "$work/wrong.yaml"
check_status 1 "a fault on one side is found" "$planted" "${compare[@]:1}" --set exactness=bounded --fault vk:later:texel
cp "$work/output" "$work/told"
check "... in its pass" grep -qF 'guilty: pass later' "$work/told"
check "a pass is fast alone" "${compare[@]}" --set passes.later.exactness=fast --json "$work/alone.json"
check "... and it alone has a twin" holds "$work/alone.json" '{p for _, p, _ in far} == {"later"}' 'contracts["first"] == "exact"'

dump() { # folder option...
    "$diptych" render --spec "$work/spec/two.yaml" --size 61x23 --backend vk --dump "$work/$1" "${@:2}"
}
check "an exact run" dump exact
check "a pass that says exact is exact in a fast spec" dump kept --set exactness=fast --set passes.later.exactness=exact \
    --set passes.one.colour.exactness=exact --set passes.decide.exactness=exact --set passes.count.exactness=exact
same() { # without the manifest, which has the --set
    diff -r -x manifest.json "$work/exact" "$work/kept"
}
check "... to the bit" same
check "a bounded pass is fast in a fast spec" dump fast --set exactness=fast
check "... so that it errs" [ "$(cmp -l "$work"/{exact,fast}/*second* | wc -l)" -gt 0 ]
check_status 1 "outliers stand beside of_exact alone" "$build/diptych-gen" "$work/spec/two.yaml" --check \
    --set 'contracts.first={abs: 1, outliers: 1}'

# What ships: shading at the edge of a shadow may fall on either side, all else is within a thousandth.
for name in rsm ${DIPTYCH_LONG:+ssvp clustered deep ssdo taa instant_radiosity}; do
    check "$name is bounded" "$diptych" compare --spec "$name" --scene cornell --size 96x54 --set exactness=bounded --json "$work/$name.json"
done
check "... and colours alone" holds "$work/rsm.json" '{"gbuffer", "composite", "tonemap"} < {p for _, p, _ in far}' \
    'not {"gather", "rsm_map", "gbuffer_triangles"} & {p for _, p, _ in far}' \
    'all(r["worst"]["error"] < 1e-3 for r in far.values() if r["worst"])'
finish
