#!/usr/bin/env bash
# Pages as readers meet them: on a phone, a usual and a large screen, light and dark, by keyboard alone. pages.js looks in Chromium. TAP.
# shellcheck source=tests/lib/tap.sh
. "$(dirname "$0")/../lib/tap.sh"
if ! command -v chromium >/dev/null; then
    skip "pages" "chromium is not installed"
    finish
fi
cd "$work" || exit 1
scene=$root/scenes/cornell.yaml
small=(--spec "$root/templates/rsm.yaml" --set rsm_size=64 --set samples=4)
reads_well() { # page: nothing cut, contrast by WCAG AA, keys, a verdict on the screen
    /usr/bin/python3 -B "$root/tests/app/pages.py" "$1" light && /usr/bin/python3 -B "$root/tests/app/pages.py" "$1" dark
}
is_seen() { # text: what is wrong with the page `broken`
    /usr/bin/python3 -B "$root/tests/app/pages.py" broken/index.html light | grep -F -- "$1"
}
breaks() { # sed script: the page that differs, with a mistake
    sed "$1" differs/index.html >broken/index.html
}

"$planted" compare --scene "$scene" "${small[@]}" --size 96x64 --fault vk:rsm_map:sign --html differs >/dev/null
check "a page that tells a difference reads well" reads_well differs/index.html
"$diptych" compare --scene "$scene" "${small[@]}" --size 64x48 --html agrees >/dev/null
check "... and one that tells none" reads_well agrees/index.html
cp -r differs broken
breaks 's/--good: #1a7f37/--good: #9fdf9f/'
check "pale letters are seen" is_seen "contrast "
breaks 's/\.scroll { overflow-x: auto;/.scroll {/'
check "... a page wider than a phone" is_seen "390: wider than the window"
breaks 's/position: sticky; top: 0; z-index: 2;//'
check "... a verdict off the screen" is_seen "the verdict is off the screen"
breaks 's/j: 1, k: -1/q: 1, k: -1/'
check "... keys that lead nowhere" is_seen "j 1 leads elsewhere"

cp -r "$root/templates" faulty
sed -i 's/irradiance_store(p, vec4(/&\n#ifdef VULKAN\n0.001 +\n#endif\n/' faulty/rsm/gather.glsl
check_status 1 "a sweep" "$diptych" sweep -o swept --scene "$scene" --spec faulty/rsm.yaml --grid samples=4,8 --size 64x48
check "... has a page that reads well" reads_well swept/index.html
check "... and says first how it went" grep -q '<p class="verdict differ">2 of 2 differ</p>' swept/index.html
check "a sweep that measures" "$diptych" sweep -o measured --scene "$scene" --spec "$root/templates/rsm.yaml" --grid samples=4,8 --size 64x48 --measure time,error --spp 4 --frames 2
check "... has a page that reads well" reads_well measured/index.html
check "... with its plots" grep -q '<img src="relative_mse.svg"' measured/index.html
check "a report" "$diptych" report --spec "$root/tests/specs/grey.yaml" --scene "$scene" --size 64x48 --spp 4 --frames 2 --warmup 1 -o reported
check "... reads well" reads_well reported/index.html
check "... with the reference's noise as a band" grep -q 'id="noise"' reported/plots/relative_mse.svg
finish
