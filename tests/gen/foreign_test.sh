#!/usr/bin/env bash
# Whole shaders, as GLSL and as SPIR-V that others made; tests/gen/foreign.py prints the TAP.
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
. "$root/tests/lib/drivers.sh"
[ ${#strangers[@]} -gt 0 ] || echo "# $no_strangers"
exec /usr/bin/python3 -B -W error "$root/tests/gen/foreign.py" gl "vk${strangers:+@llvmpipe}" "${strangers[@]}"
