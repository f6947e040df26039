#!/usr/bin/env bash
# The commands of every README: they run, and print what the README shows. Those that take long or change the system are
# checked for their options alone. TAP.
. "$(dirname "$0")/../lib/tap.sh"
export DIPTYCH_QUIET=1
/usr/bin/python3 "$root/tests/tools/readme.py" "$root" "$build" "$work"
