/* Sampling sequences; see sequence.h. Sobol points by B. Burley, "Practical Hash-based Owen
 * Scrambling", JCGT 9(4), 2020: the first two Sobol dimensions, padded to any number of pairs by
 * shuffling the order of the points differently for each pair. */
#include "truth/sequence.h"

/* A permutation of 32 bit integers in which every bit of the result depends on every bit of x:
 * C. Wellons' lowbias32, found by search. */
static uint32_t mix_bits(uint32_t x)
{
    x = (x ^ x >> 16) * 0x7feb352du;
    x = (x ^ x >> 15) * 0x846ca68bu;
    return x ^ x >> 16;
}

static uint32_t reverse_bits(uint32_t x)
{
    x = x >> 16 | x << 16;
    x = (x & 0xff00ff00u) >> 8 | (x & 0x00ff00ffu) << 8;
    x = (x & 0xf0f0f0f0u) >> 4 | (x & 0x0f0f0f0fu) << 4;
    x = (x & 0xccccccccu) >> 2 | (x & 0x33333333u) << 2;
    return (x & 0xaaaaaaaau) >> 1 | (x & 0x55555555u) << 1;
}

/* Owen's scrambling in base 2 flips every bit by a hash of the bits above it. This does so for a
 * number whose bits are reversed, where they are the bits below: S. Laine's and T. Karras' hash
 * (2011), each step of which lets bits act on higher ones only, with N. Vegdahl's constants
 * (2021). */
static uint32_t scramble_reversed(uint32_t x, uint32_t seed)
{
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= seed >> 16 | 1;
    x ^= x * 0x05526c56u;
    return x ^ x * 0x53a22864u;
}

/* The second Sobol dimension of the point whose number is given, and whose first dimension is that
 * number with its bits reversed; so is the result. The generator matrix is Pascal's triangle modulo
 * 2, the fifth Kronecker power of ((1, 1), (0, 1)), so five steps multiply by it. */
static uint32_t second_reversed(uint32_t x)
{
    x ^= x >> 1 & 0x55555555u;
    x ^= x >> 2 & 0x33333333u;
    x ^= x >> 4 & 0x0f0f0f0fu;
    x ^= x >> 8 & 0x00ff00ffu;
    return x ^ x >> 16;
}

/* 24 bits are what a float below 1 can hold without rounding up to it. */
static float fraction(uint32_t x)
{
    return (float)(x >> 8) * 0x1p-24f;
}

uint32_t sequence_seed(uint32_t seed, uint32_t pixel)
{
    return mix_bits(mix_bits(seed + 0x9e3779b9u) ^ pixel);
}

void sequence_pair(const struct sequence *sequence, uint32_t pair, float out[2])
{
    uint32_t seed = mix_bits(sequence->seed ^ mix_bits(pair + 1));
    if (sequence->kind == SEQUENCE_RANDOM) {
        uint32_t first = mix_bits(seed + mix_bits(sequence->sample ^ 0x68bc21ebu));
        out[0] = fraction(first);
        out[1] = fraction(mix_bits(first ^ 0x02e5be93u));
        return;
    }
    uint32_t number = reverse_bits(scramble_reversed(reverse_bits(sequence->sample), seed));
    uint32_t second = second_reversed(number);
    out[0] = fraction(reverse_bits(scramble_reversed(number, mix_bits(seed ^ 0x68bc21ebu))));
    out[1] = fraction(reverse_bits(scramble_reversed(second, mix_bits(seed ^ 0x02e5be93u))));
}
