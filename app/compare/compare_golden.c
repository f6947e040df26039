/* `compare --golden`: a folder kept in a repository, with hashes of what passes write, and pictures; see
 * compare.h. Only the hashes decide. Resources whose contract allows differences have none. */
#include <cjson/cJSON.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "base/foreign.h"
#include "compare/compare.h"
#include "picture/picture.h"
#include "scenes/image.h"

enum { HASH_TEXT = 17 };
static const char mark[] = "golden"; /* the key of its manifest that tells its format */

static bool golden_out_of_memory(const struct compare *compare)
{
    return report_error(&compare->console->log, "out of memory");
}

/* As they were given. */
static cJSON *sets_of(const struct options *options)
{
    cJSON *list = cJSON_CreateArray();
    for (uint32_t i = 0; i < options->setup.set_count; i++)
        cJSON_AddItemToArray(list, cJSON_CreateString(options->setup.sets[i]));
    return list;
}

static const struct dt_resource *resource_of(const struct compare *compare, const struct row *row)
{
    return &compare->pipeline.info->resources[row->resource];
}

/* ---- Open ------------------------------------------------------------------------------------ */

static bool manifest_is_whole(const cJSON *manifest)
{
    const cJSON *results = cJSON_GetObjectItem(manifest, "results"), *item;
    bool whole = cJSON_HasObjectItem(manifest, mark) && cJSON_IsArray(results);
    cJSON_ArrayForEach(item, results) whole &=
        cJSON_IsString(cJSON_GetObjectItem(item, "pass")) &&
        cJSON_IsString(cJSON_GetObjectItem(item, "resource"));
    return whole;
}

static bool read_golden_manifest(struct compare *compare)
{
    const char *folder = compare->options.golden;
    const struct dt_log *log = &compare->console->log;
    if (!foreign_has(folder, "manifest.json"))
        return report_error(log, "--golden %s: nothing is kept there; make it with --update",
                            folder);
    compare->golden.kept = foreign_json(folder, "manifest.json", log);
    bool good = manifest_is_whole(compare->golden.kept);
    if (compare->golden.kept && !good)
        report_error(log, "%s/manifest.json: was not written by --golden", folder);
    return good;
}

/* The pipeline's name is known when it is planned. */
bool golden_suits(const struct compare *compare)
{
    const cJSON *kept = cJSON_GetObjectItem(compare->golden.kept, "pipeline");
    const char *name = cJSON_GetStringValue(kept), *own = compare->pipeline.info->name;
    return !compare->golden.kept || (name && strcmp(name, own) == 0) ||
           report_error(&compare->console->log, "--golden %s: is of the pipeline %s, this is %s",
                        compare->options.golden, name ? name : "?", own);
}

bool golden_open(struct compare *compare)
{
    struct options *options = &compare->options;
    if (options->update)
        return folder_begin(&compare->golden.folder, compare->console, "--golden", options->golden,
                            mark);
    if (!read_golden_manifest(compare) ||
        !identity_take_frame(compare->golden.kept, options->golden, &options->setup,
                             &compare->console->log))
        return false;
    cJSON *sets = sets_of(options);
    const cJSON *kept = cJSON_GetObjectItem(compare->golden.kept, "set");
    bool same = cJSON_Compare(sets, kept, true);
    char *theirs = cJSON_PrintUnformatted(kept), *ours = cJSON_PrintUnformatted(sets);
    if (!same)
        report_error(&compare->console->log, "--golden %s: was made with --set %s, this is %s",
                     options->golden, theirs ? theirs : "?", ours ? ours : "?");
    cJSON_free(theirs);
    cJSON_free(ours);
    cJSON_Delete(sets);
    return same;
}

/* ---- Every row ------------------------------------------------------------------------------- */

static char *picture_name(const struct compare *compare, const struct row *row)
{
    return format_string("%02u.%s.%s.png", row->pass,
                         compare->pipeline.info->passes[row->pass].name, row->name);
}

static bool add_golden_picture(struct compare *compare, const struct row *row)
{
    const struct dt_log *log = &compare->console->log;
    struct picture picture = {0};
    struct dt_bytes bytes;
    if (!source_ask(&compare->sources[0], row) || !source_take(&compare->sources[0], row, &bytes))
        return false;
    char *name = picture_name(compare, row);
    char *path = name ? format_string("%s/%s", compare->golden.folder.temporary, name) : NULL;
    bool good = (path || golden_out_of_memory(compare)) &&
                picture_codes(&picture, resource_of(compare, row), &bytes, log) &&
                image_write_png(path, picture.width, picture.height, 3, picture.codes, log);
    picture_free(&picture);
    free(path);
    free(name);
    return good;
}

static bool has_picture(const struct compare *compare, const struct row *row)
{
    return resource_of(compare, row)->kind == DT_IMAGE && row->mip == 0;
}

bool golden_add(struct compare *compare, uint32_t output, uint32_t frame, uint64_t hash)
{
    const struct row *row = &compare->rows.outputs.list[output];
    hash_bytes(&compare->golden.hashes[output], &hash, sizeof hash);
    bool shown = compare->options.update && frame + 1 == compare->options.setup.frames;
    return !shown || !has_picture(compare, row) || add_golden_picture(compare, row);
}

/* ---- Compare --------------------------------------------------------------------------------- */

static cJSON *row_result(const struct compare *compare, uint32_t index)
{
    const struct row *row = &compare->rows.outputs.list[index];
    char text[HASH_TEXT];
    cJSON *item = cJSON_CreateObject();
    row_json(item, compare->pipeline.info, row, true);
    if (resource_of(compare, row)->contract.kind == DT_CONTRACT_EXACT) {
        snprintf(text, sizeof text, "%016" PRIx64, compare->golden.hashes[index]);
        cJSON_AddStringToObject(item, "hash", text);
    }
    return item;
}

static bool same_place(const cJSON *a, const cJSON *b)
{
    static const char *const keys[] = {"pass", "resource", "mip"};
    bool same = true;
    for (size_t i = 0; i < DT_ARRAY_COUNT(keys); i++) {
        const cJSON *own = cJSON_GetObjectItem(a, keys[i]),
                    *other = cJSON_GetObjectItem(b, keys[i]);
        same &= (!own && !other) || cJSON_Compare(own, other, true);
    }
    return same;
}

static const cJSON *find_place(const cJSON *list, const cJSON *wanted)
{
    const cJSON *item;
    cJSON_ArrayForEach(item, list)
    {
        if (same_place(item, wanted))
            return item;
    }
    return NULL;
}

/* Adds a copy without its hash. */
static void add_differing(struct compare *compare, const cJSON *item, const char *how)
{
    cJSON *copy = cJSON_Duplicate(item, true);
    cJSON_DeleteItemFromObject(copy, "hash");
    cJSON_DeleteItemFromObject(copy, "picture");
    cJSON_AddStringToObject(copy, "is", how);
    cJSON_AddItemToArray(compare->golden.differing, copy);
}

static void compare_all(struct compare *compare)
{
    const cJSON *kept = cJSON_GetObjectItem(compare->golden.kept, "results"), *item;
    cJSON *own = cJSON_CreateArray();
    for (uint32_t i = 0; i < compare->rows.outputs.count; i++)
        cJSON_AddItemToArray(own, row_result(compare, i));
    cJSON_ArrayForEach(item, own)
    {
        const cJSON *before = find_place(kept, item), *hash = cJSON_GetObjectItem(item, "hash");
        if (!before)
            add_differing(compare, item, "new");
        else if (hash && !cJSON_Compare(hash, cJSON_GetObjectItem(before, "hash"), true))
            add_differing(compare, item, "different");
    }
    cJSON_ArrayForEach(item, kept)
    {
        if (!find_place(own, item))
            add_differing(compare, item, "gone");
    }
    cJSON_Delete(own);
}

/* ---- Update ---------------------------------------------------------------------------------- */

static bool write_all(struct compare *compare)
{
    const struct options *options = &compare->options;
    cJSON *manifest = cJSON_CreateObject();
    cJSON_AddNumberToObject(manifest, mark, 1);
    cJSON_AddStringToObject(manifest, "pipeline", compare->pipeline.info->name);
    cJSON_AddItemToObject(manifest, "set", sets_of(options));
    cJSON_AddNumberToObject(manifest, "width", options->setup.size[0]);
    cJSON_AddNumberToObject(manifest, "height", options->setup.size[1]);
    cJSON_AddNumberToObject(manifest, "frame", options->setup.frames - 1);
    cJSON *results = cJSON_AddArrayToObject(manifest, "results");
    for (uint32_t i = 0; i < compare->rows.outputs.count; i++) {
        const struct row *row = &compare->rows.outputs.list[i];
        cJSON *item = row_result(compare, i);
        char *name = has_picture(compare, row) ? picture_name(compare, row) : NULL;
        cJSON_AddStringToObject(item, "picture", name);
        free(name);
        cJSON_AddItemToArray(results, item);
    }
    bool good = folder_write_json(&compare->golden.folder, "manifest.json", manifest) &&
                folder_end(&compare->golden.folder, true);
    cJSON_Delete(manifest);
    return good;
}

bool golden_end(struct compare *compare)
{
    bool differ = false;
    compare->golden.differing = cJSON_CreateArray();
    if (!compare->golden.differing)
        return golden_out_of_memory(compare);
    for (uint32_t i = 0; i < compare->pair_count; i++)
        differ |= compare->pairs[i].broken || compare->pairs[i].sheet.not_finite.row;
    if (!compare->options.update)
        compare_all(compare);
    else if (!differ)
        return write_all(compare);
    else
        report_message(
            &compare->console->log, DT_INFO,
            "--golden %s: the sides differ, or leave NaN or infinity; nothing was written",
            compare->options.golden);
    return true;
}

void golden_print(const struct compare *compare)
{
    const cJSON *first = compare->golden.differing ? compare->golden.differing->child : NULL;
    if (!compare->options.golden || compare->options.update)
        return;
    if (!first)
        printf("golden %s: all resources are as kept\n", compare->options.golden);
    else
        printf("golden %s: %d resources are not as kept, first pass %s, resource %s: %s; --update "
               "keeps the new ones\n",
               compare->options.golden, cJSON_GetArraySize(compare->golden.differing),
               cJSON_GetStringValue(cJSON_GetObjectItem(first, "pass")),
               cJSON_GetStringValue(cJSON_GetObjectItem(first, "resource")),
               cJSON_GetStringValue(cJSON_GetObjectItem(first, "is")));
}

bool golden_differs(const struct compare *compare)
{
    return cJSON_GetArraySize(compare->golden.differing) > 0;
}

void golden_free(struct golden *golden)
{
    folder_end(&golden->folder, false);
    free(golden->hashes);
    cJSON_Delete(golden->kept);
    cJSON_Delete(golden->differing);
}
