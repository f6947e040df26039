/* Writes dumps; see dump.h. */
#include "result/dump.h"

#include <stdio.h>
#include <stdlib.h>

#include "picture/texels.h"

bool dump_begin(struct dump *dump, struct console *console, const struct dt_pipeline *pipeline,
                const char *folder)
{
    *dump = (struct dump){.console = console, .pipeline = pipeline};
    if (!folder_begin(&dump->folder, console, "--dump", folder, "entries"))
        return false;
    dump->manifest = cJSON_CreateObject();
    dump->history = cJSON_CreateArray();
    dump->entries = cJSON_CreateArray();
    if (!dump->manifest || !dump->history || !dump->entries)
        report_error(&console->log, "out of memory");
    return dump->manifest && dump->history && dump->entries;
}

static void add_fields(cJSON *entry, const struct dt_resource *resource)
{
    cJSON *fields = cJSON_AddArrayToObject(entry, "fields");
    for (uint32_t i = 0; i < resource->field_count; i++) {
        const struct dt_field *field = &resource->fields[i];
        cJSON *item = cJSON_CreateObject();
        cJSON_AddStringToObject(item, "name", field->name);
        cJSON_AddStringToObject(item, "type", type_info(field->type)->name);
        cJSON_AddNumberToObject(item, "offset", field->offset);
        if (field->array_count) {
            cJSON_AddNumberToObject(item, "array_count", field->array_count);
            cJSON_AddNumberToObject(item, "array_stride", field->array_stride);
        }
        cJSON_AddItemToArray(fields, item);
    }
}

/* How each number of a texel is stored, a packed texel as one: "float16", "uint32". */
static void add_number_type(cJSON *entry, enum dt_format format)
{
    enum number_kind kind = format_info(format)->kind;
    char name[16];
    snprintf(name, sizeof name, "%s%u",
             number_is_packed(kind)   ? "uint"
             : number_is_float(kind)  ? "float"
             : number_is_signed(kind) ? "int"
                                      : "uint",
             8 * number_size(kind));
    cJSON_AddStringToObject(entry, "number", name);
}

void dump_describe(cJSON *entry, const struct dt_resource *resource, uint32_t mip,
                   const uint32_t extent[3])
{
    static const char *const names[] = {"width", "height", "layers"};
    bool buffer = resource->kind == DT_BUFFER;
    cJSON_AddStringToObject(entry, "resource", resource->name);
    if (resource->mips > 1)
        cJSON_AddNumberToObject(entry, "mip", mip);
    cJSON_AddStringToObject(entry, "kind", buffer ? "buffer" : "image");
    if (buffer)
        add_fields(entry, resource);
    else {
        cJSON_AddStringToObject(entry, "format", format_info(resource->format)->name);
        add_number_type(entry, resource->format);
    }
    cJSON_AddNumberToObject(entry, "stride", resource_stride(resource));
    for (int i = 0; i < (buffer ? 1 : 3); i++)
        cJSON_AddNumberToObject(entry, buffer ? "count" : names[i], extent[i]);
}

static bool add_manifest_entry(struct dump *dump, uint32_t pass, const struct dt_resource *resource,
                               uint32_t mip, const char *file, const struct dt_bytes *bytes)
{
    cJSON *entry = cJSON_CreateObject();
    if (pass != DUMP_HISTORY)
        cJSON_AddStringToObject(entry, "pass", dump->pipeline->passes[pass].name);
    cJSON_AddStringToObject(entry, "file", file);
    dump_describe(entry, resource, mip, bytes->extent);
    return cJSON_AddItemToArray(pass == DUMP_HISTORY ? dump->history : dump->entries, entry);
}

/* The pass's number comes first, so that a listing is in order of execution. */
static char *file_name(const struct dump *dump, uint32_t pass, const char *resource, uint32_t mip)
{
    char number[16] = "history";
    if (pass != DUMP_HISTORY)
        snprintf(number, sizeof number, "%02u.", pass);
    const char *name = pass == DUMP_HISTORY ? "" : dump->pipeline->passes[pass].name;
    return mip ? format_string("%s%s.%s.mip%u.raw", number, name, resource, mip)
               : format_string("%s%s.%s.raw", number, name, resource);
}

bool dump_add(struct dump *dump, uint32_t pass, uint32_t resource, uint32_t mip,
              struct dt_bytes *bytes)
{
    const struct dt_resource *what = &dump->pipeline->resources[resource];
    if (!resource_clear_padding(what, bytes))
        return report_error(&dump->console->log, "out of memory");
    char *file = file_name(dump, pass, what->name, mip);
    bool good = file && add_manifest_entry(dump, pass, what, mip, file, bytes);
    if (good)
        good = folder_write(&dump->folder, file, bytes->data, bytes->size);
    else
        report_error(&dump->console->log, "out of memory");
    free(file);
    return good;
}

static bool write_manifest(struct dump *dump)
{
    cJSON_AddItemToObject(dump->manifest, "history", dump->history);
    cJSON_AddItemToObject(dump->manifest, "entries", dump->entries);
    dump->history = dump->entries = NULL;
    return folder_write_json(&dump->folder, "manifest.json", dump->manifest);
}

bool dump_end(struct dump *dump, bool keep)
{
    if (!dump->console)
        return true;
    bool good = keep && dump->entries && write_manifest(dump);
    good = folder_end(&dump->folder, good) && good;
    cJSON_Delete(dump->history);
    cJSON_Delete(dump->entries);
    cJSON_Delete(dump->manifest);
    *dump = (struct dump){0};
    return good || !keep;
}
