/* Reduces a difference to one pass; see bisect.h.
 *
 * blame.c has named the guilty pass and the first row that breaks its contract, but keeps no bytes:
 * those of all passes together may be more than memory holds. So the frame runs a third time, and
 * the viewer keeps what belongs to this pass alone: all its inputs, and the outputs of both sides.
 * region.c then finds the box of failing elements and, by halving it, the smallest region that
 * fails; evidence.c writes the folder, whole or not at all.
 *
 * Inputs are those of the first side, which the second side got, too. So the folder holds one set
 * of inputs, and what both sides made of it: `replay` needs no other pass, and runs on any backend.
 *
 * Padding is zeroed before anything is kept (keep_row): drivers leave it as they like, and equal
 * content shall give equal files. If the row agrees in this run, the side is not repeatable, and no
 * folder is written: evidence that does not show the difference is worse than none. */
#include "compare/bisect.h"

#include <stdlib.h>
#include <string.h>

#include "picture/texels.h"

struct gathering {
    const struct dt_log *log;
    const struct rows *rows;
    uint32_t pass;
    struct dt_bytes *inputs;
    struct dt_bytes *outputs[2];
};

/* Zeroes the padding, so that equal content gives equal files. */
static bool keep_row(const struct gathering *gathering, const struct row *row,
                     struct dt_bytes *kept, const struct dt_bytes *bytes)
{
    const struct dt_resource *resource = &gathering->rows->pipeline->resources[row->resource];
    *kept = *bytes;
    kept->data = malloc(bytes->size ? bytes->size : 1);
    if (kept->data)
        memcpy(kept->data, bytes->data, bytes->size);
    return (kept->data && resource_clear_padding(resource, kept)) ||
           report_error(gathering->log, "out of memory");
}

static bool keep_input(void *user, const struct row *row, const struct dt_bytes *bytes)
{
    const struct gathering *gathering = user;
    const struct row_list *inputs = &gathering->rows->inputs;
    uint32_t place = (uint32_t)(row - inputs->list) - inputs->first[gathering->pass];
    return row->pass != gathering->pass ||
           keep_row(gathering, row, &gathering->inputs[place], bytes);
}

static bool keep_output(void *user, uint32_t index, const struct dt_bytes copies[2])
{
    const struct gathering *gathering = user;
    const struct row_list *outputs = &gathering->rows->outputs;
    uint32_t place = index - outputs->first[gathering->pass];
    const struct row *row = &outputs->list[index];
    return row->pass != gathering->pass ||
           (keep_row(gathering, row, &gathering->outputs[0][place], &copies[0]) &&
            keep_row(gathering, row, &gathering->outputs[1][place], &copies[1]));
}

/* Finds the region and writes the folder; returns the region as text. */
static char *conclude(const struct gathering *gathering, const struct replay *replay,
                      uint32_t guilty, const char *const devices[2], const char *folder,
                      struct region *region)
{
    const struct session_info *session = &replay->workers[0].session;
    const struct row_list *outputs = &gathering->rows->outputs;
    const struct dt_resource *resource =
        &gathering->rows->pipeline->resources[outputs->list[guilty].resource];
    uint32_t place = guilty - outputs->first[gathering->pass];
    const struct dt_bytes copies[2] = {gathering->outputs[0][place], gathering->outputs[1][place]};
    struct evidence evidence = {.console = session->console,
                                .setup = session->setup,
                                .pipeline = session->pipeline,
                                .scene = session->scene,
                                .rows = gathering->rows,
                                .sides = {session->side, replay->workers[1].session.side},
                                .devices = {devices[0], devices[1]},
                                .frame = replay->frame,
                                .guilty = guilty,
                                .inputs = gathering->inputs,
                                .outputs = {gathering->outputs[0], gathering->outputs[1]}};
    if (!region_find(&evidence.region, resource, copies, gathering->log))
        return NULL;
    if (!evidence.region.failing) {
        report_error(gathering->log,
                     "--bisect %s: %s of pass %s agrees in this run: a side is not repeatable",
                     folder, outputs->list[guilty].name,
                     gathering->rows->pipeline->passes[gathering->pass].name);
        return NULL;
    }
    *region = evidence.region;
    char *text = region_describe(&evidence.region, resource);
    if (text && evidence_write(&evidence, folder))
        return text;
    free(text);
    return NULL;
}

static void free_rows(struct dt_bytes *bytes, uint32_t count)
{
    for (uint32_t i = 0; bytes && i < count; i++)
        free(bytes[i].data);
    free(bytes);
}

char *bisect(const struct replay *replay, uint32_t guilty, const char *const devices[2],
             const char *folder, struct region *region)
{
    const struct rows *rows = replay->rows;
    uint32_t pass = rows->outputs.list[guilty].pass;
    uint32_t inputs = rows->inputs.first[pass + 1] - rows->inputs.first[pass];
    uint32_t outputs = rows->outputs.first[pass + 1] - rows->outputs.first[pass];
    struct gathering gathering = {.log = &replay->console->log,
                                  .rows = rows,
                                  .pass = pass,
                                  .inputs = calloc(inputs + 1, sizeof(struct dt_bytes)),
                                  .outputs = {calloc(outputs, sizeof(struct dt_bytes)),
                                              calloc(outputs, sizeof(struct dt_bytes))}};
    const struct replay_viewer viewer = {
        .input = keep_input, .output = keep_output, .user = &gathering};
    char *text = NULL;
    if (!gathering.inputs || !gathering.outputs[0] || !gathering.outputs[1])
        report_error(gathering.log, "out of memory");
    else if (replay_run(replay, &viewer))
        text = conclude(&gathering, replay, guilty, devices, folder, region);
    free_rows(gathering.inputs, inputs);
    free_rows(gathering.outputs[0], outputs);
    free_rows(gathering.outputs[1], outputs);
    return text;
}
