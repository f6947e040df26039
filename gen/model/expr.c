/* Integer expressions: parsed with the place of every part, resolved against the model, evaluated
 * with overflow checks, and printed as C or GLSL. */
#include "expr.h"
#include "names.h"

#include <ctype.h>
#include <inttypes.h>
#include <string.h>

enum operation {
    OP_NUMBER,
    OP_FRAME_WIDTH,
    OP_FRAME_HEIGHT,
    OP_NAME, /* leaves */
    OP_NEGATE,
    OP_NOT,
    OP_MULTIPLY,
    OP_DIVIDE,
    OP_REMAINDER,
    OP_ADD,
    OP_SUBTRACT,
    OP_SHIFT_LEFT,
    OP_SHIFT_RIGHT,
    OP_LESS,
    OP_LESS_EQUAL,
    OP_GREATER,
    OP_GREATER_EQUAL,
    OP_EQUAL,
    OP_NOT_EQUAL,
    OP_AND,
    OP_OR,
    OP_CHOOSE,
    OP_MIN,
    OP_MAX,
    OP_CEIL_DIV
};

struct expr {
    enum operation operation;
    struct expr *operand[3];
    int64_t number;
    const char *name;        /* perhaps with dots; resolving takes off the component */
    const char *base, *last; /* of a name with dots: what precedes the last dot, and follows it */
    int component;           /* of a vector parameter; -1: none */
    struct loc loc;
    const struct param *param;       /* resolved */
    const struct constant *constant; /* resolved */
};

/* ---- Parsing --------------------------------------------------------------------------------- */

struct parser {
    struct model *model;
    struct diag *diag;
    const char *text;
    size_t at;
    struct loc loc; /* of the whole text */
    const struct expr_names *names;
    bool replaces; /* the text stands for a name: all parts have the place of that name */
    unsigned depth, terms;
    bool failed;
};

enum { DEEPEST = 64 }; /* later stages recurse over nesting and terms */

static struct loc place_in_text(const struct parser *p, size_t from, size_t to)
{
    struct loc loc = p->loc;
    if (p->replaces)
        return loc;
    loc.column += (int)from;
    loc.length = to > from ? (int)(to - from) : 1;
    return loc;
}

enum { SHOWN = 100 }; /* bytes of an expression in a message */

static struct expr *expr_fail(struct parser *p, size_t from, size_t to, const char *what)
{
    if (!p->failed)
        diag_error(p->diag, place_in_text(p, from, to), "%s in the expression `%.*s%s`", what,
                   SHOWN, p->text, strlen(p->text) > SHOWN ? "..." : "");
    p->failed = true;
    return NULL;
}

static void skip_spaces(struct parser *p)
{
    while (isspace((unsigned char)p->text[p->at]))
        p->at++;
}

static bool take_token(struct parser *p, const char *token)
{
    skip_spaces(p);
    size_t length = strlen(token);
    if (strncmp(p->text + p->at, token, length))
        return false;
    p->at += length;
    return true;
}

static struct expr *node(struct parser *p, enum operation operation, size_t from)
{
    if (++p->terms > EXPR_MOST_TERMS)
        return expr_fail(p, from, from + 1, "more than 1000 terms");
    struct expr *expr = arena_alloc(p->model->arena, sizeof *expr);
    if (!expr) {
        p->failed = true;
        return NULL;
    }
    expr->operation = operation;
    expr->component = -1;
    expr->loc = place_in_text(p, from, p->at);
    return expr;
}

/* A node over operands, of which a missing one was reported. */
static struct expr *branch(struct parser *p, enum operation operation, size_t from, struct expr *a,
                           struct expr *b, struct expr *c)
{
    struct expr *expr = a ? node(p, operation, from) : NULL;
    if (expr) {
        expr->operand[0] = a;
        expr->operand[1] = b;
        expr->operand[2] = c;
    }
    return expr;
}

static struct expr *parse_choose(struct parser *p);

static struct expr *parse_number(struct parser *p)
{
    size_t from = p->at;
    uint64_t value = 0;
    bool overflow = false;
    for (; isdigit((unsigned char)p->text[p->at]); p->at++)
        overflow |= __builtin_mul_overflow(value, 10u, &value) ||
                    __builtin_add_overflow(value, (uint64_t)(p->text[p->at] - '0'), &value);
    char next = p->text[p->at];
    if (next == '.' || isalpha((unsigned char)next) || next == '_') {
        while (isalnum((unsigned char)p->text[p->at]) ||
               strchr("._", p->text[p->at] ? p->text[p->at] : ' '))
            p->at++;
        return expr_fail(p, from, p->at, "a number that is no integer");
    }
    if (overflow || value > INT64_MAX)
        return expr_fail(p, from, p->at, "a number beyond 64 bits");
    struct expr *expr = node(p, OP_NUMBER, from);
    if (expr)
        expr->number = (int64_t)value;
    return expr;
}

static bool text_is(const char *text, size_t length, const char *word)
{
    return strlen(word) == length && !strncmp(text, word, length);
}

static struct expr *parse_call(struct parser *p, enum operation operation, size_t from)
{
    struct expr *a = parse_choose(p);
    if (!a)
        return NULL;
    if (!take_token(p, ","))
        return expr_fail(p, p->at, p->at + 1,
                         p->text[p->at] ? "expected `,` and a second argument"
                                        : "expected `,` and a second argument (inside { } and [ ], "
                                          "YAML ends a value without quotes at its comma)");
    struct expr *b = parse_choose(p);
    if (!b)
        return NULL;
    if (!take_token(p, ")"))
        return expr_fail(p, p->at, p->at + 1, "expected `)`");
    return branch(p, operation, from, a, b, NULL);
}

static size_t word_length(const char *text)
{
    size_t length = 0;
    while (isalnum((unsigned char)text[length]) || text[length] == '_')
        length++;
    return length;
}

static struct expr *parse_frame(struct parser *p, size_t from)
{
    if (p->text[p->at] == '.') {
        const char *member = p->text + p->at + 1;
        size_t length = word_length(member);
        p->at += 1 + length;
        if (text_is(member, length, "width"))
            return node(p, OP_FRAME_WIDTH, from);
        if (text_is(member, length, "height"))
            return node(p, OP_FRAME_HEIGHT, from);
    }
    return expr_fail(p, from, p->at, "`frame` has only `frame.width` and `frame.height`");
}

/* Words joined by dots. */
static size_t path_length(const char *text)
{
    size_t length = word_length(text), next;
    while (text[length] == '.' && (next = word_length(text + length + 1)))
        length += 1 + next;
    return length;
}

static struct expr *parse_all(struct parser *p);

/* What the name stands for inside a group or repeat. */
static struct expr *parse_replacement(struct parser *p, const struct expr_text *text, size_t from)
{
    struct parser inner = {.model = p->model,
                           .diag = p->diag,
                           .text = text->text,
                           .loc = place_in_text(p, from, p->at),
                           .names = &text->names,
                           .replaces = true,
                           .depth = p->depth + 1,
                           .terms = p->terms};
    if (inner.depth > DEEPEST)
        return expr_fail(p, from, p->at, "more than 64 nested levels");
    struct expr *expr = parse_all(&inner);
    p->terms = inner.terms;
    p->failed |= inner.failed;
    return expr;
}

static struct expr *parse_name(struct parser *p)
{
    static const struct {
        const char *name;
        enum operation operation;
    } calls[] = {{"min", OP_MIN}, {"max", OP_MAX}, {"ceil_div", OP_CEIL_DIV}};
    size_t from = p->at, length = word_length(p->text + from);
    p->at += length;
    if (text_is(p->text + from, length, "frame"))
        return parse_frame(p, from);
    for (size_t i = 0; i < sizeof calls / sizeof *calls; i++)
        if (text_is(p->text + from, length, calls[i].name) && take_token(p, "("))
            return parse_call(p, calls[i].operation, from);
    if (text_is(p->text + from, length, "true") || text_is(p->text + from, length, "false")) {
        struct expr *expr = node(p, OP_NUMBER, from);
        if (expr)
            expr->number = p->text[from] == 't';
        return expr;
    }
    length = path_length(p->text + from);
    p->at = from + length;
    char *name = arena_strndup(p->model->arena, p->text + from, length);
    struct expr_text text = {0};
    if (name && p->names && p->names->find && p->names->find(p->names->scope, name, &text))
        return parse_replacement(p, &text, from);
    struct expr *expr = name ? node(p, OP_NAME, from) : NULL;
    if (!expr)
        return NULL;
    expr->name = name;
    const char *dot = strrchr(name, '.');
    if (dot) {
        expr->base = arena_strndup(p->model->arena, name, (size_t)(dot - name));
        expr->last = dot + 1;
    }
    return !dot || expr->base ? expr : NULL;
}

static struct expr *parse_primary(struct parser *p)
{
    skip_spaces(p);
    char c = p->text[p->at];
    if (isdigit((unsigned char)c))
        return parse_number(p);
    if (isalpha((unsigned char)c) || c == '_')
        return parse_name(p);
    if (c == '(') {
        p->at++;
        struct expr *expr = parse_choose(p);
        if (expr && !take_token(p, ")"))
            return expr_fail(p, p->at, p->at + 1, "expected `)`");
        return expr;
    }
    if (!c)
        return expr_fail(p, p->at ? p->at - 1 : 0, p->at,
                         "expected a number, a name or `(` at the end");
    return expr_fail(p, p->at, p->at + 1, "expected a number, a name or `(`");
}

static struct expr *parse_unary(struct parser *p)
{
    skip_spaces(p);
    size_t from = p->at;
    char c = p->text[from];
    if (c != '-' && c != '!')
        return parse_primary(p);
    p->at++;
    if (++p->depth > DEEPEST)
        return expr_fail(p, from, from + 1, "more than 64 nested levels");
    struct expr *operand = parse_unary(p);
    p->depth--;
    return branch(p, c == '-' ? OP_NEGATE : OP_NOT, from, operand, NULL, NULL);
}

/* Binary operators by level, loosest first. `<=` stands before `<`, or `<` would match first. */
struct binary {
    const char *token;
    enum operation operation;
    int level;
};
static const struct binary binaries[] = {
    {"||", OP_OR, 0},          {"&&", OP_AND, 1},        {"==", OP_EQUAL, 2},
    {"!=", OP_NOT_EQUAL, 2},   {"<=", OP_LESS_EQUAL, 3}, {">=", OP_GREATER_EQUAL, 3},
    {"<", OP_LESS, 3},         {">", OP_GREATER, 3},     {"<<", OP_SHIFT_LEFT, 4},
    {">>", OP_SHIFT_RIGHT, 4}, {"+", OP_ADD, 5},         {"-", OP_SUBTRACT, 5},
    {"*", OP_MULTIPLY, 6},     {"/", OP_DIVIDE, 6},      {"%", OP_REMAINDER, 6},
};
enum { BINARY_LEVELS = 7, BINARY_COUNT = sizeof binaries / sizeof *binaries };

static struct expr *parse_binary(struct parser *p, int level)
{
    if (level == BINARY_LEVELS)
        return parse_unary(p);
    skip_spaces(p);
    size_t from = p->at;
    struct expr *left = parse_binary(p, level + 1);
    while (left) {
        const struct binary *found = NULL;
        for (size_t i = 0; i < BINARY_COUNT && !found; i++)
            if (binaries[i].level == level && take_token(p, binaries[i].token))
                found = &binaries[i];
        if (!found)
            break;
        struct expr *right = parse_binary(p, level + 1);
        left = right ? branch(p, found->operation, from, left, right, NULL) : NULL;
    }
    return left;
}

static struct expr *parse_choose(struct parser *p)
{
    skip_spaces(p);
    size_t from = p->at;
    if (++p->depth > DEEPEST)
        return expr_fail(p, from, from + 1, "more than 64 nested levels");
    struct expr *condition = parse_binary(p, 0);
    if (condition && take_token(p, "?")) {
        struct expr *yes = parse_choose(p);
        if (yes && !take_token(p, ":"))
            return expr_fail(p, p->at, p->at + 1, "expected `:`");
        struct expr *no = yes ? parse_choose(p) : NULL;
        condition = no ? branch(p, OP_CHOOSE, from, condition, yes, no) : NULL;
    }
    p->depth--;
    return condition;
}

static struct expr *parse_all(struct parser *p)
{
    struct expr *expr = parse_choose(p);
    if (!expr)
        return NULL;
    skip_spaces(p);
    if (p->text[p->at])
        return expr_fail(p, p->at, p->at + 1, "expected an operator");
    return expr;
}

struct expr *expr_parse(struct model *model, const char *text, struct loc loc,
                        const struct expr_names *names, struct diag *diag)
{
    struct parser p = {.model = model, .diag = diag, .text = text, .loc = loc, .names = names};
    return parse_all(&p);
}

struct loc expr_loc(const struct expr *expr)
{
    return expr->loc;
}

/* ---- Resolving ------------------------------------------------------------------------------- */

static void report_unknown_name(const struct expr *expr, const struct pipeline *pipeline,
                                struct diag *diag)
{
    const char *otherwise =
        !strcmp(expr->name, "width") ? "; did you mean `frame.width`?"
        : !strcmp(expr->name, "height")
            ? "; did you mean `frame.height`?"
            : "; expressions know parameters, constants, frame.width and frame.height";
    diag_error(
        diag, expr->loc, "unknown name `%s`%s", expr->name,
        declared_hint(pipeline, DECLARED_PARAM | DECLARED_CONSTANT, expr->name, otherwise).text);
}

static bool resolve_param(struct expr *expr, const struct param *param, struct diag *diag)
{
    static const char letters[] = "xyzw";
    bool is_float = param->type <= DT_TYPE_VEC4 || param->type == DT_TYPE_MAT4;
    if (is_float)
        diag_error(diag, expr->loc, "`%s` is a float parameter, but expressions are over integers",
                   param->name);
    else if (param->components > 1 && expr->component < 0)
        diag_error(diag, expr->loc, "`%s` is a vector; write `%s.x` for one of its components",
                   param->name, param->name);
    else if (param->components == 1 && expr->component >= 0)
        diag_error(diag, expr->loc, "`%s` is no vector and has no component `.%c`", param->name,
                   letters[expr->component]);
    else if (expr->component >= (int)param->components)
        diag_error(diag, expr->loc, "`%s` has %u components and no `.%c`", param->name,
                   param->components, letters[expr->component]);
    else
        return true;
    return false;
}

/* NAME.width, NAME.height, NAME.count of a resource with a file, whose header was read. */
static bool resolve_member(struct expr *expr, const struct pipeline *pipeline, struct diag *diag)
{
    const struct resource *from = declared_find(pipeline, DECLARED_RESOURCE, expr->base);
    bool is_count = !strcmp(expr->last, "count");
    if (!from || !from->file || is_count != (from->kind == DT_BUFFER)) {
        diag_error(diag, expr->loc, "`%s` is known only of %s with a `file`", expr->name,
                   is_count ? "a buffer" : "an image");
        return false;
    }
    const struct expr *size = is_count                       ? from->count
                              : !strcmp(expr->last, "width") ? from->width
                                                             : from->height;
    if (!from->file_path || !size) /* reported */
        return false;
    expr->operation = OP_NUMBER;
    expr->number = size->number;
    return true;
}

/* Whether the parameter or constant exists, which `expr` then names. */
static bool find_name(struct expr *expr, const char *name, const struct pipeline *pipeline)
{
    expr->param = declared_find(pipeline, DECLARED_PARAM, name);
    expr->constant = expr->param ? NULL : declared_find(pipeline, DECLARED_CONSTANT, name);
    return expr->param || expr->constant;
}

static bool resolve_name(struct expr *expr, const struct pipeline *pipeline, struct diag *diag)
{
    bool found = find_name(expr, expr->name, pipeline);
    if (!found && expr->base && find_name(expr, expr->base, pipeline)) {
        const char *letter = strchr("xyzw", *expr->last);
        if (!letter || expr->last[1]) {
            diag_error(diag, expr->loc, "a component is one of .x .y .z .w in the expression `%s`",
                       expr->name);
            return false;
        }
        expr->component = *letter == 'w' ? 3 : *letter - 'x';
        expr->name = expr->base;
        found = true;
    }
    if (!found && expr->base &&
        (!strcmp(expr->last, "width") || !strcmp(expr->last, "height") ||
         !strcmp(expr->last, "count")))
        return resolve_member(expr, pipeline, diag);
    if (!found)
        report_unknown_name(expr, pipeline, diag);
    if (expr->param)
        return resolve_param(expr, expr->param, diag);
    if (expr->constant && expr->component >= 0)
        diag_error(diag, expr->loc, "`%s` is a constant and has no components",
                   expr->constant->name);
    return expr->constant && expr->component < 0;
}

bool expr_resolve(struct expr *expr, const struct pipeline *pipeline, struct diag *diag)
{
    if (!expr)
        return true;
    if (expr->operation == OP_NAME)
        return resolve_name(expr, pipeline, diag);
    bool good = true;
    for (int i = 0; i < 3; i++)
        good &= expr_resolve(expr->operand[i], pipeline, diag);
    return good;
}

size_t expr_terms(const struct expr *expr)
{
    if (!expr)
        return 0;
    size_t terms = expr->operation == OP_NAME && expr->constant ? expr->constant->terms : 1;
    for (int i = 0; i < 3; i++)
        terms += expr_terms(expr->operand[i]);
    return terms;
}

bool expr_mentions(const struct expr *expr, const char *name)
{
    if (!expr)
        return false;
    if (expr->operation == OP_NAME)
        return !strcmp(expr->name, name) || (expr->base && !strcmp(expr->base, name));
    return expr_mentions(expr->operand[0], name) || expr_mentions(expr->operand[1], name) ||
           expr_mentions(expr->operand[2], name);
}

/* Whether the operand is baked and has this truth value. */
static bool decides(const struct expr *expr, bool truth)
{
    int64_t value;
    return expr_reach(expr) == EXPR_BAKED && expr_eval(expr, 1, 1, &value) == EXPR_OK &&
           (value != 0) == truth;
}

static unsigned reach_of_operands(const struct expr *expr)
{
    const struct expr *const *operand = (const struct expr *const *)expr->operand;
    if (expr->operation == OP_AND || expr->operation == OP_OR) {
        bool truth = expr->operation == OP_OR;
        if (decides(operand[0], truth) || decides(operand[1], truth))
            return EXPR_BAKED;
    }
    if (expr->operation == OP_CHOOSE && (decides(operand[0], true) || decides(operand[0], false)))
        return expr_reach(operand[decides(operand[0], true) ? 1 : 2]);
    return expr_reach(operand[0]) | expr_reach(operand[1]) | expr_reach(operand[2]);
}

static unsigned reach_of_name(const struct expr *expr)
{
    if (expr->constant)
        return expr->constant->folds ? EXPR_BAKED : expr_reach(expr->constant->value);
    return expr->param && expr->param->live ? EXPR_LIVE : EXPR_BAKED;
}

unsigned expr_reach(const struct expr *expr)
{
    if (!expr)
        return EXPR_BAKED;
    switch (expr->operation) {
    case OP_FRAME_WIDTH:
    case OP_FRAME_HEIGHT:
        return EXPR_FRAME;
    case OP_NAME:
        return reach_of_name(expr);
    default:
        return reach_of_operands(expr);
    }
}

static bool has_uniform(const struct expr *expr)
{
    if (!expr)
        return false;
    if (expr->operation == OP_NAME)
        return expr->constant ? !constant_is_literal(expr->constant)
                              : expr->param && expr->param->uniform;
    return has_uniform(expr->operand[0]) || has_uniform(expr->operand[1]) ||
           has_uniform(expr->operand[2]);
}

bool constant_is_literal(const struct constant *constant)
{
    return expr_reach(constant->value) == EXPR_BAKED &&
           (constant->literal || !has_uniform(constant->value));
}

bool expr_is_literal(const struct expr *expr)
{
    return expr_reach(expr) == EXPR_BAKED && !has_uniform(expr);
}

/* ---- Evaluation ------------------------------------------------------------------------------ */

struct evaluation {
    int64_t width, height;
    const void *live;         /* the block of live parameters; NULL: their defaults */
    const struct expr *fault; /* the part that failed */
};

static enum expr_result evaluate_node(const struct expr *expr, struct evaluation *e,
                                      int64_t *value);

static enum expr_result fault(const struct expr *expr, struct evaluation *e,
                              enum expr_result result)
{
    if (!e->fault)
        e->fault = expr;
    return result;
}

static enum expr_result divide(const struct expr *expr, struct evaluation *e, int64_t a, int64_t b,
                               int64_t *value)
{
    if (b == 0)
        return fault(expr, e, EXPR_DIVIDES_BY_ZERO);
    if (a == INT64_MIN && b == -1)
        return fault(expr, e, EXPR_OVERFLOWS);
    if (expr->operation == OP_DIVIDE)
        *value = a / b;
    else if (expr->operation == OP_REMAINDER)
        *value = a % b;
    else
        *value = a / b + (a % b > 0);
    return EXPR_OK;
}

/* By 0 to 31, as GLSL defines it for int. */
static enum expr_result shift(const struct expr *expr, struct evaluation *e, int64_t a, int64_t b,
                              int64_t *value)
{
    if (b < 0 || b > 31 ||
        (expr->operation == OP_SHIFT_LEFT && __builtin_mul_overflow(a, INT64_C(1) << b, value)))
        return fault(expr, e, EXPR_OVERFLOWS);
    if (expr->operation == OP_SHIFT_RIGHT)
        *value = a >> b;
    return EXPR_OK;
}

static enum expr_result combine(const struct expr *expr, struct evaluation *e, int64_t a, int64_t b,
                                int64_t *value)
{
    bool overflow = false;
    switch (expr->operation) {
    case OP_MULTIPLY:
        overflow = __builtin_mul_overflow(a, b, value);
        break;
    case OP_ADD:
        overflow = __builtin_add_overflow(a, b, value);
        break;
    case OP_SUBTRACT:
        overflow = __builtin_sub_overflow(a, b, value);
        break;
    case OP_DIVIDE:
    case OP_REMAINDER:
    case OP_CEIL_DIV:
        return divide(expr, e, a, b, value);
    case OP_SHIFT_LEFT:
    case OP_SHIFT_RIGHT:
        return shift(expr, e, a, b, value);
    case OP_LESS:
        *value = a < b;
        break;
    case OP_LESS_EQUAL:
        *value = a <= b;
        break;
    case OP_GREATER:
        *value = a > b;
        break;
    case OP_GREATER_EQUAL:
        *value = a >= b;
        break;
    case OP_EQUAL:
        *value = a == b;
        break;
    case OP_NOT_EQUAL:
        *value = a != b;
        break;
    case OP_MIN:
        *value = a < b ? a : b;
        break;
    default:
        *value = a > b ? a : b;
        break; /* OP_MAX */
    }
    return overflow ? fault(expr, e, EXPR_OVERFLOWS) : EXPR_OK;
}

/* The parameter as an integer, converted as in C and GLSL. */
static int64_t param_value(const struct expr *expr, const struct evaluation *e)
{
    const struct param *param = expr->param;
    int component = expr->component > 0 ? expr->component : 0;
    uint32_t bits;
    float number;
    if (!e->live || !param->live)
        return (int64_t)param->value[component];
    memcpy(&bits, (const char *)e->live + param->offset + 4 * component, sizeof bits);
    memcpy(&number, &bits, sizeof number);
    if (param->type <= DT_TYPE_VEC4)
        return (int64_t)number;
    return param->type >= DT_TYPE_INT && param->type <= DT_TYPE_IVEC4 ? (int64_t)(int32_t)bits
                                                                      : (int64_t)bits;
}

/* Leaves and unary operators. */
static enum expr_result evaluate_simple(const struct expr *expr, struct evaluation *e,
                                        int64_t *value)
{
    enum expr_result result;
    switch (expr->operation) {
    case OP_NUMBER:
        *value = expr->number;
        return EXPR_OK;
    case OP_FRAME_WIDTH:
        *value = e->width;
        return EXPR_OK;
    case OP_FRAME_HEIGHT:
        *value = e->height;
        return EXPR_OK;
    case OP_NAME:
        if (expr->constant && expr->constant->folds) {
            *value = expr->constant->folded;
            return EXPR_OK;
        }
        if (expr->constant) {
            result = evaluate_node(expr->constant->value, e, value);
            return result == EXPR_OK ? result : (e->fault = expr, result);
        }
        *value = expr->param ? param_value(expr, e) : 1;
        return EXPR_OK;
    case OP_NOT:
        result = evaluate_node(expr->operand[0], e, value);
        *value = !*value;
        return result;
    default: /* OP_NEGATE */
        result = evaluate_node(expr->operand[0], e, value);
        if (result == EXPR_OK && __builtin_sub_overflow((int64_t)0, *value, value))
            return fault(expr, e, EXPR_OVERFLOWS);
        return result;
    }
}

/* A missing expression was reported; its value is 1, which causes no further errors. */
static enum expr_result evaluate_node(const struct expr *expr, struct evaluation *e, int64_t *value)
{
    *value = 1;
    if (!expr)
        return EXPR_OK;
    if (expr->operation <= OP_NOT)
        return evaluate_simple(expr, e, value);
    int64_t a, b;
    enum expr_result result = evaluate_node(expr->operand[0], e, &a);
    if (result != EXPR_OK)
        return result;
    if (expr->operation == OP_CHOOSE)
        return evaluate_node(expr->operand[a ? 1 : 2], e, value);
    if ((expr->operation == OP_AND && !a) || (expr->operation == OP_OR && a)) {
        *value = a != 0;
        return EXPR_OK;
    }
    result = evaluate_node(expr->operand[1], e, &b);
    if (result != EXPR_OK)
        return result;
    if (expr->operation == OP_AND || expr->operation == OP_OR) {
        *value = b != 0;
        return EXPR_OK;
    }
    return combine(expr, e, a, b, value);
}

enum expr_result expr_eval(const struct expr *expr, int64_t frame_width, int64_t frame_height,
                           int64_t *value)
{
    struct evaluation e = {.width = frame_width, .height = frame_height};
    return evaluate_node(expr, &e, value);
}

enum expr_result expr_eval_live(const struct expr *expr, int64_t frame_width, int64_t frame_height,
                                const void *live, int64_t *value)
{
    struct evaluation e = {.width = frame_width, .height = frame_height, .live = live};
    return evaluate_node(expr, &e, value);
}

struct loc expr_fault_loc(const struct expr *expr, int64_t frame_width, int64_t frame_height)
{
    struct evaluation e = {.width = frame_width, .height = frame_height};
    int64_t value;
    evaluate_node(expr, &e, &value);
    return e.fault ? e.fault->loc : expr->loc;
}

/* ---- Text ------------------------------------------------------------------------------------ */

enum language { LANGUAGE_C, LANGUAGE_GLSL };
static void emit(const struct expr *expr, enum language language, bool nested, struct text *out);
static void emit_condition(const struct expr *expr, enum language language, struct text *out);

/* Whether to write a literal. C has uniform parameters as literals; GLSL reads the block. */
static bool is_value(const struct expr *expr, enum language language)
{
    return language == LANGUAGE_C ? expr_reach(expr) == EXPR_BAKED : expr_is_literal(expr);
}

static const char *operator_token(enum operation operation)
{
    for (size_t i = 0; i < BINARY_COUNT; i++)
        if (binaries[i].operation == operation)
            return binaries[i].token;
    return "";
}

static bool is_condition(const struct expr *expr)
{
    return (expr->operation >= OP_LESS && expr->operation <= OP_OR) || expr->operation == OP_NOT;
}

static bool is_boolean_param(const struct expr *expr)
{
    return expr->operation == OP_NAME && expr->param && expr->param->type == DT_TYPE_BOOL;
}

static void emit_param(const struct expr *expr, enum language language, struct text *out)
{
    const struct param *param = expr->param;
    bool vector = param->components > 1;
    bool is_int = param->type == DT_TYPE_INT || (vector && param->type <= DT_TYPE_IVEC4);
    int component = expr->component > 0 ? expr->component : 0;
    if (language == LANGUAGE_GLSL) {
        text_add(out, is_int ? "%s" : "int(%s", param->name);
        if (vector)
            text_add(out, ".%c", "xyzw"[component]);
        text_add(out, is_int ? "" : ")");
    } else if (vector) {
        text_add(out, "(int64_t)live->%s[%d]", param->name, component);
    } else {
        text_add(out, param->type == DT_TYPE_BOOL ? "(live->%s != 0)" : "(int64_t)live->%s",
                 param->name);
    }
}

static void emit_leaf(const struct expr *expr, enum language language, struct text *out)
{
    if (expr->operation == OP_NAME && expr->constant) {
        if (language == LANGUAGE_GLSL)
            text_add_word(out, expr->name);
        else
            emit(expr->constant->value, language, true, out);
    } else if (expr->operation == OP_NAME) {
        emit_param(expr, language, out);
    } else {
        const char *side = expr->operation == OP_FRAME_WIDTH ? "width" : "height";
        text_add(out, language == LANGUAGE_C ? "(int64_t)%s" : "int(frame.%s)", side);
    }
}

/* Writes a pattern, in which $N is an operand, #N one without parentheses around it, and ~N one as a
 * condition. */
static void emit_pattern(const struct expr *expr, enum language language, const char *pattern,
                         struct text *out)
{
    for (; *pattern; pattern++) {
        const struct expr *operand =
            strchr("$#~", *pattern) ? expr->operand[pattern[1] - '0'] : NULL;
        if (operand && *pattern == '~')
            emit_condition(operand, language, out);
        else if (operand)
            emit(operand, language, *pattern == '$', out);
        else
            text_add_bytes(out, pattern, 1);
        pattern += operand != NULL;
    }
}

/* The operand that decides alone, as `a` in `a && true`; NULL: both decide. */
static const struct expr *deciding_operand(const struct expr *expr, enum language language)
{
    for (int i = 0; i < 2; i++) {
        const struct expr *operand = expr->operand[i];
        int64_t value;
        if (is_value(operand, language) && expr_eval(operand, 1, 1, &value) == EXPR_OK &&
            (value != 0) == (expr->operation == OP_AND))
            return expr->operand[1 - i];
    }
    return NULL;
}

static void emit_comparison(const struct expr *expr, enum language language, struct text *out)
{
    bool logic = expr->operation == OP_AND || expr->operation == OP_OR;
    const struct expr *deciding = logic ? deciding_operand(expr, language) : NULL;
    if (deciding) {
        emit_condition(deciding, language, out);
        return;
    }
    if (expr->operation == OP_NOT) {
        emit_pattern(expr, language, "!(~0)", out);
        return;
    }
    emit_pattern(expr, language, logic ? "(~0)" : "$0", out);
    text_add(out, " %s ", operator_token(expr->operation));
    emit_pattern(expr, language, logic ? "(~1)" : "$1", out);
}

/* Writes a boolean, because GLSL conditions do not convert int to bool. */
static void emit_condition(const struct expr *expr, enum language language, struct text *out)
{
    int64_t value;
    if (is_value(expr, language) && expr_eval(expr, 1, 1, &value) == EXPR_OK) {
        text_add(out, value ? "true" : "false");
    } else if (is_condition(expr)) {
        emit_comparison(expr, language, out);
    } else if (language == LANGUAGE_C && is_boolean_param(expr)) {
        text_add(out, "live->%s != 0", expr->param->name);
    } else {
        emit(expr, language, true, out);
        text_add(out, " != 0");
    }
}

/* Of operations that are no conditions; NULL: a binary operator. */
static const char *pattern_of(enum operation operation, enum language language)
{
    static const char *const patterns[][2] = {
        [OP_NEGATE] = {"(-$0)", "(-$0)"},
        [OP_CHOOSE] = {"(~0 ? $1 : $2)", "(~0 ? $1 : $2)"},
        [OP_MIN] = {"($0 < $1 ? $0 : $1)", "min(#0, #1)"},
        [OP_MAX] = {"($0 > $1 ? $0 : $1)", "max(#0, #1)"},
        [OP_CEIL_DIV] = {"($0 / $1 + ($0 % $1 > 0))", "($0 / $1 + int($0 % $1 > 0))"}};
    return patterns[operation][language];
}

static void emit(const struct expr *expr, enum language language, bool nested, struct text *out)
{
    int64_t value;
    if (!expr)
        return;
    if (is_value(expr, language) && expr_eval(expr, 1, 1, &value) == EXPR_OK) {
        text_add(out, nested && value < 0 ? "(%" PRId64 ")" : "%" PRId64, value);
    } else if (expr->operation <= OP_NAME) {
        emit_leaf(expr, language, out);
    } else if (is_condition(expr)) {
        text_add(out, language == LANGUAGE_GLSL ? "int(" : "(");
        emit_comparison(expr, language, out);
        text_add(out, ")");
    } else if (pattern_of(expr->operation, language)) {
        emit_pattern(expr, language, pattern_of(expr->operation, language), out);
    } else {
        bool bare = !nested && expr->operation <= OP_SUBTRACT;
        text_add(out, bare ? "" : "(");
        emit_pattern(expr, language, "$0", out);
        text_add(out, " %s ", operator_token(expr->operation));
        emit_pattern(expr, language, bare ? "$1" : "$1)", out);
    }
}

void expr_emit_c(const struct expr *expr, struct text *out)
{
    emit(expr, LANGUAGE_C, false, out);
}

void expr_emit_c_condition(const struct expr *expr, struct text *out)
{
    emit_condition(expr, LANGUAGE_C, out);
}

void expr_emit_glsl(const struct expr *expr, struct text *out)
{
    emit(expr, LANGUAGE_GLSL, false, out);
}
