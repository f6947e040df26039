#!/usr/bin/env bash
# GLSL and SPIR-V that the generator makes of bodies; tests/gen/glsl.py prints the TAP.
exec /usr/bin/python3 -B -W error "$(dirname "${BASH_SOURCE[0]}")/glsl.py"
