/* Passes of a spec. */
#include <math.h>
#include <string.h>

#include "reader.h"
#include "model/sanitize_kinds.h"

/* ---- Lists ----------------------------------------------------------------------------------- */

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
            node_error(reader, item, "expected a name");
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
    if (!node || fy_node_get_type(node) != FYNT_MAPPING) {
        int word = field_choice(reader, fields, "blend", 0);
        return word ? &words[word] : NULL;
    }
    const int not_given = -1;
    struct dt_blend *blend = reader_alloc(reader, 1, sizeof *blend);
    if (!blend)
        return NULL;
    *blend =
        (struct dt_blend){.alpha_src = not_given, .alpha_dst = not_given, .alpha_op = not_given};
    if (!map_read(reader, fields, "blend", blend))
        return NULL;
    if ((int)blend->alpha_src == not_given)
        blend->alpha_src = blend->src;
    if ((int)blend->alpha_dst == not_given)
        blend->alpha_dst = blend->dst;
    if ((int)blend->alpha_op == not_given)
        blend->alpha_op = blend->op;
    return blend;
}

/* Inside an instance the body knows a resource by the name in the group. */
static void set_name(struct reader *reader, struct fy_node *node, struct access *access)
{
    const char *text = node_text(reader, node);
    access->name = referred_name(reader, node);
    if (access->as || !text || !access->name || (!strcmp(text, access->name) && !strchr(text, '.')))
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
    if (!node || fy_node_get_type(node) != FYNT_MAPPING)
        return diag_error(
            reader->diag, access->loc,
            "expected a resource's name, or a map such as {name: NAME, sampler: NAME}");
    struct fields fields;
    if (!fields_read(reader, node, SECTION_ACCESS, access->loc, &fields))
        return false;
    record_read(reader, &fields, 0, access);
    set_name(reader, field_node(&fields, "name"), access);
    access->own_blend = field_given(&fields, "blend");
    access->blend = read_blend(reader, &fields);
    access->own_mask = field_given(&fields, "mask");
    access->keep = (uint8_t)(14 - field_choice(reader, &fields, "mask", 14));
    if (access->layer && mode == MODE_WRITE)
        key_error(reader, &fields, "layer",
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
    EACH(define, words->pass->defines, words->pass->define_count)
        if (!strcmp(define->name, word)) /* an inner scope's, or a macro */
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

/* Returns the number of dimensions; those at the end that are written as 1 are none. */
static int read_dispatch(struct reader *reader, const struct fields *fields, struct pass *pass)
{
    const char *key = field_node(fields, "dispatch") ? "dispatch" : "groups";
    struct fy_node *node = field_node(fields, key);
    const char *text = referred_name(reader, node);
    pass->size_loc = field_loc(reader, fields, key);
    pass->size = !strcmp(key, "groups") ? SIZE_GROUPS : SIZE_INVOCATIONS;
    if (pass->size == SIZE_INVOCATIONS && text && names_image(&reader->model->pipeline, text)) {
        pass->size = SIZE_IMAGE;
        pass->dispatch_image = text;
        return 2;
    }
    int dimensions = node_exprs(reader, node, pass->dispatch);
    for (; dimensions > 1; dimensions--) {
        const char *last = fy_node_get_scalar0(fy_node_sequence_get_by_index(node, dimensions - 1));
        if (!last || strcmp(last, "1") != 0)
            break;
    }
    return dimensions;
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
        node_exprs(reader, node, pass->local_size);
}

static enum dt_pass_kind pass_kind(struct reader *reader, const struct fields *fields)
{
    struct fy_node *draw = field_node(fields, "draw");
    if (draw && fy_node_get_type(draw) == FYNT_MAPPING)
        return DT_PASS_DRAW_VERTICES;
    return draw ? (enum dt_pass_kind)field_choice(reader, fields, "draw", 0) : DT_PASS_DISPATCH;
}

static void read_draw(struct reader *reader, const struct fields *fields, struct pass *pass)
{
    struct fy_node *node = field_node(fields, "draw");
    struct fields map;
    if (pass->kind != DT_PASS_DRAW_VERTICES ||
        !fields_read(reader, node, SECTION_DRAW, node_loc(reader, node), &map))
        return;
    record_read(reader, &map, 0, pass);
    if (!pass->indirect && !field_given(&map, "vertices"))
        node_error(reader, node,
                   "a draw of vertices needs the key `vertices`, or `indirect` beside `draw`");
    for (int i = 0; i < 2; i++) {
        const char *key = i ? "instances" : "vertices";
        if (pass->indirect && field_given(&map, key))
            key_error(reader, &map, key, "`indirect` excludes `%s`: the buffer gives the number",
                      key);
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
            key_error(reader, fields, keys[i],
                      "`%s` beside `%s`; a pass has exactly one of `draw`, `dispatch`, `groups`, "
                      "`interleave`",
                      keys[i], found);
        else
            found = keys[i];
    }
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
            diag_error(
                reader->diag, pass->loc,
                "the pass `%s` needs one of `draw`, `dispatch`, `groups`, `interleave`, `indirect`",
                pass->name);
    }
    if (pass->indirect && found && pass->kind == DT_PASS_DISPATCH)
        diag_error(reader->diag, pass->indirect_loc,
                   "`indirect` excludes `%s`: the buffer gives the number of workgroups", found);
    if (pass->kind == DT_PASS_DISPATCH)
        read_local(reader, fields, pass, dimensions);
}

/* ---- A pass ---------------------------------------------------------------------------------- */

static bool has_depth_target(const struct pipeline *pipeline, const struct pass *pass)
{
    EACH(access, pass->accesses, pass->access_count) {
        const struct resource *image = declared_find(pipeline, DECLARED_IMAGE, access->name);
        if (access->mode != MODE_READ && image && image->format == DT_FORMAT_D32F)
            return true;
    }
    return false;
}

static void read_depth_bias(struct reader *reader, const struct fields *fields, struct pass *pass)
{
    static const char *const keys[] = {"constant", "slope"};
    struct fy_node *node = field_node(fields, "depth_bias");
    struct fields map;
    if (!node || !fields_read(reader, node, SECTION_DEPTH_BIAS, node_loc(reader, node), &map))
        return;
    record_read(reader, &map, 0, pass);
    for (int i = 0; i < 2; i++)
        if (!isfinite((float)(i ? pass->bias_slope : pass->bias_constant)))
            key_error(reader, &map, keys[i], "`%s` is larger than a 32-bit float can be", keys[i]);
}

static void read_draw_state(struct reader *reader, const struct fields *fields, struct pass *pass)
{
    if (pass->kind == DT_PASS_DISPATCH)
        return;
    bool depth = has_depth_target(&reader->model->pipeline, pass);
    pass->view = field_choice(reader, fields, "view", 0) ? "light" : "camera";
    int compare = field_choice(reader, fields, "depth", depth ? 1 : 0); /* 0: off */
    pass->depth_test = compare > 0;
    pass->depth_compare = pass->depth_test ? (enum dt_compare)(compare - 1) : DT_COMPARE_LESS;
    read_depth_bias(reader, fields, pass);
    const struct dt_blend *blend = read_blend(reader, fields);
    CHANGE_EACH(access, pass->accesses, pass->access_count)
        if (!access->own_blend)
            access->blend = blend;
    if (pass->clip_distances > 8)
        diag_error(reader->diag, pass->clip_loc, "at most 8 clip distances");
    if (pass->depth_test && !depth)
        key_error(reader, fields, "depth",
                  "`depth` needs a depth target: the pass `%s` writes no image of format d32f",
                  pass->name);
    if (field_given(fields, "depth_bias") && !depth)
        diag_error(
            reader->diag, pass->bias_loc,
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
    static const struct entries ranges = {.key = "ranges", .size = sizeof(struct range)};
    *pass = (struct pass){
        .frame_binding = -1, .live_binding = -1, .textures_binding = -1, .materials_binding = -1};
    pass->kind = pass_kind(reader, fields);
    record_read(reader, fields, 1U << pass->kind, pass);
    pass->name = pass->name ? declared_name(reader, field_node(fields, "name"), pass->name) : "?";
    read_exactness(reader, fields, pass);
    read_files(reader, fields, pass);
    pass->when_text = argument_text(reader, field_node(fields, "when"), NULL);
    pass->use_count = read_names(reader, field_node(fields, "uses"), &pass->uses, &pass->use_locs);
    pass->after_count =
        read_names(reader, field_node(fields, "after"), &pass->after, &pass->after_locs);
    read_accesses(reader, fields, pass);
    read_kind(reader, fields, pass);
    pass->ranges = entries_read(reader, fields, &ranges, &pass->range_count);
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
        key_error(reader, top, "passes", "a pipeline has at least one pass");
}
