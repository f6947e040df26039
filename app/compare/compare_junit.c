/* JUnit's XML of `compare`; see compare.h. */
#include <cjson/cJSON.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "base/printable.h"
#include "compare/compare.h"

/* Control characters have no place in XML. */
static void put_escaped(FILE *out, const char *of)
{
    char *copy = text_printable(of);
    for (const char *text = copy ? copy : ""; *text; text++)
        if (strchr("&<>\"", *text))
            fprintf(out, "&#%d;", *text);
        else
            fputc((unsigned char)*text < ' ' ? ' ' : *text, out);
    free(copy);
}

static void put_attribute(FILE *out, const char *name, const char *text)
{
    fprintf(out, " %s=\"", name);
    put_escaped(out, text);
    fputc('"', out);
}

static void put_case(FILE *out, const struct compare *compare, const struct pair *pair,
                     const struct row *row, const struct result *result, const char *pass)
{
    const struct difference *difference = &result->difference;
    fputs("<testcase", out);
    put_attribute(out, "classname", pass);
    put_attribute(out, "name", row->name);
    if (difference_verdict(difference) != VERDICT_DIFFERS) {
        fputs("/>\n", out);
        return;
    }
    char *worst = compare_describe_worst(compare, pair, row, result);
    fprintf(out, "><failure message=\"%llu of %llu differ; ",
            (unsigned long long)difference->differing, (unsigned long long)difference->elements);
    put_escaped(out, worst ? worst : "");
    fputs("\"/></testcase>\n", out);
    free(worst);
}

static uint32_t count_failures(const struct result *results, uint32_t count)
{
    uint32_t failures = 0;
    for (uint32_t i = 0; i < count; i++)
        failures += difference_verdict(&results[i].difference) == VERDICT_DIFFERS;
    return failures;
}

static void put_suite(FILE *out, const struct compare *compare, uint32_t index)
{
    const struct pair *pair = &compare->pairs[index];
    const struct row_list *outputs = &compare->rows.outputs, *history = &compare->rows.history;
    char *name = format_string("%s: %s against %s", compare->pipeline.info->name,
                               pair->sides[1]->label, pair->sides[0]->label);
    fputs("<testsuite", out);
    put_attribute(out, "name", name ? name : "");
    fprintf(out, " tests=\"%u\" failures=\"%u\">\n<properties>\n", history->count + outputs->count,
            count_failures(pair->history, history->count) +
                count_failures(pair->results, outputs->count));
    const uint32_t sides[2] = {0, index + 1};
    for (int i = 0; i < 2; i++) {
        fputs("<property", out);
        put_attribute(out, "name", pair->sides[i]->label);
        put_attribute(out, "value", compare->devices[sides[i]]);
        fputs("/>\n", out);
    }
    fputs("</properties>\n", out);
    for (uint32_t i = 0; i < history->count; i++)
        put_case(out, compare, pair, &history->list[i], &pair->history[i], "before");
    for (uint32_t i = 0; i < outputs->count; i++)
        put_case(out, compare, pair, &outputs->list[i], &pair->results[i],
                 compare->pipeline.info->passes[outputs->list[i].pass].name);
    fputs("</testsuite>\n", out);
    free(name);
}

/* A case per resource that differs, else one. */
static void put_golden(FILE *out, const struct compare *compare)
{
    int count = cJSON_GetArraySize(compare->golden.differing);
    const cJSON *item;
    fprintf(out, "<testsuite name=\"%s: golden\" tests=\"%d\" failures=\"%d\">\n",
            compare->pipeline.info->name, count ? count : 1, count);
    if (!count)
        fputs("<testcase classname=\"golden\" name=\"all resources are as kept\"/>\n", out);
    cJSON_ArrayForEach(item, compare->golden.differing)
    {
        fputs("<testcase", out);
        put_attribute(out, "classname", cJSON_GetStringValue(cJSON_GetObjectItem(item, "pass")));
        put_attribute(out, "name", cJSON_GetStringValue(cJSON_GetObjectItem(item, "resource")));
        fputs("><failure", out);
        put_attribute(out, "message", cJSON_GetStringValue(cJSON_GetObjectItem(item, "is")));
        fputs("/></testcase>\n", out);
    }
    fputs("</testsuite>\n", out);
}

/* --repeat: a case per pass and side with several results, else one. */
static void put_repeats(FILE *out, const struct compare *compare)
{
    const cJSON *item;
    int count = 0;
    cJSON_ArrayForEach(item, compare->elsewhere.list) count +=
        cJSON_HasObjectItem(item, "distinct");
    fprintf(out, "<testsuite name=\"%s: repeated runs\" tests=\"%d\" failures=\"%d\">\n",
            compare->pipeline.info->name, count ? count : 1, count);
    if (!count)
        fputs("<testcase classname=\"repeat\" name=\"all runs are equal\"/>\n", out);
    cJSON_ArrayForEach(item, compare->elsewhere.list)
    {
        if (!cJSON_HasObjectItem(item, "distinct"))
            continue;
        fputs("<testcase classname=\"repeat\"", out);
        put_attribute(out, "name", cJSON_GetStringValue(cJSON_GetObjectItem(item, "pass")));
        fputs("><failure", out);
        put_attribute(out, "message", cJSON_GetStringValue(cJSON_GetObjectItem(item, "message")));
        fputs("/></testcase>\n", out);
    }
    fputs("</testsuite>\n", out);
}

/* --sanitize: a case per finding, else one. */
static void put_undefined(FILE *out, const struct compare *compare)
{
    cJSON *list = compare_undefined_json(compare);
    const cJSON *item;
    int count = cJSON_GetArraySize(list);
    fprintf(out, "<testsuite name=\"%s: undefined behaviour\" tests=\"%d\" failures=\"%d\">\n",
            compare->pipeline.info->name, count ? count : 1, count);
    if (!count)
        fputs("<testcase classname=\"sanitize\" name=\"nothing undefined\"/>\n", out);
    cJSON_ArrayForEach(item, list)
    {
        char *place =
            format_string("%s:%d:%d", cJSON_GetStringValue(cJSON_GetObjectItem(item, "file")),
                          cJSON_GetObjectItem(item, "line")->valueint,
                          cJSON_GetObjectItem(item, "column")->valueint);
        fputs("<testcase", out);
        put_attribute(out, "classname", cJSON_GetStringValue(cJSON_GetObjectItem(item, "pass")));
        put_attribute(out, "name", place ? place : "");
        fputs("><failure", out);
        put_attribute(out, "message", cJSON_GetStringValue(cJSON_GetObjectItem(item, "message")));
        fputs("/></testcase>\n", out);
        free(place);
    }
    fputs("</testsuite>\n", out);
    cJSON_Delete(list);
}

bool compare_write_junit(const struct compare *compare)
{
    struct file_draft draft;
    if (!file_draft_begin(&draft, &compare->console->log)) {
        file_draft_discard(&draft);
        return false;
    }
    fputs("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n", draft.out);
    for (uint32_t i = 0; i < compare->pair_count; i++)
        put_suite(draft.out, compare, i);
    if (compare->options.golden && !compare->options.update)
        put_golden(draft.out, compare);
    if (compare->options.repeat)
        put_repeats(draft.out, compare);
    if (compare->options.setup.sanitize)
        put_undefined(draft.out, compare);
    fputs("</testsuites>\n", draft.out);
    console_hold(compare->console);
    bool good = file_draft_end(&draft, compare->options.junit, &compare->console->log);
    console_release(compare->console);
    return good;
}
