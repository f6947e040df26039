/* YAML -> model. A section is read after the sections whose names it may use, in any order of the
 * file. */
#include <stdlib.h>
#include <string.h>

#include "reader.h"

static void read_assert(struct reader *reader, const struct fields *fields,
                        struct assertion *assertion)
{
    assertion->loc = field_loc(reader, fields, "that");
    assertion->that = field_expr(reader, fields, "that");
    assertion->warning = field_choice(reader, fields, "level", 1) == 0;
    assertion->message = field_text(reader, fields, "message");
}

static void read_asserts(struct reader *reader, const struct fields *top)
{
    struct pipeline *pipeline = &reader->model->pipeline;
    size_t count = 0;
    for (const struct fields *at = top; at; at = at->next)
        if (field_node(at, "asserts"))
            count += (size_t)fy_node_sequence_item_count(field_node(at, "asserts"));
    pipeline->assertions = reader_alloc(reader, count, sizeof *pipeline->assertions);
    for (const struct fields *at = top; at && pipeline->assertions; at = at->next) {
        struct fy_node *list = field_node(at, "asserts"), *item;
        void *iterator = NULL;
        while (list && (item = fy_node_sequence_iterate(list, &iterator))) {
            struct fields fields;
            if (fields_read(reader, item, SECTION_ASSERT, node_loc(reader, item), &fields))
                read_assert(reader, &fields, &pipeline->assertions[pipeline->assertion_count++]);
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
            diag_error(reader->diag, field_loc(reader, at, key), "a second `%s`", key);
            diag_note(reader->diag, field_loc(reader, of, key), "first here");
            return NULL;
        }
        of = at;
    }
    return of;
}

static void read_jitter(struct reader *reader, const struct fields *top)
{
    const struct fields *of = find_only(reader, top, "jitter");
    if (of)
        reader->model->pipeline.jitter = field_expr(reader, of, "jitter");
}

static void read_output(struct reader *reader, const struct fields *top)
{
    struct pipeline *pipeline = &reader->model->pipeline;
    const struct fields *of = find_only(reader, top, "output");
    struct fields fields;
    if (!of || !fields_read(reader, field_node(of, "output"), SECTION_OUTPUT,
                            field_loc(reader, of, "output"), &fields))
        return;
    pipeline->linear_output = field_text(reader, &fields, "linear");
    pipeline->linear_loc = field_loc(reader, &fields, "linear");
    pipeline->display_output = field_text(reader, &fields, "display");
    pipeline->display_loc = field_loc(reader, &fields, "display");
}

static void read_sections(struct reader *reader)
{
    struct pipeline *pipeline = &reader->model->pipeline;
    const struct fields *top = documents_fields(reader);
    pipeline->spec = reader->spec.source->path;
    pipeline->name = field_text(reader, top, "pipeline");
    pipeline->loc = field_loc(reader, top, "pipeline");
    pipeline->doc = field_text(reader, top, "doc");
    pipeline->exactness = (enum exactness)field_choice(reader, top, "exactness", EXACTNESS_EXACT);
    int target = field_choice(reader, top, "target", 0);
    pipeline->automatic = target == 0 && !reader->model->sanitize; /* places are of one plan */
    pipeline->gpu = target ? target == 2 : reader->model->gpu;
    pipeline->top = field_choice(reader, top, "origin", 0) == 1;
    read_params(reader, top);
    read_constants(reader, top);
    read_structs(reader, top);
    read_resources(reader, top);
    read_samplers(reader, top);
    read_metrics(reader, top);
    read_interleaves(reader, top);
    pipeline->value_count = read_shader_values(reader, top, &pipeline->values);
    read_passes(reader, top);
    read_copies(reader);
    read_asserts(reader, top);
    read_contracts(reader, top);
    read_jitter(reader, top);
    read_output(reader, top);
}

bool read_spec(struct model *model, const char *path, const char *const *sets, size_t set_count,
               struct diag *diag)
{
    struct reader reader = {.model = model, .diag = diag};
    const char *reason;
    const struct source *source = source_read(model, path, &reason);
    if (!source) {
        diag_error(diag, (struct loc){0}, "cannot read the spec `%s`: %s", path, reason);
        return false;
    }
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
