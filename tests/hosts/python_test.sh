#!/usr/bin/env bash
# The Python module: pytest runs tests/hosts/python_test.py, and each of its tests becomes a line of TAP.
. "$(dirname "$0")/../lib/tap.sh"
if ! /usr/bin/python3 -c 'import numpy, pytest' 2>"$work/output"; then
    skip "the Python module" "needs python3-numpy and python3-pytest"
    finish
fi
cd "$work" || exit
DIPTYCH_BUILD=$build /usr/bin/python3 -B -m pytest -p no:cacheprovider -W error -rA --tb=short \
    "$root/tests/hosts/python_test.py" >"$work/output" 2>&1
status=$?
while read -r outcome name _; do
    [ "$outcome" = PASSED ]
    tap_result $? "${name#*::}"
done < <(sed -n '/short test summary info/,$p' "$work/output" | grep -E '^(PASSED|FAILED|ERROR) ')
[ $status = 0 ]
tap_result $? "pytest passed them all"
finish
