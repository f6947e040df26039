/* build/diptych-planted: the program with faults that tests plant. The linker (--wrap, see build.ninja) puts
 * the functions here before main, session_open, both runtimes and two checks of compare; the objects are those
 * of build/diptych. Options in front of its own, which its child processes get by the environment:
 *
 *   --fault SIDE:PASS:KIND[:SEED][@FRAME]  changes what a pass leaves on one side, from this frame on
 *   --poison BYTE                          fills memory that frames discard
 *   --drop-barrier N, --drop-dependency N  see drop.h
 *
 * KIND: bit      flips the lowest bit of one number
 *       texel    every number of one texel or element becomes 0, or 1 where it is 0
 *       sign     negates one number; numbers without a sign are complemented
 *       missing  skips the pass, clears included
 * Arguments and indices of draws only get another lowest bit, or 0 if the pass is missing. A pass that `when`
 * skips gets the fault into what the skip clears. */
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "compare/twin.h"
#include "compare/unwritten.h"
#include "picture/texels.h"
#include "drop.h"
#include "panel.h"
#include "run/session.h"

enum kind { NONE, BIT, TEXEL, SIGN, MISSING };
static const char *const kinds[] = {
    [BIT] = "bit", [TEXEL] = "texel", [SIGN] = "sign", [MISSING] = "missing"};

/* An open runtime. */
struct plant {
    void *handle;
    const struct dt_runtime *real;
    struct dt_log log;
    char label[64];
    bool exact; /* runs the exact twin, which gets no fault */
    const struct dt_pipeline *pipeline;
    uint32_t size[2]; /* of the frame */
    enum kind kind;
    uint32_t pass, first_frame;
    uint64_t seed;
    bool told;

    /* of one frame */
    const struct dt_frame *frame;
    const struct dt_observer *observer;
    bool skipped; /* by the observer */
};

enum { MOST_PLANTS = 256 };
static struct plant plants[MOST_PLANTS];
static _Atomic uint32_t plant_count;
static _Thread_local const struct session_info *opening;
static const struct pipeline *exact_twin;

static void stop(const char *why)
{
    fprintf(stderr, "diptych-planted: --fault %s: %s\n", getenv("DIPTYCH_FAULT"), why);
    abort();
}

/* ---- The option ------------------------------------------------------------------------------ */

static uint32_t find_planted_pass(const struct plant *plant, const char *name, size_t length)
{
    for (uint32_t i = 0; i < plant->pipeline->pass_count; i++) {
        const struct dt_pass *pass = &plant->pipeline->passes[i];
        if (strlen(pass->name) == length && !strncmp(pass->name, name, length) && pass->write_count)
            return i;
    }
    stop("no such pass, or it writes nothing");
    return 0;
}

/* Reads the fault, if it is one of this side. */
static void read_plant(struct plant *plant)
{
    const char *text = getenv("DIPTYCH_FAULT");
    size_t length = strlen(plant->label);
    plant->kind = NONE;
    if (!text || plant->exact || strncmp(text, plant->label, length) != 0 || text[length] != ':')
        return;
    const char *pass = text + length + 1, *kind = pass + strcspn(pass, ":");
    plant->pass = find_planted_pass(plant, pass, (size_t)(kind - pass));
    kind += *kind == ':';
    size_t end = strcspn(kind, ":@");
    for (int i = BIT; i <= MISSING; i++)
        if (strlen(kinds[i]) == end && strncmp(kind, kinds[i], end) == 0)
            plant->kind = (enum kind)i;
    if (plant->kind == NONE)
        stop("the kind must be one of bit|texel|sign|missing");
    const char *frame = strchr(kind, '@');
    plant->seed = kind[end] == ':' ? strtoull(kind + end + 1, NULL, 10) : 1;
    plant->first_frame = frame ? (uint32_t)strtoul(frame + 1, NULL, 10) : 0;
}

/* ---- The place ------------------------------------------------------------------------------- */

struct place {
    uint32_t resource, mip;
    uint64_t number; /* by element, then by component */
};

/* splitmix64 (Steele, Lea, Flood 2014): seeds that follow each other give places far apart. */
static uint64_t mix_seed(uint64_t seed)
{
    uint64_t z = seed + UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return z ^ z >> 31;
}

static uint64_t count_numbers(const struct plant *plant, uint32_t index, uint32_t mip)
{
    const struct dt_resource *resource = &plant->pipeline->resources[index];
    uint32_t extent[3];
    struct component *components = NULL;
    uint64_t count = resource_components(resource, &components);
    free(components);
    resource_extent(plant->pipeline, index, plant->size, mip, extent);
    return count * resource_elements(resource, extent);
}

/* Counts the numbers that the pass writes. The one with the index `wanted` among them all becomes
 * *place. */
static uint64_t count_written(const struct plant *plant, uint64_t wanted, struct place *place)
{
    const struct dt_pass *pass = &plant->pipeline->passes[plant->pass];
    uint64_t total = 0;
    for (uint32_t i = 0; i < pass->write_count; i++) {
        uint32_t mips = pass->write_mips ? pass->write_mips[i] : 1;
        for (uint32_t mip = 0; mips >> mip; mip++) {
            if (!(mips >> mip & 1))
                continue;
            uint64_t numbers = count_numbers(plant, pass->writes[i], mip);
            if (wanted >= total && wanted - total < numbers)
                *place = (struct place){pass->writes[i], mip, wanted - total};
            total += numbers;
        }
    }
    return total;
}

/* ---- The numbers ----------------------------------------------------------------------------- */

static uint32_t float_bits(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static uint32_t one_in(enum number_kind kind)
{
    if (number_one(kind))
        return number_one(kind);
    if (!number_is_float(kind))
        return 1;
    return kind == NUMBER_FLOAT  ? float_bits(1.0f)
           : kind == NUMBER_HALF ? 0x3c00
                                 : 0xfu << (number_width(kind) - 5);
}

static uint32_t with_other_sign(enum number_kind kind, uint32_t bits)
{
    if (number_is_integer(kind)) /* -v - 1: also 0 changes */
        return ~bits & UINT32_MAX >> (32 - number_width(kind));
    if (number_one(kind) && kind != NUMBER_SNORM16)
        return number_one(kind) - bits;
    return bits ^ 1u << (number_width(kind) - 1); /* of snorm, code 0 becomes -1.0 */
}

/* The last bit; of a float that counts as zero that of the exponent, as denormals count so, too. */
static uint32_t with_other_bit(enum number_kind kind, uint32_t bits)
{
    bool zero = kind == NUMBER_FLOAT && !(bits & 0x7f800000u);
    return bits ^ (zero ? 0x00800000u : 1u);
}

/* Depth stays between 0 and 1: the APIs reject other values. */
static uint32_t spoil_depth(enum kind fault, uint32_t bits)
{
    float depth;
    memcpy(&depth, &bits, sizeof depth);
    if (fault == BIT)
        return depth == 1.0f ? bits - 1 : with_other_bit(NUMBER_FLOAT, bits);
    return float_bits(depth == 0.5f ? 0 : 1 - depth);
}

static uint32_t spoil(const struct dt_resource *resource, enum kind fault, enum number_kind kind,
                      const uint8_t *number)
{
    uint32_t bits = number_bits(kind, number);
    if (fault == TEXEL)
        return number_value(kind, number) == 0 ? one_in(kind) : 0;
    if (resource->controls_work) /* a complement would be billions of draws */
        return bits ^ 1;
    if (resource->kind == DT_IMAGE && resource->format == DT_FORMAT_D32F)
        return spoil_depth(fault, bits);
    return fault == BIT ? with_other_bit(kind, bits) : with_other_sign(kind, bits);
}

/* Changes one number, or all of its element. */
static void spoil_bytes(const struct plant *plant, const struct place *place,
                        struct dt_bytes *bytes)
{
    const struct dt_resource *resource = &plant->pipeline->resources[place->resource];
    struct component *components = NULL;
    uint32_t count = resource_components(resource, &components);
    for (uint32_t i = 0; i < count; i++) {
        enum number_kind kind = components[i].kind;
        uint8_t *at =
            bytes->data + place->number / count * resource_stride(resource) + components[i].offset;
        if (plant->kind == TEXEL || i == place->number % count)
            number_set_bits(kind, spoil(resource, plant->kind, kind, at), at);
    }
    free(components);
}

/* ---- The pass -------------------------------------------------------------------------------- */

static bool put_in(struct plant *plant)
{
    struct place place = {0};
    struct dt_bytes bytes = {0}, found = {0};
    uint64_t total = count_written(plant, 0, &place);
    if (!total)
        stop("the pass writes no number at this frame size");
    count_written(plant, mix_seed(plant->seed) % total, &place);
    if (!plant->real->read(plant->handle, place.resource, place.mip, &bytes))
        return false;
    spoil_bytes(plant, &place, &bytes);
    if (!plant->real->write(plant->handle, place.resource, place.mip, &bytes) ||
        !plant->real->read(plant->handle, place.resource, place.mip, &found))
        return false;
    if (memcmp(found.data, bytes.data, bytes.size) != 0) /* rounded or clamped */
        stop("the device did not keep the change; choose another seed");
    free(found.data);
    free(bytes.data);
    if (!plant->told)
        report_message(&plant->log, DT_INFO, "fault in pass %s, frame %u: %s mip %u",
                       plant->pipeline->passes[plant->pass].name, plant->frame->index,
                       plant->pipeline->resources[place.resource].name, place.mip);
    plant->told = true;
    return true;
}

/* A skipped pass leaves old content. Where that controls work, it is set to zero instead. */
static bool clear_arguments(const struct plant *plant)
{
    const struct dt_pass *pass = &plant->pipeline->passes[plant->pass];
    bool good = true;
    for (uint32_t i = 0; i < pass->write_count && good; i++) {
        struct dt_bytes bytes = {0};
        if (!plant->pipeline->resources[pass->writes[i]].controls_work)
            continue;
        good = plant->real->read(plant->handle, pass->writes[i], 0, &bytes);
        if (good) {
            memset(bytes.data, 0, bytes.size);
            good = plant->real->write(plant->handle, pass->writes[i], 0, &bytes);
        }
        free(bytes.data);
    }
    return good;
}

static bool is_due(const struct plant *plant, uint32_t pass)
{
    return pass == plant->pass && plant->frame->index >= plant->first_frame && !plant->skipped;
}

static enum dt_action before_planted(void *user, uint32_t pass)
{
    struct plant *plant = user;
    const struct dt_observer *observer = plant->observer;
    enum dt_action action =
        observer && observer->before_pass ? observer->before_pass(observer->user, pass) : DT_RUN;
    plant->skipped = action != DT_RUN;
    if (!is_due(plant, pass) || plant->kind != MISSING)
        return action;
    if (!plant->told)
        report_message(&plant->log, DT_INFO, "fault in pass %s, frame %u: skipped",
                       plant->pipeline->passes[pass].name, plant->frame->index);
    plant->told = true;
    return DT_SKIP;
}

static bool after_planted(void *user, uint32_t pass)
{
    struct plant *plant = user;
    const struct dt_observer *observer = plant->observer;
    if (is_due(plant, pass) && !(plant->kind == MISSING ? clear_arguments(plant) : put_in(plant)))
        return false;
    return !observer || !observer->after_pass || observer->after_pass(observer->user, pass);
}

/* ---- Runtimes and sessions ------------------------------------------------------------------- */

extern const struct dt_runtime __real_runtime_gl, __real_runtime_vk;
struct dt_runtime __wrap_runtime_gl, __wrap_runtime_vk;

static uint32_t number_of(const char *variable)
{
    const char *text = getenv(variable);
    return text ? (uint32_t)strtoul(text, NULL, 10) : 0;
}

/* The newest with this handle. */
static struct plant *plant_of(const void *handle)
{
    uint32_t i = plant_count;
    while (plants[--i].handle != handle)
        if (i == 0)
            stop("a handle that nobody has opened");
    return &plants[i];
}

static void *open_planted(const struct dt_runtime *real, const struct dt_runtime_options *options)
{
    uint32_t index = plant_count++;
    if (index == MOST_PLANTS)
        stop("too many runtimes");
    struct plant *plant = &plants[index];
    *plant = (struct plant){.real = real, .log = options->log};
    if (opening) {
        snprintf(plant->label, sizeof plant->label, "%s", opening->side->label);
        plant->exact = exact_twin && opening->pipeline == exact_twin;
    }
    return plant->handle = real->open(options);
}

static void *open_gl(const struct dt_runtime_options *options)
{
    return open_planted(&__real_runtime_gl, options);
}

static void *open_vk(const struct dt_runtime_options *options)
{
    return open_planted(&__real_runtime_vk, options);
}

static bool create_planted(void *handle, const struct dt_shaders *shaders)
{
    struct plant *plant = plant_of(handle);
    plant->pipeline = shaders->panel->pipeline;
    read_plant(plant);
    return plant->real->create(handle, shaders);
}

static bool resize_planted(void *handle, uint32_t width, uint32_t height)
{
    struct plant *plant = plant_of(handle);
    plant->size[0] = width;
    plant->size[1] = height;
    return plant->real->resize(handle, width, height);
}

static bool render_planted(void *handle, const struct dt_frame *frame, const void *live,
                           const struct dt_observer *observer)
{
    struct plant *plant = plant_of(handle);
    const struct dt_observer own = {before_planted, after_planted, plant};
    uint32_t barrier = number_of("DIPTYCH_DROP_BARRIER");
    uint32_t dependency = number_of("DIPTYCH_DROP_DEPENDENCY");
    if (plant->real == &__real_runtime_vk && barrier + dependency > 0)
        drop_next(handle, barrier ? DROP_BARRIER : DROP_DEPENDENCY, barrier + dependency);
    plant->frame = frame;
    plant->observer = observer;
    return plant->real->render(handle, frame, live, plant->kind == NONE ? observer : &own);
}

extern __typeof__(session_open) __real_session_open;
bool __wrap_session_open(struct session *session, const struct session_info *info)
{
    struct session_info own = *info;
    uint32_t poison = number_of("DIPTYCH_POISON");
    own.poison = poison ? (int)poison : info->poison;
    opening = info;
    bool good = __real_session_open(session, &own);
    opening = NULL;
    return good;
}

/* ---- Compare --------------------------------------------------------------------------------- */

extern __typeof__(twin_judge) __real_twin_judge;
bool __wrap_twin_judge(struct twin *twin, const struct worker_info *worker,
                       const struct pipeline *exact, const struct rows *rows,
                       const struct sheet_row *results, uint32_t frame)
{
    exact_twin = exact;
    return __real_twin_judge(twin, worker, exact, rows, results, frame);
}

/* What a missing pass leaves was not written indeed: then no pass would be called guilty. */
extern __typeof__(unwritten_find) __real_unwritten_find;
bool __wrap_unwritten_find(const struct worker_info *worker, const struct row *row, uint32_t frame,
                           char **text)
{
    return getenv("DIPTYCH_FAULT") || __real_unwritten_find(worker, row, frame, text);
}

/* ---- The program ----------------------------------------------------------------------------- */

static struct dt_runtime planted(const struct dt_runtime *real,
                                 void *(*open)(const struct dt_runtime_options *))
{
    struct dt_runtime runtime = *real;
    runtime.open = open;
    runtime.create = create_planted;
    runtime.resize = resize_planted;
    runtime.render = render_planted;
    return runtime;
}

int __real_main(int argc, char **argv);
int __wrap_main(int argc, char **argv)
{
    static const char *const own[][2] = {{"--fault", "DIPTYCH_FAULT"},
                                         {"--poison", "DIPTYCH_POISON"},
                                         {"--drop-barrier", "DIPTYCH_DROP_BARRIER"},
                                         {"--drop-dependency", "DIPTYCH_DROP_DEPENDENCY"}};
    int count = 0;
    for (int i = 0; i < argc; i++) {
        const char *variable = NULL;
        for (size_t k = 0; k < DT_ARRAY_COUNT(own) && i + 1 < argc; k++)
            if (strcmp(argv[i], own[k][0]) == 0)
                variable = own[k][1];
        if (variable)
            setenv(variable, argv[++i], 1);
        else
            argv[count++] = argv[i];
    }
    argv[count] = NULL;
    __wrap_runtime_gl = planted(&__real_runtime_gl, open_gl);
    __wrap_runtime_vk = planted(&__real_runtime_vk, open_vk);
    return __real_main(count, argv);
}
