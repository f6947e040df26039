#!/bin/sh
# Puts what is built under DESTDIR/PREFIX: `PREFIX=/opt/diptych ninja install`. Called by that, with the version. PREFIX is
# /usr/local where it is not given; DESTDIR is for packagers, and no file names it. The tree that is installed can be moved:
# programs find their files from where they are, and so do the files of pkg-config and CMake. With `uninstall` after the
# version, removes what it has put there. LIBDIR (default: lib) is the libraries' folder below PREFIX; lib/TRIPLET in Debian's packages.
set -eu
version=$1
lib=${LIBDIR:-lib}
up=$(printf '%s' "$lib" | sed 's|[^/]*|..|g') # from there to PREFIX
case $version in # of the sonames, see DT_VERSION in diptych.h
0.*) soversion=${version%.*} ;;
*) soversion=${version%%.*} ;;
esac
root=${DESTDIR:-}${PREFIX:-/usr/local}
case $root in
/*) ;;
*)
    echo "install: PREFIX and DESTDIR must be absolute, but together they are $root" >&2
    exit 1
    ;;
esac

list=$root/share/diptych/installed
if [ "${2:-}" = uninstall ]; then
    [ -e "$list" ] || { echo "uninstall: $list is missing: nothing was installed there" >&2 && exit 1; }
    (cd "$root" && xargs -d '\n' rm -f <"$list")
    rm -f "$list"
    find "$root/share/diptych" "$root/include/diptych" "$root/lib/diptych" "$root/$lib/cmake/diptych" \
        "$root/share/doc/diptych" "$root/lib/python3/dist-packages/diptych" -depth -type d -empty -delete
    exit
fi
mkdir -p "$(dirname "$list")"
: >"$list"

# Each file appears whole: under a name of its own first.
put() { # mode file target
    echo "$3" >>"$list"
    [ -d "$root/${3%/*}" ] || install -d -m 755 "$root/${3%/*}"
    install -m "$1" "$2" "$root/$3.new.$$"
    mv -f "$root/$3.new.$$" "$root/$3"
}

# The same of what a command writes.
put_output() { # target command...
    target=$1
    shift
    output=$(mktemp)
    "$@" >"$output" || { rm -f "$output" && exit 1; }
    put 644 "$output" "$target"
    rm -f "$output"
}

package() { # name description cflags libs private-libs
    cat <<END
prefix=\${pcfiledir}/../$up
includedir=\${prefix}/include/diptych
libdir=\${prefix}/$lib
templates=\${prefix}/share/diptych/templates
generator=\${prefix}/bin/diptych-gen

Name: $1
Description: $2
Version: $version
Cflags: -I\${includedir}
Libs: -L\${libdir} $3
Libs.private: $4
END
}

# What a program says of itself, as its manual page (man) or completion (bash).
manual() { # program man|bash
    description=$("build/$1" --describe) || exit 1
    echo "$description" | awk -v "page=$2" -v "version=$version" -f app/manual.awk
}

put 755 build/diptych bin/diptych
put 755 build/diptych-gen bin/diptych-gen
put 644 build/libdiptych_image.so lib/diptych/libdiptych_image.so

for name in gl vk scene; do
    put 644 build/library/libdiptych_$name.a "$lib/libdiptych_$name.a"
    put 644 "build/library/libdiptych_$name.so.$version" "$lib/libdiptych_$name.so.$version"
done
put 644 build/libdiptych_play.so "$lib/libdiptych_play.so.$version"
for name in gl vk scene play; do
    ln -sfn "libdiptych_$name.so.$version" "$root/$lib/libdiptych_$name.so.$soversion"
    ln -sfn "libdiptych_$name.so.$soversion" "$root/$lib/libdiptych_$name.so"
    printf "$lib/libdiptych_%s\n" "$name.so" "$name.so.$soversion" >>"$list"
done
put_output "$lib"/pkgconfig/diptych-gl.pc package diptych-gl "pipelines of diptych in an OpenGL renderer" "-ldiptych_gl" ""
put_output "$lib"/pkgconfig/diptych-vk.pc package diptych-vk "pipelines of diptych in a Vulkan renderer" "-ldiptych_vk" ""
put_output "$lib"/pkgconfig/diptych-play.pc package diptych-play "plays pipelines of diptych" "-ldiptych_play" ""
put_output "$lib"/pkgconfig/diptych-scene.pc package diptych-scene "scene files of diptych" "-ldiptych_scene" \
    "-lpng -lassimp -lmeshoptimizer -lfyaml -lcjson -ldl -lm -Wl,-rpath,\${prefix}/lib/diptych"

put 644 app/diptych-config.cmake "$lib"/cmake/diptych/diptych-config.cmake
put_output "$lib"/cmake/diptych/diptych-config-version.cmake cat <<END
# Versions with the same first two numbers go together.
set(PACKAGE_VERSION $version)
set(wanted "\${PACKAGE_FIND_VERSION_MAJOR}.\${PACKAGE_FIND_VERSION_MINOR}")
if(NOT PACKAGE_FIND_VERSION OR
   (PACKAGE_VERSION VERSION_GREATER_EQUAL PACKAGE_FIND_VERSION AND wanted STREQUAL "${version%.*}"))
  set(PACKAGE_VERSION_COMPATIBLE TRUE)
endif()
END
put 644 LICENSE share/doc/diptych/LICENSE
examples=share/doc/diptych/examples
for file in tests/hosts/examples/*.* tests/hosts/examples/project/*; do
    put 644 "$file" "$examples/hosts/${file#tests/hosts/examples/}"
done
# shellcheck disable=SC2016 # the pattern of a fence
put_output $examples/play.py sed -n '/^```python/,/^```$/ { /^```/d; p }' templates/README.md
put_output share/doc/diptych/reference.md build/diptych-gen --reference

for header in templates/c/diptych.h templates/c/formats.def templates/c/types.def templates/c/panel.h templates/c/diptych_reports.h templates/c/device_limits.h runtime_gl/diptych_gl.h \
    runtime_vk/diptych_vk.h scenes/diptych_scene.h app/play/diptych_play.h templates/c/diptych_tap.h templates/c/diptych_tap_gl.h \
    templates/c/diptych_tap_vk.h; do
    put 644 $header "include/diptych/$(basename $header)"
done

for file in app/python/diptych/* app/python/diptych/rdc/*; do
    [ ! -f "$file" ] || put 644 "$file" "lib/python3/dist-packages/${file#app/python/}"
done

# Scaffolds and headers are in the generator and in include/.
find templates -type f ! -path 'templates/c/*' ! -name '*.ninja' | sort | while read -r file; do
    put 644 "$file" "share/diptych/$file"
done
for file in cornell.yaml cornell.obj cornell.mtl scene.schema.json motion.schema.json; do
    put 644 "scenes/$file" "share/diptych/scenes/$file"
done

for program in diptych diptych-gen; do
    put_output share/man/man1/$program.1 manual $program man
    put_output share/bash-completion/completions/$program manual $program bash
done
