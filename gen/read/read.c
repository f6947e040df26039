/* YAML -> model. A section is read after the sections whose names it may use, in any order of the
 * file. */
#include <stdlib.h>

#include "reader.h"

static void read_asserts(struct reader *reader, const struct fields *top)
{
    struct pipeline *pipeline = &reader->model->pipeline;
    size_t count = 0;
    for (const struct fields *at = top; at; at = at->next)
        count += (size_t)list_count(field_node(at, "asserts"));
    pipeline->assertions = reader_alloc(reader, count, sizeof *pipeline->assertions);
    for (const struct fields *at = top; at && pipeline->assertions; at = at->next) {
        struct fy_node *list = field_node(at, "asserts");
        EACH_ITEM(item, list) {
            struct fields fields;
            if (fields_read(reader, item, SECTION_ASSERT, node_loc(reader, item), &fields))
                record_read(reader, &fields, 0, &pipeline->assertions[pipeline->assertion_count++]);
        }
    }
}

/* The file with this key of the top level, which only one may have; NULL: none. */
static const struct fields *find_only(struct reader *reader, const struct fields *top,
                                      const char *key)
{
    const struct fields *of = NULL;
    for (const struct fields *at = top; at; at = at->next) {
        if (!field_node(at, key))
            continue;
        if (of) {
            key_error(reader, at, key, "a second `%s`", key);
            diag_note(reader->diag, field_loc(reader, of, key), "first here");
            return NULL;
        }
        of = at;
    }
    return of;
}

/* Keys that only one file may have. */
static void read_single(struct reader *reader, const struct fields *top)
{
    struct pipeline *pipeline = &reader->model->pipeline;
    const struct fields *jitter = find_only(reader, top, "jitter"),
                        *output = find_only(reader, top, "output");
    if (jitter)
        pipeline->jitter = node_expr(reader, field_node(jitter, "jitter"));
    if (output)
        map_read(reader, output, "output", pipeline);
}

static void read_sections(struct reader *reader)
{
    struct pipeline *pipeline = &reader->model->pipeline;
    const struct fields *top = documents_fields(reader);
    pipeline->spec = reader->spec.source->path;
    record_read(reader, top, 0, pipeline);
    int target = field_choice(reader, top, "target", 0);
    pipeline->automatic = target == 0 && !reader->model->sanitize; /* places are of one plan */
    pipeline->gpu = target ? target == 2 : reader->model->gpu;
    pipeline->top = field_choice(reader, top, "origin", 0) == 1;
    read_params(reader, top);
    read_constants(reader, top);
    read_structs(reader, top);
    read_resources(reader, top);
    read_functions(reader, top);
    pipeline->value_count = read_shader_values(reader, top, &pipeline->values);
    read_passes(reader, top);
    read_copies(reader);
    read_asserts(reader, top);
    read_contracts(reader, top);
    read_single(reader, top);
}

bool read_spec(struct model *model, const char *path, const char *const *sets, size_t set_count,
               struct diag *diag)
{
    struct reader reader = {.model = model, .diag = diag};
    const char *reason;
    const struct source *source = source_read(model, path, &reason);
    if (!source)
        return diag_error(diag, (struct loc){0}, "cannot read the spec `%s`: %s", path, reason);
    bool loaded = documents_load(&reader, source);
    if (loaded) {
        document_set(&reader, sets, set_count, true);
        loaded = documents_expand(&reader);
    }
    if (loaded) {
        document_set(&reader, sets, set_count, false);
        read_sections(&reader);
    }
    if (reader.out_of_memory)
        diag_error(diag, (struct loc){0}, "out of memory while reading `%s`", path);
    for (size_t i = 0; i < reader.override_count; i++) /* frees nodes outside the document */
        if (reader.overrides[i].node && !fy_node_is_attached(reader.overrides[i].node))
            fy_node_free(reader.overrides[i].node);
    free(reader.overrides);
    documents_free(&reader);
    return loaded && !reader.unfilled && !reader.out_of_memory;
}
