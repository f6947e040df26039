/* Content from outside fits what it is for: no pass writes it, files hold what their buffers and
 * images are made of. Called by check.c after check_references. */
#include "check.h"
#include "plan.h"

static void check_encoding(const struct checker *c, const struct resource *image)
{
    bool takes_light = image->format >= DT_FORMAT_R16F && image->format <= DT_FORMAT_RGBA32F;
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

static void check_file(const struct checker *c, const struct resource *resource)
{
    const char *misfit;
    if (!resource->file_path)
        return;
    if (resource->kind == DT_IMAGE) {
        if (format_info(resource->format)->integer)
            diag_error(c->diag, resource->file_loc,
                       "a picture has no integers, so it cannot be the content of `%s`, which is "
                       "%s",
                       resource->name, format_info(resource->format)->name);
        return;
    }
    if (resource->structure)
        diag_error(c->diag, resource->file_loc,
                   "a file holds scalars or vectors, but `%s` is made of the struct `%s`; use "
                   "`input: true`",
                   resource->name, resource->structure->name);
    else if ((misfit = npy_misfit(&resource->array, resource->type)))
        diag_error(c->diag, resource->file_loc, "the file does not fit `%s`: %s", resource->name,
                   misfit);
}

static void check_writers(const struct checker *c, const struct pass *pass)
{
    for (uint32_t i = 0; i < pass->access_count; i++) {
        const struct access *access = &pass->accesses[i];
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
    for (uint32_t i = 0; i < c->pipeline->resource_count; i++) {
        check_encoding(c, &c->pipeline->resources[i]);
        check_file(c, &c->pipeline->resources[i]);
    }
    for (uint32_t i = 0; i < c->pipeline->pass_count; i++)
        check_writers(c, &c->pipeline->passes[i]);
}
