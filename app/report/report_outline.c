/* What a report shows: the outline, a YAML file that belongs to a spec, and the scenes.
 *
 *   title, source            what the pipeline is, and where it comes from
 *   scenes: [FILE, ...]      beside the outline, for when --scene names none
 *   reference: {bounces: N, title: ...}
 *   pictures: [{name: ..., title: ..., set: [PATH=VALUE, ...]}, ...]
 *   sweep: {parameter: NAME, values: [...]}       of each picture; the last value is the best
 *   motion: {frames: N, size: WxH, spp: N, block: N, show: RESOURCE,
 *            quantity: radiance|irradiance, from_bounce: N,   of the references (irradiance, 1)
 *            of: [{name: ..., title: ..., scene: NAME, file: FILE}, ...],
 *            runs: [{name: ..., title: ..., set: [...]}, ...]}
 *   stages: [{name: ..., doc: ..., passes: [...]}, ...]
 *   published: {by, device, scene, size, stages: {NAME: [ms of each value of the sweep]}, total: [...],
 *               figures: {pictures: ..., errors: ..., times: ...}, own_error: {metric: ..., values: [...]}}
 *
 * Only pictures, sweep and reference must be there. */
#include <errno.h>
#include <libfyaml.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/files.h"
#include "spec/pipeline.h"
#include "report/report.h"
#include "base/yaml_file.h"

const char *report_item(const cJSON *list, int index, char buffer[32])
{
    const cJSON *item = cJSON_GetArrayItem(list, index);
    if (cJSON_IsString(item))
        return item->valuestring;
    buffer[0] = 0;
    if (cJSON_IsNumber(item))
        snprintf(buffer, 32, "%.9g", item->valuedouble);
    return buffer;
}

/* ---- The outline ----------------------------------------------------------------------------- */

/* ssvp/report.yaml for ssvp.yaml. */
static char *find_outline(const struct report *report)
{
    const char *given = report->options->outline;
    const char *dot = strrchr(report->steps.spec, '.');
    int length = (int)(dot ? dot - report->steps.spec : (long)strlen(report->steps.spec));
    char *path =
        given ? strdup(given) : format_string("%.*s/report.yaml", length, report->steps.spec);
    char *real = path ? realpath(path, NULL) : NULL;
    if (!real)
        report_error(&report->steps.console->log,
                     "%s: cannot be read: %s; it says what a report of this spec shows, see "
                     "templates/ssvp/report.yaml; --outline names another",
                     path ? path : "outline", strerror(errno));
    free(path);
    return real;
}

static bool is_number(struct fy_node *node)
{
    const char *text = node && fy_node_is_scalar(node) ? fy_node_get_scalar0(node) : "";
    char *end = NULL;
    return *text && isfinite(strtod(text, &end)) && !*end;
}

static bool is_text(struct fy_node *node)
{
    return node && fy_node_is_scalar(node) && *fy_node_get_scalar0(node) && !is_number(node);
}

/* Reports what is not one thing or more of those that `fits` says, which are called `what`. */
static void check_list(struct reader *reader, const struct key *key,
                       bool (*fits)(struct fy_node *item), const char *what)
{
    void *position = NULL;
    struct fy_node *item;
    if (!key->node || !fy_node_is_sequence(key->node))
        return;
    if (fy_node_sequence_item_count(key->node) == 0)
        reader_report(reader, key->node, "`%s` takes a list of %s", key->name, what);
    while ((item = fy_node_sequence_iterate(key->node, &position)))
        if (fits && !fits(item))
            reader_report(reader, item, "`%s` takes a list of %s", key->name, what);
}

/* Reads each item of a list that holds mappings. */
static void read_list(struct reader *reader, const struct key *key, const char *owner,
                      const struct key *keys, size_t count,
                      void (*check)(struct reader *reader, const struct key *keys))
{
    void *position = NULL;
    struct fy_node *item;
    struct key own[4];
    check_list(reader, key, fy_node_is_mapping, "mappings");
    if (!key->node || !fy_node_is_sequence(key->node))
        return;
    while ((item = fy_node_sequence_iterate(key->node, &position))) {
        if (!fy_node_is_mapping(item))
            continue;
        struct fy_node_pair *first = fy_node_mapping_get_by_index(item, 0);
        memcpy(own, keys, count * sizeof *keys);
        reader_mapping(reader, item, first ? fy_node_pair_key(first) : item, owner, own, count);
        check(reader, own);
    }
}

static void read_part(struct reader *reader, const struct key *self, const char *owner,
                      struct key *keys, size_t count)
{
    if (self->node && fy_node_is_mapping(self->node))
        reader_mapping(reader, self->node, self->name_node, owner, keys, count);
}

static void check_name(struct reader *reader, const struct key *keys)
{
    struct fy_node *name = keys[0].node;
    if (name && fy_node_is_scalar(name) &&
        !(is_text(name) && step_is_name(fy_node_get_scalar0(name))))
        reader_report(reader, name, "`name` must be valid as a file name");
}

/* Of a picture, or a run of a motion. */
static void check_picture(struct reader *reader, const struct key *keys)
{
    check_name(reader, keys);
    check_list(reader, &keys[2], is_text, "PATH=VALUE");
}

static void check_stage(struct reader *reader, const struct key *keys)
{
    check_list(reader, &keys[1], is_text, "passes");
}

static void read_lists(struct reader *reader, const struct key *pictures, const struct key *stages)
{
    static const struct key picture[] = {{.name = "name", .type = KEY_TEXT, .required = true},
                                         {.name = "title", .type = KEY_TEXT, .required = true},
                                         {.name = "set", .type = KEY_SEQUENCE, .required = true}};
    static const struct key stage[] = {{.name = "name", .type = KEY_TEXT, .required = true},
                                       {.name = "passes", .type = KEY_SEQUENCE, .required = true},
                                       {.name = "doc", .type = KEY_TEXT}};
    read_list(reader, pictures, "a picture", picture, DT_ARRAY_COUNT(picture), check_picture);
    read_list(reader, stages, "a stage", stage, DT_ARRAY_COUNT(stage), check_stage);
}

/* Reports settings of a motion that `diptych reference` refuses. `bounces` is the reference's. */
static void check_traced(struct reader *reader, const struct key *quantity,
                         const struct key *from_bounce, const struct key *bounces)
{
    const char *text = quantity->node && fy_node_is_scalar(quantity->node)
                           ? fy_node_get_scalar0(quantity->node)
                           : "radiance";
    struct fy_node *place = from_bounce->node ? from_bounce->node : bounces->node;
    if (strcmp(text, "radiance") != 0 && strcmp(text, "irradiance") != 0)
        reader_report(reader, quantity->node, "`quantity` takes `radiance` or `irradiance`");
    if (place && bounces->node && from_bounce->number[0] > bounces->number[0])
        reader_report(reader, place,
                      "`from_bounce` of `motion` (default: 1) must be at most `bounces` of "
                      "`reference`");
}

/* `bounces` is the reference's. */
static void read_motion(struct reader *reader, const struct key *self, const struct key *bounces)
{
    static const struct key of[] = {{.name = "name", .type = KEY_TEXT, .required = true},
                                    {.name = "title", .type = KEY_TEXT, .required = true},
                                    {.name = "scene", .type = KEY_TEXT, .required = true},
                                    {.name = "file", .type = KEY_TEXT, .required = true}};
    static const struct key run[] = {{.name = "name", .type = KEY_TEXT, .required = true},
                                     {.name = "title", .type = KEY_TEXT, .required = true},
                                     {.name = "set", .type = KEY_SEQUENCE, .required = true}};
    enum { FRAMES, SPP, BLOCK, FROM_BOUNCE, SIZE, SHOW, QUANTITY, OF, RUNS, COUNT };
    struct key keys[COUNT] = {
        [FRAMES] = KEY_OF_NUMBERS("frames", true, 1, 2, OPTIONS_MAX_FRAMES, 2),
        [SPP] = KEY_OF_NUMBERS("spp", true, 1, 1, OPTIONS_MAX_FRAMES, 1),
        [BLOCK] = KEY_OF_NUMBERS("block", true, 1, 1, OPTIONS_MAX_SIZE, 1),
        [FROM_BOUNCE] = KEY_OF_NUMBERS("from_bounce", false, 1, 0, 1000, 1),
        [SIZE] = {.name = "size", .type = KEY_TEXT, .required = true},
        [QUANTITY] = {.name = "quantity", .type = KEY_TEXT},
        [SHOW] = {.name = "show", .type = KEY_TEXT, .required = true},
        [OF] = {.name = "of", .type = KEY_SEQUENCE, .required = true},
        [RUNS] = {.name = "runs", .type = KEY_SEQUENCE, .required = true},
    };
    read_part(reader, self, "`motion`", keys, COUNT);
    read_list(reader, &keys[OF], "a motion", of, DT_ARRAY_COUNT(of), check_name);
    read_list(reader, &keys[RUNS], "a run", run, DT_ARRAY_COUNT(run), check_picture);
    for (int i = FRAMES; i <= FROM_BOUNCE; i++)
        if (keys[i].number[0] != floor(keys[i].number[0]))
            reader_report(reader, keys[i].node, "`%s` takes a whole number", keys[i].name);
    if (self->node)
        check_traced(reader, &keys[QUANTITY], &keys[FROM_BOUNCE], bounces);
}

/* One number for each value of the sweep, or fewer. */
static void check_numbers(struct reader *reader, struct fy_node *node, const char *name, int count,
                          bool fewer)
{
    void *position = NULL;
    struct fy_node *item;
    int found = node && fy_node_is_sequence(node) ? fy_node_sequence_item_count(node) : -1;
    if (!node)
        return;
    if (found < 1 || found > count || (found < count && !fewer)) {
        reader_report(reader, node, "`%s` takes %s the sweep has values", name,
                      fewer ? "no more numbers than" : "as many numbers as");
        return;
    }
    while ((item = fy_node_sequence_iterate(node, &position)))
        if (!is_number(item))
            reader_report(reader, item, "`%s` takes numbers", name);
}

static void read_published(struct reader *reader, const struct key *self, int values)
{
    enum { BY, DEVICE, SCENE, SIZE, STAGES, TOTAL, FIGURES, OWN_ERROR, COUNT };
    struct key keys[COUNT] = {
        [BY] = {.name = "by", .type = KEY_TEXT},
        [DEVICE] = {.name = "device", .type = KEY_TEXT},
        [SCENE] = {.name = "scene", .type = KEY_TEXT},
        [SIZE] = {.name = "size", .type = KEY_TEXT},
        [STAGES] = {.name = "stages", .type = KEY_MAPPING},
        [TOTAL] = {.name = "total", .type = KEY_SEQUENCE},
        [FIGURES] = {.name = "figures", .type = KEY_MAPPING},
        [OWN_ERROR] = {.name = "own_error", .type = KEY_MAPPING},
    };
    struct key error[] = {{.name = "metric", .type = KEY_TEXT},
                          {.name = "values", .type = KEY_SEQUENCE}};
    struct key figures[] = {{.name = "pictures", .type = KEY_TEXT},
                            {.name = "errors", .type = KEY_TEXT},
                            {.name = "times", .type = KEY_TEXT}};
    struct fy_node_pair *pair;
    void *position = NULL;
    read_part(reader, self, "`published`", keys, COUNT);
    read_part(reader, &keys[FIGURES], "`figures`", figures, DT_ARRAY_COUNT(figures));
    read_part(reader, &keys[OWN_ERROR], "`own_error`", error, DT_ARRAY_COUNT(error));
    check_numbers(reader, keys[TOTAL].node, "total", values, false);
    check_numbers(reader, error[1].node, "values", values, true);
    struct fy_node *stages = keys[STAGES].node;
    while (stages && fy_node_is_mapping(stages) &&
           (pair = fy_node_mapping_iterate(stages, &position)))
        check_numbers(reader, fy_node_pair_value(pair), "stages", values, false);
}

static void read_report_outline(struct reader *reader, struct fy_node *root, void *user)
{
    enum { TITLE, SOURCE, SCENES, REFERENCE, PICTURES, SWEEP, MOTION, STAGES, PUBLISHED, COUNT };
    struct key keys[COUNT] = {
        [TITLE] = {.name = "title", .type = KEY_TEXT},
        [SOURCE] = {.name = "source", .type = KEY_TEXT},
        [SCENES] = {.name = "scenes", .type = KEY_SEQUENCE},
        [REFERENCE] = {.name = "reference", .type = KEY_MAPPING, .required = true},
        [PICTURES] = {.name = "pictures", .type = KEY_SEQUENCE, .required = true},
        [SWEEP] = {.name = "sweep", .type = KEY_MAPPING, .required = true},
        [MOTION] = {.name = "motion", .type = KEY_MAPPING},
        [STAGES] = {.name = "stages", .type = KEY_SEQUENCE},
        [PUBLISHED] = {.name = "published", .type = KEY_MAPPING},
    };
    struct key reference[] = {KEY_OF_NUMBERS("bounces", true, 1, 0, 1000, 0),
                              {.name = "title", .type = KEY_TEXT}};
    struct key sweep[] = {{.name = "parameter", .type = KEY_TEXT, .required = true},
                          {.name = "values", .type = KEY_SEQUENCE, .required = true}};
    struct fy_node_pair *first = fy_node_mapping_get_by_index(root, 0);
    reader_mapping(reader, root, first ? fy_node_pair_key(first) : root, "the outline", keys,
                   COUNT);
    check_list(reader, &keys[SCENES], is_text, "scene files");
    read_lists(reader, &keys[PICTURES], &keys[STAGES]);
    read_part(reader, &keys[REFERENCE], "`reference`", reference, DT_ARRAY_COUNT(reference));
    read_motion(reader, &keys[MOTION], &reference[0]);
    read_part(reader, &keys[SWEEP], "`sweep`", sweep, DT_ARRAY_COUNT(sweep));
    check_list(reader, &sweep[1], NULL, "values");
    bool listed = sweep[1].node && fy_node_is_sequence(sweep[1].node);
    read_published(reader, &keys[PUBLISHED],
                   listed ? fy_node_sequence_item_count(sweep[1].node) : 0);

    struct report *report = user;
    char *text = fy_emit_document_to_string(fy_node_document(root), FYECF_MODE_JSON_ONELINE);
    report->outline = text ? cJSON_Parse(text) : NULL;
    free(text);
    if (!report->outline)
        reader_report(reader, root, "the file cannot be converted to JSON");
}

bool report_read_outline(struct report *report)
{
    static const struct file_kind outline_file = {
        "report outline", "`pictures`, `sweep` and `reference`", read_report_outline};
    const struct dt_log *log = &report->steps.console->log;
    report->outline_path = find_outline(report);
    return report->outline_path && reader_file(report->outline_path, &outline_file, report, log);
}

char *report_outline_file(const struct report *report, const char *name)
{
    const char *slash = strrchr(report->outline_path, '/');
    return name[0] == '/' ? strdup(name)
                          : format_string("%.*s/%s", (int)(slash - report->outline_path),
                                          report->outline_path, name);
}

const cJSON *report_next_motion(const struct report *report, const struct step_scene *scene,
                                const cJSON *motion)
{
    const cJSON *list = cJSON_GetObjectItem(cJSON_GetObjectItem(report->outline, "motion"), "of");
    motion = motion ? motion->next : cJSON_GetArrayItem(list, 0);
    while (motion && strcmp(step_text(motion, "scene"), scene->name) != 0)
        motion = motion->next;
    return motion;
}

const char *report_motion_quantity(const struct report *report)
{
    const cJSON *motion = cJSON_GetObjectItem(report->outline, "motion");
    return cJSON_HasObjectItem(motion, "quantity") ? step_text(motion, "quantity") : "irradiance";
}

int report_motion_from_bounce(const struct report *report)
{
    const cJSON *motion = cJSON_GetObjectItem(report->outline, "motion");
    const cJSON *from = cJSON_GetObjectItem(motion, "from_bounce");
    return from ? from->valueint : 1;
}

const char *report_parameter(const struct report *report)
{
    return step_text(cJSON_GetObjectItem(report->outline, "sweep"), "parameter");
}

const cJSON *report_values(const struct report *report)
{
    return cJSON_GetObjectItem(cJSON_GetObjectItem(report->outline, "sweep"), "values");
}

int report_value_count(const struct report *report)
{
    return cJSON_GetArraySize(report_values(report));
}

/* ---- Scenes ---------------------------------------------------------------------------------- */

static bool find_outline_scenes(struct report *report, const cJSON *list)
{
    uint32_t count = 0, most = (uint32_t)cJSON_GetArraySize(list);
    char **paths = calloc(most + 1, sizeof *paths);
    bool good = paths;
    for (; count < most && good; count++) {
        const cJSON *item = cJSON_GetArrayItem(list, (int)count);
        paths[count] = report_outline_file(report, cJSON_IsString(item) ? item->valuestring : "");
        good = paths[count];
    }
    if (good)
        good = steps_find_scenes(&report->steps, (const char *const *)paths, count);
    else
        report_error(&report->steps.console->log, "out of memory");
    for (uint32_t i = 0; i < count && paths; i++)
        free(paths[i]);
    free(paths);
    return good;
}

bool report_find_scenes(struct report *report)
{
    const struct text_list *given = &report->options->scene_list;
    return given->count
               ? steps_find_scenes(&report->steps, given->items, given->count)
               : find_outline_scenes(report, cJSON_GetObjectItem(report->outline, "scenes"));
}
