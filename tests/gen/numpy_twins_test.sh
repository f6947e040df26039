#!/usr/bin/env bash
# NumPy programs of 32-bit floats give the bits of exact passes; tests/gen/numpy_twins.py prints the TAP.
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
python=/usr/bin/python3
if ! $python -c 'import numpy' 2>/dev/null; then
    echo "ok 1 - NumPy gives the bits of exact passes # SKIP python3-numpy is missing"
    echo "1..1"
    exit
fi
exec $python -B -W error "$root/tests/gen/numpy_twins.py"
