#!/usr/bin/env bash
# GLSL as people write it, tests/gen/corpus: the results that its rules give, and the same bits on every side; tests/gen/corpus.py prints the
# TAP.
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
. "$root/tests/lib/drivers.sh"
export PYTHONDONTWRITEBYTECODE=1
[ ${#strangers[@]} -gt 0 ] || echo "# $no_strangers"
exec /usr/bin/python3 "$root/tests/gen/corpus.py" "${DIPTYCH_BUILD:-$root/build}" gl gl+glsl "vk${strangers:+@llvmpipe}" "${strangers[@]}"
