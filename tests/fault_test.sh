#!/usr/bin/env bash
# The test of the test: compare finds every fault that is put in on purpose, and names its pass. TAP.
. "$(dirname "$0")/tap.sh"
python3 "$root/tests/faults.py" "$diptych" "$root" "$work"
