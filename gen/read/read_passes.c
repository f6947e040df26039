/* Passes of a spec. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "reader.h"
#include "model/sanitize_kinds.h"

/* ---- Lists ----------------------------------------------------------------------------------- */

static int list_count(struct fy_node *list)
{
    return list ? fy_node_sequence_item_count(list) : 0;
}

/* Reads a list of references; reports and skips other items. */
static uint32_t read_names(struct reader *reader, struct fy_node *list, const char ***names,
                           struct loc **locs)
{
    uint32_t count = 0;
    *names = reader_alloc(reader, (size_t)list_count(list), sizeof **names);
    *locs = reader_alloc(reader, (size_t)list_count(list), sizeof **locs);
    for (int i = 0; *names && *locs && i < list_count(list); i++) {
        struct fy_node *item = fy_node_sequence_get_by_index(list, i);
        const char *text = referred_name(reader, item);
        if (!text || !is_path(text)) {
            diag_error(reader->diag, node_loc(reader, item), "expected a name");
            continue;
        }
        (*names)[count] = text;
        (*locs)[count++] = node_loc(reader, item);
    }
    return count;
}

/* NULL: off. */
static const struct dt_blend *read_blend(struct reader *reader, const struct fields *fields)
{
    static const struct dt_blend words[] = {
        [2] = {DT_FACTOR_SRC_ALPHA, DT_FACTOR_ONE_MINUS_SRC_ALPHA, DT_BLEND_ADD, DT_FACTOR_ONE,
               DT_FACTOR_ONE_MINUS_SRC_ALPHA, DT_BLEND_ADD},
        [3] = {.dst = DT_FACTOR_ONE_MINUS_SRC_ALPHA, .alpha_dst = DT_FACTOR_ONE_MINUS_SRC_ALPHA},
        [4] = {.op = DT_BLEND_MIN, .alpha_op = DT_BLEND_MIN},
        [5] = {.op = DT_BLEND_MAX, .alpha_op = DT_BLEND_MAX},
        [6] = {DT_FACTOR_DST_COLOR, DT_FACTOR_ZERO, DT_BLEND_ADD, DT_FACTOR_DST_COLOR,
               DT_FACTOR_ZERO, DT_BLEND_ADD},
    };
    struct fy_node *node = field_node(fields, "blend");
    struct fields map;
    if (!node || fy_node_get_type(node) != FYNT_MAPPING) {
        int word = field_choice(reader, fields, "blend", 0);
        return word ? &words[word] : NULL;
    }
    struct dt_blend *blend = reader_alloc(reader, 1, sizeof *blend);
    if (!blend || !fields_read(reader, node, SECTION_BLEND, node_loc(reader, node), &map))
        return NULL;
    blend->src = (enum dt_factor)field_choice(reader, &map, "src", DT_FACTOR_ONE);
    blend->dst = (enum dt_factor)field_choice(reader, &map, "dst", DT_FACTOR_ONE);
    blend->op = (enum dt_blend_op)field_choice(reader, &map, "op", DT_BLEND_ADD);
    blend->alpha_src = (enum dt_factor)field_choice(reader, &map, "alpha_src", (int)blend->src);
    blend->alpha_dst = (enum dt_factor)field_choice(reader, &map, "alpha_dst", (int)blend->dst);
    blend->alpha_op = (enum dt_blend_op)field_choice(reader, &map, "alpha_op", (int)blend->op);
    return blend;
}

/* Inside an instance the body knows a resource by the name in the group. */
static void set_name(struct reader *reader, struct fy_node *node, struct access *access)
{
    const char *text = node_text(reader, node);
    access->name = referred_name(reader, node);
    if (!text || !access->name || (!strcmp(text, access->name) && !strchr(text, '.')))
        return;
    struct text word = {0};
    text_add_word(&word, text);
    access->as = arena_strndup(reader->model->arena, word.data ? word.data : "", word.length);
    access->as_loc = access->loc;
    text_free(&word);
}

static bool read_access(struct reader *reader, struct fy_node *node, enum access_mode mode,
                        struct access *access)
{
    *access = (struct access){
        .mode = mode, .binding = -1, .attachment = -1, .loc = node_loc(reader, node)};
    set_name(reader, node, access);
    if (access->name && is_path(access->name))
        return true;
    if (!node || fy_node_get_type(node) != FYNT_MAPPING) {
        diag_error(reader->diag, access->loc,
                   "expected a resource's name, or a map such as {name: NAME, sampler: NAME}");
        return false;
    }
    struct fields fields;
    if (!fields_read(reader, node, SECTION_ACCESS, access->loc, &fields))
        return false;
    access->loc = field_loc(reader, &fields, "name");
    set_name(reader, field_node(&fields, "name"), access);
    if (field_node(&fields, "as")) {
        access->as = field_text(reader, &fields, "as");
        access->as_loc = field_loc(reader, &fields, "as");
    }
    access->sampler = field_reference(reader, &fields, "sampler");
    access->sampler_loc = field_loc(reader, &fields, "sampler");
    double previous = field_number(reader, &fields, "previous", 0);
    access->previous = previous < UINT16_MAX ? (uint32_t)previous : UINT16_MAX;
    access->mip = field_expr(reader, &fields, "mip");
    access->layer = field_expr(reader, &fields, "layer");
    access->own_blend = field_given(&fields, "blend");
    access->blend = read_blend(reader, &fields);
    access->blend_loc = field_loc(reader, &fields, "blend");
    access->own_mask = field_given(&fields, "mask");
    access->keep = (uint8_t)(14 - field_choice(reader, &fields, "mask", 14));
    access->mask_loc = field_loc(reader, &fields, "mask");
    if (access->layer && mode == MODE_WRITE)
        diag_error(reader->diag, field_loc(reader, &fields, "layer"),
                   "`writes` replaces all layers of a mip; list one layer in `updates`");
    if (access->sampler && mode != MODE_READ)
        diag_error(reader->diag, access->sampler_loc, "only `reads` take a sampler");
    return access->name != NULL;
}

static void read_accesses(struct reader *reader, const struct fields *fields, struct pass *pass)
{
    static const char *const keys[] = {"reads", "writes", "updates"};
    int total = 0;
    for (int k = 0; k < 3; k++)
        total += list_count(field_node(fields, keys[k]));
    pass->accesses =
        reader_alloc(reader, (size_t)total + SANITIZE_ACCESSES, sizeof *pass->accesses);
    for (int k = 0; pass->accesses && k < 3; k++) {
        struct fy_node *list = field_node(fields, keys[k]);
        for (int i = 0; i < list_count(list); i++)
            if (read_access(reader, fy_node_sequence_get_by_index(list, i), (enum access_mode)k,
                            &pass->accesses[pass->access_count]))
                pass->access_count++;
    }
}

static void read_ranges(struct reader *reader, const struct fields *fields, struct pass *pass)
{
    struct named_list list = fields_named(reader, fields, "ranges");
    if (!list.count)
        return;
    pass->ranges = reader_alloc(reader, list.count, sizeof *pass->ranges);
    for (uint32_t i = 0; pass->ranges && i < list.count; i++) {
        struct fields inner;
        struct range *range = &pass->ranges[pass->range_count];
        *range = (struct range){.name = list.items[i].name, .loc = list.items[i].loc, .first = "0"};
        if (!fields_read(reader, list.items[i].value, SECTION_RANGE, range->loc, &inner))
            continue;
        pass->range_count++;
        range->of = field_reference(reader, &inner, "of");
        range->of_loc = field_loc(reader, &inner, "of");
        range->count = field_expr(reader, &inner, "count");
        if (field_node(&inner, "first"))
            range->first = field_text(reader, &inner, "first");
        range->storage = (enum storage_class)field_choice(reader, &inner, "storage", STORAGE_AUTO);
        range->loop = (enum loop_shape)field_choice(reader, &inner, "loop", LOOP_AUTO);
    }
}

struct word_visit {
    struct reader *reader;
    struct pass *pass;
    struct fy_node *node;
    uint32_t count;
};

static void count_word(void *user, const char *word, struct fy_node *at)
{
    struct word_visit *words = user;
    words->count++;
    (void)word, (void)at;
}

/* Not the name of a resource or of a file, which bodies cannot use as a value. */
static void add_word(void *user, const char *word, struct fy_node *at)
{
    struct word_visit *words = user;
    struct reader *reader = words->reader;
    for (uint32_t i = 0; i < words->pass->define_count; i++)
        if (!strcmp(words->pass->defines[i].name, word)) /* an inner scope's, or a macro */
            return;
    struct expr_names names = node_names(reader, words->node);
    struct diag *silent = diag_create();
    struct loc loc = node_loc(reader, at);
    struct expr *value = silent ? expr_parse(reader->model, word, loc, &names, silent) : NULL;
    bool known = value && expr_resolve(value, &reader->model->pipeline, silent);
    diag_free(silent);
    struct define define = {.name = word, .loc = loc, .value = known ? value : NULL, .word = true};
    const struct param *param = declared_find(&reader->model->pipeline, DECLARED_PARAM,
                                              node_word(reader, words->node, word));
    if (!known && param)
        define.param = param->name;
    if (known || define.param)
        words->pass->defines[words->pass->define_count++] = define;
}

/* The macros of the body, and in an instance its arguments, constants and number. */
static void read_defines(struct reader *reader, const struct fields *fields, struct pass *pass)
{
    struct named_list list = fields_named(reader, fields, "defines");
    struct word_visit words = {reader, pass, field_node(fields, "name"), list.count};
    each_word(reader, words.node, count_word, &words);
    if (!words.count)
        return;
    pass->defines = reader_alloc(reader, words.count, sizeof *pass->defines);
    for (uint32_t i = 0; pass->defines && i < list.count; i++)
        pass->defines[pass->define_count++] =
            (struct define){.name = list.items[i].name,
                            .loc = list.items[i].loc,
                            .value = node_expr(reader, list.items[i].value)};
    if (pass->defines)
        each_word(reader, words.node, add_word, &words);
}

/* Values must say their type, since the functions that give them have one. */
uint32_t read_shader_values(struct reader *reader, const struct fields *fields,
                            struct value **values)
{
    uint32_t count = 0;
    struct named_list list = fields_named(reader, fields, "values");
    *values = list.count ? reader_alloc(reader, list.count, sizeof **values) : NULL;
    for (uint32_t i = 0; *values && i < list.count; i++) {
        const char *text = argument_text(reader, list.items[i].value, NULL);
        struct loc loc = node_loc(reader, list.items[i].value);
        size_t length = text ? strcspn(text, "(") : 0;
        if (!length || text[length] != '(' || strspn(text, " ") || text[strlen(text) - 1] != ')')
            diag_error(reader->diag, loc,
                       "a value is a GLSL expression that begins with its type, such as "
                       "`vec2(frame.width, frame.height)`");
        else
            (*values)[count++] =
                (struct value){.name = list.items[i].name, .text = text, .loc = loc};
    }
    return count;
}

/* ---- The kind and the size ------------------------------------------------------------------- */

static bool names_image(const struct pipeline *pipeline, const char *text)
{
    return declared_find(pipeline, DECLARED_IMAGE, text) &&
           !declared_find(pipeline, DECLARED_PARAM | DECLARED_CONSTANT, text);
}

/* One to three expressions; returns their number. */
static int read_exprs(struct reader *reader, struct fy_node *node, struct expr *exprs[3])
{
    if (fy_node_get_type(node) == FYNT_SCALAR) {
        exprs[0] = node_expr(reader, node);
        return 1;
    }
    int count = fy_node_sequence_item_count(node);
    for (int i = 0; i < count && i < 3; i++)
        exprs[i] = node_expr(reader, fy_node_sequence_get_by_index(node, i));
    return count;
}

/* Returns the number of dimensions. */
static int read_dispatch(struct reader *reader, const struct fields *fields, struct pass *pass)
{
    const char *key = field_node(fields, "dispatch") ? "dispatch" : "groups";
    struct fy_node *node = field_node(fields, key);
    const char *text = referred_name(reader, node);
    pass->kind = DT_PASS_DISPATCH;
    pass->size_loc = field_loc(reader, fields, key);
    pass->size = !strcmp(key, "groups") ? SIZE_GROUPS : SIZE_INVOCATIONS;
    if (pass->size == SIZE_INVOCATIONS && text && names_image(&reader->model->pipeline, text)) {
        pass->size = SIZE_IMAGE;
        pass->dispatch_image = text;
        return 2;
    }
    return read_exprs(reader, node, pass->dispatch);
}

static void read_local(struct reader *reader, const struct fields *fields, struct pass *pass,
                       int dimensions)
{
    struct fy_node *own = reader->model->pipeline.gpu ? field_node(fields, "gpu_local") : NULL;
    struct fy_node *node = own ? own : field_node(fields, "local");
    pass->local[0] = node ? 1 : dimensions == 1 ? 64 : 8;
    pass->local[1] = node || dimensions == 1 ? 1 : 8;
    pass->local[2] = 1;
    if (node)
        read_exprs(reader, node, pass->local_size);
}

static void refuse_others(struct reader *reader, const struct fields *fields,
                          const struct pass *pass)
{
    static const char *const scene[] = {"local", "gpu_local", "ranges", NULL};
    static const char *const fullscreen[] = {"local",          "gpu_local", "ranges",  "indirect",
                                             "view",           "layers",    "indices", "cull",
                                             "clip_distances", NULL};
    static const char *const vertices[] = {"local", "gpu_local", "ranges", "view", "indices", NULL};
    static const char *const dispatch[] = {
        "view",  "layers",         "indices",  "cull",    "depth",      "depth_write",
        "blend", "clip_distances", "viewport", "scissor", "depth_bias", NULL};
    if (pass->kind == DT_PASS_DRAW_SCENE)
        refuse_keys(reader, fields, "a draw", scene);
    else if (pass->kind == DT_PASS_DRAW_FULLSCREEN)
        refuse_keys(reader, fields, "a fullscreen draw", fullscreen);
    else if (pass->kind == DT_PASS_DRAW_VERTICES)
        refuse_keys(reader, fields, "a draw of vertices", vertices);
    else
        refuse_keys(reader, fields, "a dispatch", dispatch);
}

static void read_draw(struct reader *reader, const struct fields *fields, struct pass *pass)
{
    struct fy_node *node = field_node(fields, "draw");
    struct fields map;
    if (!node || fy_node_get_type(node) != FYNT_MAPPING) {
        pass->kind =
            field_choice(reader, fields, "draw", 0) ? DT_PASS_DRAW_FULLSCREEN : DT_PASS_DRAW_SCENE;
        return;
    }
    pass->kind = DT_PASS_DRAW_VERTICES;
    if (!fields_read(reader, node, SECTION_DRAW, node_loc(reader, node), &map))
        return;
    pass->vertices = field_expr(reader, &map, "vertices");
    pass->instances = field_expr(reader, &map, "instances");
    pass->topology = (enum dt_topology)field_choice(reader, &map, "topology", DT_TRIANGLES);
    pass->topology_loc = field_loc(reader, &map, "topology");
    if (!pass->indirect && !field_given(&map, "vertices"))
        diag_error(reader->diag, node_loc(reader, node),
                   "a draw of vertices needs the key `vertices`, or `indirect` beside `draw`");
    for (int i = 0; i < 2; i++) {
        const char *key = i ? "instances" : "vertices";
        if (pass->indirect && field_given(&map, key))
            diag_error(reader->diag, field_loc(reader, &map, key),
                       "`indirect` excludes `%s`: the buffer gives the number", key);
    }
}

static void read_kind(struct reader *reader, const struct fields *fields, struct pass *pass)
{
    static const char *const keys[] = {"draw", "dispatch", "groups", "interleave"};
    const char *found = NULL;
    int dimensions = 1;
    for (int i = 0; i < 4; i++) {
        if (!field_node(fields, keys[i]))
            continue;
        if (found)
            diag_error(reader->diag, field_loc(reader, fields, keys[i]),
                       "`%s` beside `%s`; a pass has exactly one of "
                       "`draw`, `dispatch`, `groups`, `interleave`",
                       keys[i], found);
        else
            found = keys[i];
    }
    pass->kind = DT_PASS_DISPATCH;
    pass->size = SIZE_INDIRECT;
    pass->size_loc = pass->indirect_loc;
    if (found && !strcmp(found, "draw")) {
        read_draw(reader, fields, pass);
    } else if (found && !strcmp(found, "interleave")) {
        pass->size = SIZE_INTERLEAVE;
        pass->size_loc = pass->interleave_loc;
        dimensions = 2;
    } else if (found) {
        dimensions = read_dispatch(reader, fields, pass);
    } else if (!pass->indirect) {
        bool given = false; /* a wrong value was reported already */
        for (size_t i = 0; i < fields->count; i++)
            given |= !fields->values[i].value;
        if (!given)
            diag_error(reader->diag, pass->loc,
                       "the pass `%s` needs one of `draw`, `dispatch`, `groups`, `interleave`, "
                       "`indirect`",
                       pass->name);
    }
    if (pass->indirect && found && pass->kind == DT_PASS_DISPATCH)
        diag_error(reader->diag, pass->indirect_loc,
                   "`indirect` excludes `%s`: the buffer gives the number of workgroups", found);
    if (pass->kind == DT_PASS_DISPATCH)
        read_local(reader, fields, pass, dimensions);
    refuse_others(reader, fields, pass);
}

/* ---- A pass ---------------------------------------------------------------------------------- */

static bool has_depth_target(const struct pipeline *pipeline, const struct pass *pass)
{
    for (uint32_t i = 0; i < pass->access_count; i++) {
        const struct resource *image =
            declared_find(pipeline, DECLARED_IMAGE, pass->accesses[i].name);
        if (pass->accesses[i].mode != MODE_READ && image && image->format == DT_FORMAT_D32F)
            return true;
    }
    return false;
}

/* x, y, width and height. */
static void read_rect(struct reader *reader, const struct fields *fields, const char *key,
                      struct expr *rect[4])
{
    struct fy_node *list = field_node(fields, key);
    for (int i = 0; list && i < 4; i++)
        rect[i] = node_expr(reader, fy_node_sequence_get_by_index(list, i));
}

static void read_depth_bias(struct reader *reader, const struct fields *fields, struct pass *pass)
{
    struct fy_node *node = field_node(fields, "depth_bias");
    struct fields map;
    if (!node || !fields_read(reader, node, SECTION_DEPTH_BIAS, node_loc(reader, node), &map))
        return;
    static const char *const keys[] = {"constant", "slope"};
    float *const values[] = {&pass->bias_constant, &pass->bias_slope};
    for (int i = 0; i < 2; i++) {
        *values[i] = (float)field_number(reader, &map, keys[i], 0);
        if (!isfinite(*values[i]))
            diag_error(reader->diag, field_loc(reader, &map, keys[i]),
                       "`%s` is larger than a 32-bit float can be", keys[i]);
    }
}

static void read_draw_state(struct reader *reader, const struct fields *fields, struct pass *pass)
{
    if (pass->kind == DT_PASS_DISPATCH)
        return;
    bool depth = has_depth_target(&reader->model->pipeline, pass);
    pass->view = field_choice(reader, fields, "view", 0) ? "light" : "camera";
    pass->layers = field_expr(reader, fields, "layers");
    pass->cull = (enum dt_cull)field_choice(reader, fields, "cull", DT_CULL_NONE);
    int compare = field_choice(reader, fields, "depth", depth ? 1 : 0); /* 0: off */
    pass->depth_test = compare > 0;
    pass->depth_compare = pass->depth_test ? (enum dt_compare)(compare - 1) : DT_COMPARE_LESS;
    pass->depth_write = field_bool(reader, fields, "depth_write", true);
    read_rect(reader, fields, "viewport", pass->viewport);
    read_rect(reader, fields, "scissor", pass->scissor);
    read_depth_bias(reader, fields, pass);
    pass->bias_loc = field_loc(reader, fields, "depth_bias");
    pass->blend_loc = field_loc(reader, fields, "blend");
    pass->clip_loc = field_loc(reader, fields, "clip_distances");
    const struct dt_blend *blend = read_blend(reader, fields);
    for (uint32_t i = 0; i < pass->access_count; i++)
        if (!pass->accesses[i].own_blend)
            pass->accesses[i].blend = blend;
    double distances = field_number(reader, fields, "clip_distances", 0);
    if (distances > 8)
        diag_error(reader->diag, field_loc(reader, fields, "clip_distances"),
                   "at most 8 clip distances");
    else
        pass->clip_distances = (uint32_t)distances;
    if (pass->depth_test && !depth)
        diag_error(reader->diag, field_loc(reader, fields, "depth"),
                   "`depth` needs a depth target: the pass `%s` writes no image of format d32f",
                   pass->name);
    if (field_given(fields, "depth_bias") && !depth)
        diag_error(
            reader->diag, field_loc(reader, fields, "depth_bias"),
            "`depth_bias` needs a depth target: the pass `%s` writes no image of format d32f",
            pass->name);
}

/* Files of an argument lie beside the file that gives it. */
static void read_files(struct reader *reader, const struct fields *fields, struct pass *pass)
{
    struct fy_node *shader = field_node(fields, "shader"), *first = shader;
    if (shader && fy_node_get_type(shader) == FYNT_SEQUENCE) {
        first = fy_node_sequence_get_by_index(shader, 0);
        pass->more = node_text(reader, fy_node_sequence_get_by_index(shader, 1));
    }
    pass->shader_loc = field_loc(reader, fields, "shader");
    pass->shader = argument_text(reader, first, &pass->shader_loc);
}

static void read_allows(struct reader *reader, const struct fields *fields, struct pass *pass)
{
    struct fields inner;
    struct fy_node *node = field_node(fields, "allow");
    if (!node ||
        !fields_read(reader, node, SECTION_ALLOW, field_loc(reader, fields, "allow"), &inner))
        return;
    pass->allows = reader_alloc(reader, inner.count, sizeof *pass->allows);
    for (unsigned kind = 1; pass->allows && kind < SANITIZE_ALL; kind <<= 1) {
        const char *name = sanitize_kind_name(kind);
        if (field_text(reader, &inner, name)) /* the reason is for readers */
            pass->allows[pass->allow_count++] =
                (struct allow){kind, field_loc(reader, &inner, name)};
    }
}

/* Its own, else that of its group. */
static void read_exactness(struct reader *reader, const struct fields *fields, struct pass *pass)
{
    const struct model *model = reader->model;
    const enum exactness spec = model->pipeline.exactness;
    int own = field_choice(reader, fields, "exactness", -1);
    if (own < 0)
        own = group_exactness(reader, field_node(fields, "name"));
    enum exactness exactness = own < 0 ? spec : (enum exactness)own;
    if (own == EXACTNESS_BOUNDED)
        exactness = spec == EXACTNESS_EXACT ? EXACTNESS_EXACT : EXACTNESS_FAST;
    pass->bounded = own > EXACTNESS_EXACT && exactness == EXACTNESS_FAST && spec != EXACTNESS_FAST;
    pass->fast = exactness == EXACTNESS_FAST && !model->exact_twin;
}

static void read_pass(struct reader *reader, const struct fields *fields, struct pass *pass)
{
    *pass = (struct pass){
        .frame_binding = -1, .live_binding = -1, .textures_binding = -1, .materials_binding = -1};
    pass->name =
        declared_name(reader, field_node(fields, "name"), field_text(reader, fields, "name"));
    pass->loc = field_loc(reader, fields, "name");
    if (!pass->name)
        pass->name = "?";
    pass->doc = field_text(reader, fields, "doc");
    read_exactness(reader, fields, pass);
    read_files(reader, fields, pass);
    pass->interleave_name = field_reference(reader, fields, "interleave");
    pass->interleave_loc = field_loc(reader, fields, "interleave");
    pass->indirect = field_reference(reader, fields, "indirect");
    pass->indirect_loc = field_loc(reader, fields, "indirect");
    pass->indices = field_reference(reader, fields, "indices");
    pass->indices_loc = field_loc(reader, fields, "indices");
    pass->when = field_expr(reader, fields, "when");
    pass->when_text = argument_text(reader, field_node(fields, "when"), NULL);
    pass->use_count = read_names(reader, field_node(fields, "uses"), &pass->uses, &pass->use_locs);
    pass->after_count =
        read_names(reader, field_node(fields, "after"), &pass->after, &pass->after_locs);
    read_accesses(reader, fields, pass);
    read_kind(reader, fields, pass);
    read_ranges(reader, fields, pass);
    read_defines(reader, fields, pass);
    read_allows(reader, fields, pass);
    pass->value_count = read_shader_values(reader, fields, &pass->values);
    read_draw_state(reader, fields, pass);
}

void read_passes(struct reader *reader, const struct fields *top)
{
    struct pipeline *pipeline = &reader->model->pipeline;
    uint32_t count = 0;
    struct fy_node **items = documents_passes(reader, &count);
    pipeline->passes = reader_alloc(reader, count, sizeof *pipeline->passes);
    for (uint32_t i = 0; items && pipeline->passes && i < count; i++) {
        struct fields fields;
        if (fields_read(reader, items[i], SECTION_PASS, node_loc(reader, items[i]), &fields))
            read_pass(reader, &fields, &pipeline->passes[pipeline->pass_count++]);
    }
    while (top->next && !field_node(top, "passes"))
        top = top->next;
    if (!count && field_node(top, "passes"))
        diag_error(reader->diag, field_loc(reader, top, "passes"),
                   "a pipeline has at least one pass");
}
