/* Products with matrices in OpenGL's GLSL text. Mesa computes `m * v` in a variable of its own that
 * `precise` does not reach, and then moves the terms. So each product of which one side is seen to
 * be a matrix becomes a call, `exact_product(m, v)`, of a function with a fixed order of terms: the
 * order in which spirv.c expands products. For SPIR-V the name is a macro for the product itself.
 * Types come from the declarations that precede a name. Products in macros, in constants and in
 * `m *= n` are not found. Called by emit_glsl.c on the whole text, before glsl_precise. */
#include "glsl.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_DEPTH = 64 };

struct shape {
    uint8_t columns, rows; /* 0: no matrix */
};

struct product { /* tokens[first] to tokens[last], once it is a call */
    uint32_t first, star, last;
    struct shape left, right, shape;
};

struct place { /* what stands at a token */
    struct token token;
    uint32_t partner;  /* of a bracket: the other one */
    uint32_t depth;    /* open brackets */
    uint32_t outer;    /* the innermost of them, or 0 */
    uint32_t declared; /* the last token up to here that may be the name in a declaration, or 0 */
    uint32_t begins, ends; /* calls that begin here; the product that ends here, counted from 1 */
    bool star;             /* of a call */
};

struct products {
    struct place *places;
    struct product *list;
    uint32_t *stars; /* `*` that are not in constants; deepest first */
    uint32_t token_count, star_count, count;
};

static bool is(const struct products *products, uint32_t index, const char *text)
{
    return index < products->token_count && token_is(products->places[index].token, text);
}

static bool is_one_of(const struct products *products, uint32_t index, const char *letters)
{
    return index < products->token_count && products->places[index].token.length == 1 &&
           strchr(letters, *products->places[index].token.text);
}

static bool is_word(const struct products *products, uint32_t index)
{
    return index < products->token_count &&
           (isalnum((unsigned char)*products->places[index].token.text) ||
            *products->places[index].token.text == '_');
}

static bool is_number(const struct products *products, uint32_t index)
{
    if (index >= products->token_count)
        return false;
    const char *text = products->places[index].token.text;
    return isdigit((unsigned char)text[*text == '.']);
}

/* Of mat2 to mat4, mat2x2 to mat4x4. */
static struct shape shape_of_type(struct token type)
{
    const char *text = type.text;
    bool square = type.length == 4, named = square || (type.length == 6 && text[4] == 'x');
    if (!named || memcmp(text, "mat", 3) || !strchr("234", text[3]) ||
        (!square && !strchr("234", text[5])))
        return (struct shape){0};
    return (struct shape){(uint8_t)(text[3] - '0'), (uint8_t)(text[square ? 3 : 5] - '0')};
}

/* ---- Tokens ---------------------------------------------------------------------------------- */

static bool is_type(const struct products *products, uint32_t index)
{
    static const char *const others[] = {"return", "else", "precise", "invariant"};
    for (size_t i = 0; i < DT_ARRAY_COUNT(others); i++)
        if (is(products, index, others[i]))
            return false;
    return is_word(products, index);
}

static void read_tokens(struct products *products, const char *text, uint32_t *open)
{
    uint32_t depth = 0, declared = 0;
    bool constant = false;
    struct token token;
    for (const char *cursor = text; (token = token_next(&cursor)).length;) {
        uint32_t i = products->token_count++;
        struct place *places = products->places;
        places[i] = (struct place){.token = token, .partner = i};
        if (is_one_of(products, i, ")]}") && depth) {
            places[i].partner = open[--depth];
            places[open[depth]].partner = i;
        }
        if (i > 1 && is_one_of(products, i, "=;,[)(") && is_word(products, i - 1) &&
            is_type(products, i - 2))
            declared = i - 1;
        places[i].declared = declared;
        places[i].depth = depth;
        places[i].outer = depth ? open[depth - 1] : 0;
        if (is_one_of(products, i, "([{"))
            open[depth++] = i;
        constant = (constant && !is(products, i, ";")) ||
                   (is(products, i, "const") && !is_one_of(products, i - 1, "(,"));
        if (i && !constant && is(products, i, "*") && *cursor != '=')
            products->stars[products->star_count++] = i;
    }
}

static bool read_text(struct products *products, const char *text)
{
    size_t count = strlen(text) + 1; /* at least as many as tokens */
    products->places = calloc(count, sizeof *products->places);
    products->stars = calloc(count, sizeof *products->stars);
    uint32_t *open = calloc(count, sizeof *open);
    bool good = products->places && products->stars && open;
    if (good)
        read_tokens(products, text, open);
    free(open);
    products->list = calloc(products->star_count + 1, sizeof *products->list);
    return good && products->list;
}

/* ---- Shapes ---------------------------------------------------------------------------------- */

/* Whether a declaration is a field of a struct. Those of a block count as variables. */
static bool is_field(const struct products *products, uint32_t index)
{
    uint32_t outer = products->places[index].outer;
    return outer > 1 && is(products, outer, "{") && is(products, outer - 2, "struct");
}

/* The shape that the last declaration before `name` gives it; a function's is its result's, an
 * array's that of its elements. member: a field's, of any struct. */
static struct shape declared_shape(const struct products *products, uint32_t name, bool member)
{
    struct token wanted = products->places[name].token;
    for (uint32_t i = products->places[name].declared; i; i = products->places[i - 1].declared) {
        struct token token = products->places[i].token;
        if (i >= name || member != is_field(products, i) || token.length != wanted.length ||
            memcmp(token.text, wanted.text, wanted.length))
            continue;
        bool array = is(products, i + 1, "["), call = is(products, i + 1, "(");
        bool fits = array == is(products, name + 1, "[") && call == is(products, name + 1, "(");
        return fits ? shape_of_type(products->places[i - 1].token) : (struct shape){0};
    }
    return (struct shape){0};
}

/* depth: of the nesting; what lies deeper than MOST_DEPTH is not seen. */
static struct shape shape_of(const struct products *products, uint32_t first, uint32_t last,
                             uint32_t depth)
{
    if (depth > MOST_DEPTH || last >= products->token_count)
        return (struct shape){0};
    uint32_t ends = products->places[last].ends;
    if (ends && products->list[ends - 1].first == first)
        return products->list[ends - 1].shape;
    while (first < last && is_one_of(products, first, "+-"))
        first++;
    if (is(products, first, "("))
        return products->places[first].partner == last && last > first + 1
                   ? shape_of(products, first + 1, last - 1, depth + 1)
                   : (struct shape){0};
    if (last > first && is(products, last - 1, "."))
        return declared_shape(products, last, true);
    bool call = is(products, first + 1, "(") && products->places[first + 1].partner == last;
    struct shape shape = shape_of_type(products->places[first].token);
    if (call && shape.rows)
        return shape;
    if (call && (is(products, first, "transpose") || is(products, first, "inverse"))) {
        shape = shape_of(products, first + 2, last - 1, depth + 1);
        return is(products, first, "inverse") ? shape : (struct shape){shape.rows, shape.columns};
    }
    bool element = is(products, first + 1, "[") && products->places[first + 1].partner == last;
    return first == last || call || element ? declared_shape(products, first, false)
                                            : (struct shape){0};
}

/* ---- Operands -------------------------------------------------------------------------------- */

/* First token of the factor that ends with `last`: v, v.xy, f(x), a[i].m, (x). */
static uint32_t factor_begin(const struct products *products, uint32_t last)
{
    if (products->places[last].ends)
        return products->list[products->places[last].ends - 1].first;
    uint32_t at = last;
    for (;;) {
        while (is_one_of(products, at, ")]")) {
            at = products->places[at].partner;
            if (at == 0 || !(is_word(products, at - 1) || is_one_of(products, at - 1, ")]")) ||
                is(products, at - 1, "return"))
                return at;
            at--;
        }
        if (at < 2 || !is(products, at - 1, "."))
            return at;
        at -= 2;
    }
}

/* Last token of the factor that begins with `first`. */
static uint32_t factor_end(const struct products *products, uint32_t first)
{
    while (is_one_of(products, first, "+-"))
        first++;
    uint32_t at = is(products, first, "(") ? products->places[first].partner : first;
    for (;;)
        if (is_one_of(products, at + 1, "(["))
            at = products->places[at + 1].partner;
        else if (is(products, at + 1, "."))
            at += 2;
        else
            return at;
}

/* Makes a call of the product at a `*`, if one side is a matrix. */
static void add_product(struct products *products, uint32_t star)
{
    struct product product = {.first = factor_begin(products, star - 1),
                              .star = star,
                              .last = factor_end(products, star + 1)};
    bool single = true;
    while (product.first > 1 && is_one_of(products, product.first - 1, "*/")) {
        product.first = factor_begin(products, product.first - 2);
        single = false;
    }
    product.left = single ? shape_of(products, product.first, star - 1, 0) : (struct shape){0};
    product.right = shape_of(products, star + 1, product.last, 0);
    if (product.left.rows && product.right.rows)
        product.shape = (struct shape){product.right.columns, product.left.rows};
    else if (is_number(products, product.first) && product.first + 1 == star)
        product.shape = product.right;
    else if (is_number(products, product.last) && product.last == star + 1)
        product.shape = product.left;
    if (!product.left.rows && !product.right.rows)
        return;
    products->list[products->count++] = product;
    products->places[product.first].begins++;
    products->places[product.last].ends = products->count;
    products->places[star].star = true;
}

static int deeper_first(const void *a, const void *b, void *user)
{
    const struct place *places = user;
    uint32_t first = *(const uint32_t *)a, second = *(const uint32_t *)b;
    uint32_t depths[] = {places[first].depth, places[second].depth};
    return depths[0] != depths[1] ? (depths[0] < depths[1] ? 1 : -1) : first < second ? -1 : 1;
}

/* Inner products first: their shapes tell those of the outer ones. */
static void find_products(struct products *products)
{
    qsort_r(products->stars, products->star_count, sizeof *products->stars, deeper_first,
            products->places);
    for (uint32_t i = 0; i < products->star_count; i++)
        add_product(products, products->stars[i]);
}

/* ---- Output ---------------------------------------------------------------------------------- */

/* BEFORE i BEHIND for i from 0 to count - 1. */
static void add_terms(struct text *out, uint32_t count, const char *before, const char *behind)
{
    for (uint32_t i = 0; i < count; i++)
        text_add(out, "%s%s%u%s", i ? ", " : "", before, i, behind);
}

static void add_with_matrix(struct text *out, struct shape shape)
{
    uint32_t columns = shape.columns, rows = shape.rows;
    text_add(out, "vec%u exact_product(mat%ux%u m, vec%u v) { return ", rows, columns, rows,
             columns);
    for (uint32_t i = 0; i < columns; i++)
        text_add(out, "%sm[%u] * v.%c", i ? " + " : "", i, "xyzw"[i]);
    text_add(out, "; }\nmat%ux%u exact_product(mat%ux%u m, float s) { return mat%ux%u(", columns,
             rows, columns, rows, columns, rows);
    add_terms(out, columns, "m[", "] * s");
    text_add(out, "); }\nmat%ux%u exact_product(float s, mat%ux%u m) { return mat%ux%u(", columns,
             rows, columns, rows, columns, rows);
    add_terms(out, columns, "m[", "] * s");
    text_add(out, "); }\nvec%u exact_product(vec%u v, mat%ux%u m) { return vec%u(", columns, rows,
             columns, rows, columns);
    for (uint32_t i = 0; i < columns; i++)
        for (uint32_t j = 0; j < rows; j++)
            text_add(out, "%sv.%c * m[%u].%c", j ? " + " : i ? ", " : "", "xyzw"[j], i, "xyzw"[j]);
    text_add(out, "); }\n");
}

static void add_with_matrices(struct text *out, struct shape left, uint32_t columns)
{
    text_add(out, "mat%ux%u exact_product(mat%ux%u a, mat%ux%u b) { return mat%ux%u(", columns,
             left.rows, left.columns, left.rows, columns, left.columns, columns, left.rows);
    add_terms(out, columns, "exact_product(a, b[", "])");
    text_add(out, "); }\n");
}

static void add_functions(struct text *out, const struct products *products)
{
    bool single[5][5] = {{0}},
         pair[5][5][5] = {{{0}}}; /* by columns and rows; columns of the right */
    for (uint32_t i = 0; i < products->count; i++) {
        struct shape left = products->list[i].left, right = products->list[i].right;
        if (!left.rows) /* if its shape was not seen, a matrix is probably square */
            left = (struct shape){right.rows, right.rows};
        if (!right.rows)
            right = (struct shape){left.columns, left.columns};
        single[left.columns][left.rows] = single[right.columns][right.rows] = true;
        pair[left.columns][left.rows][right.columns] = true;
    }
    text_add(out, "\n#ifdef GL_SPIRV\n#define exact_product(a, b) ((a) * (b))\n#else\n");
    for (uint8_t i = 2; i <= 4; i++)
        for (uint8_t j = 2; j <= 4; j++)
            if (single[i][j])
                add_with_matrix(out, (struct shape){i, j});
    for (uint8_t i = 2; i <= 4; i++)
        for (uint8_t j = 2; j <= 4; j++)
            for (uint8_t k = 2; k <= 4; k++)
                if (pair[i][j][k])
                    add_with_matrices(out, (struct shape){i, j}, k);
    text_add(out, "#endif\n");
}

static void add_place(struct text *out, const struct place *place)
{
    for (uint32_t i = 0; i < place->begins; i++)
        text_add(out, "exact_product(");
    if (place->star)
        text_add(out, ",");
    else
        text_add_bytes(out, place->token.text, place->token.length);
    if (place->ends)
        text_add(out, ")");
}

void glsl_products(struct text *text, size_t head)
{
    if (text->failed)
        return;
    struct products products = {0};
    struct text out = {0};
    const char *copied = text->data;
    if (!read_text(&products, copied))
        out.failed = true;
    else
        find_products(&products);
    if (products.count) {
        text_add_bytes(&out, copied, head);
        add_functions(&out, &products);
        copied += head;
    }
    for (uint32_t i = 0; products.count && i < products.token_count; i++) {
        struct token token = products.places[i].token;
        if (token.text < copied)
            continue;
        text_add_bytes(&out, copied, (size_t)(token.text - copied));
        add_place(&out, &products.places[i]);
        copied = token.text + token.length;
    }
    if (products.count || out.failed) {
        text_add(&out, "%s", copied);
        text_free(text);
        *text = out;
    }
    free(products.places);
    free(products.stars);
    free(products.list);
}
