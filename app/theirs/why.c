/* Hands copies to Python and takes its reasons; see why.h. Content goes in a file that only exists in memory. */
#include "theirs/why.h"

#include <cjson/cJSON.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/temporary.h"
#include "console/python.h"
#include "result/difference.h"

/* Where the content stands in the file: offset, size. */
static cJSON *add_content(struct why_batch *batch, const void *data, size_t size)
{
    const double place[2] = {(double)batch->size, (double)size};
    batch->good = batch->good && write_all(batch->file, data, size);
    batch->size += size;
    return cJSON_CreateDoubleArray(place, 2);
}

static cJSON *extent_json(const uint32_t extent[3])
{
    const int numbers[3] = {(int)extent[0], (int)extent[1], (int)extent[2]};
    return cJSON_CreateIntArray(numbers, 3);
}

/* Kind and offset of each. */
static cJSON *components_json(const struct dt_resource *resource)
{
    struct component *list = NULL;
    uint32_t count = resource_components(resource, &list);
    cJSON *root = cJSON_CreateArray();
    for (uint32_t i = 0; i < count; i++) {
        cJSON *item = cJSON_CreateObject();
        cJSON_AddStringToObject(item, "kind", number_kind_name(list[i].kind));
        cJSON_AddNumberToObject(item, "offset", list[i].offset);
        cJSON_AddItemToArray(root, item);
    }
    free(list);
    return root;
}

static void hand_relatives(struct why_batch *batch, const struct why_question *question,
                           cJSON *list)
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
        cJSON_AddItemToObject(item, "file", add_content(batch, bytes.data, bytes.size));
        cJSON_AddItemToArray(list, item);
        free(bytes.data);
    }
}

void why_add(struct why_batch *batch, const struct why_question *question)
{
    const struct dt_resource *resource = question->resource;
    const struct dt_bytes *copies = question->copies;
    cJSON *root = cJSON_CreateObject();
    if (!batch->questions) {
        *batch = (struct why_batch){.file = memfd_create("copies", 0)};
        batch->questions = cJSON_CreateArray();
        batch->good = batch->file >= 0;
    }
    cJSON_AddItemToArray(batch->questions, root);
    cJSON_AddBoolToObject(root, "image", resource->kind == DT_IMAGE);
    cJSON_AddNumberToObject(root, "stride", resource_stride(resource));
    cJSON_AddItemToObject(root, "extent", extent_json(copies[0].extent));
    cJSON_AddItemToObject(root, "components", components_json(resource));
    contract_json(root, &resource->contract);
    cJSON_AddItemToObject(root, "labels", cJSON_CreateStringArray(question->labels, 2));
    cJSON *files = cJSON_AddArrayToObject(root, "files");
    for (int i = 0; i < 2; i++)
        cJSON_AddItemToArray(files, add_content(batch, copies[i].data, copies[i].size));
    cJSON_AddBoolToObject(root, "coverage",
                          resource->kind == DT_IMAGE && resource->format == DT_FORMAT_D32F);
    if (question->edges)
        cJSON_AddItemToObject(
            root, "edges",
            add_content(batch, question->edges, resource_elements(resource, copies[0].extent)));
    hand_relatives(batch, question, cJSON_AddArrayToObject(root, "relatives"));
}

cJSON *why_ask_all(struct why_batch *batch, bool until_loud, struct console *console)
{
    char path[40];
    int output = memfd_create("answers", 0);
    cJSON *request = cJSON_CreateObject(), *answers = NULL;
    snprintf(path, sizeof path, "/proc/self/fd/%d", batch->file);
    cJSON_AddStringToObject(request, "content", path);
    cJSON_AddBoolToObject(request, "until_loud", until_loud);
    cJSON_AddItemToObject(request, "questions", batch->questions);
    if (!batch->good || output < 0) {
        report_error(&console->log, "why: out of memory");
        cJSON_Delete(request);
    } else if (python_child(console, "why", "finding a reason", request, output)) {
        off_t size = lseek(output, 0, SEEK_END);
        char *text = size > 0 ? calloc((size_t)size + 1, 1) : NULL;
        if (text && pread(output, text, (size_t)size, 0) == size)
            answers = cJSON_Parse(text);
        free(text);
    }
    if (batch->file >= 0)
        close(batch->file);
    if (output >= 0)
        close(output);
    *batch = (struct why_batch){0};
    return answers;
}

cJSON *why_ask(const struct why_question *question, struct console *console)
{
    struct why_batch batch = {0};
    why_add(&batch, question);
    cJSON *answers = why_ask_all(&batch, false, console);
    cJSON *answer = cJSON_DetachItemFromArray(answers, 0);
    cJSON_Delete(answers);
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
