/* Injects faults; see fault.h. */
#include "run/fault.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "console/console.h"
#include "base/files.h"
#include "console/texels.h"
#include "base/nearest.h"

static const char *const kind_names[] = {[FAULT_BIT] = "bit",
                                         [FAULT_TEXEL] = "texel",
                                         [FAULT_SIGN] = "sign",
                                         [FAULT_MISSING] = "missing"};

/* ---- The option ------------------------------------------------------------------------------ */

static bool wrong_form(const char *text, const char *what, const struct dt_log *log)
{
    report_error(log, "--fault %s: %s; must be SIDE:PASS:KIND[:SEED][@FRAME], like vk:blur:bit:7",
                 text, what);
    return false;
}

/* Finds the label before a colon at the start of the text. Takes the longest match, since labels
 * may contain colons. Returns the text behind the colon, or NULL. */
static const char *read_side(const char *text, const char *const *labels, uint32_t count,
                             uint32_t *side)
{
    size_t longest = 0;
    for (uint32_t i = 0; i < count; i++) {
        size_t length = strlen(labels[i]);
        if (strncmp(text, labels[i], length) == 0 && text[length] == ':' && length > longest) {
            longest = length;
            *side = i;
        }
    }
    return longest ? text + longest + 1 : NULL;
}

static bool unknown_side(const char *text, const char *const *labels, uint32_t count,
                         const struct dt_log *log)
{
    char *word = strndup(text, strcspn(text, ":"));
    char *list = strdup("");
    for (uint32_t i = 0; list && i < count; i++) {
        char *longer = format_string("%s%s%s", list, i ? ", " : "", labels[i]);
        free(list);
        list = longer;
    }
    report_error(log, "--fault %s: there is no side \"%s\"; the sides are %s", text,
                 word ? word : "", list ? list : "");
    free(list);
    free(word);
    return false;
}

static bool find_faulty_pass(struct fault *fault, const char *text, const char *word,
                             const struct dt_pipeline *pipeline, const struct dt_log *log)
{
    const char **names = calloc(pipeline->pass_count + 1, sizeof *names);
    for (uint32_t i = 0; i < pipeline->pass_count; i++) {
        if (strcmp(pipeline->passes[i].name, word) == 0) {
            fault->pass = i;
            free(names);
            if (pipeline->passes[i].write_count)
                return true;
            report_error(log, "--fault %s: pass %s writes nothing", text, word);
            return false;
        }
        if (names)
            names[i] = pipeline->passes[i].name;
    }
    report_error(log, "--fault %s: %s has no pass \"%s\"%s", text, pipeline->name, word,
                 name_hint('"', word, names, pipeline->pass_count, "").text);
    free(names);
    return false;
}

static bool find_kind(struct fault *fault, const char *text, const char *word,
                      const struct dt_log *log)
{
    for (int i = FAULT_BIT; i <= FAULT_MISSING; i++) {
        if (strcmp(word, kind_names[i]) == 0) {
            fault->kind = (enum fault_kind)i;
            return true;
        }
    }
    report_error(log, "--fault %s: the kind \"%s\" must be one of bit|texel|sign|missing", text,
                 word);
    return false;
}

/* Cuts off the number behind the last `mark`, if there is one. */
static bool take_number(char *text, char mark, uint64_t most, uint64_t *number)
{
    char *place = strrchr(text, mark);
    if (!place)
        return true;
    char *end = NULL;
    errno = 0;
    *number = strtoull(place + 1, &end, 10);
    *place = 0;
    return !errno && end != place + 1 && !*end && place[1] != '-' && *number <= most;
}

/* Parses PASS:KIND[:SEED][@FRAME]; modifies `rest`. */
static bool parse_rest(struct fault *fault, const char *text, char *rest,
                       const struct dt_pipeline *pipeline, const struct dt_log *log)
{
    uint64_t frame = 0;
    if (!take_number(rest, '@', UINT32_MAX, &frame))
        return wrong_form(text, "the frame after @ is no whole number", log);
    char *kind = strchr(rest, ':');
    if (!kind)
        return wrong_form(text, "the kind is missing", log);
    *kind++ = 0;
    fault->seed = 1;
    if (!take_number(kind, ':', UINT64_MAX, &fault->seed))
        return wrong_form(text, "the seed is no whole number", log);
    fault->first_frame = (uint32_t)frame;
    return find_faulty_pass(fault, text, rest, pipeline, log) && find_kind(fault, text, kind, log);
}

bool fault_parse(struct fault *fault, uint32_t *side, const char *text,
                 const struct dt_pipeline *pipeline, const char *const *labels,
                 uint32_t label_count, const struct dt_log *log)
{
    *fault = (struct fault){0};
    *side = 0;
    if (!strchr(text, ':'))
        return wrong_form(text, "the pass is missing", log);
    const char *rest = read_side(text, labels, label_count, side);
    if (!rest)
        return unknown_side(text, labels, label_count, log);
    char *copy = strdup(rest);
    bool good = copy && parse_rest(fault, text, copy, pipeline, log);
    if (!copy)
        report_error(log, "out of memory");
    free(copy);
    return good;
}

/* ---- The place ------------------------------------------------------------------------------- */

struct fault_place {
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

static uint64_t count_numbers(const struct fault_run *run, const struct dt_resource *resource,
                              uint32_t mip)
{
    uint32_t extent[3];
    struct component *components = NULL;
    uint64_t count = resource_components(resource, &components);
    free(components);
    resource_extent(run->pipeline, (uint32_t)(resource - run->pipeline->resources), run->size, mip,
                    extent);
    return count * resource_elements(resource, extent);
}

/* Counts the numbers that the pass writes. The one with the index `wanted` among them all becomes
 * *place. */
static uint64_t count_written(const struct fault_run *run, const struct dt_pass *pass,
                              uint64_t wanted, struct fault_place *place)
{
    uint64_t total = 0;
    for (uint32_t i = 0; i < pass->write_count; i++) {
        uint32_t mips = pass->write_mips ? pass->write_mips[i] : 1;
        for (uint32_t mip = 0; mips >> mip; mip++) {
            if (!(mips >> mip & 1))
                continue;
            uint64_t numbers = count_numbers(run, &run->pipeline->resources[pass->writes[i]], mip);
            if (wanted >= total && wanted - total < numbers)
                *place = (struct fault_place){
                    .resource = pass->writes[i], .mip = mip, .number = wanted - total};
            total += numbers;
        }
    }
    return total;
}

static bool choose_place(const struct fault_run *run, struct fault_place *place)
{
    const struct dt_pass *pass = &run->pipeline->passes[run->fault->pass];
    uint64_t total = count_written(run, pass, 0, place);
    if (total)
        count_written(run, pass, mix_seed(run->fault->seed) % total, place);
    else
        report_error(run->log, "--fault: pass %s writes no number at this frame size", pass->name);
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
static uint32_t spoil_depth(enum fault_kind fault, uint32_t bits)
{
    float depth;
    memcpy(&depth, &bits, sizeof depth);
    if (fault == FAULT_BIT)
        return depth == 1.0f ? bits - 1 : with_other_bit(NUMBER_FLOAT, bits);
    return float_bits(depth == 0.5f ? 0 : 1 - depth);
}

static uint32_t spoil(const struct dt_resource *resource, enum fault_kind fault,
                      enum number_kind kind, const uint8_t *number)
{
    uint32_t bits = number_bits(kind, number);
    if (fault == FAULT_TEXEL)
        return number_value(kind, number) == 0 ? one_in(kind) : 0;
    if (resource->controls_work) /* a complement would be billions of draws */
        return bits ^ 1;
    if (resource->kind == DT_IMAGE && resource->format == DT_FORMAT_D32F)
        return spoil_depth(fault, bits);
    return fault == FAULT_BIT ? with_other_bit(kind, bits) : with_other_sign(kind, bits);
}

/* Changes one number, or all of its element; *change gets the place and the bits. */
static bool spoil_bytes(const struct fault_run *run, const struct dt_resource *resource,
                        uint64_t number, struct dt_bytes *bytes, char **change)
{
    struct component *components = NULL;
    uint32_t count = resource_components(resource, &components);
    uint64_t element = count ? number / count : 0;
    bool all = run->fault->kind == FAULT_TEXEL;
    *change = count ? element_place(resource, bytes->extent, element) : NULL;
    for (uint32_t i = 0; i < count && *change; i++) {
        enum number_kind kind = components[i].kind;
        uint8_t *at = bytes->data + element * resource_stride(resource) + components[i].offset;
        if (!all && i != number % count)
            continue;
        uint32_t before = number_bits(kind, at);
        uint32_t after = spoil(resource, run->fault->kind, kind, at);
        number_set_bits(kind, after, at);
        int digits = (int)(number_width(kind) + 3) / 4;
        char *longer =
            format_string("%s %s%s0x%0*x -> 0x%0*x", *change, components[i].name,
                          components[i].name[0] ? " " : "", digits, before, digits, after);
        free(*change);
        *change = longer;
    }
    free(components);
    if (!*change)
        report_error(run->log, "out of memory");
    return *change;
}

/* Reads the change back: when a driver rounds or clamps it away, there is no fault to find. */
static bool is_there(const struct fault_run *run, const struct fault_place *place,
                     const struct dt_bytes *wanted)
{
    struct dt_bytes found = {0};
    if (!run->runtime->read(run->handle, place->resource, place->mip, &found))
        return false;
    bool same = found.size == wanted->size && memcmp(found.data, wanted->data, found.size) == 0;
    if (!same)
        report_error(run->log,
                     "--fault: the device did not keep the change in %s; choose another seed",
                     run->pipeline->resources[place->resource].name);
    free(found.data);
    return same;
}

static bool put_in(const struct fault_run *run)
{
    struct fault_place place;
    struct dt_bytes bytes = {0};
    char *change = NULL;
    if (!choose_place(run, &place) ||
        !run->runtime->read(run->handle, place.resource, place.mip, &bytes))
        return false;
    const struct dt_resource *resource = &run->pipeline->resources[place.resource];
    bool good = spoil_bytes(run, resource, place.number, &bytes, &change) &&
                run->runtime->write(run->handle, place.resource, place.mip, &bytes) &&
                is_there(run, &place, &bytes);
    if (good)
        report_message(run->log, DT_INFO, "fault in pass %s, frame %u: %s mip %u %s",
                       run->pipeline->passes[run->fault->pass].name, run->frame, resource->name,
                       place.mip, change);
    free(change);
    free(bytes.data);
    return good;
}

/* A skipped pass leaves old content. Where that controls work, it is set to zero instead. */
static bool clear_arguments(const struct fault_run *run)
{
    const struct dt_pass *pass = &run->pipeline->passes[run->fault->pass];
    bool good = true;
    for (uint32_t i = 0; i < pass->write_count && good; i++) {
        struct dt_bytes bytes = {0};
        if (!run->pipeline->resources[pass->writes[i]].controls_work)
            continue;
        good = run->runtime->read(run->handle, pass->writes[i], 0, &bytes);
        if (good) {
            memset(bytes.data, 0, bytes.size);
            good = run->runtime->write(run->handle, pass->writes[i], 0, &bytes);
        }
        free(bytes.data);
    }
    return good;
}

/* ---- The observer ---------------------------------------------------------------------------- */

static bool is_due(const struct fault_run *run, uint32_t pass)
{
    return run->fault->kind != FAULT_NONE && pass == run->fault->pass &&
           run->frame >= run->fault->first_frame;
}

static enum dt_action fault_before_pass(void *user, uint32_t pass)
{
    struct fault_run *run = user;
    const struct dt_observer *observer = run->observer;
    enum dt_action action =
        observer && observer->before_pass ? observer->before_pass(observer->user, pass) : DT_RUN;
    run->skipped = action != DT_RUN;
    if (action != DT_RUN || !is_due(run, pass) || run->fault->kind != FAULT_MISSING)
        return action;
    report_message(run->log, DT_INFO, "fault in pass %s, frame %u: skipped",
                   run->pipeline->passes[pass].name, run->frame);
    return DT_SKIP;
}

static bool fault_after_pass(void *user, uint32_t pass)
{
    struct fault_run *run = user;
    const struct dt_observer *observer = run->observer;
    if (is_due(run, pass) && !run->skipped &&
        !(run->fault->kind == FAULT_MISSING ? clear_arguments(run) : put_in(run)))
        return false;
    return !observer || !observer->after_pass || observer->after_pass(observer->user, pass);
}

struct dt_observer fault_observer(struct fault_run *run)
{
    return (struct dt_observer){
        .before_pass = fault_before_pass, .after_pass = fault_after_pass, .user = run};
}
