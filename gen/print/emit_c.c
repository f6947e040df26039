/* Pieces that all emitters of C share; see emit_c.h. */
#include "emit_c.h"
#include "read/body_files.h"

#include <ctype.h>
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <string.h>

/* ---- Literals and names ---------------------------------------------------------------------- */

static void c_upper(struct text *out, const char *name)
{
    for (; *name; name++)
        text_add(out, "%c", *name == '.' ? '_' : toupper((unsigned char)*name));
}

/* SSVP_PASS_GBUFFER */
static void c_enumerator(const struct c_output *c, const char *group, const char *name)
{
    c_add(c, "@N_@s_@U", group, name);
}

/* A question mark behind another is escaped, because C11 knows trigraphs. */
void c_string(struct text *out, const char *text)
{
    text_add(out, "\"");
    for (const char *at = text ? text : ""; *at; at++) {
        unsigned char byte = (unsigned char)*at;

        if (byte == '\n')
            text_add(out, "\\n");
        else if (byte == '"' || byte == '\\' || (byte == '?' && at > text && at[-1] == '?'))
            text_add(out, "\\%c", byte);
        else if (byte < 32 || byte == 127)
            text_add(out, "\\%03o", byte);
        else
            text_add_bytes(out, at, 1);
    }
    text_add(out, "\"");
}

void c_comment(struct text *out, const char *text)
{
    for (const char *at = text ? text : ""; *at; at++) {
        bool marker = (at[0] == '*' && at[1] == '/') || (at[0] == '/' && at[1] == '*');

        if (*at != '\n' || at[1]) /* block scalars of YAML end with a line break */
            text_add(out, marker ? "%c " : "%c", (unsigned char)*at < 32 ? ' ' : *at);
    }
}

void c_double(struct text *out, double value)
{
    if (isinf(value))
        text_add(out, value < 0 ? "DT_NO_MIN" : "DT_NO_MAX");
    else
        text_add_double(out, value);
}

void c_float(struct text *out, double value)
{
    size_t begin = out->length;
    text_add_float(out, value);
    text_add(out, out->data && strpbrk(out->data + begin, ".en") ? "f" : ".0f");
}

void c_resource(const struct c_output *c, uint32_t resource)
{
    static const char *const builtins[] = {
        "DT_FRAME",           "DT_LIVE",          "DT_SCENE_VERTICES", "DT_SCENE_INDICES",
        "DT_SCENE_MATERIALS", "DT_SCENE_OBJECTS", "DT_SCENE_TEXTURES"};
    if (resource >= DT_FRAME)
        text_add(c->out, "%s", builtins[resource - DT_FRAME]);
    else
        c_enumerator(c, "RESOURCE", c->pipeline->resources[resource].name);
}

void c_pass(const struct c_output *c, uint32_t pass)
{
    c_enumerator(c, "PASS", c->pipeline->order[pass]->name);
}

void c_expr(struct text *out, const struct expr *expr)
{
    int64_t value = 1;
    if (expr && expr_reach(expr) != EXPR_BAKED) {
        expr_emit_c(expr, out);
        return;
    }
    if (expr)
        expr_eval(expr, REFERENCE_WIDTH, REFERENCE_HEIGHT, &value);
    text_add(out, value > INT32_MAX || value < INT32_MIN ? "INT64_C(%" PRId64 ")" : "%" PRId64,
             value);
}

void c_amount(const struct c_output *c, const struct amount *amount)
{
    static const char *const opens[] = {[USE_COUNT] = "dt_count(", [USE_GROUPS] = "dt_groups("};
    bool calls = amount->use == USE_COUNT || amount->use == USE_GROUPS;
    text_add(c->out, "%s", calls ? opens[amount->use] : "");
    switch (amount->kind) {
    case AMOUNT_NUMBER:
        text_add(c->out, "%" PRIu32, amount->number);
        break;
    case AMOUNT_RESOURCE:
        c_resource(c, amount->number);
        break;
    case AMOUNT_EXPR:
        c_expr(c->out, amount->expr);
        break;
    case AMOUNT_IMAGE:
        text_add(c->out, "size[%" PRIu32 "]", amount->number);
        break;
    case AMOUNT_FRAME:
        text_add(c->out, amount->number ? "height" : "width");
        break;
    case AMOUNT_CONDITION:
        text_add(c->out, amount->expr ? "runs" : "true");
    }
    if (amount->use == USE_GROUPS || amount->use == USE_TIMES)
        text_add(c->out, calls ? ", %" PRIu32 : " * %" PRIu32, amount->local);
    text_add(c->out, calls ? ")" : "");
}

void c_add(const struct c_output *c, const char *text, ...)
{
    va_list arguments;
    va_start(arguments, text);
    for (const char *slot; (slot = strchr(text, '@')); text = slot + 2) {
        const char *word = strchr("swUqc", slot[1]) ? va_arg(arguments, const char *) : "";
        text_add_bytes(c->out, text, (size_t)(slot - text));
        switch (slot[1]) {
        case 'n':
            text_add(c->out, "%s", c->pipeline->name);
            break;
        case 'N':
            c_upper(c->out, c->pipeline->name);
            break;
        case 's':
            text_add(c->out, "%s", word ? word : "");
            break;
        case 'w':
            text_add_word(c->out, word);
            break;
        case 'U':
            c_upper(c->out, word);
            break;
        case 'q':
            c_string(c->out, word);
            break;
        case 'c':
            c_comment(c->out, word);
            break;
        case 'u':
            text_add(c->out, "%" PRIu32, va_arg(arguments, uint32_t));
            break;
        case 'R':
            c_resource(c, va_arg(arguments, uint32_t));
            break;
        case 'P':
            c_pass(c, va_arg(arguments, uint32_t));
            break;
        case 'E':
            c_expr(c->out, va_arg(arguments, const struct expr *));
        }
    }
    va_end(arguments);
    text_add(c->out, "%s", text);
}

static bool names_word(const char *text, const char *word)
{
    for (const char *at = text; (at = find_word(at, word)); at += strlen(word))
        if (at == text || at[-1] != '>')
            return true;
    return false;
}

void c_frame_locals(const struct c_output *c, const char *body)
{
    if (names_word(body, "width"))
        text_add(c->out, "    const int64_t width = r->width;\n");
    if (names_word(body, "height"))
        text_add(c->out, "    const int64_t height = r->height;\n");
    if (names_word(body, "live"))
        c_add(c, "    const struct @n_live *live = r->live;\n");
}

void c_table(const struct c_output *c, const char *name, const char *count, uint32_t n)
{
    if (n)
        c_add(c, "    .@s = @s,\n    .@s = @u,\n", name, name, count, n);
}

bool c_both(const struct c_output *c, void (*emit)(const struct c_output *c, uint32_t index),
            uint32_t index)
{
    const struct lowered *tables[2] = {c->tables, c->tables->gpu};
    struct text texts[2] = {{0}, {0}};
    struct c_output inner[2];
    for (int i = 0; i < 2 && tables[i]; i++) {
        inner[i] = (struct c_output){tables[i]->model, &tables[i]->model->pipeline, tables[i],
                                     &texts[i], NULL};
        emit(&inner[i], index);
        c->out->failed |= texts[i].failed;
    }
    bool differ = tables[1] &&
                  (texts[0].length != texts[1].length ||
                   (texts[0].length && memcmp(texts[0].data, texts[1].data, texts[0].length) != 0));
    text_add_bytes(c->out, texts[0].data ? texts[0].data : "", texts[0].length);
    if (differ) {
        inner[1].out = c->out;
        inner[1].suffix = C_GPU;
        emit(&inner[1], index);
    }
    text_free(&texts[0]);
    text_free(&texts[1]);
    return differ;
}

void c_head(const struct c_output *c, const char *what)
{
    const char *path = c->pipeline->spec ? c->pipeline->spec : "a model without a file";
    const char *slash = strrchr(path, '/');
    c_add(c,
          "/* @c@s\n * Generated by diptych-gen @u.@u.@u from @c; change that and generate again. "
          "*/\n",
          c->pipeline->doc ? c->pipeline->doc : c->pipeline->name, what, DT_VERSION_MAJOR,
          DT_VERSION_MINOR, DT_VERSION_PATCH, slash ? slash + 1 : path);
}
