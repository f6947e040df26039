/* Each frame shifts the sampling patterns by its own vector (Cranley, Patterson 1976), for the mean
 * over frames. With reuse_pattern all frames use the same patterns, which keeps a sequence coherent
 * without a mean (paper, section on temporal coherence). The vectors are the R2 sequence
 * (Roberts 2018): multiples of the inverse of the plastic number and of its square, as integers of
 * 2^-32, so without rounding errors. The first frame has the zero vector. */
vec2 pattern_shift()
{
    uint turns = reuse_pattern == 1 ? 0u : frame.index;
    uvec2 shift = (turns * uvec2(3242174889u, 2447445414u)) >> 8;
    return vec2(shift) * (1.0 / 16777216.0);
}

/* Shifts a point of the unit square. */
vec2 shift_square(vec2 u)
{
    return fract(u + pattern_shift());
}

/* Turns a point of the unit disk. */
vec2 turn_disk(vec2 p)
{
    float angle = 6.28318530718 * pattern_shift().y;
    float c = cos(angle);
    float s = sin(angle);
    return vec2(p.x * c - p.y * s, p.x * s + p.y * c);
}

/* Shifts a point of the unit disk in its squared radius and its angle. These two map the disk to a
 * rectangle and preserve area, whatever map the point came from. */
vec2 shift_disk(vec2 p)
{
    vec2 shift = pattern_shift();
    if (shift == vec2(0.0))
        return p;
    float square = dot(p, p);
    vec2 way = square > 0.0 ? p * inversesqrt(square) : vec2(1.0, 0.0);
    float radius = sqrt(fract(square + shift.x));
    return radius * turn_disk(way);
}
