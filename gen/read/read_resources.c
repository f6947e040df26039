/* Structs, buffers, images, samplers, metrics, interleaves and contracts of a spec. */
#include <stdlib.h>
#include <string.h>

#include "reader.h"
#include "model/sanitize_kinds.h"
#include "base/nearest.h"

/* ---- Structs --------------------------------------------------------------------------------- */

/* Parses TYPE or TYPE[N]. */
static void set_type(struct reader *reader, struct field *field, const char *text, struct loc loc)
{
    const struct key *key = table_find(SECTION_FIELD, "type");
    const char *bracket = strchr(text, '[');
    const char *word = arena_strndup(reader->model->arena, text,
                                     bracket ? (size_t)(bracket - text) : strlen(text));
    if (!word)
        return;
    int type = table_choice(key->choices, word);
    if (bracket) {
        char *end;
        unsigned long count = strtoul(bracket + 1, &end, 10);
        if (end == bracket + 1 || strcmp(end, "]") || !count || count > 65536)
            diag_error(reader->diag, loc,
                       "`%s` is no type; an array is written TYPE[N], N from 1 to 65536", text);
        else
            field->array_count = (uint32_t)count;
    }
    if (type == DT_TYPE_BOOL) {
        diag_error(reader->diag, loc, "bool has no layout in a buffer; use uint");
    } else if (type < 0) {
        static const char *const words[] = {"float", "vec2",  "vec3",  "vec4", "int",
                                            "ivec2", "ivec3", "ivec4", "uint", "uvec2",
                                            "uvec3", "uvec4", "mat4"};
        diag_error(reader->diag, loc, "unknown type `%s`%s", word,
                   name_hint('`', word, words, DT_ARRAY_COUNT(words),
                             "; a field is float, int, uint, a vector of them or mat4")
                       .text);
    } else {
        field->type = (enum dt_type)type;
    }
}

static void finish_field(struct reader *reader, const struct fields *fields, void *record)
{
    struct field *field = record;
    struct fy_node *count = field_node(fields, "count");
    uint32_t elements = field->array_count;
    const char *type = field_text(reader, fields, "type");
    field->array_count = 0;
    if (type)
        set_type(reader, field, type, field_loc(reader, fields, "type"));
    if (count && (elements < 1 || elements > 65536))
        node_error(reader, count, "an array has 1 to 65536 elements");
    else if (count)
        field->array_count = elements;
}

/* A struct is a section of free names in a section of free names. `wrapper` makes the inner section
 * readable for entries_read. */
static void finish_struct(struct reader *reader, const struct fields *fields, void *record)
{
    static const struct entries kind = {"*", sizeof(struct field), NULL, finish_field, false};
    struct structure *structure = record;
    struct fields wrapper = {.section = SECTION_STRUCTS, .loc = fields->loc, .count = 1};
    wrapper.values[0] = (struct field_value){table_find(SECTION_STRUCTS, "*"), NULL, fields->node};
    structure->fields = entries_read(reader, &wrapper, &kind, &structure->field_count);
    if (!structure->field_count)
        diag_error(reader->diag, fields->loc, "the struct `%s` has no fields", structure->name);
}

void read_structs(struct reader *reader, const struct fields *top)
{
    static const struct entries kind = {"structs", sizeof(struct structure), NULL, finish_struct,
                                        false};
    struct pipeline *pipeline = &reader->model->pipeline;
    pipeline->structs = entries_read(reader, top, &kind, &pipeline->struct_count);
}

/* ---- Buffers and images ---------------------------------------------------------------------- */

static void finish_buffer(struct reader *reader, const struct fields *fields, void *record)
{
    struct resource *buffer = record;
    buffer->of = argument_text(reader, field_node(fields, "of"), NULL);
    read_content(reader, fields, buffer);
    if (!field_given(fields, "count") && !buffer->file)
        diag_error(reader->diag, fields->loc, "a buffer needs the key `count`");
}

static void read_clear(struct reader *reader, struct fy_node *node, struct resource *image)
{
    double fallback = image->format == DT_FORMAT_D32F ? 1 : 0;
    for (int i = 0; i < 4; i++)
        image->clear[i] = fallback;
    const char *text = node_text(reader, node);
    if (text) { /* one number for all components */
        for (int i = 0; i < 4; i++)
            text_number(text, &image->clear[i]);
    } else if (node) {
        for (int i = 0; i < fy_node_sequence_item_count(node); i++)
            text_number(node_text(reader, fy_node_sequence_get_by_index(node, i)),
                        &image->clear[i]);
    }
}

/* `layers`, `cube` and the third part of `size`. */
static void read_shape(struct reader *reader, const struct fields *fields, struct fy_node *size,
                       struct resource *image)
{
    bool cube = field_bool(reader, fields, "cube", false);
    bool volume =
        size && fy_node_get_type(size) == FYNT_SEQUENCE && fy_node_sequence_item_count(size) == 3;
    if (volume && (cube || image->layers))
        key_error(reader, fields, "size", "`%s` has a depth, so it cannot have `%s`", image->name,
                  cube ? "cube" : "layers");
    if (volume) {
        image->shape = DT_SHAPE_3D;
        image->layers = node_expr(reader, fy_node_sequence_get_by_index(size, 2));
    } else if (cube && image->layers) {
        image->shape = DT_SHAPE_CUBE_ARRAY;
    } else if (cube) {
        image->shape = DT_SHAPE_CUBE;
        image->layers = number_expr(reader, 6, field_loc(reader, fields, "cube"));
    }
}

static void finish_image(struct reader *reader, const struct fields *fields, void *record)
{
    struct resource *image = record;
    struct fy_node *size = field_node(fields, "size");
    if (size && fy_node_get_type(size) == FYNT_SEQUENCE) {
        image->width = node_expr(reader, fy_node_sequence_get_by_index(size, 0));
        image->height = node_expr(reader, fy_node_sequence_get_by_index(size, 1));
    } else {
        struct loc loc = field_loc(reader, fields, "size");
        image->width = expr_parse(reader->model, "frame.width", loc, NULL, reader->diag);
        image->height = expr_parse(reader->model, "frame.height", loc, NULL, reader->diag);
    }
    read_shape(reader, fields, size, image);
    image->encoding_is_given = field_given(fields, "encoding");
    read_content(reader, fields, image);
    if (!field_given(fields, "size") && !image->input)
        diag_error(reader->diag, fields->loc, "an image needs the key `size`");
    read_clear(reader, field_node(fields, "clear"), image);
}

void read_resources(struct reader *reader, const struct fields *top)
{
    static const struct resource buffer = {.kind = DT_BUFFER, .share = -1};
    static const struct resource image = {.kind = DT_IMAGE, .share = -1, .format = DT_FORMAT_RGBA8};
    static const struct entries kinds[] = {
        {"buffers", sizeof buffer, &buffer, finish_buffer, false},
        {"images", sizeof image, &image, finish_image, false}};
    struct pipeline *pipeline = &reader->model->pipeline;
    uint32_t counts[2];
    struct resource *lists[2];
    for (int i = 0; i < 2; i++)
        lists[i] = entries_read(reader, top, &kinds[i], &counts[i]);
    pipeline->resources = reader_alloc(reader, counts[0] + counts[1] + SANITIZE_RESOURCES,
                                       sizeof *pipeline->resources);
    for (int i = 0; i < 2 && pipeline->resources; i++)
        for (uint32_t k = 0; k < counts[i]; k++) {
            lists[i][k].index = pipeline->resource_count;
            pipeline->resources[pipeline->resource_count++] = lists[i][k];
        }
}

/* ---- Samplers, metrics, interleaves ---------------------------------------------------------- */

static void finish_sampler(struct reader *reader, const struct fields *fields, void *record)
{
    struct sampler *sampler = record;
    sampler->kind = (enum sampler_kind)field_choice(reader, fields, "kind", SAMPLER_FILTER);
    bool points = sampler->kind == SAMPLER_HAMMERSLEY;
    if (field_node(fields, "kind"))
        record_read(reader, fields, points ? OF_POINTS : OF_FILTER, sampler);
    if (points && !field_node(fields, "count"))
        diag_error(reader->diag, fields->loc, "a sampler of kind hammersley needs the key `count`");
    if (!points && field_given(fields, "border") && sampler->wrap != DT_WRAP_BORDER)
        key_error(reader, fields, "border", "`%s` has a border colour, but not `wrap: border`",
                  sampler->name);
    if (sampler->anisotropy < 1 || sampler->anisotropy > 16)
        key_error(reader, fields, "anisotropy", "anisotropy is 1 to 16");
}

static struct weight read_weight(struct reader *reader, const struct fields *fields,
                                 const char *key)
{
    const char *text = field_text(reader, fields, key);
    struct weight weight = {.loc = field_loc(reader, fields, key)};
    if (text && !text_number(text, &weight.value))
        weight.param = text;
    if (weight.value < 0)
        diag_error(reader->diag, weight.loc, "a weight cannot be negative");
    return weight;
}

static void finish_metric(struct reader *reader, const struct fields *fields, void *record)
{
    struct metric *metric = record;
    metric->position = read_weight(reader, fields, "position");
    metric->normal = read_weight(reader, fields, "normal");
}

void read_functions(struct reader *reader, const struct fields *top)
{
    static const struct sampler sampler = {.kind = SAMPLER_FILTER, .anisotropy = 1};
    static const struct interleave interleave = {.tile = {1, 1}};
    static const struct entries samplers = {"samplers", sizeof sampler, &sampler, finish_sampler,
                                            true};
    static const struct entries metrics = {"metrics", sizeof(struct metric), NULL, finish_metric,
                                           false};
    static const struct entries interleaves = {"interleaves", sizeof interleave, &interleave, NULL,
                                               false};
    struct pipeline *pipeline = &reader->model->pipeline;
    pipeline->samplers = entries_read(reader, top, &samplers, &pipeline->sampler_count);
    pipeline->metrics = entries_read(reader, top, &metrics, &pipeline->metric_count);
    pipeline->interleaves = entries_read(reader, top, &interleaves, &pipeline->interleave_count);
}

/* ---- Contracts ------------------------------------------------------------------------------- */

static double read_tolerance(struct reader *reader, const struct fields *fields, const char *key)
{
    double tolerance = field_amount(reader, fields, key, 0);
    if (tolerance < 0)
        key_error(reader, fields, key, "a tolerance cannot be negative");
    return tolerance;
}

static void read_outliers(struct reader *reader, const struct fields *fields,
                          struct dt_contract *contract)
{
    contract->outliers = field_amount(reader, fields, "outliers", 0);
    if (contract->outliers < 0 || contract->outliers > 1)
        key_error(reader, fields, "outliers", "a share is 0 to 1, or 0%% to 100%%");
}

static void read_image_contract(struct reader *reader, struct fy_node *node, struct loc loc,
                                struct dt_contract *contract)
{
    struct fields fields;
    if (!fields_read(reader, node, SECTION_IMAGE_CONTRACT, loc, &fields))
        return;
    contract->tolerance = read_tolerance(reader, &fields, "max");
    read_outliers(reader, &fields, contract);
}

static struct contract read_contract(struct reader *reader, const struct named *named)
{
    static const char *const kinds[] = {"ulp",   "abs",    "rel",     "image",
                                        "flips", "raster", "of_exact"};
    struct contract contract = {.allowed = {.margin_field = -1}, .loc = named->loc};
    struct dt_contract *allowed = &contract.allowed;
    struct fields fields;
    size_t found = 0;
    if (fy_node_get_type(named->value) != FYNT_MAPPING ||
        !fields_read(reader, named->value, SECTION_CONTRACT, named->loc, &fields))
        return contract;
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        if (!field_node(&fields, kinds[i]))
            continue;
        found++;
        contract.loc = field_loc(reader, &fields, kinds[i]);
        allowed->kind = (enum dt_contract_kind)(DT_CONTRACT_ULP + i);
        if (allowed->kind == DT_CONTRACT_IMAGE)
            read_image_contract(reader, field_node(&fields, "image"), contract.loc, allowed);
        else
            allowed->tolerance = read_tolerance(reader, &fields, kinds[i]);
        if (allowed->kind == DT_CONTRACT_RASTER && allowed->tolerance > 1)
            diag_error(reader->diag, contract.loc, "a share is 0 to 1, or 0%% to 100%%");
    }
    if (allowed->kind == DT_CONTRACT_OF_EXACT)
        read_outliers(reader, &fields, allowed);
    else if (field_node(&fields, "outliers"))
        key_error(reader, &fields, "outliers",
                  "`outliers` is only allowed beside `of_exact`, and in `image`");
    contract.margin = field_text(reader, &fields, "margin");
    contract.margin_loc = field_loc(reader, &fields, "margin");
    if (contract.margin && !field_node(&fields, "flips"))
        diag_error(reader->diag, contract.margin_loc, "`margin` is only allowed beside `flips`");
    if (found != 1 && fields.count == found + !!contract.margin + !!field_node(&fields, "outliers"))
        diag_error(reader->diag, named->loc,
                   "a contract has exactly one of `ulp`, `abs`, `rel`, `image`, `flips`, `raster`, "
                   "`of_exact`");
    return contract;
}

/* Included files may have a contract for the same name. */
static void refuse_second(struct reader *reader, const struct named_list *list)
{
    for (uint32_t i = 0; i < list->count; i++)
        for (uint32_t k = 0; k < i; k++)
            if (!strcmp(list->items[k].name, list->items[i].name)) {
                diag_error(reader->diag, list->items[i].loc, "a second contract for `%s`",
                           list->items[i].name);
                diag_note(reader->diag, list->items[k].loc, "first here");
            }
}

/* Called after read_resources. Applies `default` first, wherever it is in the map. */
void read_contracts(struct reader *reader, const struct fields *top)
{
    struct pipeline *pipeline = &reader->model->pipeline;
    struct named_list list = fields_named(reader, top, "contracts");
    refuse_second(reader, &list);
    for (uint32_t i = 0; i < list.count; i++) {
        if (strcmp(list.items[i].name, "default"))
            continue;
        struct contract contract = read_contract(reader, &list.items[i]);
        if (contract.allowed.kind >= DT_CONTRACT_IMAGE &&
            contract.allowed.kind <= DT_CONTRACT_RASTER) {
            diag_error(reader->diag, contract.loc,
                       "`default` cannot have `%s`; set it for single resources",
                       contract.allowed.kind == DT_CONTRACT_IMAGE   ? "image"
                       : contract.allowed.kind == DT_CONTRACT_FLIPS ? "flips"
                                                                    : "raster");
            continue;
        }
        CHANGE_EACH(resource, pipeline->resources, pipeline->resource_count)
            resource->contract = contract;
    }
    for (uint32_t i = 0; i < list.count; i++) {
        struct resource *resource = declared_find(pipeline, DECLARED_RESOURCE, list.items[i].name);
        if (!strcmp(list.items[i].name, "default"))
            continue;
        if (resource)
            resource->contract = read_contract(reader, &list.items[i]);
        else
            diag_error(reader->diag, list.items[i].loc, "no buffer or image `%s`%s",
                       list.items[i].name,
                       declared_hint(pipeline, DECLARED_RESOURCE, list.items[i].name, "").text);
    }
}
