#!/usr/bin/env bash
# What `metrics` and `flicker` compute, in Python: pytest runs metrics.py and flicker.py. TAP.
. "$(dirname "$0")/../lib/tap.sh"
run_pytest "$root/tests/app/metrics.py" "$root/tests/app/flicker.py"
finish
