#!/usr/bin/env bash
# The README's two commands on a bare Debian: installs one into a folder, clones this checkout's last commit into that, and runs
# `./bootstrap demo` or `./bootstrap test` there. Needs root, debootstrap, and a network.
# usage: [SUITE=bookworm|trixie] [R=FOLDER] tests/fresh.sh [demo|test]    R is kept, and used again
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
time chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 sh -c "cd /src && ./bootstrap $what"
