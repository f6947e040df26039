/* Vectors of three floats for the path tracer: rays.c and tracer.c. */
#pragma once

#include <math.h>

struct vec3 {
    float x, y, z;
};

static inline struct vec3 vec3_of(const float v[3])
{
    return (struct vec3){v[0], v[1], v[2]};
}

static inline struct vec3 add(struct vec3 a, struct vec3 b)
{
    return (struct vec3){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline struct vec3 subtract(struct vec3 a, struct vec3 b)
{
    return (struct vec3){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline struct vec3 scale(struct vec3 v, float factor)
{
    return (struct vec3){v.x * factor, v.y * factor, v.z * factor};
}

static inline struct vec3 multiply(struct vec3 a, struct vec3 b)
{
    return (struct vec3){a.x * b.x, a.y * b.y, a.z * b.z};
}

static inline float dot(struct vec3 a, struct vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline struct vec3 cross(struct vec3 a, struct vec3 b)
{
    return (struct vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline float largest(struct vec3 v)
{
    return fmaxf(v.x, fmaxf(v.y, v.z));
}

/* Unit vector along v, or `otherwise` for a zero vector. */
static inline struct vec3 unit_or(struct vec3 v, struct vec3 otherwise)
{
    float square = dot(v, v);
    return square > 1e-24f ? scale(v, 1 / sqrtf(square)) : otherwise;
}
