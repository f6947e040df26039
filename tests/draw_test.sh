#!/usr/bin/env bash
# What draws can do, tests/specs/particles.yaml: the backends agree, and every texel of blended targets is what the formula of
# its mode gives. TAP.
. "$(dirname "$0")/tap.sh"
spec=$root/tests/specs/particles.yaml

for size in 40x24 17x9 1x1; do
    check "draws agree at $size, validation silent" "$diptych" compare --spec "$spec" --size $size --debug --backend gl,vk,gl+glsl
done

# shellcheck disable=SC2317 # called through check
blended() { # backend
    "$diptych" render --spec "$spec" --size 40x24 --backend "$1" --dump "$work/$1" -o "$work/$1.png" && python3 - "$work/$1" <<'PYTHON'
import glob, struct, sys
def image(name, code="f"):
    data = open(glob.glob(f"{sys.argv[1]}/*.blend.{name}.raw")[0], "rb").read()
    values = struct.unpack(f"<{len(data) // 4}{code}", data)
    return [values[i : i + 4] for i in range(0, len(values), 4)]
def same(name, formula, code="f"):
    for i, texel in enumerate(image(name, code)):
        x, y = i % 40, i // 40
        dst = [(n & 15) / 16 for n in (x, y, x + y, 3 * x + y)]
        src = [(n & 15) / 16 for n in (5 * x, 3 * y, x ^ y, 7 * x + y)]
        want = tuple(formula(s, d, src[3], dst[3], c) for c, (s, d) in enumerate(zip(src, dst)))
        assert texel == want, (name, x, y, texel, want)
same("over", lambda s, d, sa, da, c: s * (1 if c == 3 else sa) + d * (1 - sa))
same("premultiplied", lambda s, d, sa, da, c: s + d * (1 - sa))
same("added", lambda s, d, sa, da, c: d if c == 2 else s + d)
same("least", lambda s, d, sa, da, c: min(s, d))
same("most", lambda s, d, sa, da, c: s if c % 2 else max(s, d)) # the clear value of g and a is -1
same("multiplied", lambda s, d, sa, da, c: s * d)
same("mixed", lambda s, d, sa, da, c: da * sa if c == 3 else d * (1 - s) - s * da)
for i, texel in enumerate(image("tally", "I")):
    assert texel == (i % 40, i // 40, 100, 100), (i, texel)
PYTHON
}
for backend in gl vk; do
    check "modes, factors and masks give what their formulas say, $backend" blended $backend
done
finish
