/* Built-in functions whose result depends on the driver, in a fixed order of scalar operations: the
 * same bits everywhere. Exact pipelines replace a call of NAME in a body by exact_NAME. Functions
 * not listed here (sqrt, sin, exp, cross, smoothstep, ...) need no replacement. */

float exact_dot(float a, float b)
{
    precise float sum = a * b;
    return sum;
}

float exact_dot(vec2 a, vec2 b)
{
    precise float sum = a.x * b.x + a.y * b.y;
    return sum;
}

float exact_dot(vec3 a, vec3 b)
{
    precise float sum = a.x * b.x + a.y * b.y + a.z * b.z;
    return sum;
}

float exact_dot(vec4 a, vec4 b)
{
    precise float sum = a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
    return sum;
}

float exact_length(float v)
{
    return abs(v);
}

float exact_length(vec2 v)
{
    return sqrt(exact_dot(v, v));
}

float exact_length(vec3 v)
{
    return sqrt(exact_dot(v, v));
}

float exact_length(vec4 v)
{
    return sqrt(exact_dot(v, v));
}

float exact_distance(float a, float b)
{
    return exact_length(a - b);
}

float exact_distance(vec2 a, vec2 b)
{
    return exact_length(a - b);
}

float exact_distance(vec3 a, vec3 b)
{
    return exact_length(a - b);
}

float exact_distance(vec4 a, vec4 b)
{
    return exact_length(a - b);
}

float exact_normalize(float v)
{
    return sign(v);
}

vec2 exact_normalize(vec2 v)
{
    precise float scale = inversesqrt(exact_dot(v, v));
    precise vec2 unit = v * scale;
    return unit;
}

vec3 exact_normalize(vec3 v)
{
    precise float scale = inversesqrt(exact_dot(v, v));
    precise vec3 unit = v * scale;
    return unit;
}

vec4 exact_normalize(vec4 v)
{
    precise float scale = inversesqrt(exact_dot(v, v));
    precise vec4 unit = v * scale;
    return unit;
}

float exact_mix(float x, float y, float a)
{
    precise float blend = x * (1.0 - a) + y * a;
    return blend;
}

vec2 exact_mix(vec2 x, vec2 y, float a)
{
    precise vec2 blend = x * (1.0 - a) + y * a;
    return blend;
}

vec2 exact_mix(vec2 x, vec2 y, vec2 a)
{
    precise vec2 blend = x * (1.0 - a) + y * a;
    return blend;
}

vec3 exact_mix(vec3 x, vec3 y, float a)
{
    precise vec3 blend = x * (1.0 - a) + y * a;
    return blend;
}

vec3 exact_mix(vec3 x, vec3 y, vec3 a)
{
    precise vec3 blend = x * (1.0 - a) + y * a;
    return blend;
}

vec4 exact_mix(vec4 x, vec4 y, float a)
{
    precise vec4 blend = x * (1.0 - a) + y * a;
    return blend;
}

vec4 exact_mix(vec4 x, vec4 y, vec4 a)
{
    precise vec4 blend = x * (1.0 - a) + y * a;
    return blend;
}

float exact_mix(float x, float y, bool a)
{
    return a ? y : x;
}

int exact_mix(int x, int y, bool a)
{
    return a ? y : x;
}

uint exact_mix(uint x, uint y, bool a)
{
    return a ? y : x;
}

bool exact_mix(bool x, bool y, bool a)
{
    return a ? y : x;
}

vec2 exact_mix(vec2 x, vec2 y, bvec2 a)
{
    return vec2(a.x ? y.x : x.x, a.y ? y.y : x.y);
}

ivec2 exact_mix(ivec2 x, ivec2 y, bvec2 a)
{
    return ivec2(a.x ? y.x : x.x, a.y ? y.y : x.y);
}

uvec2 exact_mix(uvec2 x, uvec2 y, bvec2 a)
{
    return uvec2(a.x ? y.x : x.x, a.y ? y.y : x.y);
}

bvec2 exact_mix(bvec2 x, bvec2 y, bvec2 a)
{
    return bvec2(a.x ? y.x : x.x, a.y ? y.y : x.y);
}

vec3 exact_mix(vec3 x, vec3 y, bvec3 a)
{
    return vec3(a.x ? y.x : x.x, a.y ? y.y : x.y, a.z ? y.z : x.z);
}

ivec3 exact_mix(ivec3 x, ivec3 y, bvec3 a)
{
    return ivec3(a.x ? y.x : x.x, a.y ? y.y : x.y, a.z ? y.z : x.z);
}

uvec3 exact_mix(uvec3 x, uvec3 y, bvec3 a)
{
    return uvec3(a.x ? y.x : x.x, a.y ? y.y : x.y, a.z ? y.z : x.z);
}

bvec3 exact_mix(bvec3 x, bvec3 y, bvec3 a)
{
    return bvec3(a.x ? y.x : x.x, a.y ? y.y : x.y, a.z ? y.z : x.z);
}

vec4 exact_mix(vec4 x, vec4 y, bvec4 a)
{
    return vec4(a.x ? y.x : x.x, a.y ? y.y : x.y, a.z ? y.z : x.z, a.w ? y.w : x.w);
}

ivec4 exact_mix(ivec4 x, ivec4 y, bvec4 a)
{
    return ivec4(a.x ? y.x : x.x, a.y ? y.y : x.y, a.z ? y.z : x.z, a.w ? y.w : x.w);
}

uvec4 exact_mix(uvec4 x, uvec4 y, bvec4 a)
{
    return uvec4(a.x ? y.x : x.x, a.y ? y.y : x.y, a.z ? y.z : x.z, a.w ? y.w : x.w);
}

bvec4 exact_mix(bvec4 x, bvec4 y, bvec4 a)
{
    return bvec4(a.x ? y.x : x.x, a.y ? y.y : x.y, a.z ? y.z : x.z, a.w ? y.w : x.w);
}

float exact_reflect(float i, float n)
{
    precise float twice = 2.0 * exact_dot(n, i);
    precise float mirrored = i - n * twice;
    return mirrored;
}

vec2 exact_reflect(vec2 i, vec2 n)
{
    precise float twice = 2.0 * exact_dot(n, i);
    precise vec2 mirrored = i - n * twice;
    return mirrored;
}

vec3 exact_reflect(vec3 i, vec3 n)
{
    precise float twice = 2.0 * exact_dot(n, i);
    precise vec3 mirrored = i - n * twice;
    return mirrored;
}

vec4 exact_reflect(vec4 i, vec4 n)
{
    precise float twice = 2.0 * exact_dot(n, i);
    precise vec4 mirrored = i - n * twice;
    return mirrored;
}

float exact_refract(float i, float n, float eta)
{
    precise float cosine = exact_dot(n, i);
    precise float k = 1.0 - eta * eta * (1.0 - cosine * cosine);
    precise float bent = i * eta - n * (eta * cosine + sqrt(max(k, 0.0)));
    return k < 0.0 ? float(0.0) : bent;
}

vec2 exact_refract(vec2 i, vec2 n, float eta)
{
    precise float cosine = exact_dot(n, i);
    precise float k = 1.0 - eta * eta * (1.0 - cosine * cosine);
    precise vec2 bent = i * eta - n * (eta * cosine + sqrt(max(k, 0.0)));
    return k < 0.0 ? vec2(0.0) : bent;
}

vec3 exact_refract(vec3 i, vec3 n, float eta)
{
    precise float cosine = exact_dot(n, i);
    precise float k = 1.0 - eta * eta * (1.0 - cosine * cosine);
    precise vec3 bent = i * eta - n * (eta * cosine + sqrt(max(k, 0.0)));
    return k < 0.0 ? vec3(0.0) : bent;
}

vec4 exact_refract(vec4 i, vec4 n, float eta)
{
    precise float cosine = exact_dot(n, i);
    precise float k = 1.0 - eta * eta * (1.0 - cosine * cosine);
    precise vec4 bent = i * eta - n * (eta * cosine + sqrt(max(k, 0.0)));
    return k < 0.0 ? vec4(0.0) : bent;
}

float exact_faceforward(float n, float i, float reference)
{
    return exact_dot(reference, i) < 0.0 ? n : -n;
}

vec2 exact_faceforward(vec2 n, vec2 i, vec2 reference)
{
    return exact_dot(reference, i) < 0.0 ? n : -n;
}

vec3 exact_faceforward(vec3 n, vec3 i, vec3 reference)
{
    return exact_dot(reference, i) < 0.0 ? n : -n;
}

vec4 exact_faceforward(vec4 n, vec4 i, vec4 reference)
{
    return exact_dot(reference, i) < 0.0 ? n : -n;
}

/* Arc tangent of 0..1, after Cephes' atanf: one reduction around 1, then an odd polynomial.
 * Against double precision atan is within 3 units in the last place. */
float exact_atan_unit(float x)
{
    bool upper = x > 0.414213562373;
    precise float t = upper ? (x - 1.0) / (x + 1.0) : x;
    precise float z = t * t;
    precise float p = ((8.05374449538e-2 * z - 1.38776856032e-1) * z + 1.99777106478e-1) * z - 3.33329491539e-1;
    precise float r = p * z * t + t;
    precise float angle = upper ? r + 0.785398163397 : r;
    return angle;
}

float exact_atan(float x)
{
    float a = abs(x);
    precise float r = exact_atan_unit(a > 1.0 ? 1.0 / a : a);
    precise float angle = a > 1.0 ? 1.57079632679 - r : r;
    return x < 0.0 ? -angle : angle;
}

float exact_atan(float y, float x)
{
    float high = max(abs(x), abs(y));
    float low = min(abs(x), abs(y));
    precise float r = high > 0.0 ? exact_atan_unit(low / high) : 0.0;
    precise float upper = abs(y) > abs(x) ? 1.57079632679 - r : r;
    precise float angle = x < 0.0 ? 3.14159265359 - upper : upper;
    return y < 0.0 ? -angle : angle;
}

/* Arc sine of 0..0.5, after Cephes' asinf. z is the square of x. Against double precision asin
 * and acos are within 3 units in the last place. */
float exact_asin_half(float x, float z)
{
    precise float p = (((4.2163199048e-2 * z + 2.4181311049e-2) * z + 4.5470025998e-2) * z + 7.4953002686e-2) * z
        + 1.6666752422e-1;
    precise float r = p * z * x + x;
    return r;
}

float exact_asin(float x)
{
    float a = abs(x);
    bool upper = a > 0.5;
    precise float z = upper ? 0.5 * (1.0 - a) : a * a;
    precise float r = exact_asin_half(upper ? sqrt(z) : a, z);
    precise float angle = upper ? 1.57079632679 - 2.0 * r : r;
    return x < 0.0 ? -angle : angle;
}

float exact_acos(float x)
{
    float a = abs(x);
    bool upper = a > 0.5;
    precise float z = upper ? 0.5 * (1.0 - a) : a * a;
    precise float r = exact_asin_half(upper ? sqrt(z) : a, z);
    precise float from_pole = 2.0 * r;
    precise float outer = x < 0.0 ? 3.14159265359 - from_pole : from_pole;
    precise float inner = x < 0.0 ? 1.57079632679 + r : 1.57079632679 - r;
    return upper ? outer : inner;
}

vec2 exact_atan(vec2 v)
{
    return vec2(exact_atan(v.x), exact_atan(v.y));
}

vec3 exact_atan(vec3 v)
{
    return vec3(exact_atan(v.x), exact_atan(v.y), exact_atan(v.z));
}

vec4 exact_atan(vec4 v)
{
    return vec4(exact_atan(v.x), exact_atan(v.y), exact_atan(v.z), exact_atan(v.w));
}

vec2 exact_asin(vec2 v)
{
    return vec2(exact_asin(v.x), exact_asin(v.y));
}

vec3 exact_asin(vec3 v)
{
    return vec3(exact_asin(v.x), exact_asin(v.y), exact_asin(v.z));
}

vec4 exact_asin(vec4 v)
{
    return vec4(exact_asin(v.x), exact_asin(v.y), exact_asin(v.z), exact_asin(v.w));
}

vec2 exact_acos(vec2 v)
{
    return vec2(exact_acos(v.x), exact_acos(v.y));
}

vec3 exact_acos(vec3 v)
{
    return vec3(exact_acos(v.x), exact_acos(v.y), exact_acos(v.z));
}

vec4 exact_acos(vec4 v)
{
    return vec4(exact_acos(v.x), exact_acos(v.y), exact_acos(v.z), exact_acos(v.w));
}

vec2 exact_atan(vec2 y, vec2 x)
{
    return vec2(exact_atan(y.x, x.x), exact_atan(y.y, x.y));
}

vec3 exact_atan(vec3 y, vec3 x)
{
    return vec3(exact_atan(y.x, x.x), exact_atan(y.y, x.y), exact_atan(y.z, x.z));
}

vec4 exact_atan(vec4 y, vec4 x)
{
    return vec4(exact_atan(y.x, x.x), exact_atan(y.y, x.y), exact_atan(y.z, x.z), exact_atan(y.w, x.w));
}
