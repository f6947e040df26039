/* Hands two copies to Python and takes its reasons; see why.h. Copies go in files that only exist in memory. */
#include "theirs/why.h"

#include <cjson/cJSON.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/temporary.h"
#include "console/python.h"

enum { MOST_FILES = 2 + 2 * WHY_RELATIVES };

struct handed {
    int files[MOST_FILES];
    uint32_t count;
    bool good;
};

/* The path by which the child opens the content. */
static cJSON *hand_file(struct handed *handed, const struct dt_bytes *bytes)
{
    int file = memfd_create("copy", 0);
    char path[40];
    snprintf(path, sizeof path, "/proc/self/fd/%d", file);
    handed->good &= file >= 0 && write_all(file, bytes->data, bytes->size);
    if (file >= 0)
        handed->files[handed->count++] = file;
    return cJSON_CreateString(path);
}

static cJSON *extent_json(const uint32_t extent[3])
{
    const int numbers[3] = {(int)extent[0], (int)extent[1], (int)extent[2]};
    return cJSON_CreateIntArray(numbers, 3);
}

static cJSON *components_json(const struct dt_resource *resource)
{
    static const char *const kinds[] = {
        [NUMBER_UNORM8] = "unorm8",   [NUMBER_UNORM16] = "unorm16", [NUMBER_UNORM24] = "unorm24",
        [NUMBER_SNORM16] = "snorm16", [NUMBER_HALF] = "half",       [NUMBER_FLOAT] = "float",
        [NUMBER_R11F] = "r11f",       [NUMBER_G11F] = "g11f",       [NUMBER_B10F] = "b10f",
        [NUMBER_R10] = "r10",         [NUMBER_G10] = "g10",         [NUMBER_B10] = "b10",
        [NUMBER_A2] = "a2",           [NUMBER_UINT] = "uint",       [NUMBER_INT] = "int",
        [NUMBER_UINT8] = "uint8",     [NUMBER_INT8] = "int8",       [NUMBER_UINT16] = "uint16",
        [NUMBER_INT16] = "int16"};
    struct component *list = NULL;
    uint32_t count = resource_components(resource, &list);
    cJSON *root = cJSON_CreateArray();
    for (uint32_t i = 0; i < count; i++) {
        cJSON *item = cJSON_CreateObject();
        cJSON_AddStringToObject(item, "kind", kinds[list[i].kind]);
        cJSON_AddNumberToObject(item, "offset", list[i].offset);
        cJSON_AddItemToArray(root, item);
    }
    free(list);
    return root;
}

static cJSON *contract_json(const struct dt_contract *contract)
{
    static const char *const kinds[] = {
        [DT_CONTRACT_EXACT] = "exact",  [DT_CONTRACT_ULP] = "ulp",
        [DT_CONTRACT_ABS] = "abs",      [DT_CONTRACT_REL] = "rel",
        [DT_CONTRACT_IMAGE] = "image",  [DT_CONTRACT_FLIPS] = "exact",
        [DT_CONTRACT_RASTER] = "exact", [DT_CONTRACT_OF_EXACT] = "of_exact"};
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "kind", kinds[contract->kind]);
    cJSON_AddNumberToObject(root, "tolerance", contract->tolerance);
    return root;
}

static void hand_relatives(struct handed *handed, const struct why_question *question, cJSON *list)
{
    for (int i = 0; i < 2 * WHY_RELATIVES && question->relative; i++) {
        enum why_relative which = (enum why_relative)(i % WHY_RELATIVES);
        int side = i / WHY_RELATIVES;
        struct dt_bytes bytes = {0};
        if (!question->relative(question->user, which, side, &bytes))
            continue;
        cJSON *item = cJSON_CreateObject();
        cJSON_AddNumberToObject(item, "side", side);
        cJSON_AddNumberToObject(item, "which", which);
        cJSON_AddItemToObject(item, "extent", extent_json(bytes.extent));
        cJSON_AddItemToObject(item, "file", hand_file(handed, &bytes));
        cJSON_AddItemToArray(list, item);
        free(bytes.data);
    }
}

static cJSON *request_of(struct handed *handed, const struct why_question *question)
{
    const struct dt_resource *resource = question->resource;
    cJSON *root = cJSON_CreateObject();
    cJSON_AddBoolToObject(root, "image", resource->kind == DT_IMAGE);
    cJSON_AddNumberToObject(root, "stride", resource_stride(resource));
    cJSON_AddItemToObject(root, "extent", extent_json(question->copies[0].extent));
    cJSON_AddItemToObject(root, "components", components_json(resource));
    cJSON_AddItemToObject(root, "contract", contract_json(&resource->contract));
    cJSON_AddItemToObject(root, "labels", cJSON_CreateStringArray(question->labels, 2));
    cJSON *files = cJSON_AddArrayToObject(root, "files");
    for (int i = 0; i < 2; i++)
        cJSON_AddItemToArray(files, hand_file(handed, &question->copies[i]));
    hand_relatives(handed, question, cJSON_AddArrayToObject(root, "relatives"));
    return root;
}

cJSON *why_ask(const struct why_question *question, struct console *console)
{
    struct handed handed = {.good = true};
    int output = memfd_create("answer", 0);
    cJSON *request = request_of(&handed, question), *answer = NULL;
    bool good = handed.good && output >= 0;
    if (!good)
        report_error(&console->log, "why: out of memory");
    if (!good)
        cJSON_Delete(request);
    else if (python_child(console, "why", "finding a reason", request, output)) {
        off_t size = lseek(output, 0, SEEK_END);
        char *text = size > 0 ? calloc((size_t)size + 1, 1) : NULL;
        if (text && pread(output, text, (size_t)size, 0) == size)
            answer = cJSON_Parse(text);
        free(text);
    }
    for (uint32_t i = 0; i < handed.count; i++)
        close(handed.files[i]);
    if (output >= 0)
        close(output);
    return answer;
}

void why_print(const cJSON *answer, const char *name)
{
    const cJSON *list = cJSON_GetObjectItem(answer, "why"), *reason;
    const char *none = cJSON_GetStringValue(cJSON_GetObjectItem(answer, "why_not"));
    cJSON_ArrayForEach(reason, list)
        printf("%s %s: %s\n", reason == list->child ? "why:" : "and ", name,
               cJSON_GetStringValue(cJSON_GetObjectItem(reason, "text")));
    if (none)
        printf("%s: %s\n", name, none);
}
