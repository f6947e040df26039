/* Noise, drift and difference of backends; see measured.h. */
#include "result/measured.h"

#include <cjson/cJSON.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"

/* The largest error in a contract's own measure. */
static double errors_under(const struct errors *errors, const struct dt_contract *contract)
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

static bool breaks(const struct sheet_row *row)
{
    const struct dt_contract *contract = &row->resource->contract;
    if (!row->errors)
        return false;
    const struct errors *between = &row->errors->between;
    double error = errors_under(between, contract);
    if (contract->kind == DT_CONTRACT_IMAGE || contract->kind == DT_CONTRACT_RASTER)
        return between->odd;
    if (contract->kind == DT_CONTRACT_EXACT)
        return between->odd || between->differing;
    return error > (contract->kind == DT_CONTRACT_OF_EXACT ? 2 : 1) * contract->tolerance;
}

bool measured_breaks(const struct sheet *sheet)
{
    bool found = false;
    for (uint32_t i = 0; i < sheet->count; i++)
        found |= breaks(&sheet->rows[i]);
    return found;
}

bool measured_add(struct errors *errors, const struct dt_resource *resource,
                  const struct dt_bytes *copies)
{
    if (copies)
        return errors_add(errors, resource, copies);
    errors->pairs++;
    errors->odd = true;
    return true;
}

bool measured_row(struct sheet_row *row, uint32_t runs, measured_pair *add, void *user,
                  const struct dt_log *log)
{
    row->errors = row->errors ? row->errors : calloc(1, sizeof *row->errors);
    bool good = row->errors;
    if (!good)
        report_error(log, "out of memory");
    for (uint32_t i = 0; i < runs && good; i++) {
        for (uint32_t k = 0; k < i && good; k++)
            for (int side = 0; side < 2 && good; side++)
                good = add(user, &row->errors->noise[side], (const int[]){side, side},
                           (const uint32_t[]){k, i});
        for (uint32_t k = 0; k < runs && good; k++)
            good = add(user, &row->errors->between, (const int[]){0, 1}, (const uint32_t[]){i, k});
    }
    return good;
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

/* The noise of both sides, and between them. */
static const struct errors *errors_of(const struct sheet_row *row, int i)
{
    return i < 2 ? &row->errors->noise[i] : &row->errors->between;
}

static bool is_still(const struct sheet_row *row)
{
    bool still = true;
    for (int i = 0; i < 3; i++)
        still &= !errors_of(row, i)->odd && !errors_of(row, i)->differing;
    return still;
}

static void print_errors(const struct errors *errors)
{
    static const double shares[] = {0.5, 0.95, 0.999, 1};
    if (errors->missing)
        printf("  missing in a run\n");
    else if (errors->odd)
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

static void print_row(const struct sheet *sheet, const struct sheet_row *row,
                      const struct columns *columns)
{
    if (is_still(row)) {
        printf("%-*s  %-*s  equal in all runs\n", columns->pass, row->pass, columns->name,
               row->name);
        return;
    }
    for (int i = 0; i < 3; i++) {
        char kind[80];
        name_kind(kind, i < 2 ? MEASURED_NOISE : sheet->kind, sheet->labels[i % 2]);
        printf("%-*s  %-*s  %-*s", columns->pass, i ? "" : row->pass, columns->name,
               i ? "" : row->name, columns->kind, kind);
        print_errors(errors_of(row, i));
    }
}

static int wider(int width, const char *text)
{
    int length = (int)strlen(text);
    return length > width ? length : width;
}

void measured_print(const struct sheet *sheet)
{
    struct columns columns = {4, 8, 0};
    for (int i = 0; i < 3; i++) {
        char kind[80];
        name_kind(kind, i < 2 ? MEASURED_NOISE : sheet->kind, sheet->labels[i % 2]);
        columns.kind = wider(columns.kind, kind);
    }
    for (uint32_t i = 0; i < sheet->count; i++) {
        if (!sheet->rows[i].errors)
            continue;
        columns.pass = wider(columns.pass, sheet->rows[i].pass);
        columns.name = wider(columns.name, sheet->rows[i].name);
    }
    printf("\n%u runs of each side; of two runs that differ most:\n", sheet->runs);
    printf("%-*s  %-*s  %-*s  %10s  %8s  %8s  %8s  %8s  %8s  %8s\n", columns.pass, "pass",
           columns.name, "resource", columns.kind, "", "differing", "median", "95 %", "99.9 %",
           "largest", "ulp", "relative");
    for (uint32_t i = 0; i < sheet->count; i++)
        if (sheet->rows[i].errors)
            print_row(sheet, &sheet->rows[i], &columns);
    for (uint32_t i = 0; i < sheet->count; i++) {
        const struct sheet_row *row = &sheet->rows[i];
        bool missing = row->errors && row->errors->between.missing;
        if (breaks(row))
            printf("%s, %s: %s in some runs\n", row->pass, row->name,
                   missing ? "missing" : "breaks its contract");
    }
}

/* ---- JSON -------------------------------------------------------------------------------------- */

static void add_errors(cJSON *root, const char *name, const struct errors *errors)
{
    cJSON *item = cJSON_AddObjectToObject(root, name);
    cJSON_AddNumberToObject(item, "pairs", errors->pairs);
    cJSON_AddNumberToObject(item, "elements", (double)errors->elements);
    cJSON_AddNumberToObject(item, "differing", (double)errors->differing);
    cJSON_AddBoolToObject(item, "not_comparable", errors->odd);
    if (errors->missing)
        cJSON_AddTrueToObject(item, "missing");
    cJSON_AddNumberToObject(item, "median", errors_quantile(errors, 0.5));
    cJSON_AddNumberToObject(item, "p95", errors_quantile(errors, 0.95));
    cJSON_AddNumberToObject(item, "p99_9", errors_quantile(errors, 0.999));
    cJSON_AddNumberToObject(item, "largest", errors->abs);
    cJSON_AddNumberToObject(item, "ulp", errors->ulp);
    cJSON_AddNumberToObject(item, "rel", errors->rel);
}

cJSON *measured_json(const struct sheet *sheet)
{
    cJSON *list = cJSON_CreateArray();
    for (uint32_t i = 0; i < sheet->count; i++) {
        const struct sheet_row *row = &sheet->rows[i];
        if (!row->errors)
            continue;
        cJSON *item = cJSON_CreateObject(), *noise;
        cJSON_AddStringToObject(item, "pass", row->pass);
        cJSON_AddStringToObject(item, "resource", row->name);
        noise = cJSON_AddObjectToObject(item, measured_names[MEASURED_NOISE]);
        for (int side = 0; side < 2; side++)
            add_errors(noise, sheet->labels[side], &row->errors->noise[side]);
        add_errors(item, measured_names[sheet->kind], &row->errors->between);
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
static uint32_t collect(const struct sheet *const *sheets, uint32_t count, struct bound *bounds)
{
    uint32_t found = 0;
    for (uint32_t p = 0; p < count; p++)
        for (uint32_t i = 0; i < sheets[p]->count; i++) {
            const struct sheet_row *row = &sheets[p]->rows[i];
            uint32_t k = 0;
            if (!row->errors)
                continue;
            while (k < found && strcmp(bounds[k].key, row->key) != 0)
                k++;
            if (k == found)
                bounds[found++] = (struct bound){.key = row->key, .resource = row->resource};
            for (int side = 0; side < 2; side++)
                errors_join(&bounds[k].kinds[MEASURED_NOISE], &row->errors->noise[side]);
            errors_join(&bounds[k].kinds[sheets[p]->kind], &row->errors->between);
            errors_join(&bounds[k].exact, &row->errors->exact);
        }
    for (uint32_t k = 0; k < found; k++)
        for (int i = 0; i < MEASURED_KINDS; i++)
            errors_join(&bounds[k].all, &bounds[k].kinds[i]);
    return found;
}

bool measured_write(const struct sheet *const *sheets, uint32_t count, const char *path,
                    struct console *console)
{
    struct file_draft draft;
    uint32_t rows = 0;
    for (uint32_t p = 0; p < count; p++)
        rows += sheets[p]->count;
    struct bound *bounds = calloc(rows + 1, sizeof *bounds);
    if (!bounds || !file_draft_begin(&draft, &console->log)) {
        if (!bounds)
            report_error(&console->log, "out of memory");
        else
            file_draft_discard(&draft);
        free(bounds);
        return false;
    }
    uint32_t found = collect(sheets, count, bounds);
    fprintf(
        draft.out,
        "# compare --measure %u --write-contracts: all of these runs keep them, and they are as "
        "tight as that.\nmeasured: %u\n",
        sheets[0]->runs, sheets[0]->runs);
    for (uint32_t k = 0; k < found; k++) {
        if (bounds[k].all.odd)
            report_message(
                &console->log, DT_WARNING,
                "%s: missing, NaN, Inf or other sizes in some runs: no contract allows them",
                bounds[k].key);
        write_bound(draft.out, &bounds[k]);
    }
    free(bounds);
    return file_draft_end(&draft, path, &console->log);
}

/* ---- Growth ------------------------------------------------------------------------------------ */

/* `error` is in the contract's measure. */
static void compare_with(const struct kept_contract *kept, enum measured_kind kind,
                         const char *side, const char *name, double error)
{
    double before = kept->measured[kind];
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

/* The largest error in the contract's own measure. */
static double difference_error(const struct difference *difference)
{
    enum dt_contract_kind kind = difference->contract.kind;
    bool counted = kind == DT_CONTRACT_FLIPS || kind == DT_CONTRACT_RASTER;
    return counted                   ? (double)difference->differing
           : difference->worst.valid ? difference->worst.error
                                     : 0;
}

void measured_grown(const struct sheet *sheet)
{
    for (uint32_t i = 0; i < sheet->count; i++) {
        const struct sheet_row *row = &sheet->rows[i];
        if (!row->kept || !row->compared)
            continue;
        if (!row->errors) {
            compare_with(row->kept, sheet->kind, "", row->key, difference_error(&row->difference));
            continue;
        }
        for (int side = 0; side < 2; side++)
            compare_with(row->kept, MEASURED_NOISE, sheet->labels[side], row->key,
                         errors_under(&row->errors->noise[side], &row->kept->contract));
        compare_with(row->kept, sheet->kind, "", row->key,
                     errors_under(&row->errors->between, &row->kept->contract));
    }
}
