#!/usr/bin/env bash
# Every version of Mesa, with vectors of any width, gives the bits whose hashes are in tests/gen/golden/rsm and tests/gen/golden/ssvp.
# UPDATE=1 writes the hashes of the installed version. TAP.
. "$(dirname "$0")/../lib/tap.sh"
cd "$root" || exit 1

update() { # arguments of compare...: keeps the hashes, but not the pictures
    local folder=${*: -1}
    rm -rf "$folder" && "$diptych" compare "$@" --size 37x23 --update && rm "$folder"/*.png &&
        sed -i '/"picture":/d; s/\("hash":.*"\),$/\1/' "$folder/manifest.json"
}
for name in rsm ssvp; do
    kept=(--spec "templates/$name.yaml" --scene scenes/cornell.yaml --golden "tests/gen/golden/$name")
    [ -z "${UPDATE:-}" ] || check "$name is kept" update "${kept[@]}"
    check "$name has the bits of other versions of Mesa" "$diptych" compare "${kept[@]}"
    # A cached shader may have another width, so the cache is off. Widths other than these two crash Mesa 22.3.
    for width in 128 ${DIPTYCH_LONG:+256}; do
        [ $name = rsm ] || [ -n "${DIPTYCH_LONG:-}" ] || continue
        check "... with vectors of $width bits" env MESA_SHADER_CACHE_DISABLE=true "LP_NATIVE_VECTOR_WIDTH=$width" \
            "$diptych" compare "${kept[@]}"
    done
done
finish
