/* Content from outside fits what it is for: no pass writes it, files hold what their buffers and
 * images are made of. */
#include "checks.h"
#include "formats.h"
#include "base/npy.h"

static void check_encoding(const struct checker *c, const struct resource *image)
{
    enum number_kind kind = format_info(image->format)->kind;
    bool takes_light =
        (kind == NUMBER_HALF || kind == NUMBER_FLOAT) && image->format != DT_FORMAT_D32F;
    if (!image->srgb)
        return;
    if (!image->input)
        diag_error(c->diag, image->encoding_loc,
                   "`encoding` is of pictures; `%s` has no `file` and is no `input`", image->name);
    else if (!takes_light)
        diag_error(c->diag, image->encoding_loc,
                   "`%s` is %s, which has no linear light; use a float format, or rgba8_srgb "
                   "without `encoding`",
                   image->name, format_info(image->format)->name);
}

static void check_array(const struct checker *c, const struct resource *buffer)
{
    const struct structure *structure = buffer->structure;
    uint32_t count = structure ? structure->field_count : 1;
    struct dt_field *fields = arena_alloc(c->model->arena, (count + 1) * sizeof *fields);
    if (!fields || (!structure && !buffer->of)) /* reported */
        return;
    fields[0] = (struct dt_field){.name = "", .type = buffer->type};
    for (uint32_t i = 0; structure && i < count; i++)
        fields[i] = (struct dt_field){.name = structure->fields[i].name,
                                      .type = structure->fields[i].type,
                                      .array_count = structure->fields[i].array_count};
    const char *misfit = npy_misfit(buffer->array, fields, count);
    if (misfit)
        diag_error(c->diag, buffer->file_loc, "the file does not fit `%s`: %s", buffer->name,
                   misfit);
}

static void check_file(const struct checker *c, const struct resource *resource)
{
    if (!resource->file_path)
        return;
    if (resource->kind == DT_BUFFER)
        check_array(c, resource);
    else if (format_is_integer(resource->format))
        diag_error(c->diag, resource->file_loc,
                   "a picture has no integers, so it cannot be the content of `%s`, which is %s",
                   resource->name, format_info(resource->format)->name);
}

static void check_writers(const struct checker *c, const struct pass *pass)
{
    EACH(access, pass->accesses, pass->access_count) {
        if (access->mode == MODE_READ || !access->resource || !access->resource->input)
            continue;
        diag_error(c->diag, access->loc,
                   "the pass `%s` changes `%s`, whose content comes from outside", pass->name,
                   access->resource->name);
        diag_note(c->diag, access->resource->loc, "`%s` is declared here", access->resource->name);
    }
}

void check_content(struct checker *c)
{
    EACH(resource, c->pipeline->resources, c->pipeline->resource_count) {
        check_encoding(c, resource);
        check_file(c, resource);
    }
    EACH(pass, c->pipeline->passes, c->pipeline->pass_count)
        check_writers(c, pass);
}
