/* The page of `compare --html`: what templates/report/compare.html is filled with; see compare.h. */
#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "console/fill.h"
#include "compare/compare.h"

/* "1 ulp", "2 to 3 ulp": of floats; other numbers have codes. */
static char *bin_name(int bin)
{
    unsigned long long low = bin ? 1ULL << (bin - 1) : 0;
    return bin == 0                     ? strdup("0 and -0")
           : bin == DIFFERENCE_BINS - 1 ? strdup("NaN or Inf")
           : bin == 1                   ? strdup("1")
                                        : format_string("%llu to %llu", low, 2 * low - 1);
}

/* Heights are logarithmic, so that one number among millions is seen. */
static void add_histogram(cJSON *item, const struct result *result)
{
    int first = 0, last = -1;
    uint64_t most = 0;
    for (int i = 0; i < DIFFERENCE_BINS; i++) {
        first = last < 0 ? i : first;
        last = result->bins[i] ? i : last;
        most = result->bins[i] > most ? result->bins[i] : most;
    }
    cJSON *bins = cJSON_AddArrayToObject(item, "bins");
    for (int i = first; i <= last; i++) {
        cJSON *bin = cJSON_CreateObject();
        char *name = bin_name(i);
        cJSON_AddStringToObject(bin, "bin", name ? name : "");
        cJSON_AddNumberToObject(bin, "numbers", (double)result->bins[i]);
        cJSON_AddNumberToObject(
            bin, "percent",
            round(100 * log2((double)result->bins[i] + 1) / log2((double)most + 1)));
        cJSON_AddItemToArray(bins, bin);
        free(name);
    }
}

static void add_pictures(cJSON *item, const struct dt_resource *resource,
                         const struct result *result)
{
    static const char *const keys[] = {"first_file", "second_file", "difference_file"};
    cJSON *shown = result->shown[0] ? cJSON_AddObjectToObject(item, "shown") : NULL;
    if (!shown)
        return;
    for (int i = 0; i < SHOWN_PICTURES; i++)
        cJSON_AddStringToObject(shown, keys[i], result->shown[i] ? result->shown[i] : "");
    cJSON_AddNumberToObject(shown, "across", result->difference.extent[0]);
    cJSON_AddNumberToObject(shown, "down", result->difference.extent[1]);
    if (resource->layered)
        cJSON_AddNumberToObject(shown, "layer", result->strip.layer);
    if (result->strip.amplification > 0)
        cJSON_AddNumberToObject(shown, "amplification", result->strip.amplification);
}

/* Whether the pass's inputs differed, and its own error, as the table that is printed has them. */
static void add_blame(cJSON *item, const struct pair *pair, uint32_t index)
{
    const struct difference *own = pair->blame.own ? &pair->blame.own[index] : NULL;
    char text[32] = "none";
    if (!cJSON_HasObjectItem(item, "inputs"))
        cJSON_AddStringToObject(item, "inputs", "");
    if (own && own->size_differs)
        snprintf(text, sizeof text, "size");
    else if (own && own->differing)
        snprintf(text, sizeof text, "%llu differ", (unsigned long long)own->differing);
    else if (own && own->not_finite)
        snprintf(text, sizeof text, "not finite");
    cJSON_AddStringToObject(item, "own", text);
}

/* Adds what the page has beyond the JSON of --json. */
static void add_row(cJSON *item, const struct compare *compare, const struct pair *pair,
                    uint32_t index)
{
    const struct row *row = &compare->rows.outputs.list[index];
    const struct dt_pass *pass = &compare->pipeline.info->passes[row->pass];
    const struct dt_resource *resource = &compare->pipeline.info->resources[row->resource];
    const struct result *result = &pair->results[index];
    const char *const labels[2] = {pair->sides[0]->label, pair->sides[1]->label};
    char *worst = difference_describe_worst(&result->difference, resource, labels);
    cJSON_AddNumberToObject(item, "row", index);
    cJSON_AddStringToObject(item, "name", row->name);
    cJSON_AddBoolToObject(item, "opens_pass", compare->rows.outputs.first[row->pass] == index);
    cJSON_AddStringToObject(item, "body", pass->shader ? pass->shader : "");
    cJSON_AddStringToObject(item, "about", resource->doc ? resource->doc : "");
    cJSON_AddBoolToObject(item, "equal", difference_verdict(&result->difference) == VERDICT_EQUAL);
    cJSON_AddStringToObject(item, "largest", worst ? worst : "");
    add_blame(item, pair, index);
    add_pictures(item, resource, result);
    add_histogram(item, result);
    free(worst);
}

static cJSON *pair_page(const struct compare *compare, uint32_t index)
{
    const struct pair *pair = &compare->pairs[index];
    cJSON *page = compare_pair_json(compare, pair), *item;
    uint32_t row = 0;
    cJSON_AddNumberToObject(page, "pair", index);
    cJSON_AddStringToObject(page, "first", pair->sides[0]->label);
    cJSON_AddStringToObject(page, "second", pair->sides[1]->label);
    cJSON_AddBoolToObject(page, "blamed",
                          pair->blame.outcome != BLAME_NOT_RUN && !pair->on_equal_inputs);
    if (!cJSON_HasObjectItem(page, "why"))
        cJSON_AddArrayToObject(page, "why");
    cJSON *guilty = cJSON_GetObjectItem(page, "guilty");
    if (cJSON_IsObject(guilty))
        cJSON_AddNumberToObject(guilty, "row", pair->blame.row);
    cJSON_ArrayForEach(item, cJSON_GetObjectItem(page, "results"))
        add_row(item, compare, pair, row++);
    return page;
}

bool compare_write_html(const struct compare *compare)
{
    char *path = format_string("%s/index.html", compare->options.html);
    cJSON *page = cJSON_CreateObject();
    cJSON_AddStringToObject(page, "pipeline", compare->pipeline.info->name);
    cJSON_AddStringToObject(page, "scene",
                            compare->options.setup.scene ? compare->options.setup.scene : "");
    cJSON_AddNumberToObject(page, "width", compare->options.setup.size[0]);
    cJSON_AddNumberToObject(page, "height", compare->options.setup.size[1]);
    cJSON_AddNumberToObject(page, "frames", compare->options.setup.frames);
    cJSON *sets = cJSON_AddArrayToObject(page, "sets");
    for (uint32_t i = 0; i < compare->options.setup.set_count; i++)
        cJSON_AddItemToArray(sets, cJSON_CreateString(compare->options.setup.sets[i]));
    cJSON *devices = cJSON_AddArrayToObject(page, "devices");
    for (uint32_t i = 0; i < compare->sides.count; i++) {
        cJSON *device = cJSON_CreateObject();
        cJSON_AddStringToObject(device, "label", compare->sides.list[i].label);
        cJSON_AddStringToObject(device, "device", compare->devices[i]);
        cJSON_AddItemToArray(devices, device);
    }
    cJSON *pairs = cJSON_AddArrayToObject(page, "pairs");
    for (uint32_t i = 0; i < compare->pair_count; i++)
        cJSON_AddItemToArray(pairs, pair_page(compare, i));
    cJSON *found = undefined_json(&compare->undefined);
    cJSON_AddItemToObject(page, "undefined", found ? found : cJSON_CreateArray());
    cJSON *golden = cJSON_AddObjectToObject(page, "golden");
    if (compare->options.golden && !compare->options.update) {
        cJSON_AddStringToObject(golden, "folder", compare->options.golden);
        cJSON_AddItemToObject(golden, "differing",
                              cJSON_Duplicate(compare->golden.differing, true));
    }
    bool good = fill_page(compare->console, "compare.html", path, page);
    cJSON_Delete(page);
    free(path);
    return good;
}
