#!/usr/bin/env bash
# glTF files against the specification; tests/app/gltf.py prints the TAP.
exec /usr/bin/python3 -B -W error "$(dirname "${BASH_SOURCE[0]}")/gltf.py"
