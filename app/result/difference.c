/* Measures differences; see difference.h. Nearly all copies are equal, so equality is tested
 * first. */
#include "result/difference.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The numbers of an element, and whether nothing but numbers of one kind lies in the resource. */
struct numbers {
    struct component *components;
    uint32_t count, stride;
    bool packed;
};

static bool numbers_of(struct numbers *numbers, const struct dt_resource *resource)
{
    numbers->count = resource_components(resource, &numbers->components);
    numbers->stride = resource_stride(resource);
    numbers->packed = numbers->count > 0;
    if (!numbers->count)
        return false;
    enum number_kind kind = numbers->components[0].kind;
    for (uint32_t i = 0; i < numbers->count; i++)
        numbers->packed &= numbers->components[i].kind == kind;
    numbers->packed &= numbers->count * number_size(kind) == numbers->stride;
    return true;
}

/* NaN or Inf: all bits of the exponent. */
static bool not_finite(enum number_kind kind, uint32_t bits)
{
    if (!number_is_float(kind))
        return false;
    uint32_t exponent = kind == NUMBER_FLOAT  ? 0x7f800000
                        : kind == NUMBER_HALF ? 0x7c00
                                              : 0x1fu << (number_width(kind) - 5);
    return (bits & exponent) == exponent;
}

/* Whether any of the numbers is NaN or Inf, 8 bytes at a time: the exponent plus one in its last
 * place carries into the sign's bit only when all bits of the exponent are set. */
static bool any_not_finite(enum number_kind kind, const uint8_t *data, size_t size)
{
    bool half = kind == NUMBER_HALF;
    const uint64_t exponent = half ? UINT64_C(0x7c007c007c007c00) : UINT64_C(0x7f8000007f800000);
    const uint64_t one = half ? UINT64_C(0x0400040004000400) : UINT64_C(0x0080000000800000);
    const uint64_t carry = half ? UINT64_C(0x8000800080008000) : UINT64_C(0x8000000080000000);
    uint64_t found = 0, word = 0;
    if (!number_is_float(kind))
        return false;
    for (; size >= sizeof word; size -= sizeof word, data += sizeof word) {
        memcpy(&word, data, sizeof word);
        found |= (word & exponent) + one;
    }
    word = 0;
    memcpy(&word, data, size);
    found |= (word & exponent) + one;
    return found & carry;
}

/* Drivers may flush denormals, where they keep or where they compute them: each counts as a zero of its
 * sign. */
static uint32_t flushed(enum number_kind kind, uint32_t bits)
{
    bool denormal = kind == NUMBER_FLOAT && !(bits & 0x7f800000u);
    return denormal ? bits & 0x80000000u : bits;
}

/* ---- One number ------------------------------------------------------------------------------ */

/* Floats in order of value become integers in order: neighbours are 1 apart, -0 and +0 are the
 * same. */
static double ordered(enum number_kind kind, uint32_t bits)
{
    uint32_t sign = kind == NUMBER_HALF ? 0x8000u : 0x80000000u;
    return bits & sign ? -(double)(bits & ~sign) : (double)bits;
}

/* Whether neighbours in a format that is coarser than arithmetic. */
static bool one_step(enum number_kind kind, const uint32_t bits[2], double codes)
{
    if (number_is_float(kind))
        return kind != NUMBER_FLOAT && fabs(ordered(kind, bits[0]) - ordered(kind, bits[1])) <= 1;
    return number_one(kind) && codes <= 1;
}

/* Smaller values count as this large. */
static const double of_exact_floor = 1e-3;

static double measure_number(enum dt_contract_kind contract, enum number_kind kind,
                             const uint32_t bits[2], const double values[2])
{
    if (not_finite(kind, bits[0]) || not_finite(kind, bits[1]))
        return INFINITY;
    double apart = fabs(values[0] - values[1]);
    double size = fmax(fabs(values[0]), fabs(values[1]));
    double codes = fabs((double)bits[0] - (double)bits[1]);
    if (number_is_snorm(kind))
        codes = fabs((double)(int16_t)bits[0] - (double)(int16_t)bits[1]);
    if (number_one(kind)) /* rounded once, so that 5 codes are no more than 5/255 */
        apart = codes / number_one(kind);
    switch (contract) {
    case DT_CONTRACT_ULP:
        if (number_is_float(kind))
            return fabs(ordered(kind, bits[0]) - ordered(kind, bits[1]));
        return number_one(kind) ? codes : apart;
    case DT_CONTRACT_REL:
        return size > 0 ? apart / size : 0;
    case DT_CONTRACT_OF_EXACT:
        return one_step(kind, bits, codes) ? 0 : apart / fmax(size, of_exact_floor);
    case DT_CONTRACT_FLIPS: /* discrete values have no distance: the first is the worst */
        return 1;
    case DT_CONTRACT_EXACT:
    case DT_CONTRACT_ABS:
    case DT_CONTRACT_IMAGE:
    case DT_CONTRACT_RASTER:
        break;
    }
    return apart;
}

/* Whether a differing number exceeds the tolerance; `allowed` says how many elements may. */
static bool is_beyond(const struct dt_contract *contract, double error)
{
    switch (contract->kind) {
    case DT_CONTRACT_EXACT:
    case DT_CONTRACT_FLIPS:
    case DT_CONTRACT_RASTER:
        return true;
    case DT_CONTRACT_ULP:
    case DT_CONTRACT_ABS:
    case DT_CONTRACT_REL:
    case DT_CONTRACT_IMAGE:
        break;
    case DT_CONTRACT_OF_EXACT: /* of both copies */
        return !(error <= 2 * contract->tolerance);
    }
    return !(error <= contract->tolerance);
}

/* How many elements of a frame may be beyond the tolerance. A share of 29 % of 100 is 29, whatever
 * the last bit of 0.29 is. */
static uint64_t allowed(const struct dt_contract *contract, uint64_t elements)
{
    double copies = contract->kind == DT_CONTRACT_OF_EXACT ? 2 : 1;
    if (contract->kind == DT_CONTRACT_IMAGE || contract->kind == DT_CONTRACT_OF_EXACT)
        return (uint64_t)(copies * contract->outliers * (double)elements + 1e-6);
    return contract->kind == DT_CONTRACT_FLIPS ? (uint64_t)contract->tolerance : 0;
}

/* ---- One frame ------------------------------------------------------------------------------- */

struct frame {
    const struct dt_contract *contract;
    const bool *edges; /* NULL: no element may differ for being at one */
    bool coverage;     /* depth: only whether it is background, 1, matters */
    const struct numbers *numbers;
    const struct dt_bytes *copies;
    uint32_t index;
};

static void keep_flip(struct difference *difference, const struct number_pair *pair)
{
    if (difference->flip_count < MOST_FLIPS)
        difference->flips[difference->flip_count++] = (struct flip){.pair = *pair};
}

static bool both_covered(const struct frame *frame, uint64_t element)
{
    static const float background = 1;
    for (int i = 0; i < 2; i++)
        if (!memcmp(frame->copies[i].data + element * sizeof background, &background,
                    sizeof background))
            return false;
    return true;
}

/* NaN in both copies, or the same Inf. */
static bool odd_in_both(enum number_kind kind, const struct number_pair *pair)
{
    return not_finite(kind, pair->bits[0]) && (pair->values[0] == pair->values[1] ||
                                               (isnan(pair->values[0]) && isnan(pair->values[1])));
}

/* What is odd in both copies stays the worst only while nothing else is there. */
static void keep_worst(struct difference *difference, const struct number_pair *pair, bool both)
{
    const struct number_pair *worst = &difference->worst;
    bool weak = !isfinite(worst->error) && !difference->not_in_both;
    if (!worst->valid || (!both && (weak || pair->error > worst->error)))
        difference->worst = *pair;
}

static void add_element(struct difference *difference, const struct frame *frame, uint64_t element)
{
    bool differs = false, beyond = false;
    for (uint32_t c = 0; c < frame->numbers->count; c++) {
        const struct component *component = &frame->numbers->components[c];
        size_t at = element * frame->numbers->stride + component->offset;
        struct number_pair pair = {.valid = true, .frame = frame->index, .element = element};
        bool odd = false;
        for (int i = 0; i < 2; i++) {
            pair.bits[i] = number_bits(component->kind, frame->copies[i].data + at);
            odd |= not_finite(component->kind, pair.bits[i]);
        }
        bool same =
            flushed(component->kind, pair.bits[0]) == flushed(component->kind, pair.bits[1]);
        if (same && !odd)
            continue;
        for (int i = 0; i < 2; i++)
            pair.values[i] = number_value(component->kind, frame->copies[i].data + at);
        pair.component = *component;
        pair.error = measure_number(frame->contract->kind, component->kind, pair.bits, pair.values);
        bool both = odd_in_both(component->kind, &pair);
        if (frame->contract->kind == DT_CONTRACT_FLIPS && !differs && !both)
            keep_flip(difference, &pair);
        keep_worst(difference, &pair, both);
        difference->not_finite += odd;
        difference->not_in_both += odd && !both;
        differs |= !both;
        beyond |= !both && (odd || is_beyond(frame->contract, pair.error));
    }
    bool edge = frame->edges && frame->edges[element];
    difference->differing += differs;
    difference->beyond += beyond && !edge;
    difference->at_edges += differs && edge;
}

static void add_elements(struct difference *difference, const struct frame *frame)
{
    const struct numbers *numbers = frame->numbers;
    const uint8_t *const data[2] = {frame->copies[0].data, frame->copies[1].data};
    size_t stride = numbers->stride, size = difference->elements * stride;
    enum number_kind kind = numbers->components[0].kind;
    bool equal = memcmp(data[0], data[1], size) == 0;
    bool finite = numbers->packed && !any_not_finite(kind, data[0], size) &&
                  (equal || !any_not_finite(kind, data[1], size));
    if (finite && equal)
        return;
    for (uint64_t i = 0; i < difference->elements; i++) {
        bool differs = memcmp(data[0] + i * stride, data[1] + i * stride, stride) != 0;
        if (frame->coverage && both_covered(frame, i))
            difference->other_depths += differs;
        else if (!finite || differs)
            add_element(difference, frame, i);
    }
}

bool difference_measure(struct difference *difference, const struct dt_resource *resource,
                        uint32_t frame, const struct dt_bytes copies[2])
{
    return difference_measure_draw(difference, resource, frame, copies, NULL);
}

bool difference_measure_draw(struct difference *difference, const struct dt_resource *resource,
                             uint32_t frame, const struct dt_bytes copies[2], const bool *edges)
{
    struct numbers numbers;
    *difference = (struct difference){.contract = resource->contract};
    if (!numbers_of(&numbers, resource)) {
        free(numbers.components);
        return false;
    }
    const uint32_t *extent = copies[0].extent;
    bool buffer = resource->kind == DT_BUFFER;
    difference->elements = buffer ? extent[0] : (uint64_t)extent[0] * extent[1] * extent[2];
    memcpy(difference->extent, extent, sizeof difference->extent);
    if (copies[0].size != copies[1].size ||
        copies[0].size < difference->elements * numbers.stride ||
        memcmp(extent, copies[1].extent, (buffer ? 1 : 3) * sizeof *extent) != 0)
        difference->size_differs = true;
    const struct frame now = {.contract = &resource->contract,
                              .edges = edges,
                              .coverage = edges && resource->kind == DT_IMAGE &&
                                          resource->format == DT_FORMAT_D32F,
                              .numbers = &numbers,
                              .copies = copies,
                              .index = frame};
    if (!difference->size_differs)
        add_elements(difference, &now);
    difference->broken =
        difference->size_differs || difference->not_in_both ||
        difference->beyond > allowed(&resource->contract, difference->elements) ||
        (double)difference->at_edges > resource->contract.tolerance * (double)difference->elements;
    free(numbers.components);
    return true;
}

/* ---- Histogram ------------------------------------------------------------------------------- */

static int bin_of(double distance)
{
    int exponent;
    frexp(distance, &exponent);
    return !isfinite(distance)              ? DIFFERENCE_BINS - 1
           : distance < 1                   ? 0
           : exponent > DIFFERENCE_BINS - 2 ? DIFFERENCE_BINS - 2
                                            : exponent;
}

double difference_distance(enum number_kind kind, const uint32_t bits[2])
{
    const double values[2] = {number_of_bits(kind, bits[0]), number_of_bits(kind, bits[1])};
    return bits[0] == bits[1] ? 0 : measure_number(DT_CONTRACT_ULP, kind, bits, values);
}

bool difference_histogram(uint64_t bins[DIFFERENCE_BINS], const struct dt_resource *resource,
                          const struct dt_bytes copies[2])
{
    struct numbers numbers;
    bool good = numbers_of(&numbers, resource);
    memset(bins, 0, DIFFERENCE_BINS * sizeof *bins);
    for (size_t at = 0; good && at + numbers.stride <= copies[0].size; at += numbers.stride)
        for (uint32_t c = 0; c < numbers.count; c++) {
            const struct component *component = &numbers.components[c];
            uint32_t bits[2];
            double values[2];
            for (int i = 0; i < 2; i++) {
                bits[i] = number_bits(component->kind, copies[i].data + at + component->offset);
                values[i] = number_of_bits(component->kind, bits[i]);
            }
            if (flushed(component->kind, bits[0]) != flushed(component->kind, bits[1]))
                bins[bin_of(measure_number(DT_CONTRACT_ULP, component->kind, bits, values))]++;
        }
    free(numbers.components);
    return good;
}

/* ---- Many pairs ------------------------------------------------------------------------------ */

double errors_step(int step)
{
    static const char *const digits[] = {"1", "1.5", "2", "3", "5", "7"};
    char text[16];
    snprintf(text, sizeof text, "%se%d", digits[step % 6], step / 6 - 20);
    return strtod(text, NULL);
}

/* Steps below the error; `steps` are those of errors_step. */
static int steps_below(const double *steps, double error)
{
    int low = 0, high = ERROR_STEPS;
    while (low < high) {
        int middle = (low + high) / 2;
        if (steps[middle] < error)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* The element's largest absolute error; 0: it is equal. */
static double add_error(struct errors *errors, const struct numbers *numbers,
                        const uint8_t *const places[2], bool *differs)
{
    double largest = 0;
    for (uint32_t c = 0; c < numbers->count; c++) {
        const struct component *component = &numbers->components[c];
        enum number_kind kind = component->kind;
        uint32_t bits[2];
        double values[2];
        bool odd = false;
        for (int i = 0; i < 2; i++) {
            bits[i] = number_bits(kind, places[i] + component->offset);
            values[i] = number_of_bits(kind, bits[i]);
            odd |= not_finite(kind, bits[i]);
        }
        errors->odd |= odd;
        if (odd || flushed(kind, bits[0]) == flushed(kind, bits[1]))
            continue;
        *differs = true;
        largest = fmax(largest, measure_number(DT_CONTRACT_ABS, kind, bits, values));
        errors->ulp = fmax(errors->ulp, measure_number(DT_CONTRACT_ULP, kind, bits, values));
        errors->rel = fmax(errors->rel, measure_number(DT_CONTRACT_REL, kind, bits, values));
        errors->of_exact =
            fmax(errors->of_exact, measure_number(DT_CONTRACT_OF_EXACT, kind, bits, values));
    }
    errors->abs = fmax(errors->abs, largest);
    return largest;
}

static void add_apart(struct errors *errors, const struct numbers *numbers,
                      const struct dt_bytes copies[2])
{
    double steps[ERROR_STEPS];
    uint64_t counts[ERROR_STEPS + 1] = {0}, differing = 0;
    for (int i = 0; i < ERROR_STEPS; i++)
        steps[i] = errors_step(i);
    for (uint64_t i = 0; i < errors->elements; i++) {
        size_t at = i * numbers->stride;
        const uint8_t *const places[2] = {copies[0].data + at, copies[1].data + at};
        bool differs = false;
        double error = add_error(errors, numbers, places, &differs);
        differing += differs;
        counts[steps_below(steps, error)]++;
    }
    for (int i = ERROR_STEPS - 1; i >= 0; i--) {
        counts[i] += counts[i + 1];
        if (counts[i + 1] > errors->beyond[i])
            errors->beyond[i] = counts[i + 1];
    }
    errors->differing = differing > errors->differing ? differing : errors->differing;
}

bool errors_add(struct errors *errors, const struct dt_resource *resource,
                const struct dt_bytes copies[2])
{
    struct numbers numbers;
    bool good = numbers_of(&numbers, resource);
    bool buffer = resource->kind == DT_BUFFER;
    errors->pairs++;
    errors->elements = resource_elements(resource, copies[0].extent);
    if (copies[0].size != copies[1].size ||
        (good && copies[0].size < errors->elements * numbers.stride) ||
        memcmp(copies[0].extent, copies[1].extent, (buffer ? 1 : 3) * sizeof(uint32_t)) != 0)
        errors->odd = true;
    else if (good)
        add_apart(errors, &numbers, copies);
    free(numbers.components);
    return good;
}

void errors_join(struct errors *errors, const struct errors *more)
{
    errors->pairs += more->pairs;
    errors->odd |= more->odd;
    errors->missing |= more->missing;
    errors->elements = more->elements > errors->elements ? more->elements : errors->elements;
    errors->differing = more->differing > errors->differing ? more->differing : errors->differing;
    errors->ulp = fmax(errors->ulp, more->ulp);
    errors->rel = fmax(errors->rel, more->rel);
    errors->of_exact = fmax(errors->of_exact, more->of_exact);
    errors->abs = fmax(errors->abs, more->abs);
    for (int i = 0; i < ERROR_STEPS; i++)
        errors->beyond[i] =
            more->beyond[i] > errors->beyond[i] ? more->beyond[i] : errors->beyond[i];
}

double errors_quantile(const struct errors *errors, double q)
{
    double most = (1 - q) * (double)errors->elements;
    if ((double)errors->differing <= most)
        return 0;
    for (int i = 0; i < ERROR_STEPS; i++)
        if ((double)errors->beyond[i] <= most)
            return fmin(errors_step(i), errors->abs);
    return errors->abs;
}

/* ---- Margins and verdict --------------------------------------------------------------------- */

bool difference_needs_margins(const struct difference *difference,
                              const struct dt_resource *resource)
{
    return resource->contract.kind == DT_CONTRACT_FLIPS && resource->contract.margin_field >= 0 &&
           difference->flip_count > 0;
}

void difference_add_margins(struct difference *difference, const struct dt_resource *resource,
                            const struct dt_resource *margin, const struct dt_bytes margins[2])
{
    uint32_t offset = margin->fields[resource->contract.margin_field].offset;
    for (uint32_t i = 0; i < difference->flip_count; i++) {
        struct flip *flip = &difference->flips[i];
        size_t at = flip->pair.element * margin->stride + offset;
        bool there = at + sizeof(float) <= margins[0].size && at + sizeof(float) <= margins[1].size;
        if (!there)
            continue;
        flip->has_margins = true;
        for (int k = 0; k < 2; k++)
            flip->margin_bits[k] = number_bits(NUMBER_FLOAT, margins[k].data + at);
    }
}

enum verdict difference_verdict(const struct difference *difference)
{
    if (difference->broken)
        return VERDICT_DIFFERS;
    if (difference->not_finite)
        return VERDICT_NOT_FINITE;
    return difference->differing ? VERDICT_WITHIN : VERDICT_EQUAL;
}

double difference_used(const struct difference *difference)
{
    const struct dt_contract *contract = &difference->contract;
    double elements = (double)difference->elements, error = difference->worst.error;
    double copies = contract->kind == DT_CONTRACT_OF_EXACT ? 2 : 1;
    double most = copies * contract->tolerance, used = difference->worst.valid ? error : 0;
    if ((contract->kind == DT_CONTRACT_IMAGE || copies > 1) && contract->outliers > 0) {
        most = (double)allowed(contract, difference->elements);
        used = (double)difference->beyond;
    } else if (contract->kind == DT_CONTRACT_FLIPS) {
        used = (double)difference->differing;
    } else if (contract->kind == DT_CONTRACT_RASTER) {
        most *= elements;
        used = (double)difference->at_edges;
    }
    bool bound = contract->kind != DT_CONTRACT_EXACT && most > 0 && !difference->size_differs;
    return bound && isfinite(used) ? used / most : NAN;
}

const char *verdict_name(enum verdict verdict)
{
    static const char *const names[] = {"equal", "within", "not finite", "DIFFERS"};
    return names[verdict];
}
