/* Writes dumps; see dump.h. */
#include "dump.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "files.h"
#include "texels.h"

/* An empty folder or an earlier dump may be replaced, anything else is somebody's. */
static bool may_replace(const char *folder, const struct dt_log *log)
{
    struct stat info;
    if (lstat(folder, &info) != 0 && errno == ENOENT)
        return true;
    char *manifest = format_string("%s/manifest.json", folder);
    bool good = manifest && S_ISDIR(info.st_mode) && (file_exists(manifest) || rmdir(folder) == 0);
    if (!good)
        report_error(log, "--dump %s: exists and is not an earlier dump; name another folder",
                     folder);
    free(manifest);
    return good;
}

static char *without_slash(const char *folder)
{
    size_t length = strlen(folder);
    while (length > 1 && folder[length - 1] == '/')
        length--;
    return strndup(folder, length);
}

bool dump_begin(struct dump *dump, struct console *console, const struct dt_pipeline *pipeline,
                const char *folder)
{
    *dump =
        (struct dump){.console = console, .pipeline = pipeline, .folder = without_slash(folder)};
    if (!dump->folder || !may_replace(dump->folder, &console->log))
        return false;
    char *temporary = format_string("%s.tmp-%d", dump->folder, (int)getpid());
    if (!temporary || !file_make_folders(temporary, &console->log)) {
        free(temporary);
        return false;
    }
    dump->temporary = temporary;
    console_temporary(console, temporary);
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
        cJSON_AddStringToObject(item, "type", type_name(field->type));
        cJSON_AddNumberToObject(item, "offset", field->offset);
        if (field->array_count) {
            cJSON_AddNumberToObject(item, "array_count", field->array_count);
            cJSON_AddNumberToObject(item, "array_stride", field->array_stride);
        }
        cJSON_AddItemToArray(fields, item);
    }
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
    else
        cJSON_AddStringToObject(entry, "format", format_name(resource->format));
    cJSON_AddNumberToObject(entry, "stride", resource_stride(resource));
    for (int i = 0; i < (buffer ? 1 : 3); i++)
        cJSON_AddNumberToObject(entry, buffer ? "count" : names[i], extent[i]);
}

static bool add_entry(struct dump *dump, uint32_t pass, const struct dt_resource *resource,
                      uint32_t mip, const char *file, const struct dt_bytes *bytes)
{
    cJSON *entry = cJSON_CreateObject();
    if (pass != DUMP_HISTORY)
        cJSON_AddStringToObject(entry, "pass", dump->pipeline->passes[pass].name);
    cJSON_AddStringToObject(entry, "file", file);
    dump_describe(entry, resource, mip, bytes->extent);
    return cJSON_AddItemToArray(pass == DUMP_HISTORY ? dump->history : dump->entries, entry);
}

/* The place in the order of the passes stands first, so that a folder's listing is in order. */
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
    if (!resource_clear_padding(what, bytes)) {
        report_error(&dump->console->log, "out of memory");
        return false;
    }
    char *file = file_name(dump, pass, what->name, mip);
    char *path = file ? format_string("%s/%s", dump->temporary, file) : NULL;
    bool good = path && file_write(path, bytes->data, bytes->size, &dump->console->log);
    if (good && !add_entry(dump, pass, what, mip, file, bytes)) {
        report_error(&dump->console->log, "out of memory");
        good = false;
    }
    free(path);
    free(file);
    return good;
}

static bool put_in_place(struct dump *dump)
{
    const struct dt_log *log = &dump->console->log;
    cJSON_AddItemToObject(dump->manifest, "history", dump->history);
    cJSON_AddItemToObject(dump->manifest, "entries", dump->entries);
    dump->history = dump->entries = NULL;
    char *text = cJSON_Print(dump->manifest);
    char *path = format_string("%s/manifest.json", dump->temporary);
    bool good = text && path && file_write(path, text, strlen(text), log);
    if (good) {
        console_hold(dump->console);
        good = may_replace(dump->folder, log) && file_remove_tree(dump->folder);
        good = good && rename(dump->temporary, dump->folder) == 0;
        if (!good)
            report_error(log, "%s: the dump cannot be put in its place: %s", dump->folder,
                         strerror(errno));
        console_release(dump->console);
    }
    free(path);
    cJSON_free(text);
    return good;
}

bool dump_end(struct dump *dump, bool keep)
{
    if (!dump->console)
        return true;
    bool good = keep && dump->entries && put_in_place(dump);
    if (dump->temporary) {
        file_remove_tree(dump->temporary); /* nothing is there when it was put in its place */
        console_forget(dump->console, dump->temporary);
    }
    cJSON_Delete(dump->history);
    cJSON_Delete(dump->entries);
    cJSON_Delete(dump->manifest);
    free(dump->temporary);
    free(dump->folder);
    *dump = (struct dump){0};
    return good || !keep;
}
