/* Noise, drift and difference of backends; see measured.h. */
#include "result/measured.h"

#include <cjson/cJSON.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"

double errors_under(const struct errors *errors, const struct dt_contract *contract)
{
    if (errors->odd)
        return INFINITY;
    switch (contract->kind) {
    case DT_CONTRACT_ULP:
        return errors->ulp;
    case DT_CONTRACT_REL:
        return errors->rel;
    case DT_CONTRACT_OF_EXACT:
        return errors->of_exact;
    case DT_CONTRACT_FLIPS:
    case DT_CONTRACT_RASTER:
        return (double)errors->differing;
    case DT_CONTRACT_EXACT:
    case DT_CONTRACT_ABS:
    case DT_CONTRACT_IMAGE:
        break;
    }
    return errors->abs;
}

static bool breaks(const struct measured_row *row)
{
    const struct dt_contract *contract = &row->resource->contract;
    double error = errors_under(&row->between, contract);
    if (contract->kind == DT_CONTRACT_IMAGE || contract->kind == DT_CONTRACT_RASTER)
        return row->between.odd;
    if (contract->kind == DT_CONTRACT_EXACT)
        return row->between.odd || row->between.differing;
    return error > (contract->kind == DT_CONTRACT_OF_EXACT ? 2 : 1) * contract->tolerance;
}

bool measured_breaks(const struct measured *measured)
{
    bool found = false;
    for (uint32_t i = 0; i < measured->count; i++)
        found |= breaks(&measured->rows[i]);
    return found;
}

/* ---- The table --------------------------------------------------------------------------------- */

static const char *const between_names[MEASURED_KINDS] = {"", "drift", "difference of backends"};

/* "noise of gl", "drift". */
static void name_kind(char text[80], enum measured_kind kind, const char *side)
{
    if (kind == MEASURED_NOISE)
        snprintf(text, 80, "noise of %.60s", side);
    else
        snprintf(text, 80, "%s", between_names[kind]);
}

static bool is_still(const struct measured_row *row)
{
    const struct errors *all[] = {&row->noise[0], &row->noise[1], &row->between};
    bool still = true;
    for (int i = 0; i < 3; i++)
        still &= !all[i]->odd && !all[i]->differing;
    return still;
}

static void print_errors(const struct errors *errors)
{
    static const double shares[] = {0.5, 0.95, 0.999, 1};
    if (errors->odd)
        printf("  NaN, Inf or other sizes\n");
    else if (!errors->differing)
        printf("  none\n");
    else {
        printf("  %10" PRIu64, errors->differing);
        for (int i = 0; i < 4; i++)
            printf("  %8.3g", i < 3 ? errors_quantile(errors, shares[i]) : errors->abs);
        printf("  %8.3g  %8.3g\n", errors->ulp, errors->rel);
    }
}

struct columns {
    int pass, name, kind;
};

static void print_row(const struct measured *measured, const struct measured_row *row,
                      const struct columns *columns)
{
    const struct errors *all[] = {&row->noise[0], &row->noise[1], &row->between};
    if (is_still(row)) {
        printf("%-*s  %-*s  equal in all runs\n", columns->pass, row->pass, columns->name,
               row->name);
        return;
    }
    for (int i = 0; i < 3; i++) {
        char kind[80];
        name_kind(kind, i < 2 ? MEASURED_NOISE : measured->kind, measured->labels[i % 2]);
        printf("%-*s  %-*s  %-*s", columns->pass, i ? "" : row->pass, columns->name,
               i ? "" : row->name, columns->kind, kind);
        print_errors(all[i]);
    }
}

static int wider(int width, const char *text)
{
    int length = (int)strlen(text);
    return length > width ? length : width;
}

void measured_print(const struct measured *measured)
{
    struct columns columns = {4, 8, 0};
    for (int i = 0; i < 3; i++) {
        char kind[80];
        name_kind(kind, i < 2 ? MEASURED_NOISE : measured->kind, measured->labels[i % 2]);
        columns.kind = wider(columns.kind, kind);
    }
    for (uint32_t i = 0; i < measured->count; i++) {
        columns.pass = wider(columns.pass, measured->rows[i].pass);
        columns.name = wider(columns.name, measured->rows[i].name);
    }
    printf("\n%u runs of each side; of two runs that differ most:\n", measured->runs);
    printf("%-*s  %-*s  %-*s  %10s  %8s  %8s  %8s  %8s  %8s  %8s\n", columns.pass, "pass",
           columns.name, "resource", columns.kind, "", "differing", "median", "95 %", "99.9 %",
           "largest", "ulp", "relative");
    for (uint32_t i = 0; i < measured->count; i++)
        print_row(measured, &measured->rows[i], &columns);
    for (uint32_t i = 0; i < measured->count; i++)
        if (breaks(&measured->rows[i]))
            printf("%s, %s: breaks its contract in some runs\n", measured->rows[i].pass,
                   measured->rows[i].name);
}

/* ---- JSON -------------------------------------------------------------------------------------- */

static void add_errors(cJSON *root, const char *name, const struct errors *errors)
{
    cJSON *item = cJSON_AddObjectToObject(root, name);
    cJSON_AddNumberToObject(item, "pairs", errors->pairs);
    cJSON_AddNumberToObject(item, "elements", (double)errors->elements);
    cJSON_AddNumberToObject(item, "differing", (double)errors->differing);
    cJSON_AddBoolToObject(item, "not_comparable", errors->odd);
    cJSON_AddNumberToObject(item, "median", errors_quantile(errors, 0.5));
    cJSON_AddNumberToObject(item, "p95", errors_quantile(errors, 0.95));
    cJSON_AddNumberToObject(item, "p99_9", errors_quantile(errors, 0.999));
    cJSON_AddNumberToObject(item, "largest", errors->abs);
    cJSON_AddNumberToObject(item, "ulp", errors->ulp);
    cJSON_AddNumberToObject(item, "rel", errors->rel);
}

cJSON *measured_json(const struct measured *measured)
{
    cJSON *list = cJSON_CreateArray();
    for (uint32_t i = 0; i < measured->count; i++) {
        const struct measured_row *row = &measured->rows[i];
        cJSON *item = cJSON_CreateObject(), *noise;
        cJSON_AddStringToObject(item, "pass", row->pass);
        cJSON_AddStringToObject(item, "resource", row->name);
        noise = cJSON_AddObjectToObject(item, measured_names[MEASURED_NOISE]);
        for (int side = 0; side < 2; side++)
            add_errors(noise, measured->labels[side], &row->noise[side]);
        add_errors(item, measured_names[measured->kind], &row->between);
        cJSON_AddItemToArray(list, item);
    }
    return list;
}

/* ---- Contracts --------------------------------------------------------------------------------- */

/* All errors of a key, over its passes, mips, frames and pairs of sides. */
struct bound {
    const char *key;
    const struct dt_resource *resource;
    struct errors kinds[MEASURED_KINDS], all, exact;
};

static bool has_integers(const struct dt_resource *resource)
{
    bool whole = true;
    if (resource->kind == DT_IMAGE)
        return number_is_integer(format_info(resource->format)->kind);
    for (uint32_t i = 0; i < resource->field_count; i++)
        whole &= type_info(resource->fields[i].type)->scalar != DT_TYPE_FLOAT;
    return whole;
}

static bool is_unorm(const struct dt_resource *resource)
{
    return resource->kind == DT_IMAGE && number_one(format_info(resource->format)->kind);
}

/* The first step below which all but one in a thousand elements are; -1: the largest error is not far above. */
static int outliers_above(const struct errors *errors)
{
    for (int i = 0; i < ERROR_STEPS; i++)
        if (errors->beyond[i] * 1000 <= errors->elements)
            return errors->beyond[i] && errors_step(i) * 8 < errors->abs ? i : -1;
    return -1;
}

/* Up to three digits, and no less than the value. */
static double rounded_up(double value, char text[24])
{
    for (int digits = 3; digits < 17; digits++) {
        double scale = pow(10, floor(log10(value)) - digits + 1);
        snprintf(text, 24, "%.*g", digits, ceil(value / scale) * scale);
        if (strtod(text, NULL) >= value)
            break;
    }
    return strtod(text, NULL);
}

enum { FEW_ULP = 16 };
#define SMALL_REL 0.01

/* The contract of a fast pass. Its bound is the largest distance of a side from the exact twin, or half the distance between
 * two sides if that is more. The spec's own contract stays if it allows outliers and there are some. */
static struct dt_contract choose_of_exact(const struct bound *bound, FILE *out)
{
    const struct dt_contract *given = &bound->resource->contract;
    double error = fmax(bound->exact.of_exact, bound->all.of_exact / 2);
    char text[24] = "0";
    if (given->kind == DT_CONTRACT_OF_EXACT && given->outliers > 0 && error > given->tolerance) {
        fprintf(out, "{of_exact: %.9g, outliers: %.9g", given->tolerance, given->outliers);
    } else {
        if (error > 0)
            rounded_up(error, text);
        fprintf(out, "{of_exact: %s", text);
    }
    return (struct dt_contract){.kind = DT_CONTRACT_OF_EXACT};
}

/* As tight as the errors are; writes it without the measured numbers. */
static struct dt_contract choose(const struct bound *bound, FILE *out)
{
    const struct errors *all = &bound->all;
    int step = bound->resource->kind == DT_IMAGE ? outliers_above(all) : -1;
    char text[24];
    if (bound->exact.differing)
        return choose_of_exact(bound, out);
    if (!all->differing) {
        fputs("exact", out);
        return (struct dt_contract){.kind = DT_CONTRACT_EXACT};
    }
    if (has_integers(bound->resource)) {
        fprintf(out, "{flips: %" PRIu64, all->differing);
        return (struct dt_contract){.kind = DT_CONTRACT_FLIPS};
    }
    if (all->ulp <= FEW_ULP || (is_unorm(bound->resource) && step < 0)) {
        fprintf(out, "{ulp: %.0f", ceil(all->ulp));
        return (struct dt_contract){.kind = DT_CONTRACT_ULP};
    }
    if (all->rel <= SMALL_REL) {
        rounded_up(all->rel, text);
        fprintf(out, "{rel: %s", text);
        return (struct dt_contract){.kind = DT_CONTRACT_REL};
    }
    if (step >= 0) {
        rounded_up((double)all->beyond[step] / (double)all->elements, text);
        fprintf(out, "{image: {max: %.2g, outliers: %s}", errors_step(step), text);
        return (struct dt_contract){.kind = DT_CONTRACT_IMAGE};
    }
    rounded_up(all->abs, text);
    fprintf(out, "{abs: %s", text);
    return (struct dt_contract){.kind = DT_CONTRACT_ABS};
}

double difference_error(const struct difference *difference)
{
    enum dt_contract_kind kind = difference->contract.kind;
    bool counted = kind == DT_CONTRACT_FLIPS || kind == DT_CONTRACT_RASTER;
    return counted                   ? (double)difference->differing
           : difference->worst.valid ? difference->worst.error
                                     : 0;
}

/* Why the contract is as it is. */
static void write_reason(FILE *out, const struct bound *bound)
{
    const char *comma = "";
    fputs("  # ", out);
    if (!bound->all.differing)
        fputs("equal in all runs", out);
    if (bound->exact.differing)
        fprintf(out, "%s%" PRIu64 " of %" PRIu64 " differ from exact",
                bound->all.differing ? "" : "; ", bound->exact.differing, bound->exact.elements);
    comma = bound->exact.differing ? "; " : comma;
    for (int i = 0; i < MEASURED_KINDS; i++) {
        const struct errors *errors = &bound->kinds[i];
        const char *name = i == MEASURED_NOISE ? "noise of a side" : between_names[i];
        if (!errors->pairs || !bound->all.differing)
            continue;
        if (!errors->differing)
            fprintf(out, "%s%s: none", comma, name);
        else
            fprintf(out, "%s%s: %" PRIu64 " of %" PRIu64 " differ, 95 %% below %.3g, largest %.3g",
                    comma, name, errors->differing, errors->elements, errors_quantile(errors, 0.95),
                    errors->abs);
        comma = "; ";
    }
    fputs("\n", out);
}

/* Names are anybody's: YAML's quotes, where a plain word could mean something else. */
static void write_key(FILE *out, const char *key)
{
    bool plain = true;
    for (const char *at = key; *at; at++)
        plain &= (*at >= 'a' && *at <= 'z') || (*at >= 'A' && *at <= 'Z') || *at == '_' ||
                 *at == '.' || (at > key && *at >= '0' && *at <= '9');
    if (!plain)
        fputc('\'', out);
    for (const char *at = key; *at; at++) {
        if (*at == '\'' && !plain)
            fputc('\'', out);
        fputc(*at, out);
    }
    fputs(plain ? ": " : "': ", out);
}

static void write_bound(FILE *out, const struct bound *bound)
{
    write_key(out, bound->key);
    const struct dt_contract contract = choose(bound, out);
    for (int i = 0; i < MEASURED_KINDS && contract.kind != DT_CONTRACT_EXACT; i++)
        if (bound->kinds[i].pairs)
            fprintf(out, ", %s: %.6g", measured_names[i],
                    errors_under(&bound->kinds[i], &contract));
    if (contract.kind != DT_CONTRACT_EXACT)
        fputc('}', out);
    write_reason(out, bound);
}

/* One per key, in order of appearance. Returns how many. */
static uint32_t collect(const struct measured *pairs, uint32_t count, struct bound *bounds)
{
    uint32_t found = 0;
    for (uint32_t p = 0; p < count; p++)
        for (uint32_t i = 0; i < pairs[p].count; i++) {
            const struct measured_row *row = &pairs[p].rows[i];
            uint32_t k = 0;
            while (k < found && strcmp(bounds[k].key, row->key) != 0)
                k++;
            if (k == found)
                bounds[found++] = (struct bound){.key = row->key, .resource = row->resource};
            for (int side = 0; side < 2; side++)
                errors_join(&bounds[k].kinds[MEASURED_NOISE], &row->noise[side]);
            errors_join(&bounds[k].kinds[pairs[p].kind], &row->between);
            errors_join(&bounds[k].exact, &row->exact);
        }
    for (uint32_t k = 0; k < found; k++)
        for (int i = 0; i < MEASURED_KINDS; i++)
            errors_join(&bounds[k].all, &bounds[k].kinds[i]);
    return found;
}

bool measured_write(const struct measured *pairs, uint32_t count, const char *path,
                    struct console *console)
{
    struct file_draft draft;
    uint32_t rows = 0;
    for (uint32_t p = 0; p < count; p++)
        rows += pairs[p].count;
    struct bound *bounds = calloc(rows + 1, sizeof *bounds);
    if (!bounds || !file_draft_begin(&draft, &console->log)) {
        if (!bounds)
            report_error(&console->log, "out of memory");
        else
            file_draft_discard(&draft);
        free(bounds);
        return false;
    }
    uint32_t found = collect(pairs, count, bounds);
    fprintf(
        draft.out,
        "# compare --measure %u --write-contracts: all of these runs keep them, and they are as "
        "tight as that.\nmeasured: %u\n",
        pairs[0].runs, pairs[0].runs);
    for (uint32_t k = 0; k < found; k++) {
        if (bounds[k].all.odd)
            report_message(&console->log, DT_WARNING,
                           "%s: NaN, Inf or other sizes in some runs: no contract allows them",
                           bounds[k].key);
        write_bound(draft.out, &bounds[k]);
    }
    free(bounds);
    return file_draft_end(&draft, path, &console->log);
}

void measured_compare(const struct kept_contract *kept, enum measured_kind kind, const char *side,
                      const char *name, double error)
{
    double before = kept ? kept->measured[kind] : NAN;
    if (isnan(before) || !(error > before * (1 + 1e-5)))
        return;
    char text[80];
    name_kind(text, kind, side);
    printf("grown: %s, %s: ", name, text);
    if (before > 0)
        printf("%.3g when it was measured, is %.3g\n", before, error);
    else
        printf("none when it was measured, is %.3g\n", error);
}

void measured_grown(const struct measured *measured, const struct measured_row *row)
{
    if (!row->kept)
        return;
    for (int side = 0; side < 2; side++)
        measured_compare(row->kept, MEASURED_NOISE, measured->labels[side], row->key,
                         errors_under(&row->noise[side], &row->kept->contract));
    measured_compare(row->kept, measured->kind, "", row->key,
                     errors_under(&row->between, &row->kept->contract));
}
