#!/usr/bin/env bash
# A test of compare itself: it finds every injected fault and names the fault's pass. TAP.
. "$(dirname "$0")/../lib/tap.sh"
/usr/bin/python3 "$root/tests/app/faults.py" "$planted" "$root" "$work"
