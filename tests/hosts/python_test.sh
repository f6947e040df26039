#!/usr/bin/env bash
# The Python module: pytest runs tests/hosts/python_test.py. TAP.
. "$(dirname "$0")/../lib/tap.sh"
run_pytest "$root/tests/hosts/python_test.py"
finish
