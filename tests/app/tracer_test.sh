#!/usr/bin/env bash
# The path tracer against closed forms; tests/app/tracer.py prints the TAP.
exec /usr/bin/python3 -B -W error "$(dirname "${BASH_SOURCE[0]}")/tracer.py"
