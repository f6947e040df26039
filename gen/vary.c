/* Draws random valid variations of a spec, as JSON. A draw has three steps: parameters; formats,
 * samplers, metrics, workgroups and ranges; the order of the passes. Each step uses the model of
 * the steps before. A draw that is invalid or needs too much memory is repeated, and listed with
 * the reason. */
#include "vary_draw.h"

#include <inttypes.h>
#include <string.h>

#include "check/check.h"
#include "plan/plan.h"
#include "read/read.h"
#include "spirv/shader_cache.h"

enum { MOST_ATTEMPTS = 1000 };

struct variation {
    uint32_t frame[2], frame_count;
    uint32_t number; /* of the draw: twins share it */
    bool fast;       /* the spec itself has `exactness: fast` */
    bool twin;       /* listed twice: with `exactness: fast`, then exact */
};

/* The last stage that take_sets() runs. */
enum depth { CHECKED, PLANNED, COMPILED };

static bool take_sets(struct model *model, const struct draws *draws, enum depth depth,
                      struct diag *diag)
{
    const struct vary_request *request = draws->request;
    size_t count = draws->set_count + request->set_count;
    const char **sets = arena_alloc(model->arena, (count + 1) * sizeof *sets);
    struct pass_shaders *shaders[2] = {NULL, NULL};
    if (!sets) {
        diag_error(diag, (struct loc){0}, "out of memory");
        return false;
    }
    if (draws->set_count)
        memcpy(sets, draws->sets, draws->set_count * sizeof *sets);
    if (request->set_count)
        memcpy(sets + draws->set_count, request->sets, request->set_count * sizeof *sets);
    if (!read_spec(model, request->spec, sets, count, diag) ||
        !check_model(model, model->templates_dir, diag) || diag_error_count(diag))
        return false;
    layout_model(model);
    if (depth == CHECKED)
        return true;
    if (!plan_model(model, diag) || diag_error_count(diag))
        return false;
    bool good = depth == PLANNED || shaders_compile(model, shaders, draws->cache, diag);
    shaders_free(model, shaders);
    return good;
}

/* The resources' bytes at the variation's frame size. */
static uint64_t total_bytes(const struct pipeline *pipeline, const uint32_t frame[2])
{
    uint64_t sum = 0;
    for (uint32_t i = 0; i < pipeline->resource_count; i++)
        sum += resource_bytes(&pipeline->resources[i], frame[0], frame[1]);
    return sum;
}

/* ---- One variation --------------------------------------------------------------------------- */

/* A draw, and the model with its overrides so far. */
struct attempt {
    struct draws *draws;
    struct variation *variation;
    struct model model;
    struct diag *diag; /* of this model */
};

static void attempt_forget(struct attempt *attempt)
{
    diag_free(attempt->diag); /* it points into the model */
    arena_free(attempt->model.arena);
}

static bool again(struct attempt *attempt, enum depth depth)
{
    const struct vary_request *request = attempt->draws->request;
    attempt_forget(attempt);
    attempt->diag = diag_create();
    attempt->model =
        (struct model){.arena = arena_create(), .templates_dir = request->templates_dir};
    if (attempt->diag && attempt->model.arena)
        return take_sets(&attempt->model, attempt->draws, depth, attempt->diag);
    attempt->draws->out_of_memory = true;
    return false;
}

static bool fits_memory(struct attempt *attempt)
{
    const struct vary_request *request = attempt->draws->request;
    const struct variation *variation = attempt->variation;
    uint64_t bytes = total_bytes(&attempt->model.pipeline, variation->frame);
    if (bytes <= request->bytes)
        return true;
    diag_error(attempt->diag, (struct loc){0},
               "its resources take %" PRIu64 " MiB at a frame of %ux%u; at most %" PRIu64,
               bytes >> 20, variation->frame[0], variation->frame[1], request->bytes >> 20);
    return false;
}

/* False: invalid; attempt->diag has the reason. */
static bool draw_variation(struct attempt *attempt)
{
    struct draws *draws = attempt->draws;
    struct variation *variation = attempt->variation;
    const struct pipeline *pipeline = &attempt->model.pipeline;
    if (!again(attempt, CHECKED))
        return false;
    draw_params(draws, pipeline);
    variation->fast = pipeline->exactness == EXACTNESS_FAST;
    variation->twin = draw_fast(draws) && !variation->fast;
    if (!again(attempt, CHECKED))
        return false;
    draw_frame(draws, pipeline, variation->frame);
    variation->frame_count = draw_frame_count(draws, pipeline);
    if (!fits_memory(attempt))
        return false;
    draw_details(draws, pipeline);
    if (!again(attempt, PLANNED) || !fits_memory(attempt))
        return false;
    draw_order(draws, &attempt->model);
    return again(attempt, COMPILED);
}

/* ---- JSON ------------------------------------------------------------------------------------ */

static void add_list(struct text *out, const char *const *words, size_t count)
{
    text_add(out, "[");
    for (size_t i = 0; i < count; i++) {
        text_add(out, i ? ", " : "");
        text_add_json(out, words[i]);
    }
    text_add(out, "]");
}

static void add_variation(struct text *out, const struct draws *draws,
                          const struct variation *variation, bool fast)
{
    text_add(out,
             "%s\n    {\"draw\": %u, \"width\": %u, \"height\": %u, \"frames\": %u, \"exact\": %s, "
             "\"sets\": ",
             out->length ? "," : "", variation->number, variation->frame[0], variation->frame[1],
             variation->frame_count, fast ? "false" : "true");
    add_list(out, draws->sets, draws->set_count);
    text_add(out, "}");
}

static void add_refusal(struct text *out, const struct draws *draws,
                        const struct variation *variation, const struct diag *diag)
{
    struct loc loc;
    const char *reason = diag_first_error(diag, &loc);
    text_add(out, "%s\n    {\"draw\": %u, \"reason\": ", out->length ? "," : "", variation->number);
    text_add_json(out, reason ? reason : "");
    text_add(out, ", \"sets\": ");
    add_list(out, draws->sets, draws->set_count);
    text_add(out, "}");
}

/* ---- All ------------------------------------------------------------------------------------- */

struct listing {
    struct text variations, refusals;
};

/* Draws until the variation is valid. */
static bool find_valid(struct draws *draws, struct variation *variation, struct listing *listing,
                       struct diag *diag)
{
    for (uint32_t attempt = 0; attempt < MOST_ATTEMPTS; attempt++) {
        struct attempt state = {.draws = draws, .variation = variation};
        draws_start(draws, variation->number, attempt);
        bool good = draw_variation(&state);
        if (!good && !draws->out_of_memory)
            add_refusal(&listing->refusals, draws, variation, state.diag);
        attempt_forget(&state);
        if (good || draws->out_of_memory)
            return good;
    }
    diag_error(
        diag, (struct loc){0},
        "no valid variation was found in %d draws; fix some values with --set, or allow more "
        "--memory",
        MOST_ATTEMPTS);
    return false;
}

/* Lists a fast variation before its exact twin. */
static void list(struct draws *draws, const struct variation *variation, struct listing *listing)
{
    struct draws fast = *draws;
    const char **sets = arena_alloc(draws->arena, (draws->set_count + 1) * sizeof *sets);
    if (variation->twin && sets) {
        sets[0] = "exactness=fast";
        if (draws->set_count)
            memcpy(sets + 1, draws->sets, draws->set_count * sizeof *sets);
        fast.sets = sets;
        fast.set_count++;
        add_variation(&listing->variations, &fast, variation, true);
    }
    draws->out_of_memory |= !sets;
    add_variation(&listing->variations, draws, variation, variation->fast);
}

static void print(const struct model *model, const struct listing *listing, struct text *out)
{
    text_add(out, "{\n  \"inputs\": ");
    add_list(out, model->inputs, model->input_count);
    text_add(out, ",\n  \"variations\": [");
    text_add(out, "%s", listing->variations.data ? listing->variations.data : "");
    text_add(out, "\n  ],\n  \"redrawn\": [");
    text_add(out, "%s", listing->refusals.data ? listing->refusals.data : "");
    text_add(out, "\n  ]\n}\n");
}

bool vary(const struct vary_request *request, struct text *out, struct diag *diag)
{
    struct draws draws = {.request = request,
                          .cache = shader_cache_open(request->cache, diag),
                          .arena = arena_create()};
    struct model model = {.arena = request->arena, .templates_dir = request->templates_dir};
    struct listing listing = {{0}, {0}};
    struct variation variation = {.number = 0};
    bool good = draws.arena && take_sets(&model, &draws, COMPILED, diag);
    for (uint32_t listed = 0; good && listed < request->count; variation.number++) {
        good = find_valid(&draws, &variation, &listing, diag);
        variation.twin = variation.twin && listed + 1 < request->count;
        if (good)
            list(&draws, &variation, &listing);
        listed += variation.twin ? 2 : 1;
    }
    if (good)
        print(&model, &listing, out);
    bool failed = !draws.arena || draws.out_of_memory || out->failed || listing.variations.failed ||
                  listing.refusals.failed;
    if (failed)
        diag_error(diag, (struct loc){0}, "out of memory");
    text_free(&listing.variations);
    text_free(&listing.refusals);
    arena_free(draws.arena);
    shader_cache_close(draws.cache);
    return good && !failed;
}
