#!/usr/bin/env bash
# Rewrites of a spec and its bodies that must not change a bit of the results; tests/gen/metamorphic.py prints the TAP. Applies
# rewrites, of some kinds half, to one pipeline on one backend, which SEED draws; with DIPTYCH_LONG, to every pipeline that it fits, on both.
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
python=/usr/bin/python3
export PYTHONDONTWRITEBYTECODE=1
if ! $python -c 'import yaml' 2>/dev/null; then
    echo "ok 1 - rewrites change nothing # SKIP python3-yaml is missing"
    echo "1..1"
    exit
fi
exec $python "$root/tests/gen/metamorphic.py" ${DIPTYCH_LONG:+--all} --seed "${SEED:-$RANDOM}" "${DIPTYCH_BUILD:-$root/build}"
