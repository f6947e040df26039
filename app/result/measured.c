/* Errors of all runs, for `compare --measure`; see measured.h. This file measures them and hands them over;
 * app/python/diptych/measured.py prints the table and writes the contracts. */
#include "result/measured.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "console/python.h"

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

/* ---- JSON -------------------------------------------------------------------------------------- */

/* `steps`: with those that contracts are chosen by. */
static void add_errors(cJSON *root, const char *name, const struct errors *errors, bool steps)
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
    cJSON_AddNumberToObject(item, "of_exact", errors->of_exact);
    cJSON *beyond = steps ? cJSON_AddArrayToObject(item, "beyond") : NULL;
    for (int i = 0; i < ERROR_STEPS && steps; i++)
        cJSON_AddItemToArray(beyond, cJSON_CreateNumber((double)errors->beyond[i]));
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
            add_errors(noise, sheet->labels[side], &row->errors->noise[side], false);
        add_errors(item, measured_names[sheet->kind], &row->errors->between, false);
        cJSON_AddItemToArray(list, item);
    }
    return list;
}

/* ---- Table and contracts ----------------------------------------------------------------------- */

static bool has_integers(const struct dt_resource *resource)
{
    bool whole = true;
    if (resource->kind == DT_IMAGE)
        return number_is_integer(format_info(resource->format)->kind);
    for (uint32_t i = 0; i < resource->field_count; i++)
        whole &= type_info(resource->fields[i].type)->scalar != DT_TYPE_FLOAT;
    return whole;
}

static cJSON *row_json(const struct sheet_row *row)
{
    const struct dt_resource *resource = row->resource;
    bool image = resource->kind == DT_IMAGE;
    cJSON *item = cJSON_CreateObject();
    cJSON_AddStringToObject(item, "pass", row->pass);
    cJSON_AddStringToObject(item, "name", row->name);
    cJSON_AddStringToObject(item, "key", row->key);
    cJSON_AddBoolToObject(item, "breaks", breaks(row));
    cJSON_AddBoolToObject(item, "image", image);
    cJSON_AddBoolToObject(item, "integers", has_integers(resource));
    cJSON_AddBoolToObject(item, "codes", image && number_one(format_info(resource->format)->kind));
    contract_json(item, &resource->contract);
    add_errors(item, "first", &row->errors->noise[0], true);
    add_errors(item, "second", &row->errors->noise[1], true);
    add_errors(item, "between", &row->errors->between, true);
    add_errors(item, "exact", &row->errors->exact, true);
    return item;
}

/* `path`: of contracts; NULL: the table. */
static bool hand_measured(const struct sheet *const *sheets, uint32_t count, const char *path,
                          struct console *console)
{
    cJSON *request = cJSON_CreateObject(), *list = cJSON_AddArrayToObject(request, "sheets");
    for (uint32_t i = 0; i < count; i++) {
        cJSON *item = cJSON_CreateObject();
        cJSON_AddItemToObject(item, "labels", cJSON_CreateStringArray(sheets[i]->labels, 2));
        cJSON_AddStringToObject(item, "kind", measured_names[sheets[i]->kind]);
        cJSON *rows = cJSON_AddArrayToObject(item, "rows");
        for (uint32_t k = 0; k < sheets[i]->count; k++)
            if (sheets[i]->rows[k].errors)
                cJSON_AddItemToArray(rows, row_json(&sheets[i]->rows[k]));
        cJSON_AddItemToArray(list, item);
    }
    cJSON_AddNumberToObject(request, "runs", sheets[0]->runs);
    cJSON_AddStringToObject(request, "write_contracts", path);
    fflush(stdout);
    return python_child(console, "measured", "writing the contracts", request,
                        path ? -1 : STDOUT_FILENO);
}

bool measured_print(const struct sheet *sheet, struct console *console)
{
    return hand_measured(&sheet, 1, NULL, console);
}

bool measured_write(const struct sheet *const *sheets, uint32_t count, const char *path,
                    struct console *console)
{
    return hand_measured(sheets, count, path, console);
}

/* ---- Growth ------------------------------------------------------------------------------------ */

/* `error` is in the contract's measure. */
static void compare_with(const struct kept_contract *kept, enum measured_kind kind,
                         const char *side, const char *name, double error)
{
    static const char *const titles[MEASURED_KINDS] = {"noise of ", "drift",
                                                       "difference of backends"};
    double before = kept->measured[kind];
    if (isnan(before) || !(error > before * (1 + 1e-5)))
        return;
    printf("grown: %s, %s%s: ", name, titles[kind], side);
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
