/* Content from outside: finds the file that a buffer or image names, and takes the size from its
 * header. The content itself is read by those who run the pipeline. */
#include <string.h>

#include "reader.h"
#include "base/npy.h"
#include "scenes/picture_size.h"

/* The file's path: absolute, or relative to the file that names it. NULL: reported. */
static const char *find_file(struct reader *reader, const struct resource *resource)
{
    const char *name = resource->file, *reason = "out of memory";
    const char *path = *name == '/'
                           ? name
                           : source_candidate(reader->model, resource->file_loc.source->path, name,
                                              strlen(name), 0);
    const char *found = path ? source_list(reader->model, path, &reason) : NULL;
    if (!found)
        diag_error(reader->diag, resource->file_loc, "cannot read the file `%s`: %s",
                   path ? path : name, reason);
    return found;
}

/* False: *reason. */
static bool take_size(struct reader *reader, struct resource *resource, const char *path,
                      const char **reason)
{
    uint32_t size[2];
    struct loc loc = resource->file_loc;
    if (resource->kind == DT_BUFFER) {
        struct npy *array = reader_alloc(reader, 1, sizeof *array);
        *reason = "out of memory";
        if (!array || !npy_header(path, array, reason))
            return false;
        resource->array = array;
        resource->count = number_expr(reader, array->count, loc);
        return true;
    }
    if (!picture_size(path, &size[0], &size[1], reason))
        return false;
    resource->width = number_expr(reader, size[0], loc);
    resource->height = number_expr(reader, size[1], loc);
    return true;
}

/* The file has the size, so the spec does not give it, too. */
static void refuse_size(struct reader *reader, const struct fields *fields,
                        const struct resource *resource)
{
    static const char *const keys[] = {"count", "size", "layers", "input"};
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++)
        if (field_given(fields, keys[i]))
            key_error(reader, fields, keys[i],
                      strcmp(keys[i], "input")
                          ? "the file of `%s` has its size; leave out `%s`"
                          : "the content of `%s` comes from its file; leave out `%s`",
                      resource->name, keys[i]);
}

void read_content(struct reader *reader, const struct fields *fields, struct resource *resource)
{
    const char *reason = NULL;
    resource->input |= resource->file != NULL;
    if (resource->input && field_given(fields, "history"))
        key_error(reader, fields, "history",
                  "the content of `%s` comes from outside and stays; leave out `history`",
                  resource->name);
    resource->history |= resource->input;
    if (!resource->file)
        return;
    refuse_size(reader, fields, resource);
    const char *path = find_file(reader, resource);
    if (path && take_size(reader, resource, path, &reason))
        resource->file_path = path;
    else if (path)
        diag_error(reader->diag, resource->file_loc, "cannot use the file `%s`: %s", path, reason);
}
