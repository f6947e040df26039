/* Exactness of OpenGL's GLSL text. SPIR-V can mark every operation (spirv.c); GLSL can only mark
 * variables, with `precise`. So every variable and parameter that a stage declares gets the
 * qualifier, and function results go through such a variable. Buffers and gl_Position are marked
 * where they are declared. For values that no variable holds, such as arguments, glsl_exact.c writes
 * calls. Called by emit_glsl.c on the complete text; line numbers do not change. */
#include "glsl.h"

#include <ctype.h>
#include <string.h>

struct rewrite {
    struct text *out;
    const char *copied;     /* all before it is in `out` */
    struct token before;    /* the previous token */
    int depth, parentheses; /* open braces and parentheses */
    bool function;          /* the open brace of depth 1 is a function's */
    struct token result;    /* type that the function returns */
    struct token first;     /* of the declaration at depth 0 */
    bool globals;           /* some variables are PRECISE */
};

static bool is_name(struct token token)
{
    return token.length && (isalpha((unsigned char)*token.text) || *token.text == '_');
}

/* Copies up to `at`, then adds `text`. */
static void insert(struct rewrite *rewrite, const char *at, const char *text)
{
    text_add_bytes(rewrite->out, rewrite->copied, (size_t)(at - rewrite->copied));
    text_add(rewrite->out, "%s", text);
    rewrite->copied = at;
}

/* Whether a declaration may begin after the previous token. After `(` or `,`: a parameter, or the
 * head of a `for`. */
static bool begins_declaration(const struct rewrite *rewrite)
{
    struct token before = rewrite->before;
    if (!before.length || token_is(before, ";") || token_is(before, "{") || token_is(before, "}"))
        return true;
    if (token_is(before, "(") || token_is(before, ",") || token_is(before, "in") ||
        token_is(before, "out") || token_is(before, "inout"))
        return rewrite->parentheses > 0;
    return token_is(before, "shared");
}

/* Integers too, since they may come from float arithmetic: ivec2(floor(x * n)). Loop counters stay
 * unmarked, for readability. */
static bool takes_precise(const struct rewrite *rewrite, struct token type)
{
    static const char *const others[] = {"const", "precise", "return", "else"};
    for (size_t i = 0; i < DT_ARRAY_COUNT(others); i++)
        if (token_is(type, others[i]))
            return false;
    return is_name(type) &&
           !(rewrite->depth && token_is(rewrite->before, "(") && token_is(type, "int"));
}

/* Whether `type name` is a declaration, judged by the token behind the name. */
static bool declares(struct token type, struct token name, struct token behind)
{
    return is_name(type) && is_name(name) && behind.length == 1 && strchr("=;,[)", *behind.text);
}

static void declaration(struct rewrite *rewrite, struct token type, const char *cursor)
{
    if (!begins_declaration(rewrite) || (rewrite->depth && !rewrite->function) ||
        !takes_precise(rewrite, type))
        return;
    struct token name = token_next(&cursor), behind = token_next(&cursor);
    if (!declares(type, name, behind))
        return;
    bool global = !rewrite->depth && !rewrite->parentheses && !token_is(rewrite->before, "shared");
    insert(rewrite, type.text, global ? "PRECISE " : "precise ");
    rewrite->globals |= global;
}

/* `return a + b;` at `token` returns through a variable. A single name or literal stays. */
static void result(struct rewrite *rewrite, struct token token, const char *cursor)
{
    const char *at = cursor;
    struct token end = token_next(&at);
    bool alone = true;
    for (; end.length && !token_is(end, ";"); end = token_next(&at))
        alone &= end.length > 1 || !strchr("(+-*/", *end.text);
    if (!rewrite->function || !end.length || alone)
        return;
    insert(rewrite, token.text, "{ precise ");
    text_add_bytes(rewrite->out, rewrite->result.text, rewrite->result.length);
    text_add(rewrite->out, " result =");
    rewrite->copied = cursor;
    insert(rewrite, end.text, "; return result; }");
    rewrite->copied = end.text + 1;
}

static void walk(struct rewrite *rewrite, struct token token)
{
    if (!rewrite->depth && !rewrite->parentheses) {
        if (!rewrite->before.length || token_is(rewrite->before, ";") ||
            token_is(rewrite->before, "}"))
            rewrite->first = token;
        if (token_is(token, "{")) {
            rewrite->function = token_is(rewrite->before, ")");
            rewrite->result = rewrite->first;
        }
    }
    rewrite->depth += token_is(token, "{") - token_is(token, "}");
    rewrite->parentheses += token_is(token, "(") - token_is(token, ")");
    rewrite->before = token;
}

/* glslang (12) writes an invalid module for a global variable that is declared with `precise`. As
 * spirv.c marks the operations, SPIR-V needs no qualifier: PRECISE is empty where GL_SPIRV is
 * defined. Inserts the macro after the line of #version. */
static void define_precise(struct text *text)
{
    const char *behind = strchr(text->data, '\n') + 1;
    struct text out = {.failed = text->failed};
    text_add_bytes(&out, text->data, (size_t)(behind - text->data));
    text_add(&out, "#ifdef GL_SPIRV\n#define PRECISE\n#else\n#define PRECISE precise\n#endif\n%s",
             behind);
    text_free(text);
    *text = out;
}

bool glsl_check_precise(const struct glsl *glsl)
{
    const char *body = glsl->parts[PART_BODY].data, *cursor = body ? body : "";
    struct token token;
    for (int depth = 0; (token = token_next(&cursor)).length;) {
        const char *at = cursor;
        depth += token_is(token, "{") - token_is(token, "}");
        if (depth || !token_is(token, "precise"))
            continue;
        struct token type = token_next(&at), name = token_next(&at), behind = token_next(&at);
        if (!declares(type, name, behind))
            continue;
        diag_error(glsl->diag, glsl_body_loc(glsl, body, (size_t)(token.text - body), token.length),
                   "glslang cannot declare a global variable with `precise`; write `%.*s %.*s;` "
                   "and `precise %.*s;` behind it",
                   (int)type.length, type.text, (int)name.length, name.text, (int)name.length,
                   name.text);
        return false;
    }
    return true;
}

void glsl_precise(struct text *text)
{
    struct text out = {.failed = text->failed};
    struct rewrite rewrite = {.out = &out, .copied = text->data};
    const char *cursor = text->data ? text->data : "";
    for (struct token token = token_next(&cursor); token.length; token = token_next(&cursor)) {
        if (token.text >= rewrite.copied) {
            if (token_is(token, "return"))
                result(&rewrite, token, cursor);
            else if (token_is(token, "out") && !rewrite.depth && !rewrite.parentheses)
                insert(&rewrite, token.text, "precise ");
            else
                declaration(&rewrite, token, cursor);
        }
        walk(&rewrite, token);
    }
    insert(&rewrite, cursor, "");
    if (rewrite.globals && out.data)
        define_precise(&out);
    text_free(text);
    *text = out;
}
