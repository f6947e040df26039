/* Expands `for (Type v : range) { ... }`. CPU drivers read a small array that all invocations
 * share twenty times faster from shared memory at literal indices than in a loop over a buffer. If
 * the plan says so and the generator knows the count, the loop becomes such reads. */
#include "glsl.h"
#include "plan/plan.h"
#include "base/nearest.h"

#include <ctype.h>
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
    uint64_t fields; /* mask of those that the body uses */
    bool copied;     /* at the start of main(), for all loops */
    bool words;      /* see by_words() */
    struct loc open_loc, close_loc;
    uint32_t line_number, close_number; /* of the sources, for #line */
};

/* ---- Finding --------------------------------------------------------------------------------- */

static void report_range(const struct glsl *glsl, struct token at, const char *message)
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

/* Finds the closing brace; rejects jumps, which cannot be expanded. */
static bool find_close(const struct glsl *glsl, struct loop *loop)
{
    static const char *const jumps[] = {"break", "continue", "return"};
    bool ok = true;
    int depth = 0;
    const char *cursor = loop->open;
    for (struct token token = token_next(&cursor); token.length; token = token_next(&cursor)) {
        for (int i = 0; i < 3; i++)
            if (token_is(token, jumps[i])) {
                report_range(
                    glsl, token,
                    "a loop over a range is unrolled: `break`, `continue` and `return` are "
                    "not allowed; put the work in an `if`");
                ok = false;
            }
        depth += token_is(token, "{") - token_is(token, "}");
        if (!depth) {
            loop->close = token.text;
            return ok;
        }
    }
    report_range(glsl, loop->head, "this loop has no closing brace");
    return false;
}

static const struct range *find_range(const struct glsl *glsl, struct token name)
{
    const char *names[64];
    size_t count = 0;
    EACH(range, glsl->pass->ranges, glsl->pass->range_count) {
        if (token_is(name, range->name))
            return range;
        if (count < 64)
            names[count++] = range->name;
    }
    const char *body = glsl->parts[PART_BODY].data;
    struct loc loc = glsl_body_loc(glsl, body, (size_t)(name.text - body), name.length);
    char *word = strndup(name.text, name.length);
    const char *near = word ? nearest_name(word, names, count) : NULL;
    diag_error(glsl->diag, loc, "pass %s has no range %s%s%s%s", glsl->pass->name, word ? word : "",
               near ? ": did you mean " : "", near ? near : "",
               near ? "?" : "; list it under `ranges`");
    free(word);
    return NULL;
}

/* Mask of the variable's fields that the body uses, or WHOLE. */
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

static bool range_is_shared(const struct range *range)
{
    return range->storage == STORAGE_SHARED;
}

/* Whether the stage reads elements of the buffer, outside of shared ranges. */
static bool is_indexed(const struct glsl *glsl, const struct access *access)
{
    const struct pass *pass = glsl->pass;
    bool indexed = find_word(glsl->parts[PART_BODY].data, access_word(access));
    for (uint32_t i = 0; i < pass->range_count && !indexed; i++) {
        const struct range *range = &pass->ranges[i];
        indexed = (range->access == access && !range_is_shared(range)) ||
                  (range->first && find_word(range->first, access_word(access)));
    }
    return indexed;
}

/* Whether the range is copied from a uniform block word by word, not field by field. A CPU runs the
 * copy for all invocations, even those with nothing to copy, and pays for each component that one
 * invocation copies. The block then has words in place of elements, and OpenGL takes one block for a
 * binding. */
static bool by_words(const struct glsl *glsl, const struct range *range)
{
    return range_is_shared(range) && range->access->kind & DT_READ_UNIFORM &&
           !is_indexed(glsl, range->access);
}

static bool check_loop(const struct glsl *glsl, struct loop *loop, bool in_main)
{
    const char *body = glsl->parts[PART_BODY].data;
    if (glsl->stage != STAGE_IS_COMPUTE || !in_main) {
        report_range(
            glsl, loop->head,
            "a loop over a range stands directly in main() of a dispatch, not in another block: "
            "all invocations of the workgroup run it together");
        return false;
    }
    const char *cursor = loop->open;
    struct token brace = token_next(&cursor);
    if (!token_is(brace, "{")) {
        report_range(glsl, brace, "the body of a loop over a range needs braces");
        return false;
    }
    loop->open = brace.text;
    loop->range = find_range(glsl, loop->name);
    if (!find_close(glsl, loop) || !loop->range)
        return false;
    const char *element = glsl_element_type(loop->range->access->resource);
    if (!token_is(loop->type, element) && !token_is(loop->type, "auto")) {
        struct loc loc =
            glsl_body_loc(glsl, body, (size_t)(loop->type.text - body), loop->type.length);
        return diag_error(glsl->diag, loc, "range %s has elements of type %s", loop->range->name,
                          element);
    }
    loop->fields = used_fields(loop);
    loop->words = by_words(glsl, loop->range);
    loop->open_loc = glsl_body_loc(glsl, body, (size_t)(loop->open - body), 1);
    loop->close_loc = glsl_body_loc(glsl, body, (size_t)(loop->close - body), 1);
    loop->line_number = source_number(glsl, loop->open_loc.source);
    loop->close_number = source_number(glsl, loop->close_loc.source);
    return true;
}

/* ---- Writing --------------------------------------------------------------------------------- */

static uint32_t chunk_of(const struct range *range)
{
    uint32_t count = (uint32_t)range->count_value;
    bool whole = !range_is_shared(range) && range->loop != LOOP_UNROLL; /* needs no chunks */
    return whole || !range->chunk || range->chunk > count ? count : range->chunk;
}

/* Reads a value `offset` bytes into element `index` of a cache of words. */
static void add_words(const struct range *range, enum dt_type type, const char *index,
                      uint32_t offset, struct text *out)
{
    const struct type_info *info = type_info(type);
    uint32_t stride = range->access->resource->stride / 4;
    bool number = strspn(index, "0123456789") == strlen(index), matrix = info->columns > 1;
    bool real = type <= DT_TYPE_VEC4 || matrix;
    text_add(out, "%s(", info->name);
    for (uint32_t i = 0; i < info->columns * info->components; i++) {
        uint32_t word = offset / 4 + i / info->components * 4 + i % info->components;
        text_add(out, "%s%s%s_words[", i ? ", " : "", real ? "uintBitsToFloat(" : "", range->name);
        if (number)
            text_add(out, "%lu", strtoul(index, NULL, 10) * stride + word);
        else
            text_add(out, "%s * %u + %u", index, stride, word);
        text_add(out, "]%s", real ? ")" : "");
    }
    text_add(out, ")");
}

static void add_field(const struct loop *loop, const struct field *field, const char *index,
                      struct text *out)
{
    const struct range *range = loop->range;
    int length = (int)loop->variable.length;
    uint32_t count = field->array_count ? field->array_count : 1;
    if (!loop->words) {
        text_add(out, "        %.*s.%s = %s_%s[%s];\n", length, loop->variable.text, field->name,
                 range->name, field->name, index);
        return;
    }
    for (uint32_t i = 0; i < count; i++) {
        text_add(out, "        %.*s.%s", length, loop->variable.text, field->name);
        if (field->array_count)
            text_add(out, "[%u]", i);
        text_add(out, " = ");
        add_words(range, field->type, index, field->offset + i * field->array_stride, out);
        text_add(out, ";\n");
    }
}

/* Declares the variable and fills it. index: of the element in the cache; without a cache, in the
 * buffer after the range's first. */
static void add_element(const struct loop *loop, const char *index, struct text *out)
{
    const struct range *range = loop->range;
    const struct resource *buffer = range->access->resource;
    const char *type = glsl_element_type(buffer);
    const struct structure *structure = buffer->structure;
    int length = (int)loop->variable.length;
    const char *variable = loop->variable.text;
    if (!range_is_shared(range)) {
        text_add(out, "        %s %.*s = %s[%s_first + %s];\n", type, length, variable,
                 access_word(range->access), range->name, index);
    } else if (loop->words && !structure) {
        text_add(out, "        %s %.*s = ", type, length, variable);
        add_words(range, buffer->type, index, 0, out);
        text_add(out, ";\n");
    } else if (loop->fields == WHOLE && !loop->words) {
        text_add(out, "        %s %.*s = %s_cache[%s];\n", type, length, variable, range->name,
                 index);
    } else {
        text_add(out, "        %s %.*s;\n", type, length, variable);
        for (uint32_t i = 0; i < structure->field_count; i++)
            if (loop->fields == WHOLE || loop->fields >> i & 1)
                add_field(loop, &structure->fields[i], index, out);
    }
}

static void add_body(const struct loop *loop, struct text *out)
{
    text_add(out, "#line %d %u\n", loop->open_loc.line, loop->line_number);
    text_add_bytes(out, loop->open + 1, (size_t)(loop->close - loop->open - 1));
    text_add(out, "\n    }\n");
}

/* All invocations of the workgroup copy `count` elements. chunk: offset after the range's first. Of
 * a storage buffer only the used fields are copied, because a CPU driver loads every component of
 * every lane separately. */
static void add_copy(const struct glsl *glsl, const struct loop *loop, uint32_t count,
                     const char *chunk, struct text *out)
{
    const struct range *range = loop->range;
    const struct resource *buffer = range->access->resource;
    const struct structure *structure = buffer->structure;
    const uint32_t *local = glsl->pass->local;
    const char *name = access_word(range->access);
    uint32_t words = loop->words ? buffer->stride / 4 : 1;
    uint32_t copied = count * words, invocations = local[0] * local[1] * local[2];
    if (copied <= invocations) /* a loop costs a CPU more checks for each vector */
        text_add(out,
                 "    if (gl_LocalInvocationIndex < %uu) {\n"
                 "        int i = int(gl_LocalInvocationIndex);\n",
                 copied);
    else
        text_add(out, "    for (int i = int(gl_LocalInvocationIndex); i < %u; i += %u) {\n", copied,
                 invocations);
    if (loop->words)
        text_add(out, "        %s_words[i] = %s_quads[(%s_first%s) * %u + (i >> 2)][i & 3];\n",
                 range->name, name, range->name, chunk, words / 4);
    else if (loop->fields == WHOLE)
        text_add(out, "        %s_cache[i] = %s[%s_first%s + i];\n", range->name, name, range->name,
                 chunk);
    for (uint32_t i = 0; !loop->words && structure && i < structure->field_count; i++)
        if (loop->fields >> i & 1)
            text_add(out, "        %s_%s[i] = %s[%s_first%s + i].%s;\n", range->name,
                     structure->fields[i].name, name, range->name, chunk,
                     structure->fields[i].name);
    text_add(out, "    }\n");
}

/* Copies between two barriers, since earlier loops may still read the old elements. */
static void add_late_copy(const struct glsl *glsl, const struct loop *loop, uint32_t count,
                          const char *chunk, struct text *out)
{
    if (!range_is_shared(loop->range) || loop->copied)
        return;
    text_add(out, "    barrier();\n");
    add_copy(glsl, loop, count, chunk, out);
    text_add(out, "    barrier();\n");
}

static void add_first(const struct range *range, struct text *out)
{
    text_add(out, "    int %s_first = %s;\n", range->name, range->first ? range->first : "0");
}

/* Writes the body for one element of a rolled loop, whose braces are open. base: as below; `after`
 * the counter. */
static void add_turn(const struct loop *loop, const char *base, uint32_t after, struct text *out)
{
    const struct range *range = loop->range;
    char index[96], counter[96];
    snprintf(counter, sizeof counter, after ? "(%s_k + %u)" : "%s_k", range->name, after);
    text_add(out, "        int %s_index = %s%s;\n", range->name, base, counter);
    snprintf(index, sizeof index, "%s_index", range->name);
    add_element(loop, range_is_shared(range) ? counter : index, out);
    add_body(loop, out);
}

/* A loop with `turn` elements per turn, for a number of elements that it divides. */
static void add_rolled(const struct loop *loop, uint32_t count, const char *base, struct text *out)
{
    const char *name = loop->range->name;
    uint32_t turn = loop->range->turn;
    if (turn == 1) {
        text_add(out, "    for (int %s_k = 0; %s_k < %u; ++%s_k) {\n", name, name, count, name);
        add_turn(loop, base, 0, out);
        return;
    }
    text_add(out, "    for (int %s_k = 0; %s_k < %u; %s_k += %u) {\n", name, name, count, name,
             turn);
    for (uint32_t i = 0; i < turn; i++) {
        text_add(out, "    {\n");
        add_turn(loop, base, i, out);
    }
    text_add(out, "    }\n");
}

/* Writes the body for `count` elements. base: text before the index, "" for the start of the
 * range. */
static void add_elements(const struct loop *loop, uint32_t count, const char *base,
                         struct text *out)
{
    const struct range *range = loop->range;
    char index[96];
    uint32_t rolled = range->loop == LOOP_UNROLL ? 0 : count - count % range->turn;
    if (rolled)
        add_rolled(loop, rolled, base, out);
    for (uint32_t i = rolled; i < count; i++) {
        text_add(out, "    {\n        %sint %s_index = %s%u;\n", *base ? "" : "const ", range->name,
                 base, i);
        snprintf(index, sizeof index, "%s%u", range_is_shared(range) ? "" : base, i);
        add_element(loop, index, out);
        add_body(loop, out);
    }
}

/* The loop reads the count at run time, so the text is the same for all counts. */
static void add_counted(const struct loop *loop, struct text *out)
{
    const struct range *range = loop->range;
    const char *name = range->name;
    char index[96];
    text_add(out, "    int %s_count = ", name);
    expr_emit_glsl(range->count, out);
    text_add(out, ";\n    for (int %s_index = 0; %s_index < %s_count; ++%s_index) {\n", name, name,
             name, name);
    snprintf(index, sizeof index, "%s_index", name);
    add_element(loop, index, out);
    add_body(loop, out);
}

/* Writes `count` elements after the first `done`. */
static void add_range_block(const struct glsl *glsl, const struct loop *loop, uint32_t done,
                            uint32_t count, struct text *out)
{
    char base[96] = "", offset[96] = "";
    if (done) {
        snprintf(offset, sizeof offset, " + %u", done);
        snprintf(base, sizeof base, "%u + ", done);
    }
    add_late_copy(glsl, loop, count, offset, out);
    add_elements(loop, count, base, out);
}

/* A loop over full blocks. */
static void add_blocks(const struct glsl *glsl, const struct loop *loop, uint32_t chunks,
                       uint32_t chunk, struct text *out)
{
    const char *name = loop->range->name;
    char base[96], offset[96];
    text_add(out, "    for (int %s_base = 0; %s_base < %u; %s_base += %u) {\n", name, name,
             chunks * chunk, name, chunk);
    snprintf(offset, sizeof offset, " + %s_base", name);
    snprintf(base, sizeof base, "%s_base + ", name);
    add_late_copy(glsl, loop, chunk, offset, out);
    add_elements(loop, chunk, base, out);
    text_add(out, "    }\n");
}

/* Whether the blocks follow each other without a loop around them. CPU drivers read shared memory
 * lane by lane inside of loops, even at literal indices. */
static bool is_straight(const struct glsl *glsl, const struct range *range)
{
    return range_is_shared(range) && range->loop == LOOP_UNROLL && !glsl->pipeline->gpu &&
           range->count_value <= UNROLLED_LIMIT;
}

static void add_loop(const struct glsl *glsl, const struct loop *loop, struct text *out)
{
    const struct range *range = loop->range;
    uint32_t count = (uint32_t)range->count_value, chunk = chunk_of(range);
    uint32_t chunks = count ? count / chunk : 0, done = 0;
    if (range->counted)
        text_add(out, "{ /* range %s of %s */\n", range->name, access_word(range->access));
    else
        text_add(out, "{ /* range %s: %u of %s */\n", range->name, count,
                 access_word(range->access));
    if (!loop->copied)
        add_first(range, out);
    if (range->counted) {
        add_counted(loop, out);
        done = count;
    } else if (chunks > 1 && !is_straight(glsl, range)) {
        add_blocks(glsl, loop, chunks, chunk, out);
        done = chunks * chunk;
    }
    for (; done < count; done += chunk)
        add_range_block(glsl, loop, done, count - done < chunk ? count - done : chunk, out);
    text_add(out, "}\n#line %d %u\n", loop->close_loc.line, loop->close_number);
}

/* Declares shared memory for the elements or fields of one range. */
static void add_caches(struct glsl *glsl, const struct range *range, uint64_t fields)
{
    struct text *out = &glsl->parts[PART_CACHES];
    const struct resource *buffer = range->access->resource;
    uint64_t count = (uint64_t)range->count_value;
    uint64_t chunk = !range->chunk || range->chunk > count ? count : range->chunk;
    if (!range_is_shared(range) || !chunk)
        return;
    if (by_words(glsl, range)) {
        text_add(out, "shared uint %s_words[%llu];\n", range->name,
                 (unsigned long long)chunk * buffer->stride / 4);
        return;
    }
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

/* Walks over the tokens of the body; knows the function and the depth of braces. */
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

struct loops {
    struct loop *list;
    size_t count;
    uint64_t *fields; /* by range of the pass: mask of all fields that its loops use */
    const char *main; /* behind the opening brace of main() */
};

static bool find_loops(const struct glsl *glsl, struct loops *loops)
{
    struct walk walk = {.cursor = glsl->parts[PART_BODY].data ? glsl->parts[PART_BODY].data : ""};
    for (struct token token = walk_next(&walk); token.length; token = walk_next(&walk)) {
        struct loop loop = {.head = token};
        loop.open = walk.cursor;
        if (token_is(token, "{") && walk.depth == 1 && token_is(walk.function, "main"))
            loops->main = walk.cursor;
        if (!token_is(token, "for") || !parse_head(&loop, &loop.open))
            continue;
        struct loop *list = realloc(loops->list, (loops->count + 1) * sizeof *list);
        if (!list)
            return false;
        loops->list = list;
        if (!check_loop(glsl, &loop, walk.depth == 1 && token_is(walk.function, "main")))
            return false;
        loops->list[loops->count++] = loop;
        loops->fields[loop.range - glsl->pass->ranges] |= loop.fields;
        walk.cursor = loop.close + 1;
    }
    return true;
}

/* Whether the word names a constant; an instance's has `_` for each dot. */
static bool token_is_constant(struct token token, const char *name)
{
    for (size_t i = 0; i < token.length; i++)
        if (!name[i] || token.text[i] != (name[i] == '.' ? '_' : name[i]))
            return false;
    return !name[token.length];
}

/* Whether a range's `first` has the same value anywhere in main(). */
static bool is_global(const struct glsl *glsl, const char *first)
{
    const struct pipeline *pipeline = glsl->pipeline;
    bool member = false;
    for (struct token token = token_next(&first); token.length; token = token_next(&first)) {
        bool known = member || !(isalpha((unsigned char)*token.text) || *token.text == '_') ||
                     token_is(token, "interleave_class") || token_is(token, "gl_WorkGroupID");
        for (uint32_t i = 0; i < pipeline->param_count && !known; i++)
            known = token_is(token, pipeline->params[i].name);
        for (uint32_t i = 0; i < pipeline->constant_count && !known; i++)
            known = token_is_constant(token, pipeline->constants[i].name);
        for (uint32_t i = 0; i < glsl->pass->define_count && !known; i++)
            known = token_is(token, glsl->pass->defines[i].name);
        if (!known)
            return false;
        member = token_is(token, ".");
    }
    return true;
}

/* At the beginning of main(), copies every range that fits one chunk and that the pass only reads.
 * Then one barrier serves all loops, and few values live across it: on a CPU, a barrier switches
 * between as many threads of control as the workgroup has vectors. */
static void add_first_copies(const struct glsl *glsl, const struct loops *loops, struct text *out)
{
    bool any = false;
    for (size_t i = 0; i < loops->count; i++) {
        struct loop *loop = &loops->list[i];
        const struct range *range = loop->range;
        bool before = false;
        loop->copied = range_is_shared(range) && range->access->mode == MODE_READ &&
                       range->count_value && chunk_of(range) == range->count_value &&
                       is_global(glsl, range->first ? range->first : "0");
        for (size_t k = 0; k < i && !before; k++)
            before = loops->list[k].range == range;
        if (!loop->copied || before)
            continue;
        struct loop all = *loop;
        all.fields = loops->fields[range - glsl->pass->ranges];
        all.fields = all.fields & WHOLE ? WHOLE : all.fields;
        text_add(out, "%s", any ? "" : "\n{ /* what the loops over ranges read */\n");
        add_first(range, out);
        add_copy(glsl, &all, (uint32_t)range->count_value, "", out);
        any = true;
    }
    if (!any)
        return;
    const char *body = glsl->parts[PART_BODY].data;
    struct loc loc = glsl_body_loc(glsl, body, (size_t)(loops->main - body), 1);
    text_add(out, "    barrier();\n}\n#line %d %u\n", loc.line, source_number(glsl, loc.source));
}

static void write_loops(struct glsl *glsl, const struct loops *loops, struct text *out)
{
    const char *from = glsl->parts[PART_BODY].data ? glsl->parts[PART_BODY].data : "";
    if (loops->count) {
        text_add_bytes(out, from, (size_t)(loops->main - from));
        add_first_copies(glsl, loops, out);
        from = loops->main;
    }
    for (size_t i = 0; i < loops->count; i++) {
        const struct loop *loop = &loops->list[i];
        text_add_bytes(out, from, (size_t)(loop->head.text - from));
        add_loop(glsl, loop, out);
        from = loop->close + 1;
    }
    text_add(out, "%s", from);
    for (uint32_t i = 0; i < glsl->pass->range_count; i++)
        if (loops->fields[i])
            add_caches(glsl, &glsl->pass->ranges[i], loops->fields[i]);
}

bool glsl_ranges(struct glsl *glsl)
{
    struct loops loops = {.fields = calloc(glsl->pass->range_count + 1, sizeof *loops.fields)};
    bool ok = loops.fields && find_loops(glsl, &loops);
    if (ok) {
        struct text out = {0};
        write_loops(glsl, &loops, &out);
        text_free(&glsl->parts[PART_BODY]);
        glsl->parts[PART_BODY] = out;
    }
    free(loops.list);
    free(loops.fields);
    return ok;
}
