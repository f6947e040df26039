/* barrier_audit SPEC [--set NAME=VALUE]... [--live NAME=VALUE]... [--size WxH] [--bits]
 * [--verbose]: checks that every barrier of a generated Vulkan pipeline is needed, and that they
 * are enough. Renders frames of the pipeline with validation on, each barrier left out in turn.
 * Reads every frame's commands (tape.c) with a model of the specification's synchronization
 * (hazard.c). Judges a barrier over all frames, the defaults and one per --live, since a pass may
 * need it only when the pass runs, or only when it is skipped. Prints a line per barrier on request
 * and the counts. Exit status 0: no hazard and no redundant barrier, 1: else, 2: could not run. Run
 * by barrier_test.sh. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/console/console.h"
#include "app/result/live.h"
#include "app/console/options.h"
#include "app/spec/pipeline.h"
#include "drop.h"
#include "hazard.h"
#include "runtime_vk/internal.h"
#include "tape.h"

enum { MAX_LIVES = 8, MAX_TAPES = 2 * (MAX_LIVES + 1) };

/* Why the layers may be silent about a hazard; bits. */
enum silence {
    UNEXPLAINED = 1,
    STORES = 2,      /* layers ignore a store after a store, also of a shader that reads, too */
    ATTACHMENTS = 4, /* layers do not follow the attachments of a dynamic rendering */
    ALIASES = 8,     /* layers do not know that an image shares its memory */
    LAYOUTS = 16,    /* layers allow a change of layout after another one */
    INDICES = 32,    /* newer layers do not know which indices an indirect draw reads */
    FRAMES = 64      /* layers do not compare two submissions */
};

struct verdict {
    bool core, sync;  /* messages of the validation layers */
    uint32_t hazards; /* by the model, over all tapes */
    unsigned silences;
    char example[256]; /* the first hazard */
};

struct counts {
    uint32_t all, core, sync, model, nobody;
    uint32_t stores, attachments, aliases, layouts, indices,
        frames; /* reasons, for barriers that only the model misses */
};

struct audit {
    struct console console;
    struct setup setup;
    const char *lives[MAX_LIVES];
    uint32_t live_count;
    bool verbose, messages;
    struct pipeline pipeline;
    struct dt_vk_runtime *rt;
    PFN_vkCmdBeginDebugUtilsLabelEXT begin_label;
    uint32_t core, sync; /* messages since the last reset */
    char last[512];      /* message that is not a validation message */
    /* With all barriers: two frames with the defaults, then two with each --live. */
    struct tape tapes[MAX_TAPES];
    uint32_t tape_count;
    struct counts dropped, weakened;
    enum drop change; /* of the next frames */
    uint32_t number;  /* of the barrier; 0: none */
    uint32_t bits, idle_bits;
    uint32_t failures;
};

static struct audit audit; /* the label hook of Vulkan takes no user */

/* ---- Messages -------------------------------------------------------------------------------- */

static void on_message(void *user, enum dt_level level, const char *message)
{
    (void)user;
    if (level != DT_ERROR)
        return;
    if (strstr(message, "SYNC-HAZARD") || strstr(message, " hazard detected")) /* newer layers */
        audit.sync++;
    else
        audit.core++;
    snprintf(audit.last, sizeof audit.last, "%s", message);
    if (audit.messages)
        printf("%s\n", message);
}

/* Prints errors of loading the pipeline. */
static void on_console(void *user, enum dt_level level, const char *message)
{
    (void)user;
    if (level == DT_ERROR)
        fprintf(stderr, "%s\n", message);
}

static void fail(const char *format, ...) __attribute__((format(printf, 1, 2)));
static void fail(const char *format, ...)
{
    va_list arguments;

    audit.failures++;
    printf("not fine: ");
    va_start(arguments, format);
    vprintf(format, arguments);
    va_end(arguments);
    printf("\n");
}

static void VKAPI_PTR on_label(VkCommandBuffer commands, const VkDebugUtilsLabelEXT *label)
{
    tape_pass(label->pLabelName);
    audit.begin_label(commands, label);
}

/* ---- Frames ---------------------------------------------------------------------------------- */

/* One triangle in front of an orthographic camera; the picture does not matter here. */
static bool set_scene(void)
{
    static const struct dt_vertex vertices[3] = {
        {.position = {-1, -1, 0}, .normal = {0, 0, 1}},
        {.position = {1, -1, 0}, .normal = {0, 0, 1}},
        {.position = {0, 1, 0}, .normal = {0, 0, 1}},
    };
    static const uint32_t indices[3] = {0, 1, 2};
    static const struct dt_material material = {.albedo = {0.5f, 0.5f, 0.5f}, .texture = -1};
    static const uint8_t texel[4] = {255, 255, 255, 255};
    const struct dt_scene scene = {
        .vertices = vertices,
        .vertex_count = 3,
        .indices = indices,
        .index_count = 3,
        .materials = &material,
        .material_count = 1,
        .texels = texel,
        .texture_width = 1,
        .texture_height = 1,
        .texture_layers = 1,
        .texture_mips = 1,
    };

    return runtime_vk.set_scene(audit.rt, &scene);
}

static void set_identity(float matrix[4][4])
{
    for (int i = 0; i < 4; i++)
        matrix[i][i] = 1;
}

static void name_resources(void)
{
    static const char *const builtin[] = {
        "frame", "live", "scene_vertices", "scene_indices", "scene_materials", "scene_objects"};
    const struct dt_pipeline *info = audit.pipeline.info;

    for (uint32_t i = 0; i < info->resource_count; i++) {
        const struct vk_resource *resource = dt_resource(&audit.rt->core, i);

        tape_name(info->resources[i].kind == DT_BUFFER ? (uint64_t)resource->buffer.handle
                                                       : (uint64_t)resource->image.handle,
                  info->resources[i].name);
    }
    for (uint32_t i = 0; i < DT_ARRAY_COUNT(builtin); i++)
        tape_name((uint64_t)audit.rt->builtin.buffers[i].handle, builtin[i]);
    tape_name((uint64_t)audit.rt->builtin.textures.handle, "scene_textures");
}

static struct tape copy_tape(const struct tape *tape)
{
    struct tape copy = *tape;

    copy.resources = malloc(tape->resource_count * sizeof *copy.resources + 1);
    copy.entries = malloc(tape->entry_count * sizeof *copy.entries + 1);
    if (!copy.resources || !copy.entries)
        abort();
    memcpy(copy.resources, tape->resources, tape->resource_count * sizeof *copy.resources);
    memcpy(copy.entries, tape->entries, tape->entry_count * sizeof *copy.entries);
    return copy;
}

static void free_tape(struct tape *tape)
{
    free(tape->resources);
    free(tape->entries);
}

/* The same frame twice without a wait between, like a host's frames in flight. */
static struct tape twice(const struct tape *tape)
{
    struct tape both = *tape;
    const uint32_t count = tape->entry_count;
    uint32_t last = 0;

    both.resources = malloc(tape->resource_count * sizeof *both.resources + 1);
    both.entries = malloc(2 * count * sizeof *both.entries + 1);
    if (!both.resources || !both.entries)
        abort();
    memcpy(both.resources, tape->resources, tape->resource_count * sizeof *both.resources);
    memcpy(both.entries, tape->entries, count * sizeof *both.entries);
    memcpy(both.entries + count, tape->entries, count * sizeof *both.entries);
    both.entry_count = 2 * count;
    for (uint32_t i = 0; i < count; i++) {
        const struct tape_entry *entry = &tape->entries[i];
        uint32_t number = entry->is_barrier ? entry->barrier.call : entry->access.command;

        last = number > last ? number : last;
    }
    for (uint32_t i = count; i < 2 * count; i++) {
        struct tape_entry *entry = &both.entries[i];

        entry->barrier.call += entry->is_barrier ? last + 1 : 0;
        entry->access.command += entry->is_barrier ? 0 : last + 1;
    }
    return both;
}

/* Renders a frame with fresh resources and the next frame, and counts their messages. Copies their
 * commands to tapes[0] and tapes[1], unless `tapes` is NULL. */
static bool render(struct tape *tapes)
{
    struct dt_frame frame = {.scene_radius = 1, .triangle_count = 1};
    const uint32_t *size = audit.setup.size;

    set_identity(frame.camera.view_projection);
    set_identity(frame.camera.inverse_view_projection);
    set_identity(frame.light_view.view_projection);
    set_identity(frame.light_view.inverse_view_projection);
    if (!runtime_vk.resize(audit.rt, size[0], size[1])) {
        printf("resize: %s\n", audit.last);
        return false;
    }
    name_resources();
    audit.core = audit.sync = 0;
    for (frame.index = 0; frame.index < 2; frame.index++) {
        drop_next(audit.rt, audit.change, audit.number);
        if (!runtime_vk.render(audit.rt, &frame, audit.pipeline.live, NULL)) {
            printf("a frame could not be rendered: %s\n", audit.last);
            return false;
        }
        if (tape_problem()) {
            printf("the recorder does not follow: %s\n", tape_problem());
            return false;
        }
        if (tapes)
            tapes[frame.index] = copy_tape(tape_last());
    }
    return true;
}

/* Barriers for a resource come from the generated code, those for all memory from the runtime. */
static bool is_planned(const struct tape_entry *entry)
{
    return entry->is_barrier && entry->barrier.resource != TAPE_ALL_MEMORY;
}

static uint32_t planned_count(const struct tape *tape)
{
    uint32_t count = 0;

    for (uint32_t i = 0; i < tape->entry_count; i++)
        count += is_planned(&tape->entries[i]);
    return count;
}

/* The entry of the index-th planned barrier. */
static uint32_t planned_entry(const struct tape *tape, uint32_t index)
{
    for (uint32_t i = 0; i < tape->entry_count; i++)
        if (is_planned(&tape->entries[i]) && index-- == 0)
            return i;
    abort();
}

static const char *entry_text(const struct tape *tape, uint32_t entry, char *text, size_t size)
{
    const struct tape_entry *what = entry == UINT32_MAX ? NULL : &tape->entries[entry];

    if (!what)
        snprintf(text, size, "(earlier work)");
    else
        snprintf(text, size, "%s.%s", what->pass,
                 tape->resources[what->is_barrier ? what->barrier.resource : what->access.resource]
                     .name);
    return text;
}

static void hazard_text(const struct tape *tape, const struct hazard *hazard, char *text,
                        size_t size)
{
    char earlier[160], later[160];

    snprintf(text, size, "%s: %s, then %s", hazard->kind,
             entry_text(tape, hazard->earlier, earlier, sizeof earlier),
             entry_text(tape, hazard->later, later, sizeof later));
}

/* ---- All barriers in place ------------------------------------------------------------------- */

static void on_real_hazard(void *user, const struct hazard *hazard)
{
    char text[256];

    hazard_text(user, hazard, text, sizeof text);
    fail("a hazard with all barriers in place: %s", text);
}

static bool set_live(const char *live)
{
    const struct dt_param *param;
    char name[64];

    memcpy(audit.pipeline.live, audit.pipeline.info->live_defaults, audit.pipeline.info->live_size);
    if (!live)
        return true;
    snprintf(name, sizeof name, "%.*s", (int)strcspn(live, "="), live);
    param = live_param(audit.pipeline.info, name);
    if (param && param->live && strchr(live, '='))
        return live_set(audit.pipeline.info, audit.pipeline.live, param, strchr(live, '=') + 1,
                        &audit.console.log);
    printf("--live %s: no live parameter of that name\n", live);
    return false;
}

/* Records the tapes with all barriers in place. Each message and each hazard is a failure. */
static bool record_tapes(void)
{
    for (uint32_t i = 0; i <= audit.live_count; i++) {
        const char *live = i ? audit.lives[i - 1] : NULL;
        struct tape *tapes = &audit.tapes[audit.tape_count];

        if (!set_live(live) || !render(tapes))
            return false;
        audit.tape_count += 2;
        if (audit.core || audit.sync)
            fail("validation speaks with all barriers in place, %s: %s", live ? live : "defaults",
                 audit.last);
        for (int frame = 0; frame < 2; frame++) {
            struct tape both = twice(&tapes[frame]);

            hazard_find(&both, on_real_hazard, &both);
            free_tape(&both);
            if (planned_count(&tapes[frame]) != planned_count(&audit.tapes[0]))
                fail("the number of barriers depends on %s", live ? live : "the frame");
        }
    }
    return set_live(NULL);
}

/* ---- One barrier changed --------------------------------------------------------------------- */

static void apply(enum drop change, struct tape *tape, uint32_t entry)
{
    if (change == DROP_DEPENDENCY) {
        tape->entries[entry].barrier.src_stage = VK_PIPELINE_STAGE_2_NONE;
        tape->entries[entry].barrier.src_access = VK_ACCESS_2_NONE;
        return;
    }
    memmove(&tape->entries[entry], &tape->entries[entry + 1],
            (tape->entry_count - entry - 1) * sizeof *tape->entries);
    tape->entry_count--;
}

static const char *resource_name(const struct tape *tape, const struct tape_entry *entry)
{
    uint32_t resource = entry->is_barrier ? entry->barrier.resource : entry->access.resource;

    return resource == TAPE_ALL_MEMORY ? "" : tape->resources[resource].name;
}

static bool same_barrier(const struct tape_barrier *a, const struct tape_barrier *b)
{
    return a->mips == b->mips && a->src_stage == b->src_stage && a->src_access == b->src_access &&
           a->dst_stage == b->dst_stage && a->dst_access == b->dst_access &&
           a->old_layout == b->old_layout && a->new_layout == b->new_layout;
}

static bool same_tape(const struct tape *a, const struct tape *b)
{
    bool same = a->entry_count == b->entry_count;

    for (uint32_t i = 0; i < a->entry_count && same; i++) {
        const struct tape_entry *x = &a->entries[i], *y = &b->entries[i];

        same = x->is_barrier == y->is_barrier &&
               strcmp(resource_name(a, x), resource_name(b, y)) == 0 &&
               (x->is_barrier
                    ? same_barrier(&x->barrier, &y->barrier)
                    : x->access.stage == y->access.stage && x->access.access == y->access.access);
    }
    return same;
}

/* Index of the planned barrier that the runtime changed; UINT32_MAX: the frame differs in anything
 * else. The runtime numbers barriers in the order of the generated tables; a tape lists buffers
 * before images. */
static uint32_t find_changed(const struct tape *changed, const struct tape *all, enum drop change)
{
    for (uint32_t index = 0; index < planned_count(all); index++) {
        struct tape tape = copy_tape(all);
        bool same;

        apply(change, &tape, planned_entry(&tape, index));
        same = same_tape(&tape, changed);
        free_tape(&tape);
        if (same)
            return index;
    }
    return UINT32_MAX;
}

/* ---- Verdicts -------------------------------------------------------------------------------- */

static bool is_attachment(const struct tape_entry *entry)
{
    return !entry->is_barrier &&
           entry->access.access &
               (VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT |
                VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT |
                VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT);
}

static bool is_store(const struct tape_entry *entry)
{
    return !entry->is_barrier && entry->access.access == VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
}

/* Whether the shader that reads here also stores to the same image. The layers see only the
 * store. */
static bool is_update(const struct tape *tape, const struct tape_entry *entry)
{
    bool update = false;

    if (entry->is_barrier || !tape->resources[entry->access.resource].image)
        return false;
    for (uint32_t i = 0; i < tape->entry_count; i++)
        update |= is_store(&tape->entries[i]) &&
                  tape->entries[i].access.command == entry->access.command &&
                  tape->entries[i].access.resource == entry->access.resource;
    return update;
}

static uint32_t entry_resource(const struct tape_entry *entry)
{
    return entry->is_barrier ? entry->barrier.resource : entry->access.resource;
}

static enum silence silence_about(const struct tape *tape, const struct hazard *hazard)
{
    const struct tape_entry *later = &tape->entries[hazard->later], *earlier;

    if (hazard->earlier == UINT32_MAX)
        return is_attachment(later) ? ATTACHMENTS : UNEXPLAINED;
    earlier = &tape->entries[hazard->earlier];
    if (is_attachment(earlier) || is_attachment(later))
        return ATTACHMENTS;
    if ((is_store(earlier) && is_store(later)) ||
        ((is_store(earlier) || earlier->is_barrier) && is_update(tape, later)))
        return STORES;
    if (entry_resource(earlier) != entry_resource(later) &&
        (tape->resources[entry_resource(earlier)].image ||
         tape->resources[entry_resource(later)].image))
        return ALIASES;
    if (!later->is_barrier && later->access.access == VK_ACCESS_2_INDEX_READ_BIT)
        return INDICES;
    return earlier->is_barrier && later->is_barrier ? LAYOUTS : UNEXPLAINED;
}

struct judgement {
    const struct tape *tape;
    struct verdict *verdict;
};

static void on_hazard(void *user, const struct hazard *hazard)
{
    const struct judgement *judgement = user;
    struct verdict *verdict = judgement->verdict;

    if (!verdict->hazards++)
        hazard_text(judgement->tape, hazard, verdict->example, sizeof verdict->example);
    verdict->silences |= silence_about(judgement->tape, hazard);
}

static void judge(enum drop change, uint32_t index, struct verdict *verdict)
{
    for (uint32_t i = 0; i < audit.tape_count; i++) {
        struct tape tape = copy_tape(&audit.tapes[i]);

        apply(change, &tape, planned_entry(&tape, index));
        hazard_find(&tape, on_hazard, &(struct judgement){&tape, verdict});
        if (!verdict->hazards) { /* the barrier may order one frame after another */
            struct tape both = twice(&tape);

            hazard_find(&both, on_hazard, &(struct judgement){&both, verdict});
            verdict->silences = verdict->hazards ? FRAMES : verdict->silences;
            free_tape(&both);
        }
        free_tape(&tape);
    }
}

static void count_verdict(struct counts *counts, const struct verdict *verdict)
{
    counts->all++;
    if (verdict->core) {
        counts->core++;
    } else if (verdict->sync) {
        counts->sync++;
    } else if (verdict->hazards) {
        counts->model++;
        counts->stores += (verdict->silences & STORES) != 0;
        counts->attachments += (verdict->silences & ATTACHMENTS) != 0;
        counts->aliases += (verdict->silences & ALIASES) != 0;
        counts->layouts += (verdict->silences & LAYOUTS) != 0;
        counts->indices += (verdict->silences & INDICES) != 0;
        counts->frames += (verdict->silences & FRAMES) != 0;
    } else {
        counts->nobody++;
    }
}

static void print_verdict(enum drop change, uint32_t number, uint32_t index,
                          const struct verdict *verdict)
{
    const struct tape *tape = &audit.tapes[0];
    char what[160];

    printf("%3u %-36s %-8s  %-4s %-4s %-5s  %s\n", number,
           entry_text(tape, planned_entry(tape, index), what, sizeof what),
           change == DROP_BARRIER ? "dropped" : "weakened", verdict->core ? "core" : "-",
           verdict->sync ? "sync" : "-", verdict->hazards ? "model" : "-", verdict->example);
}

/* Renders with barrier `number` changed, with the defaults and with every --live. *index: index of
 * this barrier among the planned ones of a tape. */
static bool render_change(enum drop change, uint32_t number, uint32_t *index,
                          struct verdict *verdict)
{
    audit.change = change;
    audit.number = number;
    for (uint32_t i = 0; i <= audit.live_count; i++) {
        struct tape changed[2];

        if (!set_live(i ? audit.lives[i - 1] : NULL) || !render(changed))
            return false;
        verdict->core |= audit.core > 0;
        verdict->sync |= audit.sync > 0;
        for (int frame = 0; frame < 2; frame++) {
            uint32_t found = find_changed(&changed[frame], &audit.tapes[2 * i + frame], change);

            if (found == UINT32_MAX || (*index != UINT32_MAX && found != *index))
                fail("barrier %u: the frames do not differ by exactly that barrier", number);
            *index = found == UINT32_MAX ? 0 : found;
            free_tape(&changed[frame]);
        }
    }
    return true;
}

static bool try_change(enum drop change, uint32_t number, uint32_t *index)
{
    struct verdict verdict = {0};

    if (!render_change(change, number, index, &verdict))
        return false;
    judge(change, *index, &verdict);
    count_verdict(change == DROP_BARRIER ? &audit.dropped : &audit.weakened, &verdict);
    if (audit.verbose)
        print_verdict(change, number, *index, &verdict);
    if (!verdict.core && !verdict.sync && !verdict.hazards)
        fail("barrier %u, %s: nobody misses it", number,
             change == DROP_BARRIER ? "dropped" : "weakened");
    if (!verdict.core && !verdict.sync && verdict.silences & UNEXPLAINED)
        fail("barrier %u: the layers should have spoken of: %s", number, verdict.example);
    return true;
}

static bool waits_and_changes_layout(const struct tape *tape, uint32_t index)
{
    const struct tape_barrier *barrier = &tape->entries[planned_entry(tape, index)].barrier;

    return barrier->old_layout != barrier->new_layout &&
           barrier->src_stage != VK_PIPELINE_STAGE_2_NONE;
}

static bool try_barriers(void)
{
    uint32_t count = planned_count(&audit.tapes[0]);

    for (uint32_t number = 1; number <= count; number++) {
        uint32_t index = UINT32_MAX;

        if (!try_change(DROP_BARRIER, number, &index))
            return false;
        if (waits_and_changes_layout(&audit.tapes[1], index) &&
            !try_change(DROP_DEPENDENCY, number, &index))
            return false;
    }
    return true;
}

/* ---- Bits of the masks ----------------------------------------------------------------------- */

static uint64_t *mask_of(struct tape_barrier *barrier, int mask)
{
    uint64_t *const masks[] = {&barrier->src_stage, &barrier->src_access, &barrier->dst_stage,
                               &barrier->dst_access};

    return masks[mask];
}

static bool bit_is_needed(uint32_t index, int mask, uint64_t bit)
{
    uint32_t hazards = 0;

    for (uint32_t i = 0; i < audit.tape_count && !hazards; i++) {
        struct tape tape = copy_tape(&audit.tapes[i]);

        *mask_of(&tape.entries[planned_entry(&tape, index)].barrier, mask) &= ~bit;
        hazards = hazard_find(&tape, NULL, NULL);
        free_tape(&tape);
    }
    return hazards;
}

static void try_bits(void)
{
    static const char *const names[] = {"source stage", "source access", "destination stage",
                                        "destination access"};
    const struct tape *tape = &audit.tapes[0];

    for (uint32_t index = 0; index < planned_count(tape); index++) {
        uint32_t entry = planned_entry(tape, index);

        for (int mask = 0; mask < 4; mask++) {
            uint64_t bits = *mask_of(&tape->entries[entry].barrier, mask);
            char what[160];

            for (uint64_t bit = 1; bit; bit <<= 1) {
                if (!(bits & bit))
                    continue;
                audit.bits++;
                if (bit_is_needed(index, mask, bit))
                    continue;
                audit.idle_bits++;
                if (audit.verbose)
                    printf("    %-36s %s 0x%llx is idle\n",
                           entry_text(tape, entry, what, sizeof what), names[mask],
                           (unsigned long long)bit);
            }
        }
    }
}

/* ---- Main ------------------------------------------------------------------------------------ */

static bool read_arguments(int argc, char **argv)
{
    static const char *sets[64];

    audit.setup = (struct setup){.sets = sets, .size = {24, 16}, .frames = 1};
    for (int i = 1; i < argc && argv[i]; i++) {
        const char *value = i + 1 < argc ? argv[i + 1] : NULL;

        if (strcmp(argv[i], "--verbose") == 0)
            audit.verbose = true;
        else if (strcmp(argv[i], "--messages") == 0)
            audit.messages = true;
        else if (strcmp(argv[i], "--set") == 0 && value && audit.setup.set_count < 64)
            sets[audit.setup.set_count++] = argv[++i];
        else if (strcmp(argv[i], "--live") == 0 && value && audit.live_count < MAX_LIVES)
            audit.lives[audit.live_count++] = argv[++i];
        else if (strcmp(argv[i], "--size") == 0 && value &&
                 sscanf(value, "%ux%u", &audit.setup.size[0], &audit.setup.size[1]) == 2)
            i++;
        else if (argv[i][0] != '-' && !audit.setup.spec)
            audit.setup.spec = argv[i];
        else
            return false;
    }
    return audit.setup.spec;
}

static bool prepare(void)
{
    const struct dt_runtime_options options = {.log = {.message = on_message}, .debug = true};

    if (!pipeline_load(&audit.pipeline, &audit.console, &audit.setup))
        return false;
    audit.rt = runtime_vk.open(&options);
    if (!audit.rt || !set_scene() || !runtime_vk.create(audit.rt, audit.pipeline.vk)) {
        printf("%s\n", audit.last);
        return false;
    }
    audit.begin_label = audit.rt->begin_label;
    audit.rt->begin_label = on_label;
    return true;
}

static void print_counts(const char *what, const struct counts *counts)
{
    printf(
        "%s: %u; found by core validation %u, synchronization validation %u, the model alone %u, "
        "nobody %u; layers silent about attachments %u, stores after stores %u, aliases %u, "
        "layouts "
        "after layouts %u, indices of indirect draws %u, from frame to frame %u\n",
        what, counts->all, counts->core, counts->sync, counts->model, counts->nobody,
        counts->attachments, counts->stores, counts->aliases, counts->layouts, counts->indices,
        counts->frames);
}

int main(int argc, char **argv)
{
    bool good;

    if (!read_arguments(argc, argv)) {
        fprintf(stderr, "usage: barrier-audit SPEC [--set NAME=VALUE]... [--live NAME=VALUE]... "
                        "[--size WxH] [--verbose] [--messages]\n");
        return EXIT_USAGE;
    }
    audit.console.log.message = on_console;
    pthread_mutex_init(&audit.console.lock, NULL);
    good = prepare() && record_tapes() && try_barriers();
    if (good) {
        try_bits();
        print_counts("dropped", &audit.dropped);
        print_counts("weakened", &audit.weakened);
        printf("bits: %u, idle %u\n", audit.bits, audit.idle_bits);
    }
    for (uint32_t i = 0; i < audit.tape_count; i++)
        free_tape(&audit.tapes[i]);
    runtime_vk.close(audit.rt);
    pipeline_unload(&audit.pipeline);
    return !good ? EXIT_USAGE : audit.failures ? EXIT_FAILED : EXIT_FINE;
}
