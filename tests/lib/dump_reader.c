/* Reads the output of `diptych render --dump`; see dump_reader.h. Written against the format in the
 * README, not against the code that writes it. */
#include "dump_reader.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static uint8_t *read_file(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        fail_msg("cannot open %s", path);
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    long end = ftell(file);
    assert_true(end >= 0);
    rewind(file);
    uint8_t *data = malloc((size_t)end + 1);
    assert_non_null(data);
    assert_int_equal(fread(data, 1, (size_t)end, file), (size_t)end);
    data[end] = 0;
    fclose(file);
    *size = (size_t)end;
    return data;
}

static const cJSON *entries(const struct dump *dump)
{
    return cJSON_GetObjectItem(dump->manifest, "entries");
}

static void read_manifest(struct dump *dump)
{
    char path[600];
    size_t size;
    snprintf(path, sizeof path, "%s/manifest.json", dump->directory);
    uint8_t *text = read_file(path, &size);
    dump->manifest = cJSON_Parse((const char *)text);
    free(text);
    if (!dump->manifest)
        fail_msg("%s is no JSON", path);
    if (cJSON_GetArraySize(entries(dump)) == 0)
        fail_msg("%s has no entries", path);
}

void dump_render(struct dump *dump, const char *arguments)
{
    char directory[] = "/tmp/diptych-test-XXXXXX", command[2048];
    assert_non_null(mkdtemp(directory));
    const char *build = getenv("DIPTYCH_BUILD");
    snprintf(command, sizeof command, "%s/diptych render --dump %s/dump %s >%s/log 2>&1 </dev/null",
             build ? build : "build", directory, arguments, directory);
    if (system(command) != 0)
        fail_msg("failed: %s", command);
    *dump = (struct dump){0};
    snprintf(dump->directory, sizeof dump->directory, "%s/dump", directory);
    read_manifest(dump);
}

void dump_close(struct dump *dump)
{
    char command[600];
    snprintf(command, sizeof command, "rm -rf '%.*s'", (int)strlen(dump->directory) - 5,
             dump->directory);
    assert_int_equal(system(command), 0);
    cJSON_Delete(dump->manifest);
    dump->manifest = NULL;
}

static size_t number(const cJSON *object, const char *key)
{
    const cJSON *item = cJSON_GetObjectItem(object, key);
    return cJSON_IsNumber(item) ? (size_t)item->valuedouble : 0;
}

static const cJSON *find(const struct dump *dump, const char *pass, const char *resource,
                         size_t mip)
{
    const cJSON *found = NULL, *item;
    cJSON_ArrayForEach(item, entries(dump))
    {
        const char *p = cJSON_GetStringValue(cJSON_GetObjectItem(item, "pass"));
        const char *r = cJSON_GetStringValue(cJSON_GetObjectItem(item, "resource"));
        if (p && r && strcmp(r, resource) == 0 && (!pass || strcmp(p, pass) == 0) &&
            number(item, "mip") == mip)
            found = item;
    }
    return found;
}

int dump_has_mip(const struct dump *dump, const char *pass, const char *resource, size_t mip)
{
    return find(dump, pass, resource, mip) != NULL;
}

struct dump_entry dump_read(const struct dump *dump, const char *pass, const char *resource)
{
    return dump_read_mip(dump, pass, resource, 0);
}

struct dump_entry dump_read_mip(const struct dump *dump, const char *pass, const char *resource,
                                size_t mip)
{
    const cJSON *found = find(dump, pass, resource, mip);
    if (!found)
        fail_msg("%s: no entry for mip %zu of %s after %s", dump->directory, mip, resource,
                 pass ? pass : "any pass");
    char path[1200];
    const char *file = cJSON_GetStringValue(cJSON_GetObjectItem(found, "file"));
    assert_non_null(file);
    snprintf(path, sizeof path, "%s/%s", dump->directory, file);
    struct dump_entry entry = {.description = found};
    entry.data = read_file(path, &entry.size);
    entry.count = number(found, "count");
    entry.width = number(found, "width");
    entry.height = number(found, "height");
    entry.layers = number(found, "layers");
    if (entry.count) {
        entry.stride = number(found, "stride");
        assert_int_equal(entry.size, entry.stride * entry.count);
    } else {
        size_t texels = entry.width * entry.height * entry.layers;
        if (texels == 0)
            fail_msg("%s has neither a count nor a size", path);
        else
            entry.stride = entry.size / texels;
        assert_int_equal(entry.size, entry.stride * entry.width * entry.height * entry.layers);
    }
    return entry;
}

void dump_entry_free(struct dump_entry *entry)
{
    free(entry->data);
    entry->data = NULL;
}

const void *dump_field(const struct dump_entry *entry, size_t index, const char *field)
{
    assert_true(index < entry->count);
    const cJSON *item;
    cJSON_ArrayForEach(item, cJSON_GetObjectItem(entry->description, "fields"))
    {
        const char *name = cJSON_GetStringValue(cJSON_GetObjectItem(item, "name"));
        if (name && strcmp(name, field) == 0)
            return entry->data + index * entry->stride + number(item, "offset");
    }
    fail_msg("no field %s", field);
    return NULL;
}

static float half_to_float(uint16_t half)
{
    int exponent = half >> 10 & 31, mantissa = half & 1023;
    float magnitude = exponent == 0    ? ldexpf((float)mantissa, -24)
                      : exponent == 31 ? (mantissa ? NAN : INFINITY)
                                       : ldexpf((float)(mantissa + 1024), exponent - 25);
    return half & 0x8000 ? -magnitude : magnitude;
}

void dump_texel(const struct dump_entry *entry, size_t x, size_t y, size_t layer, float out[4])
{
    assert_true(x < entry->width && y < entry->height && layer < entry->layers);
    const char *format = cJSON_GetStringValue(cJSON_GetObjectItem(entry->description, "format"));
    assert_non_null(format);
    const uint8_t *texel =
        entry->data + ((layer * entry->height + y) * entry->width + x) * entry->stride;
    size_t channels = strncmp(format, "rgba", 4) == 0 ? 4 : strncmp(format, "rg", 2) == 0 ? 2 : 1;
    size_t bytes = entry->stride / channels;
    bool integer = strstr(format, "ui") != NULL;
    for (size_t c = 0; c < channels; ++c, texel += bytes) {
        uint16_t half;
        uint32_t word;
        if (bytes == 1) {
            out[c] = (float)*texel / 255.0f;
        } else if (bytes == 2) {
            memcpy(&half, texel, 2);
            out[c] = half_to_float(half);
        } else if (integer) {
            memcpy(&word, texel, 4);
            out[c] = (float)word;
        } else {
            memcpy(&out[c], texel, 4);
        }
    }
}
