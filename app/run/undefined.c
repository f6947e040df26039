/* Findings of --sanitize; see undefined.h. */
#include "run/undefined.h"

#include <cjson/cJSON.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/text.h"
#include "console/console.h"
#include "gen/plan/sanitize.h"

static bool is_same(const struct dt_finding *a, const struct dt_finding *b)
{
    return strcmp(a->place->file, b->place->file) == 0 && a->place->line == b->place->line &&
           a->place->column == b->place->column && strcmp(a->what->pass, b->what->pass) == 0 &&
           strcmp(a->text, b->text) == 0;
}

static void add_report(struct undefined *undefined, const struct dt_finding *report, uint32_t side)
{
    uint32_t bit = 1u << (side & 31);
    for (uint32_t i = 0; i < undefined->count; i++)
        if (is_same(&undefined->list[i], report) && !(undefined->sides[i] & bit)) {
            undefined->sides[i] |= bit;
            return;
        }
    undefined->list[undefined->count] = *report;
    undefined->sides[undefined->count++] = bit;
}

bool undefined_add(struct undefined *undefined, const struct pipeline *pipeline, uint32_t side,
                   const struct dt_bytes *bytes, const struct dt_log *log)
{
    struct dt_finding *found = NULL;
    uint32_t count = 0;
    bool good = plan_undefined(pipeline->plan, bytes->data, bytes->size, &found, &count);
    size_t most = undefined->count + count + 1;
    struct dt_finding *list = good ? realloc(undefined->list, most * sizeof *list) : NULL;
    undefined->list = list ? list : undefined->list;
    uint32_t *sides = list ? realloc(undefined->sides, most * sizeof *sides) : NULL;
    undefined->sides = sides ? sides : undefined->sides;
    for (uint32_t i = 0; sides && i < count; i++)
        add_report(undefined, &found[i], side);
    free(found);
    return sides || report_error(log, "out of memory");
}

void undefined_free(struct undefined *undefined)
{
    free(undefined->list);
    free(undefined->sides);
    *undefined = (struct undefined){0};
}

/* The path as it is typed here: below the working directory without it. */
static const char *typed(const char *path)
{
    char folder[4096];
    size_t length = getcwd(folder, sizeof folder) ? strlen(folder) : 0;
    bool below = length && !strncmp(path, folder, length) && path[length] == '/';
    return below ? path + length + 1 : path;
}

/* With commas between thousands. */
static void print_count(uint32_t count)
{
    if (count >= 1000) {
        print_count(count / 1000);
        printf(",%03u", count % 1000);
    } else {
        printf("%u", count);
    }
}

void undefined_text(const struct undefined *undefined, struct text *text)
{
    text_add(text, "%s", "");
    for (uint32_t i = 0; i < undefined->count; i++) {
        const struct dt_finding *report = &undefined->list[i];
        text_add(text, "%s:%d:%d: undefined: %s; pass %s, %u times\n", report->place->file,
                 report->place->line, report->place->column, report->text, report->what->pass,
                 report->count);
    }
}

void undefined_print(const struct undefined *undefined, const char *const *labels,
                     uint32_t side_count)
{
    uint32_t lost = 0;
    for (uint32_t i = 0; i < undefined->count; i++) {
        const struct dt_finding *report = &undefined->list[i];
        lost += report->lost;
        printf("%s:%d:%d: undefined: %s\n  pass %s, invocation (%u, %u, %u), ",
               typed(report->place->file), report->place->line, report->place->column, report->text,
               report->what->pass, report->invocation[0], report->invocation[1],
               report->invocation[2]);
        print_count(report->count);
        printf(" time%s; first in frame %u", report->count == 1 ? "" : "s", report->frame);
        const char *between = "; ";
        for (uint32_t side = 0; side_count > 1 && side < side_count; side++)
            if (undefined->sides[i] >> (side & 31) & 1) {
                printf("%s%s", between, labels[side]);
                between = ", ";
            }
        printf("\n");
    }
    if (lost)
        printf(DT_LOST_TEXT "\n", lost);
}

static cJSON *sides_json(uint32_t mask, const char *const *labels, uint32_t side_count)
{
    cJSON *sides = cJSON_CreateArray();
    for (uint32_t side = 0; side < side_count; side++)
        if (mask >> (side & 31) & 1)
            cJSON_AddItemToArray(sides, cJSON_CreateString(labels[side]));
    return sides;
}

cJSON *undefined_json(const struct undefined *undefined, const char *const *labels,
                      uint32_t side_count)
{
    cJSON *list = cJSON_CreateArray();
    for (uint32_t i = 0; i < undefined->count; i++) {
        const struct dt_finding *report = &undefined->list[i];
        cJSON *item = cJSON_CreateObject(), *invocation = cJSON_CreateArray();
        cJSON_AddStringToObject(item, "file", report->place->file);
        cJSON_AddNumberToObject(item, "line", report->place->line);
        cJSON_AddNumberToObject(item, "column", report->place->column);
        cJSON_AddStringToObject(item, "kind", report->what->kind);
        cJSON_AddStringToObject(item, "message", report->text);
        cJSON_AddStringToObject(item, "pass", report->what->pass);
        for (int axis = 0; axis < 3; axis++)
            cJSON_AddItemToArray(invocation, cJSON_CreateNumber(report->invocation[axis]));
        cJSON_AddItemToObject(item, "invocation", invocation);
        cJSON_AddNumberToObject(item, "count", report->count);
        cJSON_AddNumberToObject(item, "frame", report->frame);
        cJSON_AddItemToObject(item, "sides", sides_json(undefined->sides[i], labels, side_count));
        cJSON_AddItemToArray(list, item);
    }
    return list;
}

void undefined_warn_idle(const struct pipeline *pipeline, struct console *console)
{
    plan_warn_idle(pipeline->plan, console);
}
