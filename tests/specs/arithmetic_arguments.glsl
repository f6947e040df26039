/* x and y: normal numbers of any exponent; angle: up to 65536; unit: -1 to 1; above_one: at least 1; exponent: -88 to 88. */
uint scramble(uint x) /* a bijection (Wellons 2018, "lowbias32") */
{
    x = (x ^ (x >> 16)) * 0x7feb352du;
    x = (x ^ (x >> 15)) * 0x846ca68bu;
    return x ^ (x >> 16);
}

float between(uint x, uint least, uint most) /* exponents */
{
    uint h = scramble(x);
    return uintBitsToFloat((h & 0x807fffffu) | (127u + least + scramble(h) % (most - least)) << 23);
}

const uint special[16] = uint[16](0x00000000u, 0x80000000u, 0x3f800000u, 0xbf800000u, /* 0, -0, 1, -1 */
                                  0x3f000000u, 0xbf000000u, 0x40000000u, 0x40490fdbu, /* 0.5, -0.5, 2, pi */
                                  0x00800000u, 0x80800000u, 0x7f7fffffu, 0xff7fffffu, /* least normal, greatest */
                                  0x3f800001u, 0x3f7fffffu, 0x7f800000u, 0xff800000u); /* beside 1, infinities */

void main()
{
    int i = invocation().x;
    if (i >= cases)
        return;
    uint k = uint(i) * 8u;
    Arguments a;
    a.x = between(k, uint(-126), 128u);
    a.y = between(k + 1u, uint(-126), 128u);
    a.angle = between(k + 2u, uint(-24), 16u);
    a.unit = between(k + 3u, uint(-24), 0u);
    a.above_one = uintBitsToFloat(floatBitsToUint(between(k + 4u, 0u, 24u)) & 0x7fffffffu);
    a.exponent = between(k + 5u, uint(-12), 6u) * 1.375;
    if (finite) {
        a.x = abs(between(k, uint(-60), 60u));
        a.y = between(k + 1u, uint(-60), 60u);
    } else if (i < 256) {
        a.x = uintBitsToFloat(special[i & 15]);
        a.y = uintBitsToFloat(special[i >> 4]);
    }
    arguments[i] = a;
}
