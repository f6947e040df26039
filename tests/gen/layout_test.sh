#!/usr/bin/env bash
# Layouts of structs on the GPU, in C and in Python; tests/gen/layout.py prints the TAP.
exec /usr/bin/python3 -B -W error "$(dirname "${BASH_SOURCE[0]}")/layout.py"
