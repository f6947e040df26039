#!/bin/sh
# Makes build/diptych-VERSION-bundle, a folder for a machine with a GPU and without packages or a network, and the same packed, at
# most 20 MiB: commands, the libraries that they need (not the drivers), specs, two scenes, and `run`. Called by `ninja bundle`, with
# the version. Libraries that drivers use, too, are the machine's own where it has them: a driver may need newer ones.
set -eu
version=$1
bundle=build/diptych-$version-bundle
rm -rf "$bundle" build/bundle/root
DESTDIR=$PWD/build/bundle/root PREFIX=/diptych sh app/install.sh "$version"
mkdir -p "$bundle/bin" "$bundle/lib/diptych" "$bundle/lib/own" "$bundle/lib/fallback" "$bundle/share"
cp -r build/bundle/root/diptych/share/diptych "$bundle/share"
mkdir -p "$bundle/lib/python3"
cp -r build/bundle/root/diptych/lib/python3/dist-packages "$bundle/lib/python3"
rm "$bundle/share/diptych/installed"
sed 's|\.\./build/scenes/||' scenes/atrium.yaml >"$bundle/share/diptych/scenes/atrium.yaml"
cp build/scenes/atrium.obj build/scenes/atrium.mtl "$bundle/share/diptych/scenes"
cp scenes/view.png "$bundle/share/photo.png"
strip -o "$bundle/bin/diptych" build/bundle/diptych
strip -o "$bundle/bin/diptych-gen" build/diptych-gen
strip -o "$bundle/lib/diptych/libdiptych_image.so" build/bundle/libdiptych_image.so
ldd build/bundle/diptych build/diptych-gen build/bundle/libdiptych_image.so | awk '$3 ~ /^\// {print $3}' | sort -u |
    while read -r library; do
        case $library in
        */libc.so.* | */libm.so.* | */libdl.so.* | */libpthread.so.* | */librt.so.*) continue ;; # glibc's
        */libassimp.* | */libmeshoptimizer.* | */libpng16.* | */libdraco.* | */libminizip.* | */libfyaml.* | */libxxhash.* | */libcjson.* | */libstb.* | */libglfw.* | */libspirv-cross*)
            cp -L "$library" "$bundle/lib/own" ;;
        *) cp -L "$library" "$bundle/lib/fallback" ;;
        esac
    done
cp app/bundle/run.sh "$bundle/run"
chmod 755 "$bundle/run"
cp LICENSE "$bundle"
tar -I "xz -T0 -4" -cf "$bundle.tar.xz" -C build "$(basename "$bundle")"
du -m "$bundle.tar.xz" | awk '{print $2 ": " $1 " MiB"; exit $1 > 20}'
