/* Prints rows of tables as C, by the members of their struct; see members.h. Members that are zero
 * are left out, as an initializer allows. */
#include <inttypes.h>
#include <string.h>

#include "emit_c.h"
#include "lower/members.h"

static bool is_zero(const struct member *member, const void *row)
{
    const char *at = (const char *)row + member->offset;
    for (size_t i = 0; i < member->size; i++)
        if (at[i])
            return member->kind >= MEMBER_ROWS && !member_count(member, row);
    return true;
}

static void emit_numbers(const struct c_output *c, const struct member *member, const void *row)
{
    const char *at = (const char *)row + member->offset;
    double values[4] = {0};
    uint32_t size = member_count(member, row), count = 1;
    for (uint32_t i = 0; i < size; i++) {
        float single = 0;
        memcpy(member->kind == MEMBER_FLOATS ? (void *)&single : &values[i],
               at + i * (member->size / size), member->size / size);
        values[i] = member->kind == MEMBER_FLOATS ? (double)single : values[i];
        count = values[i] != 0 ? i + 1 : count;
    }
    text_add(c->out, size > 1 ? "{" : "");
    for (uint32_t i = 0; i < count; i++) {
        text_add(c->out, i ? ", " : "");
        if (member->kind == MEMBER_FLOATS)
            c_float(c->out, values[i]);
        else
            c_double(c->out, values[i]);
    }
    text_add(c->out, size > 1 ? "}" : "");
}

static void emit_mask(const struct c_output *c, const struct member *member, unsigned mask)
{
    const char *between = "";
    for (unsigned bit = 0; member->word(bit); bit++)
        if (mask >> bit & 1) {
            text_add(c->out, "%s%s", between, member->word(bit));
            between = " | ";
        }
}

static void emit_integer(const struct c_output *c, const struct member *member, const void *row,
                         uint32_t index)
{
    int64_t value = member_integer(member, row, index);
    if (member->kind == MEMBER_RESOURCE || member->kind == MEMBER_RESOURCES)
        c_resource(c, (uint32_t)value);
    else if (member->kind == MEMBER_PASS)
        c_pass(c, (uint32_t)value);
    else if (member->kind == MEMBER_MASK)
        emit_mask(c, member, (unsigned)value);
    else if (member->kind == MEMBER_MIP && value == DT_ALL_MIPS)
        text_add(c->out, "DT_ALL_MIPS");
    else if (member->kind == MEMBER_WORD)
        text_add(c->out, "%s", member->word((unsigned)value));
    else if (member->kind == MEMBER_FLAG)
        text_add(c->out, "true");
    else
        text_add(c->out, "%" PRId64, value);
}

/* Of a struct: sizeof. */
static void emit_stride(const struct c_output *c, const struct dt_resource *resource)
{
    const struct structure *structure =
        c->pipeline->resources[resource - c->tables->pipeline.resources].structure;
    if (structure)
        c_add(c, "sizeof(struct @n_@s)", structure->name);
    else
        c_add(c, "@u", resource->stride);
}

static void emit_list(const struct c_output *c, const struct member *member, const void *row)
{
    uint32_t count = member_count(member, row);
    text_add(c->out, "(const uint16_t[]){");
    for (uint32_t i = 0; i < count; i++) {
        text_add(c->out, i ? ", " : "");
        emit_integer(c, member, row, i);
    }
    text_add(c->out, "}");
}

static void emit_inner(const struct c_output *c, const struct member *member, const void *row,
                       int indent)
{
    const char *inner = (const char *)row + member->offset;
    uint32_t count = member_count(member, row);
    if (member->kind == MEMBER_ROW) {
        emit_row(c, member->rows, inner, indent);
        return;
    }
    memcpy(&inner, inner, sizeof inner);
    if (member->kind == MEMBER_POINTER) {
        text_add(c->out, "&(const struct %s)", member->rows->tag);
        emit_row(c, member->rows, inner, indent);
        return;
    }
    text_add(c->out, "(const struct %s[]){\n", member->rows->tag);
    for (uint32_t i = 0; i < count; i++) {
        text_add(c->out, "%*s", indent + 4, "");
        emit_row(c, member->rows, inner + i * member->rows->size, indent + 4);
        text_add(c->out, ",\n");
    }
    text_add(c->out, "%*s}", indent, "");
}

static void emit_member(const struct c_output *c, const struct member *member, const void *row,
                        int indent)
{
    const char *text;
    text_add(c->out, ".%s = ", member->name);
    switch (member->kind) {
    case MEMBER_TEXT:
        memcpy(&text, (const char *)row + member->offset, sizeof text);
        c_string(c->out, text);
        break;
    case MEMBER_FLOATS:
    case MEMBER_DOUBLES:
        emit_numbers(c, member, row);
        break;
    case MEMBER_RESOURCES:
    case MEMBER_NUMBERS:
        emit_list(c, member, row);
        break;
    case MEMBER_STRIDE:
        emit_stride(c, row);
        break;
    case MEMBER_ROW:
    case MEMBER_POINTER:
    case MEMBER_ROWS:
        emit_inner(c, member, row, indent);
        break;
    default:
        emit_integer(c, member, row, 0);
    }
}

void emit_row(const struct c_output *c, const struct members *members, const void *row, int indent)
{
    bool any = false, alone = false; /* the member before stands on lines of its own */
    text_add(c->out, "{");
    for (size_t i = 0; i < members->count; i++) {
        const struct member *member = &members->list[i];
        bool list = members->tall && member->kind >= MEMBER_ROW;
        if (!member->always && is_zero(member, row))
            continue;
        text_add(c->out, any ? "," : "");
        if (members->tall && (!any || list || alone))
            text_add(c->out, "\n%*s", indent + 4, "");
        else
            text_add(c->out, any ? " " : "");
        emit_member(c, member, row, members->tall ? indent + 4 : indent);
        any = true;
        alone = list;
    }
    if (members->tall)
        text_add(c->out, ",\n%*s}", indent, "");
    else
        text_add(c->out, "}");
}

void emit_rows(const struct c_output *c, const char *name, const struct members *members,
               const void *rows, uint32_t count,
               void (*label)(const struct c_output *c, uint32_t index))
{
    if (!count)
        return;
    text_add(c->out, "static const struct %s %s[] = {\n", members->tag, name);
    for (uint32_t i = 0; i < count; i++) {
        text_add(c->out, label ? "    [" : "    ");
        if (label)
            label(c, i);
        text_add(c->out, label ? "] = " : "");
        emit_row(c, members, (const char *)rows + i * members->size, 4);
        text_add(c->out, ",\n");
    }
    text_add(c->out, "};\n\n");
}
