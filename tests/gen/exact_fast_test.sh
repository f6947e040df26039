#!/usr/bin/env bash
# Exact passes leave what fast passes leave from the same inputs, but for rounding; tests/gen/exact_fast.py prints the TAP. SEED
# draws the pipelines; with DIPTYCH_LONG all, on both scenes and both backends.
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
python=/usr/bin/python3
if ! $python -c 'import numpy' 2>/dev/null; then
    echo "ok 1 - exact is near fast # SKIP python3-numpy is missing"
    echo "1..1"
    exit
fi
. "$root/tests/lib/drivers.sh"
export STRANGERS="${strangers[*]}"
exec $python -B -W error "$root/tests/gen/exact_fast.py" ${DIPTYCH_LONG:+--long} "${DIPTYCH_BUILD:-$root/build}"
