/* The pieces that all emitted C has in common: literals, names, expressions, the filling of
 * scaffolds. Called by emit_header.c, emit_pipeline.c, emit_gl.c and emit_vk.c. */
#include "emit_c.h"

#include <ctype.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- Literals and names ---------------------------------------------------------------------- */

void c_upper(struct text *out, const char *name)
{
    for (; *name; name++) {
        text_add(out, "%c", toupper((unsigned char)*name));
    }
}

void c_enumerator(const struct c_output *c, const char *group, const char *name)
{
    c_upper(c->out, c->pipeline->name);
    text_add(c->out, "_%s_", group);
    c_upper(c->out, name);
}

/* Question marks are escaped because C11 knows trigraphs. */
void c_string(struct text *out, const char *text)
{
    text_add(out, "\"");
    for (const char *at = text ? text : ""; *at; at++) {
        unsigned char byte = (unsigned char)*at;

        if (byte == '\n') {
            text_add(out, "\\n");
        } else if (byte == '"' || byte == '\\' || (byte == '?' && at[1] == '?')) {
            text_add(out, "\\%c", byte);
        } else if (byte < 32 || byte == 127) {
            text_add(out, "\\%03o", byte);
        } else {
            text_add_bytes(out, at, 1);
        }
    }
    text_add(out, "\"");
}

void c_comment(struct text *out, const char *text)
{
    for (const char *at = text ? text : ""; *at; at++) {
        bool marker = (at[0] == '*' && at[1] == '/') || (at[0] == '/' && at[1] == '*');

        if (*at != '\n' || at[1]) { /* block scalars of YAML end with a line break */
            text_add(out, marker ? "%c " : "%c", (unsigned char)*at < 32 ? ' ' : *at);
        }
    }
}

void c_double(struct text *out, double value)
{
    if (isinf(value)) {
        text_add(out, value < 0 ? "DT_NO_MIN" : "DT_NO_MAX");
    } else {
        text_add(out, "%.17g", value);
    }
}

void c_float(struct text *out, double value)
{
    char digits[40];

    snprintf(digits, sizeof digits, "%.9g", value);
    text_add(out, strpbrk(digits, ".en") ? "%sf" : "%s.0f", digits);
}

void c_clear(struct text *out, const struct resource *resource)
{
    uint32_t count = 4;

    while (count > 1 && resource->clear[count - 1] == 0) {
        count--;
    }
    for (uint32_t i = 0; i < count; i++) {
        text_add(out, i ? ", " : "{");
        c_float(out, resource->clear[i]);
    }
    text_add(out, "}");
}

void c_expr(struct text *out, const struct expr *expr, int64_t otherwise)
{
    int64_t value = otherwise;

    if (expr && expr_reach(expr) != EXPR_BAKED) {
        expr_emit_c(expr, out);
        return;
    }
    if (expr) {
        expr_eval(expr, REFERENCE_WIDTH, REFERENCE_HEIGHT, &value);
    }
    text_add(out, value > INT32_MAX || value < INT32_MIN ? "INT64_C(%" PRId64 ")" : "%" PRId64,
             value);
}

static bool names_word(const char *text, const char *word)
{
    size_t length = strlen(word);

    for (const char *at = text; text && (at = strstr(at, word)); at += length) {
        unsigned char before = at > text ? (unsigned char)at[-1] : ' ',
                      after = (unsigned char)at[length];

        if (!isalnum(before) && !strchr("_.>", before) && !isalnum(after) && after != '_') {
            return true;
        }
    }
    return false;
}

void c_size_locals(struct text *out, const char *body, const char *from_width,
                   const char *from_height)
{
    if (names_word(body, "width")) {
        text_add(out, "    const int64_t width = %s;\n", from_width);
    }
    if (names_word(body, "height")) {
        text_add(out, "    const int64_t height = %s;\n", from_height);
    }
}

/* ---- Passes and resources as C names them ---------------------------------------------------- */

const char *c_group(const struct resource *resource)
{
    return resource->kind == DT_BUFFER ? "buffers" : "images";
}

const char *c_kind(const struct resource *resource)
{
    return resource->kind == DT_BUFFER ? "buffer" : "image";
}

static const char *backend_prefix(const struct c_output *c)
{
    return c->backend == BACKEND_GL ? "gl" : "vk";
}

void c_resource_members(const struct c_output *c)
{
    for (enum dt_kind kind = DT_BUFFER; kind <= DT_IMAGE; kind++) {
        const struct resource *any = NULL;

        for (uint32_t i = 0; i < c->pipeline->resource_count; i++) {
            const struct resource *resource = &c->pipeline->resources[i];

            if (resource->kind == kind) {
                text_add(c->out, any ? "" : "    struct {\n");
                text_add(c->out, "        struct %s_%s %s;\n", backend_prefix(c), c_kind(resource),
                         resource->name);
                any = resource;
            }
        }
        if (any) {
            text_add(c->out, "    } %s;\n", c_group(any));
        }
    }
}

void c_sampler_members(const struct c_output *c, const char *type)
{
    bool any = false;

    for (uint32_t i = 0; i < c->pipeline->sampler_count; i++) {
        if (c->pipeline->samplers[i].kind == SAMPLER_FILTER) {
            text_add(c->out, any ? "" : "    struct {\n");
            text_add(c->out, "        %s %s;\n", type, c->pipeline->samplers[i].name);
            any = true;
        }
    }
    text_add(c->out, any ? "    } samplers;\n" : "");
}

void c_program_members(const struct c_output *c)
{
    for (uint32_t i = 0; i < c->pipeline->pass_count; i++) {
        text_add(c->out, i ? "" : "    struct {\n");
        text_add(c->out, "        struct %s_program %s;\n", backend_prefix(c),
                 c->pipeline->order[i]->name);
    }
    text_add(c->out, c->pipeline->pass_count ? "    } programs;\n" : "");
}

void c_create_head(const struct c_output *c, const struct resource *resource)
{
    const char *api = backend_prefix(c), *name = c->pipeline->name;

    text_add(c->out,
             "static bool create_%s_%s(struct %s_runtime *rt, struct %s_%s_state *state)\n{\n"
             "    uint32_t extent[3];\n\n    %s_extent_%s(state->width, state->height, extent);\n",
             c_kind(resource), resource->name, api, name, api, name, resource->name);
}

void c_create_resources(const struct c_output *c)
{
    for (uint32_t i = 0; i < c->pipeline->resource_count; i++) {
        const struct resource *resource = &c->pipeline->resources[i];

        text_add(c->out, "    ok = ok && create_%s_%s(rt, state);\n", c_kind(resource),
                 resource->name);
    }
}

bool access_is_image(const struct access *access)
{
    return access->resource ? access->resource->kind == DT_IMAGE
                            : access->builtin == BUILTIN_TEXTURES;
}

void c_object(struct text *out, const struct access *access)
{
    static const char *const builtins[BUILTIN_COUNT] = {"vertices", "indices", "materials",
                                                        "textures"};

    if (access->resource) {
        text_add(out, "state->%s.%s", c_group(access->resource), access->resource->name);
    } else {
        text_add(out, "builtin->%s", builtins[access->builtin]);
    }
}

void c_element(const struct c_output *c, struct text *out, const struct resource *buffer)
{
    if (buffer->structure) {
        text_add(out, "sizeof(struct %s_%s)", c->pipeline->name, buffer->structure->name);
    } else {
        text_add(out, "%" PRIu32, buffer->stride);
    }
}

bool pass_draws(const struct pass *pass)
{
    return pass->kind != PASS_DISPATCH;
}

bool pass_clears_targets(const struct pass *pass)
{
    for (uint32_t i = 0; i < pass->access_count; i++) {
        if (pass->accesses[i].kind & (ACCESS_COLOR | ACCESS_DEPTH) &&
            pass->accesses[i].mode == MODE_WRITE) {
            return true;
        }
    }
    return false;
}

bool has_fetch(const struct pipeline *pipeline)
{
    for (uint32_t i = 0; i < pipeline->resource_count; i++) {
        if (pipeline->resources[i].usage & ACCESS_FETCH) {
            return true;
        }
    }
    return false;
}

bool pass_has_depth(const struct pass *pass)
{
    for (uint32_t i = 0; i < pass->access_count; i++) {
        if (pass->accesses[i].kind & ACCESS_DEPTH) {
            return true;
        }
    }
    return false;
}

static bool is_live(const struct expr *expr)
{
    return expr && expr_reach(expr) & EXPR_LIVE;
}

bool c_pass_uses_live(const struct pass *pass)
{
    return (pass->conditional && is_live(pass->when)) || is_live(pass->dispatch[0]) ||
           is_live(pass->dispatch[1]) || is_live(pass->dispatch[2]);
}

static void groups_of(const struct c_output *c, struct text *out, const struct expr *expr,
                      uint32_t local)
{
    if (!expr || expr_reach(expr) == EXPR_BAKED) {
        uint32_t count = expr_value(expr, REFERENCE_WIDTH, REFERENCE_HEIGHT, 1);

        text_add(out, "%" PRIu32, count / local + (count % local != 0));
        return;
    }
    text_add(out, "%s_groups(", c->pipeline->name);
    c_expr(out, expr, 1);
    text_add(out, ", %" PRIu32 ")", local);
}

static void image_groups(const struct c_output *c, const struct pass *pass, struct text *out)
{
    static const char *const members[3] = {"width", "height", "layers"};

    for (int axis = 0; axis < 3; axis++) {
        text_add(out, axis ? ", " : "");
        if (axis == 2 && !pass->size_resource->layers) {
            text_add(out, "1");
        } else {
            text_add(out, "%s_groups(state->images.%s.%s, %" PRIu32 ")", c->pipeline->name,
                     pass->size_resource->name, members[axis], pass->local[axis]);
        }
    }
}

/* "x, y, z": workgroups of a dispatch. */
static void emit_groups(const struct c_output *c, const struct pass *pass, struct text *out)
{
    if (pass->size == SIZE_IMAGE) {
        image_groups(c, pass, out);
    } else if (pass->size == SIZE_INTERLEAVE) {
        const uint32_t *tile = pass->interleave->tile;

        /* A group covers local pixels of one class, and a class has every tile-th pixel of the
         * frame. */
        text_add(out, "%s_groups(width, %" PRIu32 "), %s_groups(height, %" PRIu32 "), %" PRIu32,
                 c->pipeline->name, tile[0] * pass->local[0], c->pipeline->name,
                 tile[1] * pass->local[1], tile[0] * tile[1]);
    } else {
        for (int axis = 0; axis < 3; axis++) {
            text_add(out, axis ? ", " : "");
            groups_of(c, out, pass->dispatch[axis],
                      pass->size == SIZE_GROUPS ? 1 : pass->local[axis]);
        }
    }
}

/* ---- Targets of draws ------------------------------------------------------------------------ */

static void emit_target(const struct c_output *c, const struct access *access)
{
    text_add(c->out, "{.image = &state->images.%s", access->resource->name);
    if (access->mip_value) {
        text_add(c->out, ", .mip = %" PRIu32, access->mip_value);
    }
    if (access->mode == MODE_UPDATE) {
        text_add(c->out, ", .load = true");
    }
    text_add(c->out, ", .clear = ");
    c_clear(c->out, access->resource);
    text_add(c->out, "},\n");
}

static void emit_targets_body(const struct c_output *c, const struct pass *pass)
{
    uint32_t colors = 0;

    for (uint32_t i = 0; i < pass->access_count; i++) {
        const struct access *access = &pass->accesses[i];

        if (access->kind & ACCESS_COLOR) {
            text_add(c->out, "        .color[%d] = ", access->attachment);
            emit_target(c, access);
            colors++;
        } else if (access->kind & ACCESS_DEPTH) {
            text_add(c->out, "        .depth = ");
            emit_target(c, access);
        }
    }
    text_add(c->out, "        .color_count = %" PRIu32 ",\n        .layers = ", colors);
    if (pass->layers && expr_reach(pass->layers) != EXPR_BAKED) {
        text_add(c->out, "(uint32_t)(");
        c_expr(c->out, pass->layers, 1);
        text_add(c->out, ")");
    } else {
        c_expr(c->out, pass->layers, 1);
    }
    text_add(c->out, ",\n");
}

void c_targets(const struct c_output *c)
{
    const char *api = backend_prefix(c);

    for (uint32_t i = 0; i < c->pipeline->pass_count; i++) {
        const struct pass *pass = c->pipeline->order[i];
        struct text body = {0}, locals = {0};
        struct c_output inner = *c;

        if (!pass_draws(pass)) {
            continue;
        }
        inner.out = &body;
        emit_targets_body(&inner, pass);
        c_size_locals(&locals, body.data, "state->width", "state->height");
        text_add(c->out, "static struct %s_targets targets_%s(%sstruct %s_%s_state *state)\n{\n",
                 api, pass->name, c->backend == BACKEND_GL ? "const " : "", c->pipeline->name, api);
        text_add(c->out, locals.data ? "%s\n" : "", locals.data);
        text_add(c->out, "    return (struct %s_targets){\n%s    };\n}\n\n", api,
                 body.data ? body.data : "");
        text_free(&body);
        text_free(&locals);
    }
}

/* ---- Record functions of passes -------------------------------------------------------------- */

/* The first arguments of a draw. OpenGL has a framebuffer for it. */
static void emit_draw(const struct c_output *c, const struct pass *pass, const char *verb)
{
    text_add(c->out, "dt_%s_%s(rt, &state->programs.%s, ", backend_prefix(c), verb, pass->name);
    if (c->backend == BACKEND_GL) {
        text_add(c->out, "state->framebuffers.%s, ", pass->name);
    }
    text_add(c->out, "&targets");
}

static void emit_indirect_draw(const struct c_output *c, const struct pass *pass)
{
    const char *arguments = pass->indirect_resource->name;

    emit_draw(c, pass, "draw_scene_indirect");
    text_add(c->out, pass->index_resource ? ", &state->buffers.%s" : ", NULL",
             pass->index_resource ? pass->index_resource->name : "");
    text_add(c->out, ", &state->buffers.%s, (uint32_t)(state->buffers.%s.size / %s))", arguments,
             arguments, c->backend == BACKEND_GL ? "20" : "sizeof(VkDrawIndexedIndirectCommand)");
}

void c_work(const struct c_output *c, const struct pass *pass)
{
    const char *api = backend_prefix(c);

    if (pass->kind == PASS_FULLSCREEN) {
        emit_draw(c, pass, "draw_fullscreen");
        text_add(c->out, ")");
    } else if (pass->kind == PASS_SCENE && pass->indirect_resource) {
        emit_indirect_draw(c, pass);
    } else if (pass->kind == PASS_SCENE) {
        emit_draw(c, pass, "draw_scene");
        text_add(c->out, ", targets.layers)");
    } else if (pass->size == SIZE_INDIRECT) {
        text_add(c->out, "dt_%s_dispatch_indirect(rt, &state->programs.%s, &state->buffers.%s)",
                 api, pass->name, pass->indirect_resource->name);
    } else {
        text_add(c->out, "dt_%s_dispatch(rt, &state->programs.%s, ", api, pass->name);
        emit_groups(c, pass, c->out);
        text_add(c->out, ")");
    }
}

void c_skip(const struct c_output *c, const struct pass *pass, const char *between)
{
    const char *api = backend_prefix(c);
    bool any = pass_draws(pass) && pass_clears_targets(pass);

    if (any && c->backend == BACKEND_GL) {
        text_add(c->out, "dt_gl_clear_targets(rt, state->framebuffers.%s, &targets)", pass->name);
    } else if (any) {
        text_add(c->out, "dt_vk_clear_targets(rt, &targets)");
    }
    for (uint32_t i = 0; i < pass->access_count; i++) {
        const struct access *access = &pass->accesses[i];

        if (!access->resource || access->mode != MODE_WRITE ||
            access->kind & (ACCESS_COLOR | ACCESS_DEPTH)) {
            continue;
        }
        text_add(c->out, "%s", any ? between : "");
        any = true;
        if (access->resource->kind == DT_BUFFER) {
            text_add(c->out, "dt_%s_clear_buffer(rt, &state->buffers.%s)", api,
                     access->resource->name);
        } else {
            text_add(c->out,
                     "dt_%s_clear_image(rt, &state->images.%s, %" PRIu32 ", (const float[4])", api,
                     access->resource->name, access->mip_value);
            c_clear(c->out, access->resource);
            text_add(c->out, ")");
        }
    }
}

void c_pass(const struct c_output *c, const struct pass *pass, const struct text *locals,
            const struct text *body)
{
    const char *api = backend_prefix(c), *name = c->pipeline->name;
    struct text rest = {0};

    if (pass->conditional) {
        text_add(&rest, "    const bool runs = (");
        c_expr(&rest, pass->when, 1);
        text_add(&rest, ") != 0;\n");
    }
    text_add(&rest, "%s", body->data ? body->data : "");
    if (pass->doc) {
        text_add(c->out, "/* ");
        c_comment(c->out, pass->doc);
        text_add(c->out, " */\n");
    }
    text_add(c->out, "static bool record_%s(struct %s_runtime *rt, %sstruct %s_%s_state *state",
             pass->name, api, c->backend == BACKEND_GL ? "const " : "", name, api);
    if (c_pass_uses_live(pass)) {
        text_add(c->out, ",\n    const struct %s_live *live", name);
    }
    text_add(c->out, ")\n{\n");
    size_t head = c->out->length;
    text_add(c->out, "%s", locals->data ? locals->data : "");
    if (pass_draws(pass)) {
        text_add(c->out, "    const struct %s_targets targets = targets_%s(state);\n", api,
                 pass->name);
    }
    c_size_locals(c->out, rest.data, "state->width", "state->height");
    /* a function does not begin with a blank line */
    bool blank = rest.data && rest.data[0] == '\n' && c->out->length == head;
    text_add(c->out, "%s}\n\n", rest.data ? rest.data + blank : "");
    c->out->failed |= locals->failed || body->failed || rest.failed;
    text_free(&rest);
}

/* ---- Scaffolds ------------------------------------------------------------------------------- */

/* Several empty lines, as slots without content leave them, become one. */
static void add_line(struct text *out, const char *line, size_t length)
{
    bool blank = length == 0;

    if (blank && out->length > 1 && out->data[out->length - 1] == '\n' &&
        out->data[out->length - 2] == '\n') {
        return;
    }
    text_add_bytes(out, line, length);
    text_add(out, "\n");
}

static const struct c_slot *find_slot(const char *name, size_t length, const struct c_slot *slots,
                                      size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (strlen(slots[i].name) == length && memcmp(slots[i].name, name, length) == 0) {
            return &slots[i];
        }
    }
    return NULL;
}

/* One line of a scaffold into `line`; returns whether it was nothing but a slot that writes whole
 * lines. */
static bool expand_line(const struct c_output *c, const char *text, size_t length,
                        const struct c_slot *slots, size_t slot_count, struct text *line)
{
    struct c_output inner = *c;
    bool only_slot = false;

    inner.out = line;
    for (size_t at = 0; at < length;) {
        const char *end = text[at] == '@' && at + 1 < length && text[at + 1] == '{'
                              ? memchr(text + at, '}', length - at)
                              : NULL;
        const struct c_slot *slot =
            end ? find_slot(text + at + 2, (size_t)(end - text) - at - 2, slots, slot_count) : NULL;

        if (!slot) {
            text_add_bytes(line, text + at++, 1);
            continue;
        }
        only_slot = at == 0 && (size_t)(end - text) + 1 == length;
        slot->emit(&inner);
        at = (size_t)(end - text) + 1;
    }
    return only_slot;
}

void c_scaffold(const struct c_output *c, const char *scaffold, const struct c_slot *slots,
                size_t slot_count)
{
    while (*scaffold) {
        size_t length = strcspn(scaffold, "\n");
        struct text line = {0};
        bool whole = expand_line(c, scaffold, length, slots, slot_count, &line);

        if (whole && line.length) {
            text_add_bytes(c->out, line.data, line.length);
        } else if (!whole) {
            add_line(c->out, line.data ? line.data : "", line.length);
        }
        c->out->failed |= line.failed;
        text_free(&line);
        scaffold += length + (scaffold[length] == '\n');
    }
}

void c_slot_name(const struct c_output *c)
{
    text_add(c->out, "%s", c->pipeline->name);
}

void c_slot_spec(const struct c_output *c)
{
    const char *path =
        c->pipeline->loc.source ? c->pipeline->loc.source->path : "a model without a file";
    const char *slash = strrchr(path, '/');

    c_comment(c->out, slash ? slash + 1 : path);
}

void c_slot_doc(const struct c_output *c)
{
    c_comment(c->out, c->pipeline->doc ? c->pipeline->doc : c->pipeline->name);
}

static const char *const stage_names[3] = {"compute", "vertex", "fragment"};

void c_code_name(const struct c_output *c, const struct pass *pass, int stage)
{
    text_add(c->out, "%s_%s_%s_%s", c->pipeline->name, c->backend == BACKEND_GL ? "gl" : "vk",
             pass->name, stage_names[stage]);
}

void c_slot_shaders(const struct c_output *c)
{
    for (uint32_t p = 0; p < c->pipeline->pass_count; p++) {
        for (int stage = 0; stage < 3; stage++) {
            if (c->shaders[p].stage[stage].word_count) {
                text_add(c->out, "extern const struct dt_code ");
                c_code_name(c, c->pipeline->order[p], stage);
                text_add(c->out, ";\n");
            }
        }
    }
}

void c_stages(const struct c_output *c, const struct pass *pass)
{
    for (int stage = 0; stage < 3; stage++) {
        if (c->shaders[pass->index].stage[stage].word_count) {
            text_add(c->out, "        .%s = ", stage_names[stage]);
            c_code_name(c, pass, stage);
            text_add(c->out, ",\n");
        }
    }
}

void c_slot_resources(const struct c_output *c)
{
    for (uint32_t i = 0; i < c->pipeline->resource_count; i++) {
        const struct resource *resource = &c->pipeline->resources[i];

        text_add(c->out, "        [");
        c_enumerator(c, "RESOURCE", resource->name);
        text_add(c->out, "] = &state->%s.%s,\n", c_group(resource), resource->name);
    }
}

void c_slot_create(const struct c_output *c)
{
    for (uint32_t i = 0; i < c->pipeline->sampler_count; i++) {
        if (c->pipeline->samplers[i].kind == SAMPLER_FILTER) {
            text_add(c->out, "    ok = ok && create_sampler_%s(rt, state);\n",
                     c->pipeline->samplers[i].name);
        }
    }
    if (c->backend == BACKEND_VK && has_fetch(c->pipeline)) {
        text_add(c->out, "    ok = ok && create_texel_sampler(rt, state);\n");
    }
    for (uint32_t i = 0; i < c->pipeline->pass_count; i++) {
        text_add(c->out, "    ok = ok && create_program_%s(rt, state);\n",
                 c->pipeline->order[i]->name);
    }
}

void c_slot_record(const struct c_output *c)
{
    for (uint32_t i = 0; i < c->pipeline->pass_count; i++) {
        const struct pass *pass = c->pipeline->order[i];

        text_add(c->out, "    ok = ok && record_%s(rt, state%s);\n", pass->name,
                 c_pass_uses_live(pass) ? ", live" : "");
    }
}
