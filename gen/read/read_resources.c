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

static void read_field(struct reader *reader, const struct named *named, struct field *field)
{
    *field = (struct field){.name = named->name, .loc = named->loc};
    struct fields fields;
    if (fy_node_get_type(named->value) == FYNT_SCALAR) {
        set_type(reader, field, node_text(reader, named->value), node_loc(reader, named->value));
    } else if (fields_read(reader, named->value, SECTION_FIELD, named->loc, &fields)) {
        const char *type = field_text(reader, &fields, "type");
        if (type)
            set_type(reader, field, type, field_loc(reader, &fields, "type"));
        double count = field_number(reader, &fields, "count", 0);
        if (field_node(&fields, "count") && (count < 1 || count > 65536))
            diag_error(reader->diag, field_loc(reader, &fields, "count"),
                       "an array has 1 to 65536 elements");
        else if (count > 0)
            field->array_count = (uint32_t)count;
    }
}

/* A struct is a section of free names in a section of free names. `wrapper` makes the inner section
 * readable for fields_named. */
static void read_struct(struct reader *reader, const struct named *named,
                        struct structure *structure)
{
    struct field_value entry = {table_find(SECTION_STRUCTS, "*"), NULL, named->value};
    struct fields wrapper = {
        .section = SECTION_STRUCTS, .loc = named->loc, .values = {entry}, .count = 1};
    *structure = (struct structure){.name = named->name, .loc = named->loc};
    struct named_list list = fields_named(reader, &wrapper, "*");
    structure->fields = reader_alloc(reader, list.count, sizeof *structure->fields);
    for (uint32_t i = 0; structure->fields && i < list.count; i++)
        read_field(reader, &list.items[i], &structure->fields[structure->field_count++]);
    if (!list.count)
        diag_error(reader->diag, named->loc, "the struct `%s` has no fields", named->name);
}

void read_structs(struct reader *reader, const struct fields *top)
{
    struct pipeline *pipeline = &reader->model->pipeline;
    struct named_list list = fields_named(reader, top, "structs");
    pipeline->structs = reader_alloc(reader, list.count, sizeof *pipeline->structs);
    for (uint32_t i = 0; pipeline->structs && i < list.count; i++)
        read_struct(reader, &list.items[i], &pipeline->structs[pipeline->struct_count++]);
}

/* ---- Buffers and images ---------------------------------------------------------------------- */

static void read_buffer_keys(struct reader *reader, const struct named *named,
                             struct resource *buffer)
{
    struct fields fields;
    *buffer =
        (struct resource){.name = named->name, .loc = named->loc, .kind = DT_BUFFER, .share = -1};
    if (!fields_read(reader, named->value, SECTION_BUFFER, named->loc, &fields))
        return;
    buffer->doc = field_text(reader, &fields, "doc");
    buffer->of = argument_text(reader, field_node(&fields, "of"), NULL);
    buffer->of_loc = field_loc(reader, &fields, "of");
    buffer->count = field_expr(reader, &fields, "count");
    buffer->history = field_bool(reader, &fields, "history", false);
    read_content(reader, &fields, buffer);
    if (!field_given(&fields, "count") && !buffer->file)
        diag_error(reader->diag, named->loc, "a buffer needs the key `count`");
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
    image->layers = field_expr(reader, fields, "layers");
    if (volume && (cube || image->layers))
        diag_error(reader->diag, field_loc(reader, fields, "size"),
                   "`%s` has a depth, so it cannot have `%s`", image->name,
                   cube ? "cube" : "layers");
    if (volume) {
        image->shape = DT_SHAPE_3D;
        image->layers = node_expr(reader, fy_node_sequence_get_by_index(size, 2));
    } else if (cube && image->layers) {
        image->shape = DT_SHAPE_CUBE_ARRAY;
    } else if (cube) {
        image->shape = DT_SHAPE_CUBE;
        image->layers =
            expr_parse(reader->model, "6", field_loc(reader, fields, "cube"), NULL, reader->diag);
    }
}

static void read_image_keys(struct reader *reader, const struct named *named,
                            struct resource *image)
{
    struct fields fields;
    *image =
        (struct resource){.name = named->name, .loc = named->loc, .kind = DT_IMAGE, .share = -1};
    image->format = DT_FORMAT_RGBA8;
    if (!fields_read(reader, named->value, SECTION_IMAGE, named->loc, &fields))
        return;
    image->doc = field_text(reader, &fields, "doc");
    image->format = (enum dt_format)field_choice(reader, &fields, "format", DT_FORMAT_RGBA8);
    struct fy_node *size = field_node(&fields, "size");
    if (size && fy_node_get_type(size) == FYNT_SEQUENCE) {
        image->width = node_expr(reader, fy_node_sequence_get_by_index(size, 0));
        image->height = node_expr(reader, fy_node_sequence_get_by_index(size, 1));
    } else {
        struct loc loc = field_loc(reader, &fields, "size");
        image->width = expr_parse(reader->model, "frame.width", loc, NULL, reader->diag);
        image->height = expr_parse(reader->model, "frame.height", loc, NULL, reader->diag);
    }
    read_shape(reader, &fields, size, image);
    image->mips = field_expr(reader, &fields, "mips");
    image->filter_mips = field_bool(reader, &fields, "filter_mips", false);
    image->history = field_bool(reader, &fields, "history", false);
    image->srgb = field_choice(reader, &fields, "encoding", 0) == 1;
    image->encoding_is_given = field_given(&fields, "encoding");
    image->encoding_loc = field_loc(reader, &fields, "encoding");
    read_content(reader, &fields, image);
    if (!field_given(&fields, "size") && !image->input)
        diag_error(reader->diag, named->loc, "an image needs the key `size`");
    read_clear(reader, field_node(&fields, "clear"), image);
}

void read_resources(struct reader *reader, const struct fields *top)
{
    struct pipeline *pipeline = &reader->model->pipeline;
    struct named_list buffers = fields_named(reader, top, "buffers"),
                      images = fields_named(reader, top, "images");
    pipeline->resources = reader_alloc(reader, buffers.count + images.count + SANITIZE_RESOURCES,
                                       sizeof *pipeline->resources);
    if (!pipeline->resources)
        return;
    for (uint32_t i = 0; i < buffers.count; i++)
        read_buffer_keys(reader, &buffers.items[i],
                         &pipeline->resources[pipeline->resource_count++]);
    for (uint32_t i = 0; i < images.count; i++)
        read_image_keys(reader, &images.items[i], &pipeline->resources[pipeline->resource_count++]);
    for (uint32_t i = 0; i < pipeline->resource_count; i++)
        pipeline->resources[i].index = i;
}

/* ---- Samplers, metrics, interleaves ---------------------------------------------------------- */

static void read_sampler(struct reader *reader, const struct named *named, struct sampler *sampler)
{
    static const char *const points[] = {"count", "map", NULL};
    static const char *const filters[] = {"filter",  "mip_filter", "wrap", "border",
                                          "compare", "anisotropy", NULL};
    struct fields fields;
    *sampler = (struct sampler){.name = named->name, .loc = named->loc, .anisotropy = 1};
    if (!fields_read(reader, named->value, SECTION_SAMPLER, named->loc, &fields))
        return;
    sampler->kind = (enum sampler_kind)field_choice(reader, &fields, "kind", SAMPLER_FILTER);
    sampler->doc = field_text(reader, &fields, "doc");
    if (!field_node(&fields, "kind"))
        return;
    if (sampler->kind == SAMPLER_HAMMERSLEY) {
        refuse_keys(reader, &fields, "a sampler of kind hammersley", filters);
        sampler->count = field_expr(reader, &fields, "count");
        sampler->map = (enum sampler_map)field_choice(reader, &fields, "map", MAP_SQUARE);
        if (!field_node(&fields, "count"))
            diag_error(reader->diag, named->loc,
                       "a sampler of kind hammersley needs the key `count`");
        return;
    }
    refuse_keys(reader, &fields, "a sampler of kind filter", points);
    sampler->linear = field_choice(reader, &fields, "filter", 0) == 1;
    sampler->linear_mip = field_choice(reader, &fields, "mip_filter", 0) == 1;
    sampler->wrap = (enum dt_wrap)field_choice(reader, &fields, "wrap", DT_WRAP_CLAMP);
    sampler->border = (enum dt_border)field_choice(reader, &fields, "border", 0);
    if (field_given(&fields, "border") && sampler->wrap != DT_WRAP_BORDER)
        diag_error(reader->diag, field_loc(reader, &fields, "border"),
                   "`%s` has a border colour, but not `wrap: border`", sampler->name);
    sampler->compare = field_bool(reader, &fields, "compare", false);
    sampler->anisotropy = field_number(reader, &fields, "anisotropy", 1);
    if (sampler->anisotropy < 1 || sampler->anisotropy > 16)
        diag_error(reader->diag, field_loc(reader, &fields, "anisotropy"), "anisotropy is 1 to 16");
}

void read_samplers(struct reader *reader, const struct fields *top)
{
    struct pipeline *pipeline = &reader->model->pipeline;
    struct named_list list = fields_named(reader, top, "samplers");
    pipeline->samplers = reader_alloc(reader, list.count, sizeof *pipeline->samplers);
    for (uint32_t i = 0; pipeline->samplers && i < list.count; i++)
        read_sampler(reader, &list.items[i], &pipeline->samplers[pipeline->sampler_count++]);
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

static void read_metric(struct reader *reader, const struct named *named, struct metric *metric)
{
    struct fields fields;
    *metric = (struct metric){.name = named->name,
                              .loc = named->loc,
                              .position_field = "position",
                              .normal_field = "normal",
                              .scale = "scene_radius"};
    if (!fields_read(reader, named->value, SECTION_METRIC, named->loc, &fields))
        return;
    metric->doc = field_text(reader, &fields, "doc");
    metric->position = read_weight(reader, &fields, "position");
    metric->normal = read_weight(reader, &fields, "normal");
    if (field_node(&fields, "position_field"))
        metric->position_field = field_text(reader, &fields, "position_field");
    if (field_node(&fields, "normal_field"))
        metric->normal_field = field_text(reader, &fields, "normal_field");
    if (field_node(&fields, "scale"))
        metric->scale = field_text(reader, &fields, "scale");
    metric->normal_term =
        (enum normal_term)field_choice(reader, &fields, "normal_term", TERM_ONE_MINUS_DOT);
}

void read_metrics(struct reader *reader, const struct fields *top)
{
    struct pipeline *pipeline = &reader->model->pipeline;
    struct named_list list = fields_named(reader, top, "metrics");
    pipeline->metrics = reader_alloc(reader, list.count, sizeof *pipeline->metrics);
    for (uint32_t i = 0; pipeline->metrics && i < list.count; i++)
        read_metric(reader, &list.items[i], &pipeline->metrics[pipeline->metric_count++]);
}

void read_interleaves(struct reader *reader, const struct fields *top)
{
    struct pipeline *pipeline = &reader->model->pipeline;
    struct named_list list = fields_named(reader, top, "interleaves");
    pipeline->interleaves = reader_alloc(reader, list.count, sizeof *pipeline->interleaves);
    for (uint32_t i = 0; pipeline->interleaves && i < list.count; i++) {
        struct named *named = &list.items[i];
        struct interleave *interleave = &pipeline->interleaves[pipeline->interleave_count++];
        *interleave = (struct interleave){.name = named->name, .loc = named->loc, .tile = {1, 1}};
        struct fields fields;
        if (!fields_read(reader, named->value, SECTION_INTERLEAVE, named->loc, &fields))
            continue;
        interleave->doc = field_text(reader, &fields, "doc");
        interleave->x = field_expr(reader, &fields, "x");
        interleave->y = field_expr(reader, &fields, "y");
    }
}

/* ---- Contracts ------------------------------------------------------------------------------- */

static double read_tolerance(struct reader *reader, const struct fields *fields, const char *key)
{
    double tolerance = field_amount(reader, fields, key, 0);
    if (tolerance < 0)
        diag_error(reader->diag, field_loc(reader, fields, key), "a tolerance cannot be negative");
    return tolerance;
}

static void read_outliers(struct reader *reader, const struct fields *fields,
                          struct dt_contract *contract)
{
    contract->outliers = field_amount(reader, fields, "outliers", 0);
    if (contract->outliers < 0 || contract->outliers > 1)
        diag_error(reader->diag, field_loc(reader, fields, "outliers"),
                   "a share is 0 to 1, or 0%% to 100%%");
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
        diag_error(reader->diag, field_loc(reader, &fields, "outliers"),
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
        for (uint32_t k = 0; k < pipeline->resource_count; k++)
            pipeline->resources[k].contract = contract;
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
