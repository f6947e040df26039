/* `for (Type v : range) { ... }` written out. Drivers that run on CPUs read a small array that
 * all invocations share twenty times faster from shared memory at literal indices than in a loop
 * over a buffer; here a count known at generation becomes exactly that, when the plan says so.
 * Called by emit_glsl.c with the body complete. */
#include "glsl.h"

#include <stdlib.h>
#include <string.h>

enum { MAX_FIELDS = 63 };
static const uint64_t WHOLE = 1ull
                              << MAX_FIELDS; /* the element itself is used, not only fields of it */

struct loop {          /* one `for` of the body */
    struct token head; /* the word `for` */
    struct token type, variable, name;
    const char *open, *close; /* the braces around its body */
    const struct range *range;
    uint64_t fields; /* that the body uses, as bits */
    struct loc open_loc, close_loc;
    uint32_t line_number, close_number; /* of the sources, for #line */
};

/* ---- Finding --------------------------------------------------------------------------------- */

static void report(const struct glsl *glsl, struct token at, const char *message)
{
    const char *body = glsl->parts[PART_BODY].data;
    diag_error(glsl->diag, glsl_body_loc(glsl, body, (size_t)(at.text - body), at.length), "%s",
               message);
}

/* Reads `(Type v : name)` behind `for`; false: an ordinary loop. */
static bool parse_head(struct loop *loop, const char **cursor)
{
    const char *at = *cursor;
    if (!token_is(token_next(&at), "("))
        return false;
    loop->type = token_next(&at);
    if (token_is(loop->type, "const"))
        loop->type = token_next(&at);
    loop->variable = token_next(&at);
    if (!token_is(token_next(&at), ":"))
        return false;
    loop->name = token_next(&at);
    if (!token_is(token_next(&at), ")"))
        return false;
    *cursor = at;
    return true;
}

/* From the opening brace to the closing one; rejects what cannot be written out. */
static bool find_close(const struct glsl *glsl, struct loop *loop)
{
    static const char *const jumps[] = {"break", "continue", "return"};
    bool ok = true;
    int depth = 0;
    const char *cursor = loop->open;
    for (struct token token = token_next(&cursor); token.length; token = token_next(&cursor)) {
        for (int i = 0; i < 3; i++)
            if (token_is(token, jumps[i])) {
                report(glsl, token,
                       "a loop over a range is written out, so it cannot be left: "
                       "use a condition around the work instead");
                ok = false;
            }
        depth += token_is(token, "{") - token_is(token, "}");
        if (!depth) {
            loop->close = token.text;
            return ok;
        }
    }
    report(glsl, loop->head, "this loop has no closing brace");
    return false;
}

static const struct range *find_range(const struct glsl *glsl, struct token name)
{
    const char *names[64];
    size_t count = 0;
    for (uint32_t i = 0; i < glsl->pass->range_count; i++) {
        if (token_is(name, glsl->pass->ranges[i].name))
            return &glsl->pass->ranges[i];
        if (count < 64)
            names[count++] = glsl->pass->ranges[i].name;
    }
    const char *body = glsl->parts[PART_BODY].data;
    struct loc loc = glsl_body_loc(glsl, body, (size_t)(name.text - body), name.length);
    char *word = strndup(name.text, name.length);
    const char *near = word ? diag_nearest(word, names, count) : NULL;
    diag_error(glsl->diag, loc, "pass %s has no range %s%s%s%s", glsl->pass->name, word ? word : "",
               near ? ": did you mean " : "", near ? near : "",
               near ? "?" : "; list it under `ranges`");
    free(word);
    return NULL;
}

/* Which fields of the variable the body names. */
static uint64_t used_fields(const struct loop *loop)
{
    const struct structure *structure = loop->range->access->resource->structure;
    if (!structure || structure->field_count > MAX_FIELDS)
        return WHOLE;
    uint64_t fields = 0;
    const char *cursor = loop->open + 1;
    struct token before = {0};
    for (struct token token = token_next(&cursor); token.length && token.text < loop->close;
         before = token, token = token_next(&cursor)) {
        if (token.length != loop->variable.length ||
            memcmp(token.text, loop->variable.text, token.length) || token_is(before, "."))
            continue;
        const char *behind = cursor;
        uint64_t field = WHOLE;
        if (token_is(token_next(&behind), ".")) {
            struct token name = token_next(&behind);
            for (uint32_t i = 0; i < structure->field_count; i++)
                if (token_is(name, structure->fields[i].name))
                    field = 1ull << i;
        }
        fields |= field;
    }
    return fields & WHOLE ? WHOLE : fields;
}

static uint32_t source_number(const struct glsl *glsl, const struct source *source)
{
    for (uint32_t i = 0; i < glsl->model->glsl_source_count; i++)
        if (glsl->model->glsl_sources[i] == source)
            return i + 1;
    return 0;
}

static bool check_loop(const struct glsl *glsl, struct loop *loop, bool in_main)
{
    const char *body = glsl->parts[PART_BODY].data;
    if (glsl->stage != STAGE_IS_COMPUTE || !in_main) {
        report(glsl, loop->head,
               "a loop over a range stands directly in main() of a dispatch, not in another block: "
               "all invocations of the workgroup run it together");
        return false;
    }
    const char *cursor = loop->open;
    struct token brace = token_next(&cursor);
    if (!token_is(brace, "{")) {
        report(glsl, brace, "the body of a loop over a range needs braces");
        return false;
    }
    loop->open = brace.text;
    loop->range = find_range(glsl, loop->name);
    if (!find_close(glsl, loop) || !loop->range)
        return false;
    const char *element = glsl_element_type(loop->range->access->resource);
    if (!token_is(loop->type, element)) {
        struct loc loc =
            glsl_body_loc(glsl, body, (size_t)(loop->type.text - body), loop->type.length);
        diag_error(glsl->diag, loc, "range %s has elements of type %s", loop->range->name, element);
        return false;
    }
    loop->fields = used_fields(loop);
    loop->open_loc = glsl_body_loc(glsl, body, (size_t)(loop->open - body), 1);
    loop->close_loc = glsl_body_loc(glsl, body, (size_t)(loop->close - body), 1);
    loop->line_number = source_number(glsl, loop->open_loc.source);
    loop->close_number = source_number(glsl, loop->close_loc.source);
    return true;
}

/* ---- Writing --------------------------------------------------------------------------------- */

static bool is_shared(const struct range *range)
{
    return range->storage == STORAGE_SHARED;
}

/* Declares the variable and fills it. index: of the element in the cache or, behind the first,
 * in the buffer. */
static void add_element(const struct loop *loop, const char *index, struct text *out)
{
    const struct range *range = loop->range;
    const char *buffer = range->access->resource->name;
    const char *type = glsl_element_type(range->access->resource);
    int length = (int)loop->variable.length;
    const char *variable = loop->variable.text;
    if (!is_shared(range)) {
        text_add(out, "        %s %.*s = %s[%s_first + %s];\n", type, length, variable, buffer,
                 range->name, index);
    } else if (loop->fields == WHOLE) {
        text_add(out, "        %s %.*s = %s_cache[%s];\n", type, length, variable, range->name,
                 index);
    } else {
        const struct structure *structure = range->access->resource->structure;
        text_add(out, "        %s %.*s;\n", type, length, variable);
        for (uint32_t i = 0; i < structure->field_count; i++)
            if (loop->fields >> i & 1)
                text_add(out, "        %.*s.%s = %s_%s[%s];\n", length, variable,
                         structure->fields[i].name, range->name, structure->fields[i].name, index);
    }
}

static void add_body(const struct loop *loop, struct text *out)
{
    text_add(out, "#line %d %u\n", loop->open_loc.line, loop->line_number);
    text_add_bytes(out, loop->open + 1, (size_t)(loop->close - loop->open - 1));
    text_add(out, "\n    }\n");
}

/* All invocations of the workgroup copy `count` elements, which then all can read. chunk: offset
 * behind the first. */
static void add_copy(const struct glsl *glsl, const struct loop *loop, uint32_t count,
                     const char *chunk, struct text *out)
{
    const struct range *range = loop->range;
    const char *buffer = range->access->resource->name;
    const uint32_t *local = glsl->pass->local;
    text_add(out,
             "    barrier();\n    for (int i = int(gl_LocalInvocationIndex); i < %u; i += %u) {\n",
             count, local[0] * local[1] * local[2]);
    if (loop->fields == WHOLE) {
        text_add(out, "        %s_cache[i] = %s[%s_first%s + i];\n", range->name, buffer,
                 range->name, chunk);
    } else {
        const struct structure *structure = range->access->resource->structure;
        for (uint32_t i = 0; i < structure->field_count; i++)
            if (loop->fields >> i & 1)
                text_add(out, "        %s_%s[i] = %s[%s_first%s + i].%s;\n", range->name,
                         structure->fields[i].name, buffer, range->name, chunk,
                         structure->fields[i].name);
    }
    text_add(out, "    }\n    barrier();\n");
}

/* `count` elements, the first of them at `base` in the range (text; "" for the start of the
 * range). */
static void add_elements(const struct loop *loop, uint32_t count, const char *base,
                         struct text *out)
{
    const struct range *range = loop->range;
    char index[96];
    if (range->loop != LOOP_UNROLL) {
        text_add(out, "    for (int %s_k = 0; %s_k < %u; ++%s_k) {\n", range->name, range->name,
                 count, range->name);
        text_add(out, "        int %s_index = %s%s_k;\n", range->name, base, range->name);
        snprintf(index, sizeof index, "%s_%s", range->name, is_shared(range) ? "k" : "index");
        add_element(loop, index, out);
        add_body(loop, out);
        return;
    }
    for (uint32_t i = 0; i < count; i++) {
        text_add(out, "    {\n        %sint %s_index = %s%u;\n", *base ? "" : "const ", range->name,
                 base, i);
        snprintf(index, sizeof index, "%s%u", is_shared(range) ? "" : base, i);
        add_element(loop, index, out);
        add_body(loop, out);
    }
}

static void add_loop(const struct glsl *glsl, const struct loop *loop, struct text *out)
{
    const struct range *range = loop->range;
    uint32_t count = (uint32_t)range->count_value;
    bool whole = !is_shared(range) && range->loop != LOOP_UNROLL; /* nothing to do in pieces */
    uint32_t chunk = whole || !range->chunk || range->chunk > count ? count : range->chunk;
    uint32_t chunks = count ? count / chunk : 0, rest = count - chunks * chunk;
    char base[96], offset[96];
    text_add(out, "{ /* range %s: %u of %s */\n    int %s_first = %s;\n", range->name, count,
             range->access->resource->name, range->name, range->first ? range->first : "0");
    if (chunks == 1) {
        if (is_shared(range))
            add_copy(glsl, loop, chunk, "", out);
        add_elements(loop, chunk, "", out);
    } else if (chunks > 1) {
        text_add(out, "    for (int %s_base = 0; %s_base < %u; %s_base += %u) {\n", range->name,
                 range->name, chunks * chunk, range->name, chunk);
        snprintf(offset, sizeof offset, " + %s_base", range->name);
        snprintf(base, sizeof base, "%s_base + ", range->name);
        if (is_shared(range))
            add_copy(glsl, loop, chunk, offset, out);
        add_elements(loop, chunk, base, out);
        text_add(out, "    }\n");
    }
    if (rest) {
        snprintf(offset, sizeof offset, " + %u", chunks * chunk);
        snprintf(base, sizeof base, "%u + ", chunks * chunk);
        if (is_shared(range))
            add_copy(glsl, loop, rest, offset, out);
        add_elements(loop, rest, base, out);
    }
    text_add(out, "}\n#line %d %u\n", loop->close_loc.line, loop->close_number);
}

/* Shared memory for what the loops over one range read. */
static void add_caches(struct glsl *glsl, const struct range *range, uint64_t fields)
{
    struct text *out = &glsl->parts[PART_CACHES];
    const struct resource *buffer = range->access->resource;
    uint64_t count = (uint64_t)range->count_value;
    uint64_t chunk = !range->chunk || range->chunk > count ? count : range->chunk;
    if (!is_shared(range) || !chunk)
        return;
    if (fields & WHOLE)
        text_add(out, "shared %s %s_cache[%llu];\n", glsl_element_type(buffer), range->name,
                 (unsigned long long)chunk);
    for (uint32_t i = 0; buffer->structure && i < buffer->structure->field_count && i < MAX_FIELDS;
         i++) {
        const struct field *field = &buffer->structure->fields[i];
        if (!(fields >> i & 1))
            continue;
        text_add(out, "shared %s %s_%s[%llu]", glsl_type(field->type), range->name, field->name,
                 (unsigned long long)chunk);
        if (field->array_count)
            text_add(out, "[%u]", field->array_count);
        text_add(out, ";\n");
    }
}

/* ---- The body -------------------------------------------------------------------------------- */

/* Walks over the body; in_main says whether `cursor` is directly in main's block. */
struct walk {
    const char *cursor;
    int depth, parentheses;
    struct token function; /* the name before the parenthesis at depth 0 */
    struct token before;
};

static struct token walk_next(struct walk *walk)
{
    struct token token = token_next(&walk->cursor);
    if (token_is(token, "(") && !walk->depth && !walk->parentheses++)
        walk->function = walk->before;
    else if (token_is(token, ")") && !walk->depth)
        walk->parentheses--;
    walk->depth += token_is(token, "{") - token_is(token, "}");
    walk->before = token;
    return token;
}

bool glsl_ranges(struct glsl *glsl)
{
    uint32_t range_count = glsl->pass->range_count;
    uint64_t *fields = calloc(range_count + 1, sizeof *fields);
    const char *from = glsl->parts[PART_BODY].data ? glsl->parts[PART_BODY].data : "";
    struct walk walk = {.cursor = from};
    struct text out = {0};
    bool ok = fields != NULL;
    for (struct token token = walk_next(&walk); ok && token.length; token = walk_next(&walk)) {
        struct loop loop = {.head = token};
        loop.open = walk.cursor;
        if (!token_is(token, "for") || !parse_head(&loop, &loop.open))
            continue;
        if (!check_loop(glsl, &loop, walk.depth == 1 && token_is(walk.function, "main"))) {
            ok = false;
            break;
        }
        text_add_bytes(&out, from, (size_t)(token.text - from));
        add_loop(glsl, &loop, &out);
        fields[loop.range - glsl->pass->ranges] |= loop.fields;
        from = walk.cursor = loop.close + 1;
    }
    if (ok) {
        text_add(&out, "%s", from);
        for (uint32_t i = 0; i < range_count; i++)
            if (fields[i])
                add_caches(glsl, &glsl->pass->ranges[i], fields[i]);
        text_free(&glsl->parts[PART_BODY]);
        glsl->parts[PART_BODY] = out;
    } else {
        text_free(&out);
    }
    free(fields);
    return ok;
}
