/* Arithmetic of exact pipelines in the text of a stage. Calls of built-in functions that devices
 * round differently, and divisions, become calls of templates/glsl/exact.glsl; operations on float
 * constants are folded here, in float, since glslang folds in double. Called by emit_glsl.c on
 * every part that may compute, before exact.glsl is added.
 *
 * In OpenGL's GLSL text, `precise` marks what is assigned to a variable (glsl_precise.c). It does
 * not reach arguments of functions, operands of divisions, conditions and indices. There, of two
 * operations of which one takes the other's result, one becomes a call such as exact_add(a, b), so
 * that compilers find no two that they may reorder. What macros stand for is not covered.
 *
 * The text is read as tokens. Only sums, products and calls are parsed; types are known of literals,
 * constructors and declared names. So a division that cannot be seen to be of integers becomes
 * exact_divide, which has overloads for integers. */
#include "glsl.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_DEPTH = 256 }; /* of the nesting; what lies deeper is copied */

struct value {
    bool integer;  /* certainly of an integer type */
    bool constant; /* certainly a constant expression */
    bool literal;  /* a scalar constant: `number` */
    bool unmarked; /* the result of an operation that `precise` does not reach */
    double number;
};

struct name { /* declared so far */
    const char *text;
    struct value value;
    bool open; /* was const, but its value calls a function */
};

struct rewrite {
    struct arena *arena;
    const char *cursor;
    struct text *out;
    struct name *names;
    size_t name_count, name_room;
    bool integer;   /* in an array's brackets or an integer's constant: operators are of integers */
    unsigned depth; /* of sequences and signs */
    bool called;    /* since a `const`: a call that is no constant expression */
    bool marks;     /* the text is for OpenGL */
    bool unmarked;  /* `precise` does not reach operations here */
    const char *peeked_at; /* where `peeked` was read */
    struct token peeked;
};

static struct value sum(struct rewrite *rewrite);
static struct value sequence(struct rewrite *rewrite, const char *ends);
static void copy_blank(struct rewrite *rewrite, const char *end);
static void add_name(struct rewrite *rewrite, const char *text, size_t length, struct value value);

/* ---- Tokens ---------------------------------------------------------------------------------- */

static struct token peek(struct rewrite *rewrite)
{
    const char *cursor = rewrite->cursor;
    if (rewrite->peeked_at != cursor)
        rewrite->peeked = token_next(&cursor);
    rewrite->peeked_at = rewrite->cursor;
    return rewrite->peeked;
}

static bool sees(struct rewrite *rewrite, const char *text)
{
    struct token token = peek(rewrite);
    return token.length && !strncmp(token.text, text, strlen(text));
}

static bool is_word(struct token token)
{
    return token.length && (isalpha((unsigned char)*token.text) || *token.text == '_');
}

static bool is_number(struct token token)
{
    return token.length && isdigit((unsigned char)token.text[*token.text == '.']);
}

/* The end of a directive: of its last line. */
static const char *directive_end(const char *at)
{
    for (at += strcspn(at, "\n"); *at && at[-1] == '\\'; at += strcspn(at, "\n"))
        at++;
    return at;
}

/* Copies a directive. What a macro stands for is rewritten. */
static const char *copy_directive(struct rewrite *rewrite, const char *at)
{
    const char *end = directive_end(at), *cursor = at + 1;
    struct token define = token_next(&cursor), name = token_next(&cursor);
    bool macro = token_is(define, "define") && name.text < end;
    const char *body = name.text + name.length;
    if (macro && *body == '(')
        body += strcspn(body, ")");
    char *text =
        macro && body < end ? arena_strndup(rewrite->arena, body, (size_t)(end - body)) : NULL;
    text_add_bytes(rewrite->out, at, (size_t)((text ? body : end) - at));
    if (text) {
        struct rewrite inner = *rewrite;
        inner.cursor = text;
        inner.unmarked = false;
        struct value value = sequence(&inner, "");
        copy_blank(&inner, text + strlen(text));
        value.literal = false; /* another branch of #if may define it otherwise */
        if (body == name.text + name.length)
            add_name(&inner, name.text, name.length, value);
        rewrite->names = inner.names;
        rewrite->name_count = inner.name_count;
        rewrite->name_room = inner.name_room;
    }
    return end;
}

/* Copies blanks, comments and directives up to `end`. */
static void copy_blank(struct rewrite *rewrite, const char *end)
{
    const char *from = rewrite->cursor;
    for (const char *at = from; at < end;) {
        const char *stop = NULL;
        if (at[0] == '/' && at[1] == '*')
            stop = strstr(at + 2, "*/");
        if (stop) {
            at = stop + 2;
        } else if (at[0] == '/' && at[1] == '/') {
            at += strcspn(at, "\n");
        } else if (*at == '#') {
            text_add_bytes(rewrite->out, from, (size_t)(at - from));
            from = at = copy_directive(rewrite, at);
        } else {
            at++;
        }
    }
    if (end > from)
        text_add_bytes(rewrite->out, from, (size_t)(end - from));
    rewrite->cursor = end;
}

/* Copies the blanks before the next token and passes the token. */
static struct token pass(struct rewrite *rewrite)
{
    struct token token = peek(rewrite);
    copy_blank(rewrite, token.text);
    rewrite->cursor = token.text + token.length;
    return token;
}

static struct token copy(struct rewrite *rewrite)
{
    struct token token = pass(rewrite);
    text_add_bytes(rewrite->out, token.text, token.length);
    return token;
}

/* Replaces the output from `at`, `length` bytes, by `text`. */
static void replace(struct text *out, size_t at, size_t length, const char *text)
{
    char *rest = out->failed || !out->data ? NULL : strdup(out->data + at + length);
    if (!rest) {
        out->failed = true;
        return;
    }
    out->length = at;
    text_add(out, "%s%s", text, rest);
    free(rest);
}

/* ---- Names ----------------------------------------------------------------------------------- */

static struct name *find_name(const struct rewrite *rewrite, struct token token)
{
    for (size_t i = rewrite->name_count; i-- > 0;)
        if (token_is(token, rewrite->names[i].text))
            return &rewrite->names[i];
    return NULL;
}

static void add_name(struct rewrite *rewrite, const char *text, size_t length, struct value value)
{
    if (rewrite->name_count == rewrite->name_room) {
        size_t room = rewrite->name_room ? 2 * rewrite->name_room : 64;
        struct name *names = realloc(rewrite->names, room * sizeof *names);
        if (!names) {
            rewrite->out->failed = true;
            return;
        }
        rewrite->names = names;
        rewrite->name_room = room;
    }
    const char *name = arena_strndup(rewrite->arena, text, length);
    rewrite->out->failed |= !name;
    if (name)
        rewrite->names[rewrite->name_count++] = (struct name){.text = name, .value = value};
}

static bool is_integer_type(struct token token)
{
    static const char *const types[] = {"int",  "ivec2", "ivec3", "ivec4",
                                        "uint", "uvec2", "uvec3", "uvec4"};
    for (size_t i = 0; i < DT_ARRAY_COUNT(types); i++)
        if (token_is(token, types[i]))
            return true;
    return false;
}

/* Functions of GLSL that exact.glsl has. */
static bool is_replaced(struct token token)
{
    static const char names[] =
        "acos acosh asin asinh atan atanh clamp cos cosh cross degrees determinant distance dot "
        "exp exp2 faceforward fma fract inverse inversesqrt ldexp length log log2 max min mix mod "
        "normalize packHalf2x16 packSnorm2x16 packSnorm4x8 packUnorm2x16 packUnorm4x8 pow radians "
        "reflect refract round sin sinh smoothstep sqrt tan tanh unpackHalf2x16 unpackSnorm2x16 "
        "unpackSnorm4x8 unpackUnorm2x16 unpackUnorm4x8";
    for (const char *at = names; *at && *at <= *token.text; at += strspn(at, " ")) {
        size_t length = strcspn(at, " ");
        if (length == token.length && !memcmp(at, token.text, length))
            return true;
        at += length;
    }
    return false;
}

/* ---- Expressions ----------------------------------------------------------------------------- */

/* Writes the literal instead of the output from `at`; keeps line numbers. */
static void put_literal(struct rewrite *rewrite, size_t at, float number)
{
    struct text *out = rewrite->out, literal = {0};
    text_add(&literal, number < 0 ? "(" : "");
    glsl_add_float((double)number, &literal);
    text_add(&literal, number < 0 ? ")" : "");
    for (const char *c = out->data ? out->data + at : ""; *c; c++)
        if (*c == '\n')
            text_add(&literal, "\n");
    out->failed |= literal.failed;
    if (!out->failed)
        replace(out, at, out->length - at, literal.data);
    text_free(&literal);
}

/* Makes a call of an operation; `operator` is the place of its operator, which becomes a comma. */
static void put_call(struct rewrite *rewrite, const char *function, size_t at, size_t operator)
{
    bool blank = !rewrite->out->failed && rewrite->out->data[operator - 1] == ' ' &&
                 rewrite->out->data[operator - 2] != ' ';
    replace(rewrite->out, operator- blank, 1 + blank, ",");
    replace(rewrite->out, at, 0, "(");
    replace(rewrite->out, at, 0, function);
    text_add(rewrite->out, ")");
    rewrite->called = true;
}

static double compute(char operator, float a, float b)
{
    float result = operator== '+' ? a + b : operator== '-' ? a - b : operator== '*' ? a * b : a / b;
    return (double)result;
}

static bool is_power_of_two(double number)
{
    int exponent;
    return fabs(frexp(number, &exponent)) == 0.5 && exponent > -120 && exponent < 120;
}

/* What `left operator right` is in the output. */
struct place {
    size_t begin, end; /* of the left operand */
    size_t operator;
};

static struct value join(struct rewrite *rewrite, struct value left, struct value right,
                         struct place place)
{
    char operator= rewrite->out->failed ? '+' : rewrite->out->data[place.operator];
    struct value value = {.integer = left.integer && right.integer,
                          .constant = left.constant && right.constant};
    if (rewrite->integer || value.integer || operator== '%') {
        value.integer |= operator== '%';
        return value;
    }
    if (left.literal && right.literal) {
        double number = compute(operator,(float) left.number, (float)right.number);
        if (isfinite(number)) {
            put_literal(rewrite, place.begin, (float)number);
            return (struct value){.constant = true, .literal = true, .number = number};
        }
    }
    if (operator== '/' && right.literal && !right.integer && is_power_of_two(right.number)) {
        put_literal(rewrite, place.operator+ 1, (float)(1 / right.number));
        replace(rewrite->out, place.operator, 1, "* ");
        operator= '*';
    } else if (operator== '/') {
        put_call(rewrite, "exact_divide", place.begin, place.operator);
        value.constant = false;
        return value;
    } else if (value.constant) {
        replace(rewrite->out, place.end, 0, ")");
        replace(rewrite->out, place.begin, 0, "exact_value(");
        rewrite->called = true;
        value.constant = false;
        return value;
    }
    bool chained = left.unmarked || right.unmarked;
    if (rewrite->marks && chained && !value.constant)
        put_call(rewrite,
                 operator== '+' ? "exact_add" :
                 operator== '-' ? "exact_subtract"
                                : "exact_multiply",
                 place.begin, place.operator);
    /* glsl_product.c does not see that a call is a matrix: factors of a call become its arguments */
    value.unmarked = rewrite->unmarked && (operator== '*' || !chained);
    return value;
}

static struct value number(struct rewrite *rewrite)
{
    struct token token = copy(rewrite);
    bool hexadecimal = token.length > 1 && (token.text[1] | 32) == 'x', whole = true;
    for (size_t i = 0; i < token.length && !hexadecimal; i++)
        whole &= isdigit((unsigned char)token.text[i]) || (token.text[i] | 32) == 'u';
    double value = whole ? (double)strtoull(token.text, NULL, 0) : (double)strtof(token.text, NULL);
    return (struct value){.integer = whole, .constant = true, .literal = true, .number = value};
}

static struct value name_value(struct rewrite *rewrite, struct token token)
{
    const struct name *name = find_name(rewrite, token);
    if (name && name->open)
        rewrite->called = true;
    if (name)
        return name->value;
    bool integer = token.length > 3 && !memcmp(token.text, "gl_", 3) &&
                   (memmem(token.text, token.length, "ID", 2) ||
                    memmem(token.text, token.length, "Index", 5) ||
                    memmem(token.text, token.length, "Group", 5));
    return (struct value){.integer = integer};
}

/* `[i]`: what stands there is an integer. */
static void index_of(struct rewrite *rewrite)
{
    bool outer = rewrite->integer, unmarked = rewrite->unmarked;
    copy(rewrite);
    rewrite->integer = rewrite->unmarked = true;
    sequence(rewrite, "]");
    rewrite->integer = outer;
    rewrite->unmarked = unmarked;
    copy(rewrite);
}

static struct value arguments(struct rewrite *rewrite)
{
    bool outer = rewrite->integer;
    copy(rewrite);
    rewrite->integer = false;
    struct value value = sequence(rewrite, ")");
    rewrite->integer = outer;
    copy(rewrite);
    return value;
}

static bool is_constructor(struct token token)
{
    static const char *const types[] = {"float", "vec2", "vec3", "vec4", "mat2", "mat3", "mat4"};
    for (size_t i = 0; i < DT_ARRAY_COUNT(types); i++)
        if (token_is(token, types[i]))
            return true;
    return is_integer_type(token);
}

/* Of integers, min, max and clamp stay as they are. `if` and `while` are calls, too. */
static struct value call(struct rewrite *rewrite, struct token token)
{
    bool replaced = is_replaced(token), called = rewrite->called, unmarked = rewrite->unmarked;
    size_t at = rewrite->out->length;
    text_add(rewrite->out, replaced ? "exact_" : "");
    text_add_bytes(rewrite->out, token.text, token.length);
    rewrite->called = false;
    rewrite->unmarked |= !is_constructor(token);
    struct value value = arguments(rewrite);
    rewrite->unmarked = unmarked;
    const struct name *name = find_name(rewrite, token);
    bool plain = replaced && value.integer &&
                 (token_is(token, "min") || token_is(token, "max") || token_is(token, "clamp"));
    if (plain)
        replace(rewrite->out, at, strlen("exact_"), "");
    rewrite->called |= called || (replaced && !plain) || (name && name->open);
    if (token_is(token, "float"))
        return (struct value){.constant = value.constant,
                              .literal = value.literal,
                              .unmarked = value.unmarked,
                              .number = (double)(float)value.number};
    return (struct value){.integer =
                              is_integer_type(token) || plain || (name && name->value.integer),
                          .constant = is_constructor(token) && value.constant,
                          .unmarked = value.unmarked && !replaced && !name};
}

/* A name, or a call of it. */
static struct value word(struct rewrite *rewrite)
{
    struct token token = pass(rewrite);
    if (sees(rewrite, "("))
        return call(rewrite, token);
    text_add_bytes(rewrite->out, token.text, token.length);
    return is_integer_type(token) ? (struct value){0} : name_value(rewrite, token);
}

/* ( expression ) */
static struct value group(struct rewrite *rewrite)
{
    copy(rewrite);
    struct value value = sequence(rewrite, ")");
    copy(rewrite);
    return value;
}

static struct value postfix(struct rewrite *rewrite)
{
    struct token token = peek(rewrite);
    if (!is_word(token) && !is_number(token) && !token_is(token, "("))
        return (struct value){0};
    struct value value = is_number(token) ? number(rewrite)
                         : is_word(token) ? word(rewrite)
                                          : group(rewrite);
    for (;;) {
        if (sees(rewrite, "[")) {
            index_of(rewrite);
        } else if (sees(rewrite, "(")) {
            arguments(rewrite);
            value = (struct value){0};
        } else if (sees(rewrite, ".")) {
            copy(rewrite);
            if (is_word(peek(rewrite)))
                copy(rewrite);
        } else if (sees(rewrite, "++") || sees(rewrite, "--")) {
            copy(rewrite);
            copy(rewrite);
        } else {
            return value;
        }
        value.literal = false;
    }
}

static struct value unary(struct rewrite *rewrite)
{
    struct token token = peek(rewrite);
    if (!token_is(token, "-") && !token_is(token, "+") && !token_is(token, "!") &&
        !token_is(token, "~"))
        return postfix(rewrite);
    copy(rewrite);
    if (rewrite->depth > MOST_DEPTH)
        return (struct value){0};
    rewrite->depth++;
    struct value value = unary(rewrite);
    rewrite->depth--;
    if (token_is(token, "-"))
        value.number = -value.number;
    else if (!token_is(token, "+"))
        value = (struct value){.integer = value.integer, .constant = value.constant};
    return value;
}

static bool compares(struct token token)
{
    return strchr("<>", *token.text) || (strchr("=!", *token.text) && token.text[1] == '=');
}

/* Whether the next product is divided, or the next sum compared. */
static bool is_ahead(const struct rewrite *rewrite, bool division)
{
    const char *cursor = rewrite->cursor;
    struct token token, before = {0};
    for (int depth = 0; depth >= 0 && (token = token_next(&cursor)).length; before = token) {
        depth += strchr("([", *token.text) ? 1 : strchr(")]", *token.text) ? -1 : 0;
        if (depth)
            continue;
        bool sign = !before.length || strchr("*/%+-", *before.text);
        if (division ? *token.text == '/' : compares(token))
            return true;
        if (strchr("{}?:,;&|^=", *token.text) ||
            (division && (compares(token) || (!sign && strchr("+-", *token.text)))))
            return false;
    }
    return false;
}

/* Behind `a`: `/= b` becomes `= exact_divide(a, b)`. at: begin of a in the output. */
static void divide_into(struct rewrite *rewrite, size_t at, bool integer)
{
    struct text *out = rewrite->out, value = {0};
    char *left = out->failed || !out->data ? NULL : strdup(out->data + at);
    struct token slash = pass(rewrite);
    bool unmarked = rewrite->unmarked;
    size_t operator_at = out->length;
    text_add(out, "/=");
    rewrite->cursor = slash.text + 2;
    rewrite->unmarked = true;
    struct value right = sequence(rewrite, ",;)");
    rewrite->unmarked = unmarked;
    out->failed |= !left;
    if (!out->failed && !(integer && right.integer)) {
        text_add(&value, "= exact_divide(%s,", left);
        replace(out, operator_at, 2, value.data ? value.data : "");
        text_add(out, ")");
        out->failed |= value.failed;
        text_free(&value);
        rewrite->called = true;
    }
    free(left);
}

static struct value product(struct rewrite *rewrite)
{
    struct token first = peek(rewrite);
    copy_blank(rewrite, first.text);
    size_t at = rewrite->out->length;
    bool unmarked = rewrite->unmarked;
    rewrite->unmarked |= is_ahead(rewrite, true);
    struct value left = unary(rewrite);
    while (rewrite->out->length > at) {
        struct token token = peek(rewrite);
        if (token_is(token, "/") && token.text[1] == '=') {
            divide_into(rewrite, at, left.integer || rewrite->integer);
            break;
        }
        if (!token.length || !strchr("*/%", *token.text) || token.text[1] == '=')
            break;
        struct place place = {.begin = at, .end = rewrite->out->length};
        copy(rewrite);
        place.operator= rewrite->out->length - 1;
        left = join(rewrite, left, unary(rewrite), place);
    }
    rewrite->unmarked = unmarked;
    return left;
}

static struct value sum(struct rewrite *rewrite)
{
    copy_blank(rewrite, peek(rewrite).text);
    size_t at = rewrite->out->length;
    struct value left = product(rewrite);
    while (rewrite->out->length > at) {
        struct token token = peek(rewrite);
        if (!token.length || !strchr("+-", *token.text) || token.text[1] == '=')
            break;
        struct place place = {.begin = at, .end = rewrite->out->length};
        copy(rewrite);
        place.operator= rewrite->out->length - 1;
        left = join(rewrite, left, product(rewrite), place);
    }
    return left;
}

/* ---- Statements ------------------------------------------------------------------------------ */

/* Behind `const`: the declarations up to the semicolon. A constant whose value calls a function is
 * declared without `const`. */
static void constants(struct rewrite *rewrite, size_t at)
{
    struct token type = copy(rewrite);
    bool called = false, outer = rewrite->integer;
    size_t first = rewrite->name_count;
    for (;;) {
        while (sees(rewrite, "["))
            index_of(rewrite);
        struct token name = copy(rewrite);
        while (sees(rewrite, "["))
            index_of(rewrite);
        if (!sees(rewrite, "="))
            return; /* a parameter */
        copy(rewrite);
        rewrite->integer = is_integer_type(type);
        rewrite->called = false;
        struct value value = sequence(rewrite, ",;");
        called |= rewrite->called;
        value = (struct value){.integer = rewrite->integer,
                               .constant = true,
                               .literal = value.literal && token_is(type, "float"),
                               .number = (double)(float)value.number};
        rewrite->integer = outer;
        add_name(rewrite, name.text, name.length, value);
        if (!sees(rewrite, ","))
            break;
        copy(rewrite);
    }
    for (size_t i = first; called && i < rewrite->name_count; i++) {
        rewrite->names[i].value.constant = rewrite->names[i].value.literal = false;
        rewrite->names[i].open = true;
    }
    if (called)
        replace(rewrite->out, at, strlen("const "), "");
}

static bool is_statement(struct token token)
{
    static const char *const words[] = {"return", "else", "do",      "in",    "out",
                                        "inout",  "case", "precise", "struct"};
    for (size_t i = 0; i < DT_ARRAY_COUNT(words); i++)
        if (token_is(token, words[i]))
            return true;
    return false;
}

/* Remembers the type of `type name`. */
static void declare(struct rewrite *rewrite, struct token type, struct token name)
{
    const char *cursor = name.text + name.length;
    struct token behind = token_next(&cursor);
    if (is_word(type) && !is_statement(type) && is_word(name) && behind.length == 1 &&
        strchr("=;,[)(", *behind.text))
        add_name(rewrite, name.text, name.length, (struct value){.integer = is_integer_type(type)});
}

/* Everything up to one of `ends` or an end of the enclosing text. The value of a single expression;
 * of a list, whether all are integers and constant. */
static struct value sequence(struct rewrite *rewrite, const char *ends)
{
    struct value value = {.integer = true, .constant = true};
    struct token before = {0}, token;
    int items = 0;
    bool unmarked = rewrite->unmarked, compared = false, any = false;
    rewrite->depth++;
    for (; (token = peek(rewrite)).length && !strchr(ends, *token.text); before = token, items++) {
        size_t length = rewrite->out->length;
        if (rewrite->depth > MOST_DEPTH) {
            value = (struct value){0};
            copy(rewrite);
        } else if (token_is(token, "const") || is_statement(token)) {
            bool constant = token_is(copy(rewrite), "const");
            if (constant)
                constants(rewrite, rewrite->out->length - strlen("const"));
            const char *end = token_is(token, "case") ? ":" : token_is(token, "struct") ? "}" : "";
            while (*end && peek(rewrite).length && !sees(rewrite, end))
                copy(rewrite);
        } else if (is_word(token) || is_number(token) || strchr("(+-!~", *token.text)) {
            declare(rewrite, before, token);
            rewrite->unmarked = unmarked || compared || is_ahead(rewrite, false);
            struct value item = sum(rewrite);
            rewrite->unmarked = unmarked;
            any |= item.unmarked;
            item.integer &= value.integer;
            item.constant &= value.constant;
            value = item;
        } else if (token_is(token, ",")) {
            copy(rewrite);
        } else {
            value.constant = false;
            compared = compares(token) || (compared && !strchr("?:;&|{}", *token.text));
            copy(rewrite);
        }
        if (rewrite->out->length == length && rewrite->cursor == token.text)
            copy(rewrite);
        if (rewrite->out->failed)
            break;
    }
    rewrite->depth--;
    if (items != 1)
        value =
            (struct value){.integer = items && value.integer, .constant = items && value.constant};
    value.unmarked = any;
    return value;
}

/* Parameters are declared later, before all parts. */
static void add_params(struct rewrite *rewrite, const struct pipeline *pipeline)
{
    add_name(rewrite, "PI", 2,
             (struct value){.constant = true, .literal = true, .number = (double)3.14159265359f});
    for (uint32_t i = 0; i < pipeline->param_count; i++) {
        const struct param *param = &pipeline->params[i];
        bool constant = !param->live && !param->uniform;
        struct value value = {.integer = param->type >= DT_TYPE_INT && param->type <= DT_TYPE_UVEC4,
                              .constant = constant,
                              .literal = constant && param->type == DT_TYPE_FLOAT,
                              .number = (double)(float)param->value[0]};
        add_name(rewrite, param->name, strlen(param->name), value);
    }
}

void glsl_exact(struct glsl *glsl)
{
    struct rewrite rewrite = {.arena = glsl->model->arena, .marks = glsl->driver};
    struct text params = {0};
    rewrite.out = &params;
    add_params(&rewrite, glsl->pipeline);
    for (int part = PART_LIBRARY; part < PART_COUNT; part++) {
        struct text *text = &glsl->parts[part], out = {.failed = text->failed || params.failed};
        if (part == PART_RESOURCES || !text->data)
            continue;
        rewrite.cursor = text->data;
        rewrite.out = &out;
        sequence(&rewrite, "");
        if (!out.failed)
            copy_blank(&rewrite, text->data + text->length);
        text_free(text);
        *text = out;
    }
    free(rewrite.names);
}
