/* Reads contracts; see contracts.h. */
#include "result/contracts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "base/yaml_file.h"

const char *const measured_names[MEASURED_KINDS] = {"noise", "drift", "backends"};

struct reading {
    struct contracts *contracts;
    struct key *keys;
    size_t count; /* without "measured", which is the last */
};

/* In the order of enum dt_contract_kind, which begins with exact. */
enum {
    ULP,
    ABS,
    REL,
    IMAGE,
    FLIPS,
    RASTER,
    OF_EXACT,
    MARGIN,
    OUTLIERS,
    MEASURED,
    BOUNDS = MEASURED + MEASURED_KINDS
};

/* A number, A/B or P%, not negative. */
static double read_amount(struct reader *reader, const struct key *key, double most)
{
    const char *text = fy_node_is_scalar(key->node) ? fy_node_get_scalar0(key->node) : NULL;
    double value = 0;
    if (text && (!text_amount(text, &value) || value < 0 || value > most)) /* else reported */
        reader_report(reader, key->node, "`%s` is a number from 0 to %g, like 0.01, 2/255 or 1%%",
                      key->name, most);
    return value;
}

static void read_image(struct reader *reader, const struct key *key, struct dt_contract *contract)
{
    struct key keys[] = {{.name = "max", .type = KEY_TEXT, .required = true},
                         {.name = "outliers", .type = KEY_TEXT}};
    reader_mapping(reader, key->node, key->name_node, key->name, keys, 2);
    if (keys[0].node)
        contract->tolerance = read_amount(reader, &keys[0], 1e30);
    if (keys[1].node)
        contract->outliers = read_amount(reader, &keys[1], 1);
}

static void read_bounds(struct reader *reader, const struct key *key, struct kept_contract *kept)
{
    struct key keys[BOUNDS] = {{.name = "ulp"},      {.name = "abs"},
                               {.name = "rel"},      {.name = "image", .type = KEY_MAPPING},
                               {.name = "flips"},    {.name = "raster"},
                               {.name = "of_exact"}, {.name = "margin"},
                               {.name = "outliers"}};
    struct dt_contract *contract = &kept->contract;
    int given = 0;
    for (int i = 0; i < MEASURED_KINDS; i++)
        keys[MEASURED + i].name = measured_names[i];
    reader_mapping(reader, key->node, key->name_node, key->name, keys, BOUNDS);
    for (int i = ULP; i <= OF_EXACT; i++) {
        if (!keys[i].node)
            continue;
        given++;
        contract->kind = (enum dt_contract_kind)(DT_CONTRACT_ULP + i);
        if (i == IMAGE && fy_node_is_mapping(keys[i].node))
            read_image(reader, &keys[i], contract);
        else if (i != IMAGE)
            contract->tolerance = read_amount(reader, &keys[i], i == RASTER ? 1 : 1e30);
    }
    for (int i = 0; i < MEASURED_KINDS; i++)
        if (keys[MEASURED + i].node)
            kept->measured[i] = read_amount(reader, &keys[MEASURED + i], 1e300);
    if (keys[MARGIN].node && fy_node_is_scalar(keys[MARGIN].node))
        kept->margin = strdup(fy_node_get_scalar0(keys[MARGIN].node));
    if (keys[MARGIN].node && !keys[FLIPS].node)
        reader_report(reader, keys[MARGIN].node, "`margin` is only allowed beside `flips`");
    if (keys[OUTLIERS].node && keys[OF_EXACT].node)
        contract->outliers = read_amount(reader, &keys[OUTLIERS], 1);
    else if (keys[OUTLIERS].node)
        reader_report(reader, keys[OUTLIERS].node,
                      "`outliers` is only allowed beside `of_exact`, and in `image`");
    if (given != 1 && reader->errors == 0)
        reader_report(reader, key->name_node,
                      "a contract is `exact`, or has exactly one of `ulp`, `abs`, `rel`, `image`, "
                      "`flips`, `raster`, `of_exact`");
}

static void read_kept(struct reader *reader, struct fy_node *root, void *user)
{
    struct reading *reading = user;
    struct contracts *contracts = reading->contracts;
    reader_mapping(reader, root, root, "the file", reading->keys, reading->count + 1);
    bool measured = reading->keys[reading->count].given;
    for (size_t i = 0; i < reading->count; i++) {
        const struct key *key = &reading->keys[i];
        if (!key->node)
            continue;
        struct kept_contract *kept = &contracts->list[contracts->count++];
        *kept = (struct kept_contract){.name = key->name, .contract.margin_field = -1};
        const char *text = fy_node_is_scalar(key->node) ? fy_node_get_scalar0(key->node) : NULL;
        for (int k = 0; k < MEASURED_KINDS; k++)
            kept->measured[k] = measured && text ? 0 : NAN;
        if (text && strcmp(text, "exact") != 0)
            reader_report(reader, key->node, "a contract is `exact`, or like {ulp: 1}");
        else if (fy_node_is_mapping(key->node))
            read_bounds(reader, key, kept);
    }
}

static void add_key(struct reading *reading, const char *name)
{
    for (size_t i = 0; i < reading->count; i++)
        if (!strcmp(reading->keys[i].name, name))
            return;
    reading->keys[reading->count++] = (struct key){.name = name, .type = KEY_MAPPING_OR_TEXT};
}

bool contracts_read(struct contracts *contracts, const char *path, const char *const *names,
                    uint32_t count, const struct dt_log *log)
{
    static const struct file_kind kind = {"contracts", "names of resources", read_kept};
    struct reading reading = {.contracts = contracts};
    reading.keys = calloc((size_t)count + 1, sizeof *reading.keys);
    contracts->list = calloc((size_t)count + 1, sizeof *contracts->list);
    bool good = reading.keys && contracts->list;
    for (uint32_t i = 0; i < count && good; i++)
        add_key(&reading, names[i]);
    if (good)
        reading.keys[reading.count] = (struct key)KEY_OF_NUMBERS("measured", false, 1, 1, 1e6, 0);
    else
        report_error(log, "out of memory");
    good = good && reader_file(path, &kind, &reading, log);
    free(reading.keys);
    return good;
}

void contracts_free(struct contracts *contracts)
{
    for (uint32_t i = 0; i < contracts->count; i++)
        free(contracts->list[i].margin);
    free(contracts->list);
    *contracts = (struct contracts){0};
}

const struct kept_contract *contracts_find(const struct contracts *contracts, const char *pass,
                                           const char *resource)
{
    const struct kept_contract *found = NULL;
    size_t length = strlen(pass);
    int best = 0;
    for (uint32_t i = 0; i < contracts->count; i++) {
        const char *name = contracts->list[i].name;
        bool of_pass = !strncmp(name, pass, length) && name[length] == '.' &&
                       !strcmp(name + length + 1, resource);
        int fit = of_pass ? 3 : !strcmp(name, resource) ? 2 : !strcmp(name, "default") ? 1 : 0;
        if (fit > best) {
            best = fit;
            found = &contracts->list[i];
        }
    }
    return found;
}

int16_t contracts_margin(const struct kept_contract *kept, const struct dt_resource *buffer)
{
    size_t length = strlen(buffer->name);
    const char *rest = kept->margin + length;
    if (buffer->kind != DT_BUFFER || strncmp(kept->margin, buffer->name, length) != 0 ||
        (*rest && *rest != '.'))
        return -1;
    for (uint32_t i = 0; i < buffer->field_count; i++)
        if (!strcmp(buffer->fields[i].name, *rest ? rest + 1 : "") &&
            buffer->fields[i].type == DT_TYPE_FLOAT && !buffer->fields[i].array_count)
            return (int16_t)i;
    return -1;
}
