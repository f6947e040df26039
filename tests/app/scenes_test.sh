#!/usr/bin/env bash
# Scenes against facts from outside; tests/app/scenes.py prints the TAP.
exec /usr/bin/python3 -B -W error "$(dirname "${BASH_SOURCE[0]}")/scenes.py"
