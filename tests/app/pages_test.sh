#!/usr/bin/env bash
# Pages as readers meet them: on a phone, a usual and a large screen, light and dark, by keyboard alone. pages.js looks in Chromium.
# Those of sweeps and reports are read in their tests. TAP.
# shellcheck source=tests/lib/tap.sh
. "$(dirname "$0")/../lib/tap.sh"
cd "$work" || exit 1
scene=$root/scenes/cornell.yaml
small=(--spec "$root/templates/rsm.yaml" --set rsm_size=64 --set samples=4)
"$planted" compare --scene "$scene" "${small[@]}" --size 96x64 --fault vk:rsm_map:sign --html differs >/dev/null
reads_well "a page that tells a difference reads well" differs/index.html
"$diptych" compare --scene "$scene" "${small[@]}" --size 64x48 --html agrees >/dev/null
reads_well "... and one that tells none" agrees/index.html
command -v chromium >/dev/null || finish
# One page with mistakes of each kind.
cp -r differs broken
sed 's/--good: #1a7f37/--good: #9fdf9f/; s/\.scroll { overflow-x: auto;/.scroll {/; s/position: sticky; top: 0; z-index: 2;//; s/j: 1, k: -1/q: 1, k: -1/' \
    differs/index.html >broken/index.html
/usr/bin/python3 -B "$root/tests/app/pages.py" broken/index.html light >said
check "pale letters are seen" grep -F "contrast " said
check "... a page wider than a phone" grep -F "390 light: wider than the window" said
check "... a verdict off the screen" grep -F "the verdict is off the screen" said
check "... keys that lead nowhere" grep -F "j 1 leads elsewhere" said
finish
