#!/usr/bin/env bash
# Random GLSL programs: the bits of IEEE 754 on every side, in whatever form the same program is written. tests/gen/random_glsl.py prints
# the TAP. SEED=N and DIPTYCH_LONG draw others, and more. The first 100 programs of seed 1 have each operator, function and statement.
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
. "$root/tests/lib/drivers.sh"
export PYTHONDONTWRITEBYTECODE=1
[ ${#strangers[@]} -gt 0 ] || echo "# $no_strangers"
exec /usr/bin/python3 "$root/tests/gen/random_glsl.py" --seed "${SEED:-1}" --programs $((DIPTYCH_LONG ? 2000 : 100)) \
    "${DIPTYCH_BUILD:-$root/build}" gl gl+glsl "vk${strangers:+@llvmpipe}" "${strangers[@]}"
