/* Reads --contracts of `compare A B`:
 *
 *   default: {ulp: 1}
 *   radiance: {rel: 1e-3}            a resource, after any pass
 *   tonemap.display: exact           after this pass
 *   picture: {max: 0.02, outliers: 0.001}
 *
 * See dumps.h. */
#include <stdlib.h>
#include <string.h>

#include "console/console.h"
#include "scenes/reader.h"
#include "theirs/dumps.h"

struct reading {
    struct dumps *dumps;
    struct key *keys; /* default, then the resources, then PASS.RESOURCE */
    size_t count;
};

enum { ULP, ABS, REL, MAX, OUTLIERS, BOUNDS };

static bool read_bounds(struct reader *reader, const struct key *key, struct dt_contract *contract)
{
    struct key bounds[BOUNDS] = {
        KEY_OF_NUMBERS("ulp", false, 1, 0, 1e9, 0), KEY_OF_NUMBERS("abs", false, 1, 0, 1e30, 0),
        KEY_OF_NUMBERS("rel", false, 1, 0, 1e9, 0), KEY_OF_NUMBERS("max", false, 1, 0, 1e30, 0),
        KEY_OF_NUMBERS("outliers", false, 1, 0, 1, 0)};
    static const enum dt_contract_kind kinds[] = {DT_CONTRACT_ULP, DT_CONTRACT_ABS, DT_CONTRACT_REL,
                                                  DT_CONTRACT_IMAGE};
    int given = 0;
    reader_mapping(reader, key->node, key->name_node, key->name, bounds, BOUNDS);
    for (int i = ULP; i <= MAX; i++)
        if (bounds[i].given && reader_range(reader, &bounds[i])) {
            given++;
            contract->kind = kinds[i];
            contract->tolerance = bounds[i].number[0];
        }
    contract->outliers = bounds[OUTLIERS].number[0];
    if (given != 1 && reader->errors == 0)
        reader_report(reader, key->name_node,
                      "a contract is `exact`, or has one of `ulp`, `abs`, `rel` and `max`");
    return given == 1 && (!bounds[OUTLIERS].given || reader_range(reader, &bounds[OUTLIERS]));
}

static void read_contracts(struct reader *reader, struct fy_node *root, void *user)
{
    struct reading *reading = user;
    struct dumps *dumps = reading->dumps;
    reader_mapping(reader, root, root, "the file", reading->keys, reading->count);
    for (size_t i = 0; i < reading->count; i++) {
        const struct key *key = &reading->keys[i];
        struct their_contract *contract = &dumps->contracts[dumps->contract_count];
        if (!key->node)
            continue;
        *contract = (struct their_contract){.name = key->name};
        const char *text = fy_node_is_scalar(key->node) ? fy_node_get_scalar0(key->node) : NULL;
        if (text && strcmp(text, "exact") != 0)
            reader_report(reader, key->node, "a contract is `exact`, or like {ulp: 1}");
        else if (text ||
                 (fy_node_is_mapping(key->node) && read_bounds(reader, key, &contract->contract)))
            dumps->contract_count++;
    }
}

static void add_contract_key(struct reading *reading, const char *name)
{
    for (size_t i = 0; i < reading->count; i++)
        if (!strcmp(reading->keys[i].name, name))
            return;
    reading->keys[reading->count++] = (struct key){.name = name, .type = KEY_MAPPING_OR_TEXT};
}

bool dumps_contracts(struct dumps *dumps, const char *path)
{
    static const struct file_kind kind = {"contracts", "`default` and names of resources",
                                          read_contracts};
    uint32_t count = dumps->count;
    struct reading reading = {.dumps = dumps};
    reading.keys = calloc(2 * (size_t)count + 1, sizeof *reading.keys);
    dumps->contracts = calloc(2 * (size_t)count + 1, sizeof *dumps->contracts);
    bool good = reading.keys && dumps->contracts;
    if (good)
        add_contract_key(&reading, "default");
    for (uint32_t i = 0; i < count && good; i++) {
        add_contract_key(&reading, dumps->matches[i].sides[0]->resource);
        if (dumps->matches[i].place)
            add_contract_key(&reading, dumps->matches[i].place);
    }
    if (!good)
        report_error(&dumps->console->log, "out of memory");
    good = good && reader_file(path, &kind, &reading, &dumps->console->log);
    free(reading.keys);
    return good;
}
