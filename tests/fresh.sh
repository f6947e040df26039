#!/usr/bin/env bash
# The README's two commands on a bare Debian: installs one into a folder, clones this checkout's last commit into that, and runs
# `./bootstrap demo` or `./bootstrap test` there. `deb`: also makes the package, installs it with apt, and builds and runs
# tests/hosts/project with it, the checkout out of sight. Needs root, debootstrap, and a network.
# usage: [SUITE=bookworm|trixie] [R=FOLDER] tests/fresh.sh [demo|test|deb]    R is kept, and used again
set -euo pipefail
cd "$(dirname "$0")/.."
suite=${SUITE:-trixie} what=${1:-demo}
root=${R:-${TMPDIR:-/tmp}/bare-$suite}
# shellcheck disable=SC2016 # apt's own words
mirror=$(apt-get indextargets --format '$(SITE)' 'Created-By: Packages' 'Component: main' | head -n 1)
if [ ! -d "$root/etc" ]; then
    debootstrap --variant=minbase "$suite" "$root.new" "$mirror"
    mv "$root.new" "$root"
fi
cp /etc/resolv.conf "$root/etc/"
apt-config dump Acquire | grep -E '^Acquire::(https?::Proxy|Check-)' >"$root/etc/apt/apt.conf.d/99host" || true
trap 'umount -l "$root"/{proc,sys,dev} 2>/dev/null || true' EXIT
for part in proc sys dev; do
    mountpoint -q "$root/$part" || mount --bind "/$part" "$root/$part"
done
rm -rf "$root/src"
git clone -q . "$root/src"
command="./bootstrap $what"
if [ "$what" = deb ]; then
    command="./bootstrap demo && apt-get install -y -q --no-install-recommends dpkg-dev cmake && ninja deb &&
        rm -rf /project && cp -r tests/hosts/project /project && cp build/diptych_*.deb / && rm -rf /src && cd / &&
        apt-get install -y -q ./diptych_*.deb && rm diptych_*.deb && cmake -S project -B project/build -G Ninja &&
        cmake --build project/build && project/build/wave &&
        diptych compare --scene /usr/share/diptych/scenes/cornell.yaml --size 64x48 | tail -n 1"
fi
time chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 sh -ec "cd /src && $command"
