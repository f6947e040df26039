/* Passes that copy, which the spec asks for by keys: `previous` of a read keeps the images of earlier
 * frames, NAME.before_K; `filter_mips` of an image fills its mips. Both are draws, since a draw can
 * write every format. */
#include <string.h>

#include "model/sanitize_kinds.h"
#include "reader.h"

enum { MOST_PREVIOUS = 64, MOST_MIPS = 15 };

/* Gives the pass `from` and `to` of images, by the names that the bodies have for them. */
static void make_copy(struct reader *reader, struct pass *pass, const char *name,
                      const char *shader, struct loc loc, const char *from, const char *to)
{
    *pass = (struct pass){.name = name ? name : "?",
                          .loc = loc,
                          .kind = DT_PASS_DRAW_FULLSCREEN,
                          .view = "camera",
                          .depth_compare = DT_COMPARE_LESS,
                          .depth_write = true,
                          .shader = shader,
                          .shader_loc = loc,
                          .local = {8, 8, 1},
                          .frame_binding = -1,
                          .live_binding = -1,
                          .textures_binding = -1,
                          .materials_binding = -1};
    pass->accesses = reader_alloc(reader, 2 + SANITIZE_ACCESSES, sizeof *pass->accesses);
    if (!pass->accesses)
        return;
    const struct access access = {.loc = loc, .as_loc = loc, .binding = -1, .attachment = -1};
    pass->accesses[0] = pass->accesses[1] = access;
    pass->accesses[0].name = from;
    pass->accesses[0].as = "from";
    pass->accesses[1].name = to;
    pass->accesses[1].as = "to";
    pass->accesses[1].mode = MODE_WRITE;
    pass->access_count = 2;
}

/* Puts a pass into the list; NULL: out of memory. */
static struct pass *insert_pass(struct reader *reader, uint32_t place)
{
    struct pipeline *pipeline = &reader->model->pipeline;
    struct pass *passes = reader_alloc(reader, pipeline->pass_count + 1, sizeof *passes);
    if (!passes)
        return NULL;
    if (place)
        memcpy(passes, pipeline->passes, place * sizeof *passes);
    if (place < pipeline->pass_count)
        memcpy(passes + place + 1, pipeline->passes + place,
               (pipeline->pass_count - place) * sizeof *passes);
    pipeline->passes = passes;
    pipeline->pass_count++;
    return &passes[place];
}

/* ---- Mips ------------------------------------------------------------------------------------ */

static bool writes(const struct pass *pass, const char *image)
{
    EACH(access, pass->accesses, pass->access_count)
        if (access->mode != MODE_READ && !access->mip && !strcmp(access->name, image))
            return true;
    return false;
}

/* Behind the last pass that writes mip 0. */
static void fill_mips(struct reader *reader, const struct resource *image)
{
    struct pipeline *pipeline = &reader->model->pipeline;
    struct arena *arena = reader->model->arena;
    struct loc loc = image->loc;
    const char *name = image->name;
    uint32_t place = pipeline->pass_count;
    int64_t mips = 0;
    if (!image->mips || !expr_resolve(image->mips, pipeline, reader->diag) ||
        expr_eval(image->mips, 1, 1, &mips) != EXPR_OK || mips < 2 || mips > MOST_MIPS) {
        diag_error(reader->diag, loc, "`filter_mips` needs `mips`, 2 to %d", MOST_MIPS);
        return;
    }
    while (place && !writes(&pipeline->passes[place - 1], name))
        place--;
    for (uint32_t mip = 1; place && mip < mips; mip++) {
        struct pass *pass = insert_pass(reader, place++);
        if (!pass)
            return;
        make_copy(reader, pass, arena_printf(arena, "%s.mip_%u", name, mip), "copy/mip.glsl", loc,
                  name, name);
        for (uint32_t i = 0; i < pass->access_count; i++)
            pass->accesses[i].mip = number_expr(reader, mip - 1 + i, loc);
    }
}

/* ---- Previous frames ------------------------------------------------------------------------- */

static const char *before(struct reader *reader, const char *name, uint32_t frames)
{
    return arena_printf(reader->model->arena, "%s.before_%u", name, frames);
}

/* NAME.before_1 to NAME.before_`frames`, and the passes that fill them, the oldest first. */
static void keep_frames(struct reader *reader, const char *name, uint32_t frames)
{
    struct pipeline *pipeline = &reader->model->pipeline;
    const struct resource *found = declared_find(pipeline, DECLARED_IMAGE, name);
    uint32_t count = pipeline->resource_count;
    struct resource *resources =
        reader_alloc(reader, count + frames + SANITIZE_RESOURCES, sizeof *resources);
    if (!resources)
        return;
    memcpy(resources, pipeline->resources, count * sizeof *resources);
    pipeline->resources = resources;
    for (uint32_t i = 0; i < frames; i++) {
        struct resource *image = &resources[count + i];
        *image = *found;
        image->name = before(reader, name, i + 1);
        image->doc = arena_printf(reader->model->arena, "%s, %u frames ago", name, i + 1);
        image->file = image->file_path = NULL;
        image->mips = NULL;
        image->srgb = 0;
        image->input = image->keep = image->encoding_is_given = image->filter_mips = false;
        image->history = true;
        image->index = count + i;
    }
    pipeline->resource_count = count + frames;
    struct loc loc = found->loc;
    for (uint32_t i = frames; i-- > 0;) {
        struct pass *pass = insert_pass(reader, pipeline->pass_count);
        if (pass)
            make_copy(reader, pass, arena_printf(reader->model->arena, "%s.keep_%u", name, i + 1),
                      "copy/previous.glsl", loc, i ? before(reader, name, i) : name,
                      before(reader, name, i + 1));
        struct allow *allow = pass && i ? reader_alloc(reader, 1, sizeof *allow) : NULL;
        if (!allow)
            continue;
        *allow = (struct allow){SANITIZE_CONTENT, loc}; /* zero before the first frame */
        pass->allows = allow;
        pass->allow_count = 1;
    }
}

/* The most frames back that a pass reads the image. */
static uint32_t most_previous(const struct pipeline *pipeline, const char *name)
{
    uint32_t most = 0;
    EACH(pass, pipeline->passes, pipeline->pass_count)
        EACH(access, pass->accesses, pass->access_count)
            if (access->previous > most && !strcmp(access->name, name))
                most = access->previous;
    return most;
}

/* The access to the image that holds an earlier frame. */
static void redirect(struct reader *reader, struct access *access)
{
    const struct resource *image =
        declared_find(&reader->model->pipeline, DECLARED_IMAGE, access->name);
    if (!access->previous)
        return;
    if (access->mode != MODE_READ || !image || image->layers)
        diag_error(reader->diag, access->loc, "`previous` is of reads of plain images");
    else if (access->previous > MOST_PREVIOUS)
        diag_error(reader->diag, access->loc, "`previous` is at most %d", MOST_PREVIOUS);
    else {
        if (!access->as)
            access->as = access->name;
        access->as_loc = access->loc;
        access->name = before(reader, access->name, access->previous);
        return;
    }
    access->previous = 0;
}

void read_copies(struct reader *reader)
{
    struct pipeline *pipeline = &reader->model->pipeline;
    uint32_t count = pipeline->resource_count;
    uint32_t *frames = reader_alloc(reader, count + 1, sizeof *frames);
    for (uint32_t i = 0; frames && i < count; i++) {
        frames[i] = most_previous(pipeline, pipeline->resources[i].name);
        if (pipeline->resources[i].filter_mips)
            fill_mips(reader, &pipeline->resources[i]);
    }
    EACH(pass, pipeline->passes, pipeline->pass_count)
        CHANGE_EACH(access, pass->accesses, pass->access_count)
            redirect(reader, access);
    for (uint32_t i = 0; frames && i < count; i++)
        if (frames[i] && frames[i] <= MOST_PREVIOUS && !pipeline->resources[i].layers &&
            pipeline->resources[i].kind == DT_IMAGE)
            keep_frames(reader, pipeline->resources[i].name, frames[i]);
}
