#!/bin/sh
# Compares every pipeline that diptych ships on every device of this machine, measures them, and leaves one folder: ./run [FOLDER [WIDTHxHEIGHT]].
# Needs glibc 2.36 or newer, the drivers, and Python; no network. In the folder, index.html has devices, verdicts and frame times, summary.txt the same as text.
here=$(cd "$(dirname "$0")" && pwd)
out=${1:-$here/results-$(uname -n)}
size=${2:-640x360}
mkdir -p "$out" || exit 2
libraries=$(mktemp -d) || exit 2
trap 'rm -rf "$libraries"' EXIT
ln -s "$here"/lib/own/* "$libraries"
for library in "$here"/lib/fallback/*; do # what drivers use, too: the machine's own where it has them
    found=$( (ldconfig -p || /sbin/ldconfig -p) 2>/dev/null | grep -F "$(basename "$library") ")
    [ -n "$found" ] || ln -s "$library" "$libraries"
done
export LD_LIBRARY_PATH="$libraries${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
diptych=$here/bin/diptych
specs=$here/share/diptych/templates
scenes=$here/share/diptych/scenes
"$diptych" --version >"$out/version.txt" || exit 2
uname -srm >"$out/machine.txt"
grep -m 1 'model name' /proc/cpuinfo >>"$out/machine.txt"
date -u '+%F %T UTC' >>"$out/machine.txt"
: >"$out/refused.txt"

# Every Vulkan device, and OpenGL, that can run a pipeline at all.
sides=
for side in vk@0 vk@1 vk@2 vk@3 vk@4 vk@5 vk@6 vk@7 gl; do
    if "$diptych" render --spec "$specs/post.yaml" --input "photo=$here/share/photo.png" --backend "$side" -o "$out/probe.png" \
        >"$out/probe.txt" 2>&1; then
        sides="$sides,$side"
    elif ! grep -q 'no Vulkan device is called' "$out/probe.txt"; then
        sed "s/^/$side: /" "$out/probe.txt" | tee -a "$out/refused.txt"
    fi
done
rm -f "$out/probe.png" "$out/probe.txt"
sides=${sides#,}
[ -n "$sides" ] || { echo "run: neither Vulkan nor OpenGL runs here; the reasons are in $out" >&2 && exit 2; }
say() {
    echo "$*" | tee -a "$out/summary.txt"
}
: >"$out/summary.txt"
say "devices: $sides"

status=0
for spec in "$specs"/*.yaml; do
    name=$(basename "$spec" .yaml)
    for scene in cornell atrium; do
        [ "$name" != machine ] && [ "$name" != post ] || [ $scene = cornell ] || continue
        case $name in
        machine) set -- --size "$size" ;;
        post) set -- --input "photo=$here/share/photo.png" ;; # which has the frame's size
        *) set -- --size "$size" --scene "$scenes/$scene.yaml" ;;
        esac
        set -- "$@" --spec "$spec"
        case $sides in
        *,*)
            "$diptych" compare "$@" --backend "$sides" --json "$out/$name-$scene.json" \
                >"$out/$name-$scene.txt" 2>"$out/$name-$scene.log" || status=1
            say "$name, $scene: $(tail -n 1 "$out/$name-$scene.txt")"
            ;;
        esac
        "$diptych" bench "$@" --frames 10 --backend "$sides" --json "$out/$name-$scene.bench.json" \
            >"$out/$name-$scene.bench.txt" 2>>"$out/$name-$scene.log"
        for device in $(echo "$sides" | tr , '\n' | sed -n 's/^vk@//p'); do # drivers of CPUs tell nothing
            "$diptych" cost "$@" --device "$device" --bench "$out/$name-$scene.bench.json" --json "$out/$name-$scene.cost-$device.json" \
                >"$out/$name-$scene.cost-$device.txt" 2>>"$out/$name-$scene.log" || rm -f "$out/$name-$scene.cost-$device."*
        done
        say "$name, $scene: ms a frame, median, p5, p95 of $sides: $(sed -n 's/^frame  *//p' "$out/$name-$scene.bench.txt")"
    done
done
"$diptych" report --collect "$out" || status=2
exit $status
