#!/usr/bin/env bash
# Whole shaders, as GLSL and as SPIR-V that others made; tests/gen/foreign.py prints the TAP.
exec /usr/bin/python3 -B -W error "$(dirname "${BASH_SOURCE[0]}")/foreign.py"
