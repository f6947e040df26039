#!/usr/bin/env bash
# Input files: pictures and arrays of the spec and of --input reach every backend with every bit; outside.py reads the same files
# for comparison. A file that does not fit is an error at the option or at the line of the spec. Dumps record the content,
# evidence and sweeps use it. TAP.
. "$(dirname "$0")/../lib/tap.sh"
specs=$root/tests/specs
cd "$work" || exit 1
/usr/bin/python3 "$root/tests/app/outside.py" make . || exit 1
cp "$specs"/outside* .
input=(--input photo=photo.png --input weights=weights.npy)

told() { # status words command...
    local want=$1 words=$2 got
    shift 2
    "$@" 2>&1 | tee told
    got=${PIPESTATUS[0]}
    [ "$got" = "$want" ] && grep -qF -- "$words" told
}

check "the backends agree in every bit, without a scene, in the size of the picture" \
    "$diptych" compare --spec outside.yaml "${input[@]}" --backend gl,vk,gl+glsl --json agree.json
check "... which is the frame's" grep -q '"width":	45' agree.json
check "the validation layers are silent" "$diptych" render --spec outside.yaml "${input[@]}" --backend vk --debug --dump dump -o vk.png
check "what the passes got is what is in the files, and what they made of it is right" /usr/bin/python3 "$root/tests/app/outside.py" dump dump .
check "--size is the frame's; other inputs may fill it" "$diptych" render --spec outside.yaml --input photo=small.png \
    --input weights=weights_2.npy --size 8x4 --backend gl -o small_out.png

sed "s/mips: 1/size: [45, 21], mips: 4/" outside.yaml >mips.yaml
check "mips are averages of light" "$diptych" render --spec mips.yaml "${input[@]}" --size 45x21 --backend vk --dump mips
check "... of areas, also with odd sides" /usr/bin/python3 "$root/tests/app/outside.py" mips mips

cat >formats.yaml <<'END'
pipeline: formats
structs:
  Bone: {bone: uint, at: vec3, turn: mat4, links: "ivec2[2]"}
buffers:
  bones: {input: true, of: Bone, count: 2}
  counts: {of: ivec2, count: 1}
images:
  exr: {file: values.exr, format: rgba16f}
  hdr: {file: two.hdr, format: rgba16f}
  jpeg: {file: ramp.jpg, format: rgba8}
passes:
  - {name: measure, dispatch: 1, reads: [exr, hdr, jpeg, bones], writes: [counts], shader: formats.glsl}
END
cat >formats.glsl <<'END'
void main()
{
    float used = min(exr(ivec2(0)).r + hdr(ivec2(0)).r + jpeg(ivec2(0)).r + float(bones[0].bone), 0.0); /* none is negative */
    counts[0] = exr_size() + hdr_size() + jpeg_size() + ivec2(used);
}
END
base64 -d >ramp.jpg <<'END'
/9j/4AAQSkZJRgABAQAAAQABAAD/4QBYRXhpZgAASUkqAAgAAAABAGmHBAABAAAAGgAAAAAAAAAEAACQBwAEAAAAMDIzMAGRBwAEAAAAAQIDAACgBwAEAAAA
MDEwMAGgAwABAAAAAQAAAAAAAAD/2wBDAAEBAQEBAQEBAQEBAQEBAQIBAQEBAQIBAQECAgICAgICAgIDAwQDAwMDAwICAwQDAwQEBAQEAgMFBQQEBQQEBAT/
wAALCAAHAAwBAREA/8QAHwAAAQUBAQEBAQEAAAAAAAAAAAECAwQFBgcICQoL/8QAtRAAAgEDAwIEAwUFBAQAAAF9AQIDAAQRBRIhMUEGE1FhByJxFDKBkaEI
I0KxwRVS0fAkM2JyggkKFhcYGRolJicoKSo0NTY3ODk6Q0RFRkdISUpTVFVWV1hZWmNkZWZnaGlqc3R1dnd4eXqDhIWGh4iJipKTlJWWl5iZmqKjpKWmp6ip
qrKztLW2t7i5usLDxMXGx8jJytLT1NXW19jZ2uHi4+Tl5ufo6erx8vP09fb3+Pn6/9oACAEBAAA/AOg8Ef8ABtD4Q/c/8SXw32/5eLX/AOKr6i0n/g2h8IfY
Yv8AiS+G/wDwItfQf7Vf/9k=
END
check "OpenEXR, HDR and JPEG are read" "$diptych" render --spec formats.yaml --input bones=bones.npy --backend gl --size 4x4 --dump formats
check "... to the nearest half, and structs as std430 has them" /usr/bin/python3 "$root/tests/app/outside.py" formats formats

# ---- What pictures say of their numbers

/usr/bin/python3 "$root/tests/app/outside.py" pictures . || exit 1
cat >as_is.yaml <<'END'
pipeline: as_is
images:
  picture: {input: true, format: rgba32f, mips: 1}
  copied: {format: rgba32f, size: frame}
passes:
  - {name: copy, dispatch: copied, reads: [picture], writes: [copied], shader: as_is.glsl}
END
cat >as_is.glsl <<'END'
void main() { if (all(lessThan(invocation().xy, copied_size()))) copied_store(invocation().xy, picture(invocation().xy)); }
END
sed 's/mips: 1/encoding: srgb/' as_is.yaml >as_codes.yaml
sed 's/mips: 1/encoding: linear/' as_is.yaml >as_light.yaml
says() { # spec file warning: what of it follows "its"; the last is empty where there is none
    rm -rf said
    "$diptych" render --spec "$1.yaml" --input "picture=$2" --backend vk --dump said 2>&1 | tee told
    [ -e said/manifest.json ] && case $3 in
    '') ! grep -q warning told ;;
    *) grep -qF -- "warning: $2: its $3" told && [ "$(grep -c warning told)" = 1 ] ;;
    esac
}
check "a PNG with gAMA" says as_is linear.png ""
check "... keeps its numbers" /usr/bin/python3 "$root/tests/app/outside.py" greys said
check "... which are not the codes that the spec promises" says as_codes linear.png "colour space is linear; its numbers are taken as sRGB codes"
check "codes are not the light that the spec promises" says as_light first.png "colour space is sRGB; its numbers are taken as linear"
check "the first declaration of a PNG counts" says as_codes first.png ""
check "another gamma is told" says as_is gamma_18.png "colour space is one of gamma 1.8; its numbers are kept"
check "... that of sRGB is none" says as_codes gamma_22.png ""
check "other primaries" says as_is wide.png "colour space is one of the primaries (0.68, 0.32)"
check "an ICC profile" says as_is p3.png "colour space is Display P3; its numbers are kept"
check "... in a JPEG" says as_is adobe.jpg "colour space is Adobe RGB (1998); its numbers are kept"
check "... of sRGB" says as_codes srgb.png ""
check "cICP" says as_is pq.png "colour space is one of primaries 9, transfer 16 (cICP)"
check "a JPEG that viewers turn" says as_is turned.jpg "EXIF orientation is 3"
check "... a PNG" says as_is turned.png "EXIF orientation is 6"
check "... upright" says as_is upright.png ""
check "EXIF data that points beyond its end says nothing" says as_is far.jpg ""
check "... and that ends early" says as_is short.jpg ""
# shellcheck disable=SC2016
check "the exposure of an HDR" says as_is exposed.hdr 'colour space is linear, changed by `EXPOSURE= 2.0`'
check "... which may be 1" says as_light once.hdr ""
check "light where the spec promises codes" says as_codes once.hdr "colour space is linear; its numbers are taken as sRGB codes"
check "an OpenEXR of a part of its window" says as_light window.exr ""
check "... is zero in the rest" /usr/bin/python3 "$root/tests/app/outside.py" window said
check "two channels of an OpenEXR" says as_light flow.exr ""
check "... are red and green" /usr/bin/python3 "$root/tests/app/outside.py" flow said
check "a layer, if it is the only one" says as_light layer.exr ""
check "an HDR with a long line" says as_light line.hdr ""
# shellcheck disable=SC2016
for wrong in 'bottom.hdr:its rows and columns are `+Y 1 +X 4`' "runs.hdr:it has run lengths of Radiance's first version" \
    "half.jpg:JPEG error: Premature end of JPEG file" "inks.jpg:its colours are CMYK" "passes.exr:its channels are " \
    "luma.exr:cannot read image luma.exr: " "eyes.exr:its channels are " "deep.exr:it is deep" "parts.exr:it has several parts"; do # OpenEXR 3.3 itself refuses the first
    check "${wrong%%:*} is refused" told 1 "${wrong#*:}" "$diptych" render --spec as_is.yaml --input "picture=${wrong%%:*}" --backend gl --dump large
done

# ---- Files that do not fit

render=("$diptych" render --spec outside.yaml --backend vk -o none.png)
check "an input without a file" told 1 "outside: the input weights has no content; give the input weights=FILE" \
    "${render[@]}" --input photo=photo.png
check "an unknown input" told 1 'input phot=photo.png: outside has no such input; did you mean "photo"?' \
    "${render[@]}" --input phot=photo.png
check "an option that is no input" told 2 "--input photo: must be NAME=FILE, like photo=in.png" "${render[@]}" --input photo
check "an input twice" told 1 "input photo=small.png: photo has a file already" "${render[@]}" "${input[@]}" --input photo=small.png
check "a file of the spec" told 1 "the spec has a file for it; set images.grade.file=FILE instead, where" \
    "${render[@]}" --input grade=photo.png
check "no file" told 1 "input photo=nowhere.png: No such file or directory" \
    "${render[@]}" --input photo=nowhere.png --input weights=weights.npy
check "no picture" told 1 "input photo=weights.npy: it is no PNG, JPEG, OpenEXR or HDR picture" \
    "${render[@]}" --input photo=weights.npy --input weights=weights.npy
check "half a picture" told 1 "input photo=cut.png: " "${render[@]}" --input photo=cut.png --input weights=weights.npy
check "another size" told 1 \
    "input photo=photo.png: it has 45x21 texels, but photo has 8x4 in a frame of 8x4" "${render[@]}" "${input[@]}" --size 8x4
check "too many elements" told 1 "input weights=three.npy: it has 3 elements, but weights has 2" \
    "${render[@]}" --input photo=photo.png --input weights=three.npy
check "another shape" told 1 "input weights=pairs.npy: the shape is (n, 2), not (n, 3)" \
    "${render[@]}" --input photo=photo.png --input weights=pairs.npy
check "another type" told 1 "input weights=whole.npy: the numbers are int32, not float32" \
    "${render[@]}" --input photo=photo.png --input weights=whole.npy
check "a file that ends early" told 1 "input weights=short.npy: it has 20 bytes of numbers; its header says 24" \
    "${render[@]}" --input photo=photo.png --input weights=short.npy
check "NaN" told 1 "input weights=nan.npy: its element 1 has a number that is not finite" \
    "${render[@]}" --input photo=photo.png --input weights=nan.npy
for wrong in "order:field 1 of its dtype is not \`at\`" "shape:the shape of \`at\` is (1, 3), not (3)" \
    "kind:the numbers of \`bone\` are int32, not uint32" "padded:its dtype is not fields of names, types and shapes, without padding"; do
    check "fields of another ${wrong%%:*}" told 1 "input bones=bones_${wrong%%:*}.npy: ${wrong#*:}" \
        "$diptych" render --spec formats.yaml --input "bones=bones_${wrong%%:*}.npy" --backend gl --dump large
done
sed 's/values.exr/nan.exr/' formats.yaml >nan.yaml
check "NaN in a picture of the spec, at its line" told 1 \
    "nan.yaml:8:15: error: cannot use the file \`$work/nan.exr\`: its texel (2, 0), from the top left, is not finite" \
    "$diptych" render --spec nan.yaml --input bones=bones.npy --backend gl --dump large
check "a number that the format cannot hold" told 1 "its texel (1, 0), from the top left, is 65520, beyond the range of rgba16f" \
    "$diptych" render --spec formats.yaml --input bones=bones.npy --backend gl --dump large --set images.exr.file=large.exr
check "nothing half written" test ! -e none.png -a ! -e large
check "a pipeline that draws the scene" told 1 \
    "--scene FILE is missing: the pass gbuffer_triangles of rsm uses the scene" "$diptych" render --spec "$root/templates/rsm.yaml" --backend gl -o none.png

# ---- Content of dumps

check "a dump of the same content" "$diptych" compare --spec outside.yaml "${input[@]}" --against dump --backend gl
check "a dump of another input" told 2 "--against dump: holds another outside: --input photo has other content" \
    "$diptych" compare --spec outside.yaml --input photo=other.png --input weights=weights.npy --against dump --backend gl
mkdir changed
cp outside* changed/
printf '\x00\x00\x00\x3e' | dd of=changed/outside_kernel.npy bs=1 seek=$(($(stat -c %s outside_kernel.npy) - 4)) conv=notrunc status=none
check "a dump of another file of the spec" told 2 "holds another outside: outside_kernel.npy has other content" \
    "$diptych" compare --spec changed/outside.yaml "${input[@]}" --against dump --backend gl

# ---- Evidence

mkdir case_of 'far #1'
cp outside* photo.png weights.npy case_of/
mv case_of/outside_kernel.npy 'far #1/'
sed -i 's/    blurred_store/#ifdef VULKAN\n    sum.g += p == ivec2(3, 4) ? 0.5 : 0.0;\n#endif\n    blurred_store/' case_of/outside_blur.glsl
(
    cd case_of || exit 1
    "$diptych" compare --spec outside.yaml "${input[@]}" --set "buffers.kernel.file='$work/far #1/outside_kernel.npy'" \
        --bisect ../case >../bisect.txt 2>&1
)
rm -rf case_of 'far #1'
check "the guilty pass is found" grep "^guilty: pass blur" bisect.txt
check "a replay needs nothing outside its folder" told 0 "as expected, what gl left" "$diptych" replay case --backend gl
check "... and finds what the other side left" told 1 "all is bit for bit as vk had it" "$diptych" replay case --backend vk
rm -f 'case/spec/far #1/outside_kernel.npy'
check "... but all of that" told 2 "cannot read the file" "$diptych" replay case --backend gl

# ---- Other verbs

check "sweep hands inputs on" "$diptych" sweep --spec outside.yaml "${input[@]}" --grid images.blurred.format=rgba16f,rgba32f -o sweep
cat >masked.yaml <<'END'
pipeline: masked
images:
  mask: {input: true, format: rgba8, size: [8, 4]}
  photo: {input: true, format: rgba8}
  picture: {format: rgba8, size: frame}
passes:
  - {name: cover, dispatch: picture, reads: [mask, photo], writes: [picture], shader: masked.glsl}
END
cat >masked.glsl <<'END'
void main()
{
    ivec2 p = invocation().xy;
    if (all(lessThan(p, picture_size())))
        picture_store(p, mask(p % 4) * photo(p));
}
END
check "... in the size of the picture that fills the frame" "$diptych" sweep --spec masked.yaml --input mask=small.png \
    --input photo=photo.png --grid images.picture.format=rgba8 -o masked
check "bench runs them" "$diptych" bench --spec outside.yaml "${input[@]}" --backend gl --frames 1 --warmup 1
finish
