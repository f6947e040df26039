/* Measures differences; see difference.h. */
#include "difference.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool is_float(enum number_kind kind)
{
    return kind == NUMBER_FLOAT || kind == NUMBER_HALF;
}

/* NaN or Inf: all bits of the exponent. */
static bool not_finite(enum number_kind kind, uint32_t bits)
{
    if (kind == NUMBER_FLOAT)
        return (bits & 0x7f800000) == 0x7f800000;
    return kind == NUMBER_HALF && (bits & 0x7c00) == 0x7c00;
}

/* Floats in order of value become integers in order: neighbours are 1 apart, -0 and +0 are the
 * same. */
static double ordered(enum number_kind kind, uint32_t bits)
{
    uint32_t sign = kind == NUMBER_HALF ? 0x8000u : 0x80000000u;
    return bits & sign ? -(double)(bits & ~sign) : (double)bits;
}

static double measure(enum dt_contract_kind contract, enum number_kind kind, const uint32_t bits[2],
                      const double values[2])
{
    if (not_finite(kind, bits[0]) || not_finite(kind, bits[1]))
        return INFINITY;
    double apart = fabs(values[0] - values[1]);
    double size = fmax(fabs(values[0]), fabs(values[1]));
    switch (contract) {
    case DT_CONTRACT_ULP:
        if (is_float(kind))
            return fabs(ordered(kind, bits[0]) - ordered(kind, bits[1]));
        return kind == NUMBER_UNORM8 ? fabs((double)bits[0] - (double)bits[1]) : apart;
    case DT_CONTRACT_REL:
        return size > 0 ? apart / size : 0;
    case DT_CONTRACT_EXACT:
    case DT_CONTRACT_ABS:
        break;
    }
    return apart;
}

struct element_result {
    bool differs, beyond;
};

/* A number that differs, or is NaN or Inf under a tolerance: `here` names its place. */
static void count_number(struct difference *difference, const struct dt_contract *contract,
                         struct worst here, const uint8_t *const places[2],
                         struct element_result *result)
{
    enum number_kind kind = here.component.kind;
    for (int i = 0; i < 2; i++) {
        here.bits[i] = number_bits(kind, places[i]);
        here.values[i] = number_value(kind, places[i]);
    }
    here.error = measure(contract->kind, kind, here.bits, here.values);
    result->differs |= here.bits[0] != here.bits[1];
    result->beyond |= contract->kind == DT_CONTRACT_EXACT || !(here.error <= contract->tolerance);
    if (!difference->worst.valid || here.error > difference->worst.error)
        difference->worst = here;
}

/* True for a number that passes without a closer look, as nearly all do. */
static bool passes_at_once(struct difference *difference, const struct dt_contract *contract,
                           enum number_kind kind, const uint8_t *const places[2])
{
    uint32_t left = number_bits(kind, places[0]);
    uint32_t right = number_bits(kind, places[1]);
    bool odd = not_finite(kind, left) || not_finite(kind, right);
    difference->not_finite += odd;
    return left == right && (!odd || contract->kind == DT_CONTRACT_EXACT);
}

bool difference_add(struct difference *difference, const struct dt_resource *resource,
                    uint32_t frame, const struct dt_bytes copies[2])
{
    struct component *components;
    uint32_t count = resource_components(resource, &components);
    if (!count) {
        free(components);
        return false;
    }
    const uint32_t *extent = copies[0].extent;
    uint32_t stride = resource_stride(resource);
    bool buffer = resource->kind == DT_BUFFER;
    difference->elements = buffer ? extent[0] : (uint64_t)extent[0] * extent[1] * extent[2];
    memcpy(difference->extent, extent, sizeof difference->extent);
    if (copies[0].size != copies[1].size || copies[0].size < difference->elements * stride ||
        memcmp(extent, copies[1].extent, (buffer ? 1 : 3) * sizeof *extent) != 0)
        difference->size_differs = true;
    for (uint64_t i = 0; i < difference->elements && !difference->size_differs; i++) {
        struct element_result result = {false, false};
        for (uint32_t c = 0; c < count; c++) {
            size_t at = i * stride + components[c].offset;
            const uint8_t *const places[2] = {copies[0].data + at, copies[1].data + at};
            if (passes_at_once(difference, &resource->contract, components[c].kind, places))
                continue;
            struct worst here = {
                .valid = true, .frame = frame, .element = i, .component = components[c]};
            count_number(difference, &resource->contract, here, places, &result);
        }
        difference->differing += result.differs;
        difference->beyond += result.beyond;
    }
    free(components);
    return true;
}

enum verdict difference_verdict(const struct difference *difference)
{
    if (difference->size_differs || difference->beyond)
        return VERDICT_DIFFERS;
    return difference->differing ? VERDICT_WITHIN : VERDICT_EQUAL;
}

const char *verdict_name(enum verdict verdict)
{
    static const char *const names[] = {"equal", "within", "DIFFERS"};
    return names[verdict];
}
