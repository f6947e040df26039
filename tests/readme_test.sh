#!/usr/bin/env bash
# README's walk from a failing table to the guilty line of GLSL, command by command. TAP.
. "$(dirname "$0")/tap.sh"
python3 "$root/tests/readme.py" "$root" "$build" "$work"
