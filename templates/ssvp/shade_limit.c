/* The pass `shade` on the CPU: the same sum over the same VPLs as shade.glsl, for AVX2. Eight
 * pixels of one class, which stand strided in the images, fill the lanes; all that a VPL needs is
 * broadcast, the maps are gathered from. Rows go to the processor's threads. */
#include "limit.h"
#include "ssvp.h"

#if defined(__AVX2__) && defined(__FMA__) && defined(__F16C__)
#include <immintrin.h>

enum {
    LANES = 8,
    TILE_X = SSVP_PARAM_TILE_X,
    TILE_Y = SSVP_PARAM_TILE_Y,
    MAP = SSVP_PARAM_MAP_SIZE,
    FIRST_EYES = SSVP_CONSTANT_FIRST_CLASS_EYES,
    SECOND_EYES = SSVP_PARAM_SECOND_CLUSTERS > 0 ? SSVP_CONSTANT_SECOND_CLASS_EYES : 0,
    MOST_EYES = FIRST_EYES > SECOND_EYES ? FIRST_EYES : SECOND_EYES
};

/* Receivers that a rounding moves to the next texel of a map see another distance. */
const struct dt_limit_tolerance limit_shade_tolerance = {.relative = 0.01, .outliers = 0.005};

struct vec3x8 {
    __m256 x, y, z;
};

/* What is the same for all pixels of a class. */
struct setting {
    __m256 closest, nearest, bias; /* m2, m, per reach */
    __m256 some;                   /* 1: hidden VPLs may be near, else 0 */
    __m256 middle[2];              /* of a map, in texels, moved by the class's stratum */
    const float *maps, *second_maps;
};

/* ---- Eight numbers at a time ----------------------------------------------------------------- */

static inline __m256 all(float value)
{
    return _mm256_set1_ps(value);
}

static inline __m256 dot_all(struct vec3x8 a, const float b[3])
{
    return _mm256_fmadd_ps(a.x, all(b[0]),
                           _mm256_fmadd_ps(a.y, all(b[1]), _mm256_mul_ps(a.z, all(b[2]))));
}

static inline __m256 dot(struct vec3x8 a, struct vec3x8 b)
{
    return _mm256_fmadd_ps(a.x, b.x, _mm256_fmadd_ps(a.y, b.y, _mm256_mul_ps(a.z, b.z)));
}

static inline __m256 negative_dot(struct vec3x8 a, struct vec3x8 b)
{
    __m256 rest = _mm256_fnmsub_ps(a.y, b.y, _mm256_mul_ps(a.z, b.z));
    return _mm256_fnmadd_ps(a.x, b.x, rest);
}

static inline struct vec3x8 from(struct vec3x8 a, const float b[3])
{
    return (struct vec3x8){_mm256_sub_ps(a.x, all(b[0])), _mm256_sub_ps(a.y, all(b[1])),
                           _mm256_sub_ps(a.z, all(b[2]))};
}

static inline __m256 positive(__m256 a)
{
    return _mm256_max_ps(a, _mm256_setzero_ps());
}

/* The processor's estimates have 12 bits, one step of Newton's method makes them 23. */
static inline __m256 reciprocal(__m256 a)
{
    __m256 guess = _mm256_rcp_ps(a);
    return _mm256_mul_ps(guess, _mm256_fnmadd_ps(a, guess, all(2)));
}

static inline __m256 square_root(__m256 a)
{
    __m256 guess = _mm256_rsqrt_ps(a);
    __m256 root = _mm256_mul_ps(a, guess);
    __m256 rest = _mm256_fnmadd_ps(root, guess, all(3));
    return _mm256_mul_ps(_mm256_mul_ps(root, all(0.5f)), rest);
}

static inline __m256i texel_of(__m256 place)
{
    __m256i texel = _mm256_cvttps_epi32(place);
    return _mm256_min_epi32(_mm256_max_epi32(texel, _mm256_setzero_si256()),
                            _mm256_set1_epi32(MAP - 1));
}

/* Of a texel, -1 to 1 over the map. */
static inline __m256 centre_of(__m256i texel)
{
    return _mm256_fmadd_ps(_mm256_cvtepi32_ps(texel), all(2.0f / MAP), all(1.0f / MAP - 1));
}

static inline void add(struct vec3x8 *sum, const float flux[3], __m256 geometry)
{
    sum->x = _mm256_fmadd_ps(all(flux[0]), geometry, sum->x);
    sum->y = _mm256_fmadd_ps(all(flux[1]), geometry, sum->y);
    sum->z = _mm256_fmadd_ps(all(flux[2]), geometry, sum->z);
}

/* ---- Shading --------------------------------------------------------------------------------- */

/* See vpl.glsl. */
static inline __m256 geometry_term(struct vec3x8 x, struct vec3x8 n, const struct ssvp_ClassVpl *v,
                                   const struct setting *setting)
{
    struct vec3x8 d = from(x, v->position);
    __m256 square = _mm256_max_ps(dot(d, d), setting->closest);
    __m256 leaving = positive(dot_all(d, v->normal)), arriving = positive(negative_dot(n, d));
    __m256 distance = square_root(square);
    __m256 disk = _mm256_mul_ps(_mm256_mul_ps(all(v->disk), leaving), distance);
    return _mm256_mul_ps(_mm256_mul_ps(leaving, arriving),
                         reciprocal(_mm256_fmadd_ps(square, square, disk)));
}

/* Square of the distance within which the eye's VPLs are visible. */
static inline __m256 open_square(struct vec3x8 x, struct vec3x8 n, const struct ssvp_Eye *e,
                                 const struct setting *setting, const float *maps)
{
    const __m256 sign = all(-0.0f), slant = all(0.70710678f);
    struct vec3x8 c = from(x, e->position);
    __m256 right = dot_all(c, e->tangent), up = dot_all(c, e->bitangent);
    __m256 side = _mm256_max_ps(_mm256_andnot_ps(sign, right), _mm256_andnot_ps(sign, up));
    __m256 reach = _mm256_max_ps(_mm256_fmadd_ps(positive(dot_all(c, e->axis)), slant, side),
                                 setting->nearest);
    __m256 scale = _mm256_mul_ps(all(0.5f * MAP), reciprocal(reach));
    __m256i column = texel_of(_mm256_fmadd_ps(right, scale, setting->middle[0]));
    __m256i row = texel_of(_mm256_fmadd_ps(up, scale, setting->middle[1]));
    __m256i texel = _mm256_add_epi32(_mm256_mullo_epi32(row, _mm256_set1_epi32(MAP)), column);
    __m256 seen = _mm256_i32gather_ps(maps + (size_t)e->layer * MAP * MAP, texel, 4);

    __m256 height = negative_dot(n, c);
    __m256 p = centre_of(column), q = centre_of(row);
    __m256 edge = _mm256_max_ps(_mm256_andnot_ps(sign, p), _mm256_andnot_ps(sign, q));
    __m256 across =
        _mm256_fmadd_ps(dot_all(n, e->tangent), p, _mm256_mul_ps(dot_all(n, e->bitangent), q));
    __m256 along = _mm256_fmadd_ps(
        dot_all(n, e->axis), _mm256_mul_ps(all(1.41421356f), _mm256_sub_ps(all(1), edge)), across);
    __m256 allowed = _mm256_mul_ps(setting->bias, reach);
    __m256 plane = _mm256_fmadd_ps(seen, along, _mm256_sub_ps(height, allowed));
    __m256 distance = _mm256_sub_ps(_mm256_sub_ps(reach, allowed), seen);
    __m256 faces = _mm256_cmp_ps(height, _mm256_setzero_ps(), _CMP_GT_OQ);
    __m256 before = _mm256_blendv_ps(distance, plane, faces);
    __m256 open = _mm256_cmp_ps(before, _mm256_setzero_ps(), _CMP_LE_OQ);
    __m256 part = positive(_mm256_fnmadd_ps(seen, reciprocal(reach), all(1)));
    __m256 square = _mm256_mul_ps(dot(c, c), _mm256_mul_ps(part, part));
    return _mm256_blendv_ps(_mm256_mul_ps(square, setting->some), all(1e30f), open);
}

static inline __m256 where_open(const __m256 *open, struct vec3x8 x, const struct ssvp_ClassVpl *v,
                                __m256 geometry)
{
    struct vec3x8 d = from(x, v->position);
    __m256 farthest = _mm256_max_ps(open[v->eye], all(v->near_square));
    return _mm256_and_ps(_mm256_cmp_ps(dot(d, d), farthest, _CMP_LT_OQ), geometry);
}

/* ---- Pixels ---------------------------------------------------------------------------------- */

/* Every TILE_X-th pixel from `first` on; lanes behind `count` repeat the last. */
static struct vec3x8 load_floats(const float *first, int count)
{
    float lanes[3][LANES];
    for (int i = 0; i < LANES; i++) {
        const float *texel = first + (size_t)(i < count ? i : count - 1) * TILE_X * 4;
        for (int axis = 0; axis < 3; axis++)
            lanes[axis][i] = texel[axis];
    }
    return (struct vec3x8){_mm256_loadu_ps(lanes[0]), _mm256_loadu_ps(lanes[1]),
                           _mm256_loadu_ps(lanes[2])};
}

static struct vec3x8 load_halves(const uint16_t *first, int count)
{
    float texels[LANES][4];
    for (int i = 0; i < LANES; i++) {
        const uint16_t *texel = first + (size_t)(i < count ? i : count - 1) * TILE_X * 4;
        _mm_storeu_ps(texels[i],
                      _mm_cvtph_ps(_mm_loadl_epi64((const __m128i *)(const void *)texel)));
    }
    float lanes[3][LANES];
    for (int i = 0; i < LANES; i++)
        for (int axis = 0; axis < 3; axis++)
            lanes[axis][i] = texels[i][axis];
    return (struct vec3x8){_mm256_loadu_ps(lanes[0]), _mm256_loadu_ps(lanes[1]),
                           _mm256_loadu_ps(lanes[2])};
}

static void store(uint16_t *first, struct vec3x8 sum, int count)
{
    const __m256 scale = all((float)SSVP_CONSTANT_CLASS_COUNT / 3.14159265f);
    const __m256 most = all(60000);
    float lanes[3][LANES];
    _mm256_storeu_ps(lanes[0], _mm256_min_ps(_mm256_mul_ps(sum.x, scale), most));
    _mm256_storeu_ps(lanes[1], _mm256_min_ps(_mm256_mul_ps(sum.y, scale), most));
    _mm256_storeu_ps(lanes[2], _mm256_min_ps(_mm256_mul_ps(sum.z, scale), most));
    for (int i = 0; i < count; i++) {
        __m128 texel = _mm_setr_ps(lanes[0][i], lanes[1][i], lanes[2][i], 1);
        _mm_storel_epi64((__m128i *)(void *)(first + (size_t)i * TILE_X * 4),
                         _mm_cvtps_ph(texel, _MM_FROUND_TO_NEAREST_INT));
    }
}

static struct setting set_up(const struct dt_limit *limit, int class_x, int class_y)
{
    const struct ssvp_live *live = limit->live;
    const float radius = limit->frame->scene_radius;
    const float blur = live->visibility_blur;
    const float right = ((float)class_x + 0.5f) / TILE_X - 0.5f;
    const float up = ((float)class_y + 0.5f) / TILE_Y - 0.5f;
    return (struct setting){.closest = all(1e-8f * radius * radius),
                            .nearest = all(1e-4f * radius),
                            .some = all(live->visibility_near > 0),
                            .bias = all(live->visibility_bias * (2.28f / MAP)),
                            .middle = {all(0.5f * MAP + blur * right), all(0.5f * MAP + blur * up)},
                            .maps = (const void *)limit->inputs[SSVP_RESOURCE_FIRST_REACH].data,
                            .second_maps =
                                (const void *)limit->inputs[SSVP_RESOURCE_SECOND_REACH].data};
}

/* What a class is shaded from. */
struct class
{
    const struct ssvp_ClassVpl *first, *second;
    const struct ssvp_Eye *first_eyes, *second_eyes;
    struct setting setting;
};

static struct class class_of(const struct dt_limit *limit, int class_x, int class_y)
{
    const int c = class_x + TILE_X * class_y;
    const struct dt_bytes *in = limit->inputs;
    const struct ssvp_ClassVpl *first = (const void *)in[SSVP_RESOURCE_FIRST_SHADING].data;
    const struct ssvp_ClassVpl *second = (const void *)in[SSVP_RESOURCE_SECOND_SHADING].data;
    const struct ssvp_Eye *eyes = (const void *)in[SSVP_RESOURCE_FIRST_EYES].data;
    const struct ssvp_Eye *others = (const void *)in[SSVP_RESOURCE_SECOND_EYES].data;
    return (struct class){.first = first + c * SSVP_CONSTANT_FIRST_CLASS_POINTS,
                          .second = second + c * SSVP_CONSTANT_SECOND_CLASS_POINTS,
                          .first_eyes = eyes + c * FIRST_EYES,
                          .second_eyes = others + c * SECOND_EYES,
                          .setting = set_up(limit, class_x, class_y)};
}

static inline struct vec3x8 shade(const struct class *class, struct vec3x8 x, struct vec3x8 n)
{
    const struct setting *setting = &class->setting;
    struct vec3x8 sum = {all(0), all(0), all(0)};
    __m256 open[MOST_EYES];
    for (int k = 0; k < FIRST_EYES; k++)
        open[k] = open_square(x, n, &class->first_eyes[k], setting, setting->maps);
    for (int k = 0; k < SSVP_CONSTANT_FIRST_CLASS_POINTS; k++)
        add(&sum, class->first[k].flux,
            where_open(open, x, &class->first[k], geometry_term(x, n, &class->first[k], setting)));
    for (int k = 0; k < SECOND_EYES; k++)
        open[k] = open_square(x, n, &class->second_eyes[k], setting, setting->second_maps);
    for (int k = 0; k < SSVP_CONSTANT_SECOND_CLASS_POINTS; k++) {
        __m256 geometry = geometry_term(x, n, &class->second[k], setting);
        add(&sum, class->second[k].flux,
            SECOND_EYES ? where_open(open, x, &class->second[k], geometry) : geometry);
    }
    return sum;
}

/* The pixels of one class in one row of the frame. */
static void shade_row(const struct dt_limit *limit, int y, int class_x)
{
    const int width = (int)limit->frame->width;
    const float *positions = (const void *)limit->inputs[SSVP_RESOURCE_GBUFFER_POSITION].data;
    const uint16_t *normals = (const void *)limit->inputs[SSVP_RESOURCE_GBUFFER_NORMAL].data;
    uint16_t *irradiance = (void *)limit->outputs[SSVP_RESOURCE_IRRADIANCE].data;
    const struct class class = class_of(limit, class_x, y % TILE_Y);
    for (int x = class_x; x < width; x += LANES * TILE_X) {
        const size_t texel = ((size_t)y * width + x) * 4;
        const int left = (width - x + TILE_X - 1) / TILE_X;
        const int count = left < LANES ? left : LANES;
        const struct vec3x8 position = load_floats(positions + texel, count);
        const struct vec3x8 normal = load_halves(normals + texel, count);
        store(irradiance + texel, shade(&class, position, normal), count);
    }
}

void limit_shade(const struct dt_limit *limit)
{
    const int height = (int)limit->frame->height;
#pragma omp parallel for schedule(dynamic, 8)
    for (int y = 0; y < height; y++)
        for (int class_x = 0; class_x < TILE_X; class_x++)
            shade_row(limit, y, class_x);
}
#endif
