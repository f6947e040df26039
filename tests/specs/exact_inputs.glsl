/* a and b: any sign, magnitudes 2^-8 to 2^8; s: -1 to 1. The first 256 are special values instead, every pair of them once.
 * Bits, not arithmetic: what is tested later does not take part here. */
uint scramble(uint x) /* a bijection (Wellons 2018, "lowbias32") */
{
    x = (x ^ (x >> 16)) * 0x7feb352du;
    x = (x ^ (x >> 15)) * 0x846ca68bu;
    return x ^ (x >> 16);
}

float moderate(uint x)
{
    uint h = scramble(x);
    uint exponent = 119u + scramble(h) % 16u;
    return uintBitsToFloat((h & 0x807fffffu) | exponent << 23);
}

float fraction(uint x) /* a multiple of 2^-23 */
{
    return float(int(scramble(x) >> 8) - 8388608) / 8388608.0;
}

const uint special[16] = uint[16](0x00000000u, 0x80000000u, 0x3f800000u, 0xbf800000u, /* 0, -0, 1, -1 */
                                  0x3f000000u, 0xbf000000u, 0x40000000u, 0x40490fdbu, /* 0.5, -0.5, 2, pi */
                                  0x00800000u, 0x00000001u, 0x7f7fffffu, 0xff7fffffu, /* least normal, least, greatest, its negative */
                                  0x3f800001u, 0x3f7fffffu, 0x7f800000u, 0xff800000u); /* beside 1, infinities */

float pick(int i)
{
    return uintBitsToFloat(special[i & 15]);
}

void main()
{
    int i = invocation().x;
    if (i >= cases)
        return;
    uint k = uint(i) * 12u;
    if (i < 256) {
        int j = i >> 4;
        inputs[i].a = vec4(pick(i), pick(j), pick(i + 5), pick(j + 9));
        inputs[i].b = vec4(pick(j), pick(i + 3), pick(j + 7), pick(i));
        inputs[i].s = clamp(vec4(pick(i), pick(j), pick(i + j), pick(i - j)), -1.0, 1.0);
        return;
    }
    inputs[i].a = vec4(moderate(k), moderate(k + 1u), moderate(k + 2u), moderate(k + 3u));
    inputs[i].b = vec4(moderate(k + 4u), moderate(k + 5u), moderate(k + 6u), moderate(k + 7u));
    inputs[i].s = vec4(fraction(k + 8u), fraction(k + 9u), fraction(k + 10u), fraction(k + 11u));
}
