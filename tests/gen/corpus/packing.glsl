// Packed and unpacked numbers.
// expect: 255 65280 0.5 1 1.5 -2
void main()
{
    result[0] = float(packUnorm4x8(vec4(one, 0.0, 0.0, 0.0)));
    result[1] = float(packUnorm4x8(vec4(0.0, two, 0.0, 0.0)));
    vec2 h = unpackHalf2x16(0x3C003800u * uint(one));
    result[2] = h.x;
    result[3] = h.y;
    h = unpackHalf2x16(packHalf2x16(vec2(one + half_, -two)));
    result[4] = h.x;
    result[5] = h.y;
}
