#!/usr/bin/env bash
# Random pipelines: --check knows which build, and all sides have the same bits. tests/gen/random_pipelines.py prints the TAP. SEED=N and
# DIPTYCH_LONG draw others, and more.
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
. "$root/tests/lib/drivers.sh"
export PYTHONDONTWRITEBYTECODE=1
if ! /usr/bin/python3 -c 'import numpy' 2>/dev/null; then
    echo "ok 1 - random pipelines have the same bits # SKIP python3-numpy is missing"
    echo "1..1"
    exit
fi
[ ${#strangers[@]} -gt 0 ] || echo "# $no_strangers"
exec /usr/bin/python3 "$root/tests/gen/random_pipelines.py" --seed "${SEED:-1}" --pipelines $((DIPTYCH_LONG ? 1000 : 50)) \
    ${DIPTYCH_LONG:+--all-sides} "${DIPTYCH_BUILD:-$root/build}" gl gl+glsl "vk${strangers:+@llvmpipe}" "${strangers[@]}"
