/* The table of `compare A B` and its JSON; see dumps.h. */
#include <cjson/cJSON.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "theirs/dumps.h"

/* "radiance", "radiance mip 2", "radiance mip 2, frame 7". */
static char *match_name(const struct their_entry *entry)
{
    char again[24] = "", mip[24] = "", frame[24] = "";
    if (entry->again)
        snprintf(again, sizeof again, " #%u", entry->again + 1);
    if (entry->mip)
        snprintf(mip, sizeof mip, " mip %u", entry->mip);
    if (entry->frame)
        snprintf(frame, sizeof frame, " frame %u", entry->frame);
    return format_string("%s%s%s%s", entry->resource, again, mip, frame);
}

static const char *verdict_of(const struct match *match)
{
    return !match->sides[1]  ? "alone"
           : match->compared ? verdict_name(difference_verdict(&match->difference))
                             : "DIFFERS";
}

static int width_of(const struct dumps *dumps, bool pass)
{
    size_t width = 8;
    for (uint32_t i = 0; i < dumps->count; i++) {
        char *name = pass ? NULL : match_name(dumps->matches[i].sides[0]);
        size_t length = pass ? strlen(dumps->matches[i].sides[0]->pass) : name ? strlen(name) : 0;
        width = length > width ? length : width;
        free(name);
    }
    return (int)width;
}

static void print_match(const struct dumps *dumps, const struct match *match, const int widths[2])
{
    const char *const labels[2] = {dumps->sides[0].label, dumps->sides[1].label};
    char *name = match_name(match->sides[0]);
    char *worst = NULL;
    if (match->compared)
        worst = difference_describe_worst(&match->difference, &match->what, labels);
    printf("%-*s  %-*s  %10" PRIu64 "  %10" PRIu64 "  %-7s  %s\n", widths[0], match->sides[0]->pass,
           widths[1], name ? name : "", match->difference.elements, match->difference.differing,
           verdict_of(match),
           worst             ? worst
           : match->sides[1] ? (match->note ? match->note : "-")
                             : "not in the second dump");
    if (worst && match->note)
        printf("  %s\n", match->note);
    if (match->not_finite)
        printf("  %" PRIu64 " numbers are NaN or infinite in both, and count as equal\n",
               match->not_finite);
    free(worst);
    free(name);
}

static bool is_matched(const struct dumps *dumps, const struct their_entry *entry)
{
    for (uint32_t i = 0; i < dumps->count; i++)
        if (dumps->matches[i].sides[1] == entry)
            return true;
    return false;
}

static void print_alone(const struct dumps *dumps, const int widths[2])
{
    const struct theirs *second = &dumps->sides[1];
    for (uint32_t i = 0; i < second->count; i++) {
        if (is_matched(dumps, &second->entries[i]))
            continue;
        char *name = match_name(&second->entries[i]);
        printf("%-*s  %-*s  %10s  %10s  %-7s  not in the first dump\n", widths[0],
               second->entries[i].pass, widths[1], name ? name : "", "-", "-", "alone");
        free(name);
    }
}

static void print_why(const struct match *match)
{
    if (!match->compared || difference_verdict(&match->difference) != VERDICT_DIFFERS)
        return;
    for (uint32_t i = 0; i < match->why.count; i++)
        printf("%s %s: %s\n", i ? "or  " : "why:", match->sides[0]->resource,
               match->why.reasons[i].text);
}

void dumps_print(const struct dumps *dumps)
{
    const int widths[2] = {width_of(dumps, true), width_of(dumps, false)};
    const struct match *guilty = dumps->guilty;
    printf("%-*s  %-*s  %10s  %10s  %-7s  largest error (%s, %s)\n", widths[0], "pass", widths[1],
           "resource", "elements", "differing", "verdict", dumps->sides[0].label,
           dumps->sides[1].label);
    for (uint32_t i = 0; i < dumps->count; i++)
        print_match(dumps, &dumps->matches[i], widths);
    print_alone(dumps, widths);
    for (uint32_t i = 0; i < dumps->count; i++)
        print_why(&dumps->matches[i]);
    if (dumps->alone[0] || dumps->alone[1])
        printf("without a partner: %u in the first dump, %u in the second\n", dumps->alone[0],
               dumps->alone[1]);
    if (guilty && guilty->sides[0]->frame)
        printf("first pass that differs: %s, resource %s, in frame %u\n", guilty->sides[0]->pass,
               guilty->sides[0]->resource, guilty->sides[0]->frame);
    else if (guilty)
        printf("first pass that differs: %s, resource %s\n", guilty->sides[0]->pass,
               guilty->sides[0]->resource);
    else
        printf("all %u resources that both have agree\n", dumps->count - dumps->alone[0]);
}

/* ---- JSON -------------------------------------------------------------------------------------- */

static cJSON *entry_json(const struct their_entry *entry)
{
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "pass", entry->pass);
    cJSON_AddStringToObject(root, "resource", entry->resource);
    cJSON_AddNumberToObject(root, "mip", entry->mip);
    cJSON_AddNumberToObject(root, "frame", entry->frame);
    return root;
}

static cJSON *match_json(const struct dumps *dumps, const struct match *match)
{
    const char *const labels[2] = {dumps->sides[0].label, dumps->sides[1].label};
    cJSON *root = entry_json(match->sides[0]);
    if (match->compared)
        difference_json(root, &match->difference, &match->what, labels);
    else
        cJSON_AddStringToObject(root, "verdict", verdict_of(match));
    if (match->note)
        cJSON_AddStringToObject(root, "note", match->note);
    if (match->not_finite)
        cJSON_AddNumberToObject(root, "not_finite_in_both", (double)match->not_finite);
    if (match->why.count)
        why_json(root, &match->why);
    return root;
}

cJSON *dumps_json(const struct dumps *dumps)
{
    cJSON *root = cJSON_CreateObject();
    cJSON *sides = cJSON_AddArrayToObject(root, "sides");
    for (int i = 0; i < 2; i++)
        cJSON_AddItemToArray(sides, cJSON_CreateString(dumps->sides[i].label));
    cJSON_AddBoolToObject(root, "agree", !dumps->guilty);
    if (dumps->guilty)
        cJSON_AddItemToObject(root, "guilty", entry_json(dumps->guilty->sides[0]));
    else
        cJSON_AddNullToObject(root, "guilty");
    cJSON *results = cJSON_AddArrayToObject(root, "results");
    for (uint32_t i = 0; i < dumps->count; i++)
        cJSON_AddItemToArray(results, match_json(dumps, &dumps->matches[i]));
    cJSON *alone = cJSON_AddArrayToObject(root, "only_in_second");
    for (uint32_t i = 0; i < dumps->sides[1].count; i++)
        if (!is_matched(dumps, &dumps->sides[1].entries[i]))
            cJSON_AddItemToArray(alone, entry_json(&dumps->sides[1].entries[i]));
    return root;
}
