#!/bin/sh
# Makes build/diptych_VERSION_ARCH.deb of what is built: `ninja deb`. Called by that, with the version. Needs dpkg-dev.
set -eu
version=$1
folder=build/deb
architecture=$(dpkg --print-architecture)
rm -rf $folder
mkdir -p $folder/root/DEBIAN $folder/debian
lib=lib/$(dpkg-architecture -qDEB_HOST_MULTIARCH)
DESTDIR=$PWD/$folder/root PREFIX=/usr LIBDIR=$lib sh app/install.sh "$version"
# The file that Debian's policy asks for, in place of the licence alone.
doc=$folder/root/usr/share/doc/diptych
{
    echo 'Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/'
    printf 'Upstream-Name: diptych\n\nFiles: *\n'
    sed -n 's/^Copyright (c) /Copyright: /p' LICENSE
    echo 'License: Expat'
    sed '1,/^Copyright/d' LICENSE | sed '1d; s/^$/./; s/^/ /'
} >$doc/copyright
rm $doc/LICENSE

printf 'Source: diptych\n\nPackage: diptych\nArchitecture: any\n' >$folder/debian/control
needs=$(cd $folder && dpkg-shlibdeps -O -xdiptych "-lroot/usr/$lib" \
    -eroot/usr/bin/diptych -eroot/usr/bin/diptych-gen -eroot/usr/lib/diptych/libdiptych_image.so \
    "-eroot/usr/$lib/libdiptych_gl.so" "-eroot/usr/$lib/libdiptych_vk.so" "-eroot/usr/$lib/libdiptych_scene.so" \
    "-eroot/usr/$lib/libdiptych_play.so" |
    sed -n 's/^shlibs:Depends=//p')
cat >$folder/root/DEBIAN/control <<END
Package: diptych
Version: $version
Architecture: $architecture
Maintainer: diptych contributors <diptych@localhost>
Installed-Size: $(du -ks $folder/root | cut -f1)
Depends: $needs, libvulkan-dev
Recommends: mesa-vulkan-drivers, libgl1-mesa-dri, gcc, python3-numpy, snakemake, python3-matplotlib, bubblewrap
Provides: python3-diptych (= $version)
Section: graphics
Priority: optional
Description: one description of a GPU pipeline, run by OpenGL and by Vulkan
 diptych-gen makes GLSL, SPIR-V and C code for both APIs from one spec. diptych
 runs pipelines with both and names the first pass that differs. The libraries
 take pipelines into other renderers, the Python module gives NumPy arrays.
END
dpkg-deb --root-owner-group --build $folder/root "build/diptych_${version}_$architecture.deb"
