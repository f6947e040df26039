/* Waves of each pass on a GPU, with --gpu: `list` asks the chip's compiler in a process of its own, again after each
 * reload. Until it answers, and where it cannot, the list of passes has none. See view.h. */
#include "view/view.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/files.h"
#include "compare/apart.h"

/* What the thread is given and leaves; owned by the view, which reads it when `running` is false. */
struct asking {
    struct console *console;
    const struct setup *setup;
    const char *gpu;
    char *edits, *file;
    struct overlay_waves *list;
    uint32_t count;
    atomic_bool running;
};

static double stage_number(const cJSON *stage, const char *name)
{
    const cJSON *number = cJSON_GetObjectItem(stage, name);
    return cJSON_IsNumber(number) ? number->valuedouble : NAN;
}

/* The stage with the fewest waves speaks for its pass. */
static struct overlay_waves waves_of(const cJSON *pass, const char *gpu)
{
    struct overlay_waves waves = {.waves = NAN};
    const cJSON *stage;
    cJSON_ArrayForEach(stage, cJSON_GetObjectItem(pass, "stages"))
    {
        double number = stage_number(stage, "waves");
        const char *limit = cJSON_GetStringValue(cJSON_GetObjectItem(stage, "limit"));
        if (isnan(number) || number >= waves.waves)
            continue;
        waves.waves = number;
        snprintf(waves.tip, sizeof waves.tip,
                 "%s: %.0f waves of a SIMD%s%s, %.0f VGPRs, %.0f spills", gpu, number,
                 limit && *limit ? ", limited by " : "", limit ? limit : "",
                 stage_number(stage, "vgprs"), stage_number(stage, "spills"));
    }
    return waves;
}

static void read_answer(struct asking *asking)
{
    size_t size;
    char *text = file_read(asking->file, &size, &asking->console->log);
    cJSON *root = text ? cJSON_Parse(text) : NULL;
    const cJSON *pass, *passes = cJSON_GetObjectItem(root, "passes");
    asking->list = calloc((size_t)cJSON_GetArraySize(passes) + 1, sizeof *asking->list);
    if (asking->list)
        cJSON_ArrayForEach(pass, passes) asking->list[asking->count++] =
            waves_of(pass, asking->gpu);
    cJSON_Delete(root);
    free(text);
}

static void *ask_for_waves(void *user)
{
    struct asking *asking = user;
    if (list_apart(asking->console, asking->setup, asking->edits, asking->gpu, asking->file))
        read_answer(asking);
    asking->running = false;
    return NULL;
}

static void free_asking(struct asking *asking)
{
    if (asking && asking->file)
        unlink(asking->file);
    if (asking) {
        free(asking->list);
        free(asking->file);
        free(asking->edits);
    }
    free(asking);
}

static char *answer_file(void)
{
    const char *place = getenv("TMPDIR");
    char *path = format_string("%s/diptych-XXXXXX", place && *place ? place : "/tmp");
    int file = path ? mkstemp(path) : -1;
    if (file >= 0)
        close(file);
    return path;
}

static void start(struct view *view)
{
    struct view_waves *waves = &view->waves;
    struct asking *asking = calloc(1, sizeof *asking);
    if (!asking)
        return;
    asking->console = view->console;
    asking->setup = &view->options->setup;
    asking->gpu = view->options->gpu;
    asking->edits = view_params_text(view, "", "\n", true, true);
    asking->file = answer_file();
    asking->running = true;
    if (asking->edits && asking->file &&
        pthread_create(&waves->thread, NULL, ask_for_waves, asking) == 0)
        waves->asking = asking;
    else
        free_asking(asking);
}

void view_waves_ask(struct view *view)
{
    free(view->waves.list);
    view->waves.list = NULL;
    view->waves.wanted = view->options->gpu != NULL;
}

/* Waits for the thread, and takes its answer. */
static void take_answer(struct view *view)
{
    struct view_waves *waves = &view->waves;
    struct asking *asking = waves->asking;
    pthread_join(waves->thread, NULL);
    waves->asking = NULL;
    if (asking->count == view->pipeline.info->pass_count && !waves->wanted) {
        waves->list = asking->list;
        asking->list = NULL;
    }
    free_asking(asking);
}

void view_waves_poll(struct view *view)
{
    struct view_waves *waves = &view->waves;
    if (waves->asking && !waves->asking->running)
        take_answer(view);
    if (waves->wanted && !waves->asking) {
        waves->wanted = false;
        start(view);
    }
}

void view_waves_tell(struct view *view, cJSON *root)
{
    if (view->waves.asking)
        take_answer(view);
    cJSON *list = view->waves.list ? cJSON_AddArrayToObject(root, "waves") : NULL;
    for (uint32_t i = 0; list && i < view->pipeline.info->pass_count; i++)
        cJSON_AddItemToArray(list, cJSON_CreateNumber(view->waves.list[i].waves));
}

void view_waves_end(struct view *view)
{
    if (view->waves.asking)
        pthread_join(view->waves.thread, NULL);
    free_asking(view->waves.asking);
    free(view->waves.list);
}
