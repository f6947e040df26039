/* The pass `shade` on the CPU: the same sum over the same VPLs as shade_vpls.glsl, for AVX2. Eight
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
    MAP = SSVP_PARAM_PARABOLOID_SIZE
};

/* Receivers that a rounding moves to the next texel of a map see another distance. */
const struct dt_limit_tolerance limit_shade_tolerance = {.relative = 0.01, .outliers = 0.005};

struct vec3x8 {
    __m256 x, y, z;
};

/* What is the same for all pixels of a class. */
struct setting {
    __m256 closest, bias;
    __m256 middle[2]; /* of a map, in texels, moved by the class's stratum */
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

/* Numerator and denominator of the geometry term, see vpl.glsl. */
struct term {
    __m256 above, below;
};

static inline struct term geometry_term(struct vec3x8 x, struct vec3x8 n,
                                        const struct ssvp_ClassVpl *v,
                                        const struct setting *setting)
{
    struct vec3x8 d = from(x, v->position);
    __m256 square = _mm256_max_ps(dot(d, d), setting->closest);
    __m256 leaving = positive(dot_all(d, v->normal)), arriving = positive(negative_dot(n, d));
    __m256 distance = square_root(square);
    __m256 cube = _mm256_fmadd_ps(square, distance, _mm256_mul_ps(all(v->disk), leaving));
    return (struct term){_mm256_mul_ps(_mm256_mul_ps(leaving, arriving), distance),
                         _mm256_mul_ps(square, cube)};
}

static inline void add_seen(struct vec3x8 *sum, struct vec3x8 x, struct vec3x8 n,
                            const struct ssvp_ClassVpl *v, const struct setting *setting,
                            const float *maps)
{
    struct vec3x8 c = from(x, v->eye);
    struct term term = geometry_term(x, n, v, setting);

    __m256 eye_square = _mm256_max_ps(dot(c, c), setting->closest);
    __m256 reach = square_root(eye_square);
    __m256 w = _mm256_add_ps(reach, positive(dot_all(c, v->axis)));
    __m256 inverse = reciprocal(_mm256_mul_ps(term.below, w));
    __m256 geometry = _mm256_mul_ps(term.above, _mm256_mul_ps(w, inverse));

    __m256 scale = _mm256_mul_ps(_mm256_mul_ps(term.below, inverse), all(0.5f * MAP));
    __m256 u = _mm256_fmadd_ps(dot_all(c, v->tangent), scale, setting->middle[0]);
    __m256 t = _mm256_fmadd_ps(dot_all(c, v->bitangent), scale, setting->middle[1]);
    __m256i column = texel_of(u), row = texel_of(t);
    __m256i texel = _mm256_add_epi32(_mm256_mullo_epi32(row, _mm256_set1_epi32(MAP)), column);
    __m256 seen = _mm256_i32gather_ps(maps + (size_t)v->layer * MAP * MAP, texel, 4);

    __m256 height = negative_dot(n, c);
    __m256 p = centre_of(column), q = centre_of(row);
    __m256 one = all(1), square_p = _mm256_fmadd_ps(p, p, _mm256_mul_ps(q, q));
    __m256 rim = _mm256_add_ps(one, square_p);
    __m256 across =
        _mm256_fmadd_ps(dot_all(n, v->tangent), p, _mm256_mul_ps(dot_all(n, v->bitangent), q));
    __m256 along = _mm256_fmadd_ps(
        all(2), across, _mm256_mul_ps(dot_all(n, v->axis), _mm256_sub_ps(one, square_p)));
    __m256 plane = _mm256_fmadd_ps(seen, along, _mm256_mul_ps(height, rim));
    __m256 distance = _mm256_mul_ps(_mm256_sub_ps(reach, seen), rim);
    __m256 faces = _mm256_cmp_ps(height, _mm256_setzero_ps(), _CMP_GT_OQ);
    __m256 before = _mm256_blendv_ps(distance, plane, faces);
    __m256 most = _mm256_mul_ps(setting->bias, _mm256_mul_ps(reach, rim));
    __m256 visible = _mm256_cmp_ps(before, most, _CMP_LE_OQ);
    add(sum, v->flux, _mm256_and_ps(geometry, visible));
}

static inline void add_unshadowed(struct vec3x8 *sum, struct vec3x8 x, struct vec3x8 n,
                                  const struct ssvp_ClassVpl *v, const struct setting *setting)
{
    struct term term = geometry_term(x, n, v, setting);
    add(sum, v->flux, _mm256_mul_ps(term.above, reciprocal(term.below)));
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
    return (struct setting){
        .closest = all(1e-8f * radius * radius),
        .bias = all(live->visibility_bias * (2.8284271f / MAP)),
        .middle = {all(0.5f * MAP + blur * right), all(0.5f * MAP + blur * up)},
        .maps = (const void *)limit->inputs[SSVP_RESOURCE_PARABOLOID_DISTANCE].data,
        .second_maps = (const void *)limit->inputs[SSVP_RESOURCE_SECOND_DISTANCE].data};
}

/* The pixels of one class in one row of the frame. */
static void shade_row(const struct dt_limit *limit, int y, int class_x)
{
    const int width = (int)limit->frame->width;
    const int class = class_x + TILE_X * (y % TILE_Y);
    const struct dt_bytes *in = limit->inputs;
    const struct ssvp_ClassVpl *first = (const void *)in[SSVP_RESOURCE_SHADING_FIRST].data;
    const struct ssvp_ClassVpl *second = (const void *)in[SSVP_RESOURCE_SHADING_SECOND].data;
    const float *positions = (const void *)in[SSVP_RESOURCE_GBUFFER_POSITION].data;
    const uint16_t *normals = (const void *)in[SSVP_RESOURCE_GBUFFER_NORMAL].data;
    uint16_t *irradiance = (void *)limit->outputs[SSVP_RESOURCE_IRRADIANCE].data;
    const struct setting setting = set_up(limit, class_x, y % TILE_Y);
    first += class * SSVP_CONSTANT_CLASS_FIRST;
    second += class * SSVP_CONSTANT_CLASS_SECOND;
    for (int x = class_x; x < width; x += LANES * TILE_X) {
        const size_t texel = ((size_t)y * width + x) * 4;
        const int left = (width - x + TILE_X - 1) / TILE_X;
        const int count = left < LANES ? left : LANES;
        const struct vec3x8 position = load_floats(positions + texel, count);
        const struct vec3x8 normal = load_halves(normals + texel, count);
        struct vec3x8 sum = {all(0), all(0), all(0)};
        for (int k = 0; k < SSVP_CONSTANT_CLASS_FIRST; k++)
            add_seen(&sum, position, normal, first + k, &setting, setting.maps);
        for (int k = 0; k < SSVP_CONSTANT_CLASS_SECOND; k++)
            if (SSVP_PARAM_SECOND_CLUSTERS > 0)
                add_seen(&sum, position, normal, second + k, &setting, setting.second_maps);
            else
                add_unshadowed(&sum, position, normal, second + k, &setting);
        store(irradiance + texel, sum, count);
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
