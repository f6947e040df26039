/* A spec, read, checked and planned in this process, ready to be played: the one file of the app's
 * headers that stands for gen/, whose own names stay behind it. */
#pragma once

#include "console/console.h"
#include "gen/request.h"
#include "verbs.h"

struct plan;

/* Errors of the spec are printed as diptych-gen prints them. NULL: there were some. */
struct plan *plan_load(struct spec_request request, struct console *console);
void plan_free(struct plan *plan); /* takes NULL */
const struct dt_pipeline *plan_pipeline(const struct plan *plan);
const struct dt_shaders *plan_shaders(const struct plan *plan, const char *backend);
bool plan_is_automatic(const struct plan *plan); /* `target: auto` */
/* The same pipeline planned for GPUs: this plan, or made by the first call and part of it. NULL: an error of the
 * spec, printed. */
struct plan *plan_for_gpu(struct plan *plan, struct console *console);
/* The paths of all files that were read. */
const char *const *plan_sources(const struct plan *plan, uint32_t *count);
/* The GLSL of a pass for a backend ("gl", "vk"); stage: 0 compute, 1 vertex, 2 fragment. *glsl is
 * NULL where the pass has none, and belongs to the plan. False when out of memory. */
bool plan_glsl(struct plan *plan, const char *backend, uint32_t pass, int stage, const char **glsl);

/* Operations of all shaders, each call as many as the function has: what a CPU driver compiles. */
uint64_t plan_operations(const struct plan *plan);

/* What a pass does in a frame of this size: the call that draws or dispatches, with its arguments; viewport or scissor. */
struct plan_work {
    const struct dt_verb_info *verb;
    int64_t arguments[4];
    bool runs, has_area;
    struct dt_rect area;
};
struct plan_work plan_work(const struct plan *plan, uint32_t pass, const uint32_t size[2],
                           const void *live);

/* Of a resource with `input` or `file` in the spec. */
struct plan_input {
    const char *file; /* path; NULL: `input` */
    bool srgb;        /* its picture holds sRGB codes, the image linear light */
    bool encoding_is_given;
};
struct plan_input plan_input(const struct plan *plan, uint32_t resource);
/* An error at the `file` of the resource, printed as diptych-gen prints it. */
void plan_blame_file(const struct plan *plan, uint32_t resource, const char *text,
                     struct console *console);

/* Sizes of workgroups, and storage and loops of ranges: other values than those in force. They change times, not results.
 * Calls `take` for each, by pass in order of execution; some may be refused. False: `take` has returned false, or out of
 * memory. */
bool plan_choices(const struct plan *plan,
                  bool (*take)(void *user, uint32_t pass, const char *path, const char *value),
                  void *user);

/* Whether the pass's `exactness` leaves it free, so that it is judged against its exact twin. */
bool plan_is_bounded(const struct plan *plan, uint32_t pass);

/* Invocations of a workgroup of a pass; 1 of a draw. */
uint32_t plan_group(const struct plan *plan, uint32_t pass);

/* The buffer that --sanitize adds; its index is that of no resource without it. */
uint32_t plan_reports(const struct plan *plan);
/* What its content tells; see sanitize_read in gen/plan/sanitize.h. */
struct dt_finding;
void plan_warn_idle(const struct plan *plan, struct console *console); /* sanitize_warn_idle */
bool plan_undefined(const struct plan *plan, const void *bytes, uint64_t size,
                    struct dt_finding **findings, uint32_t *count);

/* Of all that a frame depends on: equal for a spec saved without a change. 0: out of memory. */
uint64_t plan_hash(const struct plan *plan);
