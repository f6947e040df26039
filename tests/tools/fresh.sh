#!/usr/bin/env bash
# Tests the README's two commands on a bare Debian: installs Debian into the folder R, clones this checkout's last commit into R,
# and runs `./bootstrap demo`, `test` or `check` there. `deb` also makes the package and installs it in a second bare Debian,
# R-user, with only the packages that users need. There it builds and runs tests/hosts/examples/project.
# Needs root, debootstrap, and a network. R is kept and used again.
# usage: [SUITE=bookworm|trixie] [R=FOLDER] tests/tools/fresh.sh [demo|test|check|deb]
set -euo pipefail
cd "$(dirname "$0")/../.."
suite=${SUITE:-trixie} what=${1:-demo}
root=${R:-${TMPDIR:-/tmp}/bare-$suite}
# shellcheck disable=SC2016 # apt's own words
mirror=$(apt-get indextargets --format '$(SITE)' 'Created-By: Packages' 'Component: main' | head -n 1)
trap 'umount -l "$root"{,-user}/{proc,sys,dev} 2>/dev/null || true' EXIT

bare() { # folder
    local part
    if [ ! -d "$1/etc" ]; then
        debootstrap --variant=minbase "$suite" "$1.new" "$mirror"
        mv "$1.new" "$1"
    fi
    cp /etc/resolv.conf "$1/etc/"
    apt-config dump Acquire | grep -E '^Acquire::(https?::Proxy|Check-)' >"$1/etc/apt/apt.conf.d/99host" || true
    for part in proc sys dev; do
        mountpoint -q "$1/$part" || mount --bind "/$part" "$1/$part"
    done
}
inside() { # folder commands
    time chroot "$1" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive sh -ec "$2"
}

bare "$root"
rm -rf "$root/src"
git clone -q . "$root/src"
if [ "$what" != deb ]; then
    inside "$root" "cd /src && ./bootstrap $what"
    exit
fi
inside "$root" "cd /src && ./bootstrap demo && apt-get install -y -q --no-install-recommends dpkg-dev && ninja deb"

# R-user is new each time. apt-get installs the package's Recommends and a user's tools by name.
umount -l "$root"-user/{proc,sys,dev} 2>/dev/null || true
rm -rf --one-file-system "$root-user"
bare "$root-user"
cp -r tests/hosts/examples/project "$root"/src/build/diptych_*.deb "$root-user"
inside "$root-user" "
    apt-get update -q
    apt-get install -y -q --no-install-recommends ./diptych_*.deb mesa-vulkan-drivers libgl1-mesa-dri python3-numpy \
        gcc libc6-dev cmake meson ninja-build pkg-config
    cmake -S project -B cmake -G Ninja
    cmake --build cmake
    cmake/wave
    meson setup meson project
    ninja -C meson
    meson/wave
    cd /usr/share/diptych
    diptych compare --scene scenes/cornell.yaml --size 64x48 >/compare.txt
    tail -n 1 /compare.txt
    python3 -c 'import diptych
pipeline = diptych.open(\"templates/rsm.yaml\", scene=\"scenes/cornell.yaml\", size=(64, 48))
print(pipeline.render(\"display\")[\"display\"].shape)'"
