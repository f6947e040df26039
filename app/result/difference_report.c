/* Differences as text and JSON; see difference.h. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include "base/files.h"
#include "result/difference.h"

enum { NUMBER_TEXT = 48 /* the largest float has 39 digits */ };

/* ---- Numbers --------------------------------------------------------------------------------- */

/* Whether reading the decimal gives the same number of that kind. A half, or a shorter float, reads
 * back from anything nearer to it than halfway to its neighbour. */
static bool reads_back(enum number_kind kind, uint32_t bits, double value, const char *text)
{
    double read = strtod(text, NULL);
    if (kind == NUMBER_FLOAT)
        return (float)read == (float)value;
    if (number_one(kind))
        return fabs(read - value) * number_one(kind) < 0.5;
    bool outward = fabs(read) > fabs(value);
    if (!outward && !(bits & 0x7fff))
        return read == 0;
    double neighbour = number_of_bits(kind, outward ? bits + 1 : bits - 1);
    neighbour = isinf(neighbour) ? copysign(65536, value) : neighbour;
    return fabs(read - value) < fabs(neighbour - value) / 2;
}

/* The shortest decimal that reads back; "100" rather than "1e+02". */
static void write_decimal(char text[NUMBER_TEXT], enum number_kind kind, uint32_t bits,
                          double value)
{
    char whole[NUMBER_TEXT];
    int digits = 0;
    do
        snprintf(text, NUMBER_TEXT, "%.*g", ++digits, value);
    while (digits < 9 && !reads_back(kind, bits, value, text));
    if (!strchr(text, 'e') || fabs(value) < 1)
        return;
    snprintf(whole, sizeof whole, "%.0f", value);
    if (strlen(whole) <= strlen(text))
        memcpy(text, whole, sizeof whole);
}

/* Decimal, then the bits: "0.5 (0x3f000000)". */
static const char *write_number(char text[2 * NUMBER_TEXT], enum number_kind kind, uint32_t bits,
                                double value)
{
    char decimal[NUMBER_TEXT];
    if (number_is_integer(kind))
        snprintf(decimal, sizeof decimal, "%.0f", value);
    else if (!isfinite(value))
        snprintf(decimal, sizeof decimal, "%s", isnan(value) ? "NaN" : value < 0 ? "-Inf" : "Inf");
    else
        write_decimal(decimal, kind, bits, value);
    snprintf(text, 2 * NUMBER_TEXT, "%s (0x%0*" PRIx32 ")", decimal,
             (int)(number_width(kind) + 3) / 4, bits);
    return text;
}

static const char *write_margin(char text[2 * NUMBER_TEXT], uint32_t bits)
{
    return write_number(text, NUMBER_FLOAT, bits,
                        number_value(NUMBER_FLOAT, (const uint8_t *)&bits));
}

/* "[3].flux.y" or "(4, 5, layer 6).r". */
static char *describe_place(const struct difference *difference, const struct dt_resource *resource,
                            const struct number_pair *pair)
{
    const char *name = pair->component.name;
    const char *dot = name[0] ? "." : "";
    char *element = element_place(resource, difference->extent, pair->element);
    char *place = element ? format_string("%s%s%s", element, dot, name) : NULL;
    free(element);
    return place;
}

/* "gl 0.5 (0x3f000000), vk 0.25 (0x3e800000)". */
static char *describe_pair(const struct number_pair *pair, const char *const labels[2])
{
    char texts[2][2 * NUMBER_TEXT];
    for (int i = 0; i < 2; i++)
        write_number(texts[i], pair->component.kind, pair->bits[i], pair->values[i]);
    return format_string("%s %s, %s %s", labels[0], texts[0], labels[1], texts[1]);
}

/* ---- In words -------------------------------------------------------------------------------- */

/* The error without its place: "0.25", "2 ulp", "3 flips", "7 numbers are NaN or Inf in both, the
 * first". */
static char *describe_size(const struct difference *difference, const struct dt_contract *contract)
{
    bool relative = contract->kind == DT_CONTRACT_REL || contract->kind == DT_CONTRACT_OF_EXACT;
    const char *unit = contract->kind == DT_CONTRACT_ULP ? " ulp" : relative ? " relative" : "";
    const char *both = difference->not_in_both ? "" : " in both";
    if (!isfinite(difference->worst.error) && difference->not_finite == 1)
        return format_string("1 number is NaN or Inf%s,", both);
    if (!isfinite(difference->worst.error))
        return format_string("%" PRIu64 " numbers are NaN or Inf%s, the first",
                             difference->not_finite, both);
    if (contract->kind == DT_CONTRACT_FLIPS)
        return format_string("%" PRIu64 " flip%s, the first", difference->differing,
                             difference->differing == 1 ? "" : "s");
    if (contract->kind == DT_CONTRACT_IMAGE)
        return format_string("%" PRIu64 " outlier%s, the largest error %.3g", difference->beyond,
                             difference->beyond == 1 ? "" : "s", difference->worst.error);
    return format_string("%.3g%s", difference->worst.error, unit);
}

char *difference_describe_worst(const struct difference *difference,
                                const struct dt_resource *resource, const char *const labels[2])
{
    const struct number_pair *worst = &difference->worst;
    if (difference->size_differs)
        return format_string("the sizes differ");
    if (!worst->valid)
        return format_string("-");
    char *size = describe_size(difference, &difference->contract);
    char *place = describe_place(difference, resource, worst);
    char *pair = describe_pair(worst, labels);
    char *text = size && place && pair ? format_string("%s at %s, frame %" PRIu32 ": %s", size,
                                                       place, worst->frame, pair)
                                       : NULL;
    free(size);
    free(place);
    free(pair);
    return text;
}

void difference_write_used(const struct difference *difference, char text[16])
{
    double used = difference_used(difference);
    if (isnan(used) || used > 9.99)
        snprintf(text, 16, "%s", isnan(used) ? "-" : "> 999 %");
    else
        snprintf(text, 16, "%.0f %%", fabs(ceil(used * 100 - 1e-9)));
}

static char *describe_flip(const struct difference *difference, const struct dt_resource *resource,
                           const struct flip *flip, const char *const labels[2])
{
    char margins[2][2 * NUMBER_TEXT];
    char *place = describe_place(difference, resource, &flip->pair);
    char *pair = describe_pair(&flip->pair, labels);
    char *margin = flip->has_margins
                       ? format_string("; margin %s %s, %s %s", labels[0],
                                       write_margin(margins[0], flip->margin_bits[0]), labels[1],
                                       write_margin(margins[1], flip->margin_bits[1]))
                       : format_string("%s", "");
    char *text = place && pair && margin ? format_string("  flip at %s, frame %" PRIu32 ": %s%s\n",
                                                         place, flip->pair.frame, pair, margin)
                                         : NULL;
    free(place);
    free(pair);
    free(margin);
    return text;
}

/* Joins and frees both; NULL when either is. */
static char *join(char *first, char *second)
{
    char *both = first && second ? format_string("%s%s", first, second) : NULL;
    free(first);
    free(second);
    return both;
}

char *difference_list_flips(const struct difference *difference, const struct dt_resource *resource,
                            const char *const labels[2])
{
    char *text = format_string("%s", "");
    if (difference->contract.kind != DT_CONTRACT_FLIPS)
        return text;
    for (uint32_t i = 0; text && i < difference->flip_count; i++)
        text = join(text, describe_flip(difference, resource, &difference->flips[i], labels));
    if (difference->differing > difference->flip_count)
        text = join(text, format_string("  and %" PRIu64 " more flips\n",
                                        difference->differing - difference->flip_count));
    return text;
}

/* ---- JSON ------------------------------------------------------------------------------------ */

/* The value is null for NaN and Inf, which JSON does not have. */
static void add_bits(cJSON *root, const char *label, enum number_kind kind, uint32_t bits,
                     double value)
{
    char text[16];
    cJSON *number = cJSON_AddObjectToObject(root, label);
    snprintf(text, sizeof text, "0x%0*" PRIx32, (int)(number_width(kind) + 3) / 4, bits);
    cJSON_AddNumberToObject(number, "value", value);
    cJSON_AddStringToObject(number, "bits", text);
}

static cJSON *pair_json(const struct difference *difference, const struct dt_resource *resource,
                        const struct number_pair *pair, const char *const labels[2])
{
    cJSON *root = cJSON_CreateObject();
    char *place = describe_place(difference, resource, pair);
    cJSON_AddNumberToObject(root, "frame", pair->frame);
    cJSON_AddNumberToObject(root, "element", (double)pair->element);
    cJSON_AddStringToObject(root, "place", place ? place : "");
    cJSON_AddStringToObject(root, "component", pair->component.name);
    cJSON_AddNumberToObject(root, "error", pair->error);
    for (int i = 0; i < 2; i++)
        add_bits(root, labels[i], pair->component.kind, pair->bits[i], pair->values[i]);
    free(place);
    return root;
}

static cJSON *flip_json(const struct difference *difference, const struct dt_resource *resource,
                        const struct flip *flip, const char *const labels[2])
{
    cJSON *root = pair_json(difference, resource, &flip->pair, labels);
    if (!flip->has_margins)
        return root;
    cJSON *margins = cJSON_AddObjectToObject(root, "margin");
    for (int i = 0; i < 2; i++) {
        double value = number_value(NUMBER_FLOAT, (const uint8_t *)&flip->margin_bits[i]);
        add_bits(margins, labels[i], NUMBER_FLOAT, flip->margin_bits[i], value);
    }
    return root;
}

void contract_json(cJSON *root, const struct dt_contract *contract)
{
    static const char *const kinds[] = {"exact", "ulp",   "abs",    "rel",
                                        "image", "flips", "raster", "of_exact"};
    cJSON_AddStringToObject(root, "contract", kinds[contract->kind]);
    if (contract->kind != DT_CONTRACT_EXACT)
        cJSON_AddNumberToObject(root, "tolerance", contract->tolerance);
    if (contract->kind == DT_CONTRACT_IMAGE || contract->kind == DT_CONTRACT_OF_EXACT)
        cJSON_AddNumberToObject(root, "outliers", contract->outliers);
}

void difference_json(cJSON *root, const struct difference *difference,
                     const struct dt_resource *resource, const char *const labels[2])
{
    const struct number_pair *worst = &difference->worst;
    contract_json(root, &difference->contract);
    cJSON_AddNumberToObject(root, "elements", (double)difference->elements);
    cJSON_AddNumberToObject(root, "differing", (double)difference->differing);
    cJSON_AddNumberToObject(root, "beyond", (double)difference->beyond);
    if (difference->contract.kind == DT_CONTRACT_RASTER)
        cJSON_AddNumberToObject(root, "at_edges", (double)difference->at_edges);
    cJSON_AddNumberToObject(root, "not_finite", (double)difference->not_finite);
    cJSON_AddBoolToObject(root, "size_differs", difference->size_differs);
    if (!isnan(difference_used(difference)))
        cJSON_AddNumberToObject(root, "of_bound", difference_used(difference));
    cJSON_AddStringToObject(root, "verdict", verdict_name(difference_verdict(difference)));
    cJSON_AddItemToObject(root, "worst",
                          worst->valid ? pair_json(difference, resource, worst, labels)
                                       : cJSON_CreateNull());
    if (difference->contract.kind != DT_CONTRACT_FLIPS)
        return;
    cJSON *flips = cJSON_AddArrayToObject(root, "flips");
    for (uint32_t i = 0; i < difference->flip_count; i++)
        cJSON_AddItemToArray(flips, flip_json(difference, resource, &difference->flips[i], labels));
}
