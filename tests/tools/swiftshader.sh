#!/usr/bin/env bash
# Puts SwiftShader, a Vulkan driver that shares no code with Mesa, into build/swiftshader. Takes it from Debian's chromium-common,
# which is downloaded, but not installed. `./bootstrap test` calls this script; without SwiftShader the tests for it are skipped.
set -eu
cd "$(dirname "$0")/../.."
mkdir -p build/swiftshader
cd build/swiftshader
[ ! -e vk_swiftshader_icd.json ] || exit 0
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
chmod 755 "$work" # apt downloads as a user of its own
(cd "$work" && apt-get download -q chromium-common)
dpkg-deb --fsys-tarfile "$work"/chromium-common_*.deb |
    tar -x -C "$work" --wildcards './usr/lib/chromium/*swiftshader*'
mv "$work"/usr/lib/chromium/libvk_swiftshader.so .
mv "$work"/usr/lib/chromium/vk_swiftshader_icd.json . # last: this file marks the folder as complete
