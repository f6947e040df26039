/* Lists what passes write and find; see rows.h. */
#include "result/rows.h"

#include <cjson/cJSON.h>
#include <stdlib.h>
#include <string.h>

#include "console/console.h"
#include "picture/texels.h"

static bool append_row(struct row_list *rows, const struct dt_pipeline *pipeline, struct row row)
{
    const struct dt_resource *resource = &pipeline->resources[row.resource];
    bool mips = resource->kind == DT_IMAGE && resource->mips > 1;
    struct row *grown = realloc(rows->list, (rows->count + 1) * sizeof *grown);
    if (!grown)
        return false;
    rows->list = grown;
    row.name = mips ? format_string("%s mip %u", resource->name, row.mip) : strdup(resource->name);
    if (row.name)
        grown[rows->count++] = row;
    return row.name;
}

static bool append_mips(struct row_list *rows, const struct dt_pipeline *pipeline, uint32_t pass,
                        uint32_t resource, uint32_t mips)
{
    for (uint32_t mip = 0; mips >> mip; mip++) {
        const struct row row = {.pass = pass, .resource = resource, .mip = mip};
        if ((mips >> mip & 1) && !append_row(rows, pipeline, row))
            return false;
    }
    return true;
}

static bool append_outputs(struct rows *rows, uint32_t pass)
{
    const struct dt_pass *info = &rows->pipeline->passes[pass];
    for (uint32_t i = 0; i < info->write_count; i++)
        if (!append_mips(&rows->outputs, rows->pipeline, pass, info->writes[i], pass_mips(info, i)))
            return false;
    return true;
}

static bool list_has(const uint16_t *list, uint32_t count, uint32_t resource)
{
    for (uint32_t i = 0; i < count; i++)
        if (list[i] == resource)
            return true;
    return false;
}

static bool append_inputs(struct rows *rows, uint32_t pass)
{
    const struct dt_pass *info = &rows->pipeline->passes[pass];
    for (uint32_t i = 0; i < rows->pipeline->resource_count; i++) {
        bool touched = list_has(info->reads, info->read_count, i) ||
                       list_has(info->writes, info->write_count, i);
        uint32_t mips = touched ? resource_mips_before(rows->pipeline, pass, i) : 0;
        if (!append_mips(&rows->inputs, rows->pipeline, pass, i, mips))
            return false;
    }
    return true;
}

static bool append_history(struct rows *rows)
{
    for (uint32_t i = 0; i < rows->pipeline->resource_count; i++)
        if (!append_mips(&rows->history, rows->pipeline, 0, i,
                         resource_mips_before(rows->pipeline, 0, i)))
            return false;
    return true;
}

bool rows_make(struct rows *rows, const struct dt_pipeline *pipeline, const struct dt_log *log)
{
    uint32_t passes = pipeline->pass_count;
    *rows = (struct rows){.pipeline = pipeline};
    rows->outputs.first = calloc(passes + 1, sizeof *rows->outputs.first);
    rows->inputs.first = calloc(passes + 1, sizeof *rows->inputs.first);
    bool good = rows->outputs.first && rows->inputs.first && append_history(rows);
    for (uint32_t pass = 0; pass < passes && good; pass++) {
        good = append_outputs(rows, pass) && append_inputs(rows, pass);
        rows->outputs.first[pass + 1] = rows->outputs.count;
        rows->inputs.first[pass + 1] = rows->inputs.count;
    }
    return good || report_error(log, "out of memory");
}

static bool is_same_row(const struct row *a, const struct row *b)
{
    return a->resource == b->resource && a->mip == b->mip;
}

bool rows_origin(const struct rows *rows, const struct row *input, uint32_t *index)
{
    for (uint32_t i = rows->outputs.first[input->pass]; i-- > 0;) {
        *index = i;
        if (is_same_row(&rows->outputs.list[i], input))
            return true;
    }
    *index = 0;
    while (*index < rows->history.count && !is_same_row(&rows->history.list[*index], input))
        ++*index;
    return false;
}

void row_json(cJSON *root, const struct dt_pipeline *info, const struct row *row, bool pass)
{
    const struct dt_resource *resource = &info->resources[row->resource];
    if (pass)
        cJSON_AddStringToObject(root, "pass", info->passes[row->pass].name);
    else
        cJSON_AddNullToObject(root, "pass");
    cJSON_AddStringToObject(root, "resource", resource->name);
    if (resource->mips > 1)
        cJSON_AddNumberToObject(root, "mip", row->mip);
}

static void free_list(struct row_list *rows)
{
    for (uint32_t i = 0; i < rows->count; i++)
        free(rows->list[i].name);
    free(rows->list);
    free(rows->first);
}

void rows_free(struct rows *rows)
{
    free_list(&rows->outputs);
    free_list(&rows->inputs);
    free_list(&rows->history);
    *rows = (struct rows){0};
}
