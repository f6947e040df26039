/* Bit masks of eyes, one bit per eye, for up to maps_limit eyes. */
uvec2 eye_bit(int eye)
{
    return eye < 32 ? uvec2(1u << eye, 0u) : uvec2(0u, 1u << (eye - 32));
}

bool shares_bit(uvec2 a, uvec2 b)
{
    uint both = a.x & b.x;
    if (many_eyes == 1)
        both |= a.y & b.y;
    return both != 0u;
}
