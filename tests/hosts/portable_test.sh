#!/usr/bin/env bash
# Compiles public headers and generated C with compilers and standards of other projects, and the runtimes with MinGW. TAP.
. "$(dirname "$0")/../lib/tap.sh"
cd "$root" || exit
warnings=(-Wall -Wextra -Wpedantic -Wconversion -Werror)
specs=(tests/specs/features templates/post) # each feature once; parameters without a bound, inputs
mingw=x86_64-w64-mingw32

# MinGW gets only Vulkan's headers of this system; the others are not for MinGW.
mkdir "$work/include" "$work/hosts"
ln -s /usr/include/vulkan /usr/include/vk_video "$work/include"
folders=(-Itemplates/c -Iruntime_gl -Iruntime_vk -Iscenes -Iapp/play)
for spec in "${specs[@]}"; do
    "$build/diptych-gen" "$spec.yaml" -o "$work/hosts" >/dev/null || exit
    echo "#include \"${spec##*/}.h\"" >>"$work/hosts/all.h"
done
printf '#include <%s.h>\n' diptych panel diptych_gl diptych_vk diptych_scene diptych_play >>"$work/hosts/all.h"
printf '#ifdef _WIN32\n#include <windows.h>\n#endif\n#include "all.h"\n' >"$work/hosts/all.c"
cp "$work/hosts/all.c" "$work/hosts/all.cpp"

compiles() { # compiler and options...
    "$@" "${folders[@]}" -c -o "$work/object.o"
}
each() { # files compiler and options...
    local file
    for file in $1; do compiles "${@:2}" "$file" || return; done
}
compile_with() { # what compiler standard files
    local options=("-std=$3" "${warnings[@]}")
    [[ $2 != $mingw* ]] || options+=("-I$work/include")
    if command -v "$2" >/dev/null && "$2" "-std=$3" --version >/dev/null 2>&1; then
        check "$2 -std=$3 compiles $1" each "$4" "$2" "${options[@]}"
    else
        skip "$2 -std=$3 compiles $1" "not here"
    fi
}
seed=${SEED:-$RANDOM}
echo "# SEED=$seed"
drawn() { # compiler word word: both words for GCC and in long runs, else one of them
    local words=("$2" "$3")
    [[ $1 = g* || -n ${DIPTYCH_LONG:-} ]] || words=("${words[seed % 2]}")
    echo "${words[@]}"
}
# The oldest and the newest standard: those between forbid nothing that both allow.
for compiler in gcc clang $mingw-gcc; do
    for standard in $(drawn "$compiler" c11 c2x); do
        compile_with "headers and generated C" "$compiler" "$standard" "$(echo "$work"/hosts/*.c)"
    done
done
for compiler in g++ clang++ $mingw-g++; do
    for standard in $(drawn "$compiler" c++11 c++20); do
        compile_with headers "$compiler" "$standard" "$work/hosts/all.cpp"
    done
done
# Defines macros as <windows.h> does, for systems without MinGW.
check "no name is a macro of <windows.h>" each "$(echo "$work"/hosts/*.c)" gcc -std=c11 "${warnings[@]}" \
    -Dnear= -Dfar= -Dsmall=char -Dinterface=struct
if command -v tcc >/dev/null; then
    check "tcc compiles headers and generated C" each "$(echo "$work"/hosts/*.c)" tcc -std=c11 -Wall -Werror
else
    skip "tcc" "not here"
fi

# Links the library's files, as listed in its build.ninja, to a DLL without undefined symbols. GCC checks formats by Windows' old
# printf, which lacks %zu; with -std=c11 it links a printf that has %zu.
links_dll() { # gl|vk
    local file objects=() options
    while read -r file; do
        options=(-Wall -Wextra -Werror -Wno-format -Wno-format-extra-args)
        [[ $file != build/glad/* ]] || options=()
        objects+=("$work/$1.${#objects[@]}.o")
        "$mingw-gcc" -std=c11 -D_GNU_SOURCE "${options[@]}" -I. -Iapp -Itemplates/c -Ibuild/glad/include "-I$work/include" \
            -c "$file" -o "${objects[-1]}" || return
    done < <(sed -nE "s#^build \\\$obj/runtime_$1/[a-z_]+\.o: cc ([^ ]+).*#\1#p" "runtime_$1/build.ninja")
    [ ${#objects[@]} -gt 5 ] && "$mingw-gcc" -shared "${objects[@]}" -o "$work/$1.dll" -lpthread
}
for api in $(drawn $mingw gl vk); do
    if command -v "$mingw-gcc" >/dev/null; then
        check "MinGW builds the $api runtime as a DLL" links_dll "$api"
    else
        skip "MinGW builds the $api runtime" "not here"
    fi
done
finish
