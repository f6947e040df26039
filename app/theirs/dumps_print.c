/* What `compare A B` tells of two dumps; see dumps.h. */
#include <cjson/cJSON.h>
#include <stdio.h>

#include "theirs/dumps.h"
#include "theirs/why.h"

static void conclude_match(struct match *match)
{
    struct sheet_row *row = match->row;
    row->kept = match->kept;
    if (row->compared) {
        row->note = match->note;
        row->text = NULL;
        row->frames_differing = difference_verdict(&row->difference) != VERDICT_EQUAL;
    } else {
        row->verdict = match->sides[1] ? verdict_name(VERDICT_DIFFERS) : "alone";
        row->text = match->sides[1] ? match->note : "not in the second dump";
    }
}

void dumps_conclude(struct dumps *dumps)
{
    struct sheet *sheet = &dumps->sheet;
    for (uint32_t i = 0; i < dumps->count; i++)
        conclude_match(&dumps->matches[i]);
    sheet->agree = sheet_agrees(sheet, dumps->first) && !measured_breaks(sheet);
    if (!dumps->first)
        return;
    sheet->guilty = sheet_event(dumps->first->row, dumps->first->row->frame);
    if (dumps->loud) {
        cJSON *loud = cJSON_AddObjectToObject(sheet->guilty.more, "beyond_noise");
        cJSON_AddStringToObject(loud, "pass", dumps->loud->sides[0]->pass);
        cJSON_AddStringToObject(loud, "resource", dumps->loud->sides[0]->resource);
        cJSON_AddItemReferenceToObject(loud, "size",
                                       cJSON_GetObjectItem(dumps->loud->row->why, "size"));
    }
}

static void print_outcome(const struct dumps *dumps)
{
    const struct match *told = dumps->first;
    char frame[32] = "";
    uint32_t both = dumps->sides[1]->count - dumps->sheet.alone;
    if (told && told->row->frame)
        snprintf(frame, sizeof frame, ", in frame %u", told->row->frame);
    if (sheet_print_odd(&dumps->sheet))
        return;
    if (!told && !dumps->sheet.agree)
        printf("the first runs agree, but not all do\n");
    else if (!told)
        printf("all %u resources that both have agree\n", both);
    else
        printf("first pass that differs: %s, resource %s%s\n", told->sides[0]->pass,
               told->sides[0]->resource, frame);
    if (dumps->loud)
        printf("first error beyond noise: %s, resource %s: %s\n", dumps->loud->sides[0]->pass,
               dumps->loud->sides[0]->resource,
               cJSON_GetStringValue(cJSON_GetObjectItem(dumps->loud->row->why, "size")));
}

/* How many elements use their bound, and why others break it. */
static void print_reasons(const struct match *match)
{
    const struct difference *difference = &match->row->difference;
    if (match->row->compared && difference_verdict(difference) == VERDICT_WITHIN)
        printf("%s: %.2g %% of the elements differ, within their bound\n", match->place,
               100 * (double)difference->differing / (double)difference->elements);
    if (match->row->why)
        why_print(match->row->why, match->sides[0]->resource);
}

bool dumps_print(const struct dumps *dumps)
{
    bool good = true;
    const struct sheet *sheet = &dumps->sheet;
    uint32_t both = dumps->sides[1]->count - sheet->alone;
    if (dumps->several)
        printf("\n%s against %s\n", sheet->labels[1], sheet->labels[0]);
    for (int i = 0; i < 2; i++)
        printf("%s: %s\n", sheet->labels[i], sheet->devices[i]);
    printf("\n");
    sheet_print(sheet);
    if (sheet->runs)
        good = measured_print(sheet, dumps->console);
    printf("\n");
    for (uint32_t i = 0; i < dumps->count; i++)
        print_reasons(&dumps->matches[i]);
    measured_grown(sheet);
    if (dumps->count > both || sheet->alone)
        printf("without a partner: %u in the first dump, %u in the second\n", dumps->count - both,
               sheet->alone);
    print_outcome(dumps);
    return good;
}
