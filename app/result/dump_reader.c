/* Reads dumps; see dump_reader.h. A dump may come from another machine: every entry is checked
 * against the pipeline. */
#include "result/dump_reader.h"

#include <stdlib.h>
#include <string.h>

#include "base/foreign.h"
#include "picture/texels.h"
#include "result/dump.h"

static const char *manifest_text(const cJSON *object, const char *key)
{
    return cJSON_GetStringValue(cJSON_GetObjectItem(object, key));
}

static cJSON *read_dump_manifest(const char *folder, const struct dt_log *log)
{
    cJSON *manifest = foreign_json(folder, "manifest.json", log);
    if (manifest && !cJSON_IsArray(cJSON_GetObjectItem(manifest, "entries"))) {
        report_error(log, "%s/manifest.json: is no manifest of a dump; render --dump makes one",
                     folder);
        cJSON_Delete(manifest);
        manifest = NULL;
    }
    return manifest;
}

bool dump_reader_open(struct dump_reader *reader, const char *folder, const struct dt_log *log)
{
    *reader = (struct dump_reader){.folder = folder, .log = log};
    reader->manifest = read_dump_manifest(folder, log);
    if (!reader->manifest)
        return false;
    const char *device = manifest_text(reader->manifest, "device");
    const char *backend = manifest_text(reader->manifest, "backend");
    reader->device = format_string("%s, by %s, in %s", device ? device : "an unknown device",
                                   backend ? backend : "an unknown backend", folder);
    return reader->device || report_error(log, "out of memory");
}

void dump_reader_close(struct dump_reader *reader)
{
    cJSON_Delete(reader->manifest);
    free(reader->device);
    free(reader->data);
    *reader = (struct dump_reader){0};
}

/* ---- Finding --------------------------------------------------------------------------------- */

const cJSON *dump_reader_find(const struct dump_reader *reader, const char *list, const char *pass,
                              const struct row *row)
{
    const char *resource = reader->pipeline->resources[row->resource].name;
    const cJSON *entry;
    cJSON_ArrayForEach(entry, cJSON_GetObjectItem(reader->manifest, list))
    {
        const char *name = manifest_text(entry, "resource"), *after = manifest_text(entry, "pass");
        const cJSON *mip = cJSON_GetObjectItem(entry, "mip");
        if (name && !strcmp(name, resource) && (!pass || (after && !strcmp(after, pass))) &&
            (cJSON_IsNumber(mip) ? cJSON_GetNumberValue(mip) : 0) == row->mip)
            return entry;
    }
    return NULL;
}

/* The entry of the pass, or of the last earlier one that wrote the resource, else its history; or NULL. */
static const cJSON *find_entry(const struct dump_reader *reader, const struct row *row, bool before)
{
    const struct dt_pass *passes = reader->pipeline->passes;
    if (reader->evidence)
        return dump_reader_find(reader, before ? "inputs" : "outputs", NULL, row);
    if (!before)
        return dump_reader_find(reader, "entries", passes[row->pass].name, row);
    const cJSON *entry = NULL;
    for (uint32_t pass = row->pass; pass-- > 0 && !entry;)
        entry = dump_reader_find(reader, "entries", passes[pass].name, row);
    return entry ? entry : dump_reader_find(reader, "history", NULL, row);
}

/* ---- Reading --------------------------------------------------------------------------------- */

/* Whether the entry describes the resource as the pipeline does. */
static bool check_entry(const struct dump_reader *reader, const cJSON *entry, const struct row *row,
                        const uint32_t extent[3])
{
    cJSON *expected = cJSON_CreateObject();
    const cJSON *item;
    const char *wrong = NULL;
    dump_describe(expected, &reader->pipeline->resources[row->resource], row->mip, extent);
    cJSON_ArrayForEach(item, expected)
    {
        if (!wrong && !cJSON_Compare(item, cJSON_GetObjectItem(entry, item->string), true))
            wrong = item->string;
    }
    if (wrong)
        report_error(reader->log,
                     "%s/manifest.json: \"%s\" of %s after pass %s is not the pipeline's",
                     reader->folder, wrong, row->name, reader->pipeline->passes[row->pass].name);
    cJSON_Delete(expected);
    return !wrong;
}

bool dump_reader_load(const struct dump_reader *reader, const cJSON *entry, const char *key,
                      const struct row *row, bool before, struct dt_bytes *bytes)
{
    const struct dt_resource *resource = &reader->pipeline->resources[row->resource];
    const char *name = manifest_text(entry, key);
    *bytes = (struct dt_bytes){0};
    resource_extent(reader->pipeline, row->resource, reader->size, row->mip, bytes->extent);
    bytes->size = resource_elements(resource, bytes->extent) * resource_stride(resource);
    if (!name)
        return report_error(reader->log, "%s/manifest.json: names no file for %s %s pass %s",
                            reader->folder, row->name, before ? "before" : "after",
                            reader->pipeline->passes[row->pass].name);
    if (!check_entry(reader, entry, row, bytes->extent))
        return false;
    bytes->data = foreign_read_exactly(reader->folder, name, bytes->size, reader->log);
    return bytes->data;
}

bool dump_reader_read(struct dump_reader *reader, const struct row *row, bool before,
                      struct dt_bytes *bytes)
{
    free(reader->data);
    const char *key = reader->evidence && !before ? "expected" : "file";
    bool good = dump_reader_load(reader, find_entry(reader, row, before), key, row, before, bytes);
    reader->data = bytes->data;
    return good;
}
