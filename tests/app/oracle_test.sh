#!/usr/bin/env bash
# Stages of ssvp against their definitions; tests/app/oracle.py prints the TAP.
exec /usr/bin/python3 -B -W error "$(dirname "${BASH_SOURCE[0]}")/oracle.py"
