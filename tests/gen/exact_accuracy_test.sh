#!/usr/bin/env bash
# Exact arithmetic against double precision; tests/gen/exact_accuracy.py prints the TAP.
exec /usr/bin/python3 -B -W error "$(dirname "${BASH_SOURCE[0]}")/exact_accuracy.py"
