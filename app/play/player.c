/* libdiptych_play: the rooms below as a library; see diptych_play.h. */
#include "play/diptych_play.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "result/live.h"
#include "picture/texels.h"
#include "spec/inputs.h"
#include "spec/list.h"
#include "result/difference.h"
#include "result/rows.h"
#include "run/session.h"
#include "run/undefined.h"

struct dt_player {
    struct console console;
    struct setup setup; /* strings are valid in open only */
    struct side side;
    struct pipeline pipeline;
    struct scene scene;
    struct session session;
    char *description;
    const struct dt_observer *observer; /* of the caller, while a frame is rendered */
    uint32_t pass;                      /* the last one of that frame, or of the whole frame */
    bool timing, sanitized;
    bool rendering; /* within render or compare */
    bool broken;    /* the last frame failed: resize before the next */
    pid_t process;  /* that opened it */
};

static bool player_fail(struct dt_player *player, const char *reason)
{
    return report_error(&player->console.log, "%s", reason);
}

/* Whether this is the process that opened the player. A child of fork() shares its device's memory, not
 * the threads of its driver. */
static bool is_own(const struct dt_player *player, const char *verb)
{
    if (!player)
        return false; /* open has told why */
    if (player->process != getpid())
        report_error(&player->console.log, "%s: another process opened this pipeline", verb);
    return player->process == getpid();
}

/* The same for what after_pass cannot call. */
static bool may_call(const struct dt_player *player, const char *verb)
{
    if (player && player->rendering)
        report_error(&player->console.log, "%s: a frame is being rendered", verb);
    return player && !player->rendering && is_own(player, verb);
}

static bool is_given(const struct dt_player *player, const char *verb, const void *pointer)
{
    if (!pointer)
        report_error(&player->console.log, "%s: a pointer is NULL", verb);
    return pointer;
}

/* ---- Open and close -------------------------------------------------------------------------- */

static struct setup setup_of(const struct dt_play_options *wanted)
{
    bool sized = wanted->width || wanted->height;
    return (struct setup){
        .spec = wanted->spec,
        .backend = wanted->backend ? wanted->backend : "vk",
        .scene = wanted->scene,
        .scenes = wanted->meshes,
        .set_list = {(const char **)wanted->sets, wanted->set_count},
        .inputs = {(const char **)wanted->inputs, wanted->input_count},
        .inputs_later = true,
        .default_size = !sized,
        .size = {sized ? wanted->width : 1920, sized ? wanted->height : 1080},
        .frames = 1,
        .debug = wanted->debug,
        .sanitize = wanted->sanitize,
    };
}

static bool check_size(const struct dt_player *player, const uint32_t size[2])
{
    return (size[0] && size[1] && size[0] <= OPTIONS_MAX_SIZE && size[1] <= OPTIONS_MAX_SIZE) ||
           report_error(&player->console.log, "size %ux%u: must be from 1x1 to %ux%u", size[0],
                        size[1], OPTIONS_MAX_SIZE, OPTIONS_MAX_SIZE);
}

static bool start_player(struct dt_player *player, const struct dt_play_options *options)
{
    struct console *console = &player->console;
    struct setup *setup = &player->setup;
    if ((setup->set_list.count && !is_given(player, "sets", setup->set_list.items)) ||
        (setup->inputs.count && !is_given(player, "inputs", setup->inputs.items)) ||
        !check_size(player, setup->size) ||
        !side_read(&player->side, setup->backend, setup, &console->log) ||
        !pipeline_load(&player->pipeline, console, setup) ||
        !inputs_load(&player->pipeline, console, setup) ||
        !session_load_scene(&player->scene, console, player->pipeline.info, setup))
        return false;
    const struct session_info info = {.side = &player->side,
                                      .console = console,
                                      .setup = setup,
                                      .pipeline = &player->pipeline,
                                      .scene = &player->scene,
                                      .timing = player->timing,
                                      .keep_history = options->keep_history};
    return session_open(&player->session, &info) && session_prepare(&player->session);
}

struct dt_player *dt_play_open(const struct dt_play_options *options)
{
    struct dt_player *player = options ? calloc(1, sizeof *player) : NULL;
    if (!player)
        return NULL;
    console_attach(&player->console, &options->log);
    player->setup = setup_of(options);
    player->timing = options->timing;
    player->sanitized = options->sanitize;
    player->process = getpid();
    if (start_player(player, options))
        return player;
    dt_play_close(player);
    return NULL;
}

void dt_play_close(struct dt_player *player)
{
    if (!player || player->process != getpid() || !may_call(player, "close"))
        return;
    session_close(&player->session);
    scene_free(&player->scene);
    pipeline_unload(&player->pipeline);
    side_free(&player->side);
    free(player->description);
    console_close(&player->console);
    free(player);
}

/* ---- Parameters and content ------------------------------------------------------------------ */

const char *dt_play_describe(struct dt_player *player)
{
    if (!is_own(player, "describe"))
        return NULL;
    cJSON *list = list_json(&player->pipeline, player->setup.size);
    cJSON_AddStringToObject(list, "backend", player->side.label);
    cJSON_AddStringToObject(list, "device",
                            player->session.runtime->device(player->session.handle)->name);
    free(player->description);
    player->description = cJSON_PrintUnformatted(list);
    cJSON_Delete(list);
    if (!player->description)
        player_fail(player, "out of memory");
    return player->description;
}

bool dt_play_set(struct dt_player *player, const char *name, const char *value)
{
    if (!is_own(player, "set") || !is_given(player, "set", name) || !is_given(player, "set", value))
        return false;
    const struct dt_param *param =
        pipeline_find_live(player->pipeline.info, "set", name, &player->console.log);
    return param && live_set(player->pipeline.info, player->pipeline.live, param, value,
                             &player->console.log);
}

/* Forgets the content of inputs whose extent depends on the frame's size. */
static void forget_inputs(struct dt_player *player, const uint32_t size[2])
{
    struct pipeline *pipeline = &player->pipeline;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < pipeline->input_count; i++) {
        struct input *input = &pipeline->inputs[i];
        bool same = true;
        for (uint32_t mip = 0; mip < input->mips; mip++) {
            uint32_t extent[3];
            resource_extent(pipeline->info, input->resource, size, mip, extent);
            same &=
                !input->mip[mip].data || memcmp(extent, input->mip[mip].extent, sizeof extent) == 0;
        }
        for (uint32_t mip = 0; !same && mip < input->mips; mip++)
            free(input->mip[mip].data);
        if (same)
            pipeline->inputs[kept++] = *input;
    }
    pipeline->input_count = kept;
}

static bool recover(struct dt_player *player)
{
    if (player->broken && !session_resize(&player->session, player->setup.size))
        return false;
    player->broken = false;
    return true;
}

bool dt_play_resize(struct dt_player *player, uint32_t width, uint32_t height)
{
    const uint32_t size[2] = {width, height};
    if (!may_call(player, "resize") || !check_size(player, size))
        return false;
    const uint32_t *fixed = player->pipeline.frame_size;
    if (fixed[0] && memcmp(fixed, size, sizeof size) != 0)
        return report_error(&player->console.log, "size %ux%u: a file of `inputs` fits %ux%u alone",
                            width, height, fixed[0], fixed[1]);
    const uint32_t before[2] = {player->setup.size[0], player->setup.size[1]};
    forget_inputs(player, size);
    memcpy(player->setup.size, size, sizeof size);
    player->broken = true;
    if (recover(player))
        return true;
    memcpy(player->setup.size, before, sizeof before); /* the next frame has that again */
    return false;
}

/* Files with such numbers are refused, too; see inputs.c. */
static bool is_finite(const struct dt_player *player, const struct dt_resource *resource,
                      const struct dt_bytes *bytes)
{
    struct component *list;
    uint32_t count = resource_components(resource, &list), stride = resource_stride(resource);
    bool good = count || player_fail((struct dt_player *)player, "out of memory");
    for (uint32_t c = 0; c < count; c++)
        for (size_t at = 0; good && number_is_float(list[c].kind) && at < bytes->size; at += stride)
            if (!isfinite(number_value(list[c].kind, bytes->data + at + list[c].offset))) {
                char *place = element_place(resource, bytes->extent, at / stride);
                report_error(&player->console.log,
                             "write %s: %s has a number%s%s that is not finite", resource->name,
                             place ? place : "an element", *list[c].name ? " in " : "",
                             list[c].name);
                free(place);
                good = false;
            }
    free(list);
    return good;
}

/* Where the pipeline keeps the content of an input, which a resize hands to the runtime. */
static struct input *input_of(struct pipeline *pipeline, uint32_t resource)
{
    const struct dt_resource *what = &pipeline->info->resources[resource];
    for (uint32_t i = 0; i < pipeline->input_count; i++)
        if (pipeline->inputs[i].resource == resource)
            return &pipeline->inputs[i];
    struct input *input = &pipeline->inputs[pipeline->input_count++];
    *input = (struct input){.resource = resource, .mips = what->kind == DT_IMAGE ? what->mips : 1};
    return input;
}

static bool keep_input(struct dt_player *player, uint32_t resource, uint32_t mip,
                       const struct dt_bytes *bytes)
{
    uint8_t *copy = malloc(bytes->size + 1);
    if (!copy)
        return player_fail(player, "out of memory");
    struct dt_bytes *kept = &input_of(&player->pipeline, resource)->mip[mip];
    free(kept->data);
    *kept = *bytes;
    kept->data = memcpy(copy, bytes->data, bytes->size);
    return true;
}

bool dt_play_write(struct dt_player *player, const char *name, uint32_t mip, const void *data,
                   size_t size)
{
    struct dt_bytes bytes = {.data = (uint8_t *)data, .size = size};
    uint32_t index;
    if (!may_call(player, "write") || !is_given(player, "write", name) ||
        !is_given(player, "write", data))
        return false;
    const struct dt_pipeline *info = player->pipeline.info;
    if (!pipeline_find(info, "write", name, &index, &player->console.log))
        return false;
    const struct dt_resource *resource = &info->resources[index];
    if (!resource->input)
        return report_error(&player->console.log, "write %s: it is no input of %s", name,
                            info->name);
    if (mip >= (resource->kind == DT_IMAGE ? resource->mips : 1))
        return report_error(&player->console.log, "write %s: it has no mip %u", name, mip);
    resource_extent(info, index, player->setup.size, mip, bytes.extent);
    if (size != resource_elements(resource, bytes.extent) * resource_stride(resource))
        return report_error(&player->console.log, "write %s: %zu bytes, but it has %zu", name, size,
                            (size_t)resource_elements(resource, bytes.extent) *
                                resource_stride(resource));
    return is_finite(player, resource, &bytes) && recover(player) &&
           player->session.runtime->write(player->session.handle, index, mip, &bytes) &&
           keep_input(player, index, mip, &bytes);
}

/* Whether the camera sees something, and knows which way is up. */
static bool is_camera(const struct dt_scene_camera *camera)
{
    float length = 0, ahead[3];
    for (int i = 0; i < 3; i++)
        ahead[i] = camera->target[i] - camera->eye[i];
    for (int i = 0, k = 1, l = 2; i < 3; i++, k = (i + 1) % 3, l = (i + 2) % 3) {
        float side = ahead[k] * camera->up[l] - ahead[l] * camera->up[k];
        length += side * side;
    }
    return length > 0 && isfinite(length) && camera->fov_y > 0 && camera->fov_y < (float)M_PI;
}

bool dt_play_camera(struct dt_player *player, const float eye[3], const float target[3],
                    const float up[3], float fov_y)
{
    struct dt_scene_camera camera = {.fov_y = fov_y * (float)(M_PI / 180)};
    if (!is_own(player, "camera") || !is_given(player, "camera", eye && target ? up : NULL))
        return false;
    memcpy(camera.eye, eye, sizeof camera.eye);
    memcpy(camera.target, target, sizeof camera.target);
    memcpy(camera.up, up, sizeof camera.up);
    if (!is_camera(&camera))
        return player_fail(player,
                           "camera: the target is away from the eye, not along up, and fov_y is "
                           "between 0 and 180 degrees");
    player->scene.camera = camera;
    return true;
}

/* Whether the mip has content that can be read at this moment. */
static bool is_there(const struct dt_player *player, uint32_t index, uint32_t mip)
{
    const struct dt_pipeline *info = player->pipeline.info;
    const struct dt_resource *resource = &info->resources[index];
    const struct dt_log *log = &player->console.log;
    bool lasts = resource->history || resource->keep || (int)index == info->linear_output ||
                 (int)index == info->display_output;
    if (!player->session.frame && !resource->input)
        return report_error(log, "read %s: no frame was rendered", resource->name);
    for (uint32_t i = 0; player->observer && i < info->passes[player->pass].write_count; i++)
        lasts |= info->passes[player->pass].writes[i] == index;
    if (!lasts)
        report_error(log,
                     "read %s: other passes may reuse its memory; read it after the pass that "
                     "writes it, or give it `keep: true` in the spec",
                     resource->name);
    else if (mip > 31 || !(resource_mips_before(info, player->pass + 1, index) >> mip & 1))
        report_error(log, "read %s: no pass wrote mip %u so far", resource->name, mip);
    else
        return true;
    return false;
}

bool dt_play_read(struct dt_player *player, const char *name, uint32_t mip, struct dt_bytes *out)
{
    uint32_t index;
    if (!is_own(player, "read") || !is_given(player, "read", name && out ? out : NULL))
        return false;
    *out = (struct dt_bytes){0};
    const struct dt_pipeline *info = player->pipeline.info;
    if (!pipeline_find(info, "read", name, &index, &player->console.log) ||
        !is_there(player, index, mip) ||
        !player->session.runtime->read(player->session.handle, index, mip, out))
        return false;
    return resource_clear_padding(&info->resources[index], out) ||
           player_fail(player, "out of memory");
}

/* ---- Frames ---------------------------------------------------------------------------------- */

static bool player_after_pass(void *user, uint32_t pass)
{
    struct dt_player *player = user;
    player->pass = pass;
    return player->observer->after_pass(player->observer->user, pass);
}

static bool render(struct dt_player *player, const struct dt_observer *observer)
{
    const struct dt_observer own = {.after_pass = player_after_pass, .user = player};
    if (!recover(player))
        return false;
    player->observer = observer->after_pass ? observer : NULL;
    player->rendering = true;
    bool drawn = session_frame(&player->session, player->observer ? &own : NULL);
    bool good = drawn && session_is_silent(&player->session);
    player->rendering = false;
    player->observer = NULL;
    player->broken = !drawn;
    player->pass = player->pipeline.info->pass_count - 1;
    return good;
}

bool dt_play_render(struct dt_player *player, bool (*after)(void *user, uint32_t pass), void *user)
{
    return may_call(player, "render") &&
           render(player, &(struct dt_observer){.after_pass = after, .user = user});
}

bool dt_play_timings(struct dt_player *player, double *pass_ms)
{
    return may_call(player, "timings") && is_given(player, "timings", pass_ms) &&
           player->session.runtime->timings(player->session.handle, pass_ms);
}

char *dt_play_undefined(struct dt_player *player)
{
    struct undefined undefined = {0};
    struct dt_bytes bytes = {0};
    if (!may_call(player, "undefined"))
        return NULL;
    const struct pipeline *pipeline = &player->pipeline;
    if (!player->sanitized) {
        report_error(&player->console.log, "undefined: the player was opened without `sanitize`");
        return NULL;
    }
    bool good = player->session.runtime->read(player->session.handle, plan_reports(pipeline->plan),
                                              0, &bytes) &&
                undefined_add(&undefined, pipeline, 0, &bytes, &player->console.log);
    cJSON *list =
        good ? undefined_json(&undefined, (const char *const *)&player->side.label, 1) : NULL;
    char *text = list ? cJSON_PrintUnformatted(list) : NULL;
    if (good && !text)
        report_error(&player->console.log, "out of memory");
    cJSON_Delete(list);
    undefined_free(&undefined);
    free(bytes.data);
    return text;
}

/* ---- Compare --------------------------------------------------------------------------------- */

struct comparison {
    struct dt_player *players[2];
    struct rows rows;
    struct dt_bytes *copies; /* of the first player, one per row of rows.outputs */
    cJSON *results;
    bool differ;
};

static bool read_row(struct dt_player *player, const struct row *row, struct dt_bytes *bytes)
{
    return player->session.runtime->read(player->session.handle, row->resource, row->mip, bytes);
}

static bool keep_copies(void *user, uint32_t pass)
{
    struct comparison *comparison = user;
    const struct row_list *outputs = &comparison->rows.outputs;
    for (uint32_t i = outputs->first[pass]; i < outputs->first[pass + 1]; i++)
        if (!read_row(comparison->players[0], &outputs->list[i], &comparison->copies[i]))
            return false;
    return true;
}

static bool compare_row(struct comparison *comparison, uint32_t index)
{
    struct dt_player *player = comparison->players[1];
    const struct row *row = &comparison->rows.outputs.list[index];
    const struct dt_resource *resource = &player->pipeline.info->resources[row->resource];
    const char *const labels[2] = {comparison->players[0]->side.label, player->side.label};
    struct difference found;
    struct dt_bytes copies[2] = {comparison->copies[index], {0}};
    if (!read_row(player, row, &copies[1]))
        return false;
    bool good = difference_measure(&found, resource, player->session.frame - 1, copies);
    cJSON *result = cJSON_CreateObject();
    row_json(result, player->pipeline.info, row, true);
    if (good)
        difference_json(result, &found, resource, labels);
    good = (good && cJSON_AddItemToArray(comparison->results, result)) ||
           player_fail(player, "out of memory");
    comparison->differ |= good && difference_verdict(&found) >= VERDICT_NOT_FINITE;
    free(copies[0].data);
    free(copies[1].data);
    comparison->copies[index].data = NULL;
    return good;
}

static bool compare_pass(void *user, uint32_t pass)
{
    struct comparison *comparison = user;
    const uint32_t *first = comparison->rows.outputs.first;
    for (uint32_t i = first[pass]; i < first[pass + 1]; i++)
        if (!compare_row(comparison, i))
            return false;
    return true;
}

static bool can_compare(struct dt_player *a, const struct dt_player *b)
{
    if (a == b)
        return player_fail(a, "compare: a player with itself; open another one");
    if (plan_hash(a->pipeline.plan) != plan_hash(b->pipeline.plan))
        return player_fail(
            a, "compare: the players have different pipelines or values of parameters that "
               "are not live");
    if (memcmp(a->setup.size, b->setup.size, sizeof a->setup.size) != 0)
        return player_fail(a, "compare: the players have frames of different sizes");
    if (a->session.frame != b->session.frame)
        return player_fail(a, "compare: the players have rendered different numbers of frames");
    return true;
}

static char *compare_frames(struct comparison *comparison)
{
    struct dt_player **players = comparison->players;
    const struct dt_observer keep = {.after_pass = keep_copies, .user = comparison},
                             compare = {.after_pass = compare_pass, .user = comparison};
    cJSON *root = cJSON_CreateObject();
    comparison->copies = calloc(comparison->rows.outputs.count + 1, sizeof *comparison->copies);
    comparison->results = cJSON_AddArrayToObject(root, "results");
    bool good =
        (comparison->copies && comparison->results) || player_fail(players[0], "out of memory");
    good = good && render(players[0], &keep) && render(players[1], &compare);
    cJSON_AddBoolToObject(root, "agree", !comparison->differ);
    char *text = good ? cJSON_PrintUnformatted(root) : NULL;
    if (good && !text)
        player_fail(players[0], "out of memory");
    for (uint32_t i = 0; comparison->copies && i < comparison->rows.outputs.count; i++)
        free(comparison->copies[i].data);
    free(comparison->copies);
    cJSON_Delete(root);
    return text;
}

char *dt_play_compare(struct dt_player *a, struct dt_player *b)
{
    struct comparison comparison = {.players = {a, b}};
    char *text = may_call(a, "compare") && may_call(b, "compare") && can_compare(a, b) &&
                         rows_make(&comparison.rows, a->pipeline.info, &a->console.log)
                     ? compare_frames(&comparison)
                     : NULL;
    rows_free(&comparison.rows);
    return text;
}
