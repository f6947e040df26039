/* The plan's rules: std430 and std140 offsets by the OpenGL specification, the order of passes, bindings, ranges, barriers and
 * lifetimes. A case is a small spec and lines that its plan must hold, as print_plan() writes them. Run by ninja test. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/lib/unit.h"
#include "base/text.h"
#include "check/check.h"
#include "plan/plan.h"
#include "read/read.h"

/* ---- A spec of few words, and its plan as text ----------------------------------------------- */

static char folder[] = "/tmp/plan_XXXXXX";

struct planned {
    struct model model;
    struct diag *diag;
};

static void write_file(const char *name, const char *text)
{
    char path[256];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0 && fclose(file) == 0);
}

/* Reads and checks a spec. `resources`: its document but for the passes; `passes`: one a line, without shader. */
static struct planned *open_spec(const char *resources, const char *passes)
{
    struct planned *planned = calloc(1, sizeof *planned);
    struct text spec = {0};
    char path[256];
    text_add(&spec, "pipeline: test\n%s\npasses:\n", resources);
    for (const char *end, *line = passes; *line; line = *end ? end + 1 : end) {
        end = strchrnul(line, '\n');
        text_add(&spec, "  - {name: %.*s, shader: none.glsl}\n", (int)(end - line), line);
    }
    write_file("plan.yaml", spec.data);
    text_free(&spec);
    snprintf(path, sizeof path, "%s/plan.yaml", folder);
    planned->model = (struct model){.arena = arena_create(), .templates_dir = "templates"};
    planned->diag = diag_create();
    if (!read_spec(&planned->model, path, NULL, 0, planned->diag) ||
        !check_model(&planned->model, "templates", planned->diag) ||
        diag_error_count(planned->diag)) {
        diag_print(planned->diag, "plan_test", stderr);
        fail_msg("%s", passes);
    }
    layout_model(&planned->model);
    return planned;
}

static void close_spec(struct planned *planned)
{
    diag_free(planned->diag);
    arena_free(planned->model.arena);
    free(planned);
}

static void add_words(struct text *text, unsigned mask, const char *const *words)
{
    const char *separator = "";
    for (int i = 0; words[i]; i++)
        if (mask & 1u << i) {
            text_add(text, "%s%s", separator, words[i]);
            separator = "+";
        }
    text_add(text, "%s", *separator ? "" : "nothing");
}

static void add_kinds(struct text *text, unsigned mask)
{
    static const char *const words[] = {"load", "store", "texture",  "uniform", "blend", "color",
                                        "test", "depth", "indirect", "index",   "clear", NULL};
    add_words(text, mask, words);
}

static void add_stages(struct text *text, unsigned mask)
{
    static const char *const words[] = {"compute",  "vertex", "fragment", "color", "depth",
                                        "indirect", "index",  "clear",    NULL};
    add_words(text, mask, words);
}

static void add_barrier(struct text *text, const struct pass *pass, const struct barrier *barrier)
{
    static const char *const layouts[] = {"buffer", "general", "read", "color", "depth"};
    text_add(text, "%s waits for %s: ", pass->name, barrier->resource->name);
    add_kinds(text, barrier->from);
    text_add(text, "%s in ", barrier->from_writes ? " written" : "");
    add_stages(text, barrier->from_stages);
    text_add(text, ", then ");
    add_kinds(text, barrier->to);
    text_add(text, " in ");
    add_stages(text, barrier->to_stages);
    text_add(text, ", %s%s",
             barrier->resource->kind == DT_BUFFER ? "buffer" : layouts[layout_of(barrier->to)],
             barrier->discard ? ", discards" : "");
    if (barrier->alias)
        text_add(text, ", memory of %s", barrier->alias->name);
    text_add(text, "\n");
}

static void add_pass(struct text *text, const struct pass *pass)
{
    static const char *const loops[] = {"auto", "unrolled", "rolled"};
    static const char *const storages[] = {"in place", "shared", "buffer", "uniform"};
    for (uint32_t i = 0; i < pass->access_count; i++) {
        const struct access *access = &pass->accesses[i];
        text_add(text, "%s.%s: ", pass->name, access_word(access));
        add_kinds(text, access->kind);
        text_add(text, ", binding %d, attachment %d\n", access->binding, access->attachment);
    }
    text_add(text, "%s: frame %d, live %d, textures %d, materials %d%s\n", pass->name,
             pass->frame_binding, pass->live_binding, pass->textures_binding,
             pass->materials_binding, pass->uniform_materials ? " uniform" : "");
    text_add(text, "%s: local %u x %u\n", pass->name, pass->local[0], pass->local[1]);
    for (uint32_t i = 0; i < pass->range_count; i++) {
        const struct range *range = &pass->ranges[i];
        text_add(text, "%s.%s: %s, %s, chunk %u, turn %u\n", pass->name, range->name,
                 storages[range->storage], loops[range->loop], range->chunk, range->turn);
    }
    for (uint32_t i = 0; i < pass->barrier_count; i++)
        add_barrier(text, pass, &pass->barriers[i]);
}

/* Plans, and writes what was planned; or the errors. free() */
static char *print_plan(struct planned *planned)
{
    struct pipeline *pipeline = &planned->model.pipeline;
    struct text text = {0};
    if (!plan_model(&planned->model, planned->diag)) {
        text_add(&text, "errors: %u\n", diag_error_count(planned->diag));
        return text.data;
    }
    text_add(&text, "order:");
    for (uint32_t i = 0; i < pipeline->pass_count; i++)
        text_add(&text, " %s", pipeline->order[i]->name);
    text_add(&text, "\nslots: %u\n", pipeline->slot_count);
    text_add(&text, "bytes: %llu, aliased %llu\n", (unsigned long long)pipeline->transient_bytes,
             (unsigned long long)pipeline->aliased_bytes);
    for (uint32_t i = 0; i < pipeline->resource_count; i++) {
        const struct resource *resource = &pipeline->resources[i];
        text_add(&text, "%s: slot %u, shares %s\n", resource->name, resource->slot,
                 resource->share < 0 ? "nothing" : pipeline->resources[resource->share].name);
    }
    for (uint32_t i = 0; i < pipeline->pass_count; i++)
        add_pass(&text, pipeline->order[i]);
    return text.data;
}

/* A line of the plan must begin with each of `lines`; with none that is written behind "no ". */
static void assert_lines(const char *plan, const char *lines)
{
    struct text text = {0}, begin = {0};
    text_add(&text, "\n%s", plan);
    for (const char *end, *line = lines; *line; line = *end ? end + 1 : end) {
        end = strchrnul(line, '\n');
        bool absent = strncmp(line, "no ", 3) == 0;
        line += absent ? 3 : 0;
        text_add(&begin, "\n%.*s", (int)(end - line), line);
        if (!strstr(text.data, begin.data) != absent)
            fail_msg("%s:%s\nthe plan:\n%s", absent ? "must not be there" : "is missing",
                     begin.data, plan);
        text_free(&begin);
    }
    text_free(&text);
}

/* ---- Cases ----------------------------------------------------------------------------------- */

static const struct {
    const char *name, *resources, *passes, *plan;
} cases[] = {
    /* -- order */
    {"a reader runs after its writer",
     "buffers: {b: {of: uint, count: 8}, c: {of: uint, count: 8}}",
     "reader, dispatch: 8, reads: [b], writes: [c]\n"
     "writer, dispatch: 8, writes: [b]",
     "order: writer reader"},
    /* The writer waits until the reader is done; no write has to become available. The first pass reads the last frame's
     * stores without a barrier: the frame opens with a full one. */
    {"history is read before it is written",
     "buffers: {h: {of: uint, count: 8, history: true}, c: {of: uint, count: 8}}",
     "reader, dispatch: 8, reads: [h], writes: [c]\n"
     "writer, dispatch: 8, writes: [h]",
     "order: reader writer\n"
     "no reader waits for h\n"
     "writer waits for h: load in compute, then store in compute, buffer"},
    {"readers stand between modifiers",
     "buffers: {b: {of: uint, count: 8}, c: {of: uint, count: 8}, d: {of: uint, count: 8}}",
     "write, dispatch: 8, writes: [b]\n"
     "first, dispatch: 8, reads: [b], writes: [c]\n"
     "update, dispatch: 8, updates: [b]\n"
     "second, dispatch: 8, reads: [b], writes: [d]",
     "order: write first update second\n"
     "first waits for b: store written in compute, then load in compute, buffer\n"
     "update waits for b: load in compute, then load+store in compute, buffer\n"
     "second waits for b: store written in compute, then load in compute, buffer"},
    {"a cycle is one error", "buffers: {a: {of: uint, count: 8}, b: {of: uint, count: 8}}",
     "p, dispatch: 8, reads: [a], writes: [b]\n"
     "q, dispatch: 8, reads: [b], writes: [a]",
     "errors: 1"},
    {"two writers need an order", "buffers: {a: {of: uint, count: 8}}",
     "p, dispatch: 8, writes: [a]\n"
     "q, dispatch: 8, writes: [a]",
     "errors: 1"},
    {"... which `after` gives", "buffers: {a: {of: uint, count: 8}}",
     "p, dispatch: 8, writes: [a], after: [q]\n"
     "q, dispatch: 8, writes: [a]",
     "order: q p"},
    {"reads and updates before a write are errors",
     "buffers: {a: {of: uint, count: 8}, b: {of: uint, count: 8}}",
     "p, dispatch: 8, reads: [a], updates: [b]", "errors: 2"},
    /* -- kinds and bindings: depth has no imageLoad */
    {"kinds and bindings",
     "buffers: {list: {of: uint, count: 8}}\n"
     "images: {color: {format: rgba16f, size: frame}, depth: {format: d32f, size: frame}, shown: "
     "{format: rgba16f, size: frame}}",
     "draw, draw: scene, view: camera, writes: [color, depth, list]\n"
     "shade, dispatch: 8, reads: [depth, list, color], writes: [shown]",
     "draw.color: color, binding -1, attachment 0\n"
     "draw.list: store, binding 0\n"
     "draw: frame 1, live 2, textures 4, materials 3 uniform\n"
     "shade.color: load, binding 0\n"
     "shade.shown: store, binding 1\n"
     "shade.list: load, binding 2\n"
     "shade: frame 3, live 4, textures -1, materials -1\n"
     "shade.depth: texture, binding 5, attachment -1"},
    /* -- barriers */
    {"a draw, then two loads: the second needs none",
     "buffers: {x: {of: uint, count: 8}, y: {of: uint, count: 8}}\nimages: {color: {format: "
     "rgba16f, size: frame}}",
     "draw, draw: fullscreen, writes: [color]\n"
     "first, dispatch: 8, reads: [color], writes: [x]\n"
     "second, dispatch: 8, reads: [color, x], writes: [y]",
     "draw waits for color: nothing in nothing, then color in color, color, discards\n"
     "first waits for color: color written in color, then load in compute, general\n"
     "no second waits for color\n"
     "second waits for x: store written in compute, then load in compute, buffer"},
    {"a conditional dispatch may clear",
     "params: {on: {value: 1, live: true}}\nbuffers: {b: {of: uint, count: 8}, c: {of: uint, "
     "count: 8}}\n"
     "images: {shown: {format: rgba16f, size: frame}}",
     "p, when: on, dispatch: 8, writes: [shown, b]\n"
     "q, dispatch: 8, reads: [shown, b], writes: [c]",
     "p waits for shown: nothing in nothing, then store+clear in compute+clear, general, discards\n"
     "q waits for b: store+clear written in compute+clear, then load in compute, buffer"},
    /* imageLoad in compute, then texelFetch in a draw: the layout changes, and waits for the readers only. */
    {"the layout changes between readers",
     "buffers: {b: {of: uint, count: 8}}\nimages: {a: {format: rgba16f, size: frame}, shown: "
     "{format: rgba8, size: frame}}",
     "w, dispatch: 8, writes: [a]\n"
     "load, dispatch: 8, reads: [a], writes: [b]\n"
     "draw, draw: fullscreen, reads: [a, b], writes: [shown]",
     "draw waits for a: load in compute, then texture in fragment, read"},
    {"arguments are read by the stage of indirect commands",
     "structs: {Arguments: {x: uint, y: uint, z: uint}}\n"
     "buffers: {args: {of: Arguments, count: 1}, shown: {of: uint, count: 8}}",
     "w, dispatch: 1, writes: [args]\n"
     "p, indirect: args, writes: [shown]",
     "p waits for args: store written in compute, then indirect in indirect, buffer"},
    /* Synchronization validation does not report a store that follows a store without a barrier: this test does. */
    {"a store waits for a store",
     "buffers: {b: {of: uint, count: 8}}\nimages: {a: {format: rgba16f, size: frame}}",
     "first, dispatch: 8, writes: [b, a]\n"
     "second, dispatch: 8, writes: [b], updates: [a], after: [first]",
     "second waits for b: store written in compute, then store in compute, buffer\n"
     "second waits for a: store written in compute, then load+store in compute, general"},
    /* Written late, read as a texture, drawn over after the reader. */
    {"depth is read between draws",
     "buffers: {b: {of: uint, count: 8}}\nimages: {depth: {format: d32f, size: frame}}",
     "draw, draw: scene, view: camera, writes: [depth]\n"
     "look, dispatch: 8, reads: [depth], writes: [b]\n"
     "more, draw: scene, view: camera, updates: [depth]",
     "look waits for depth: depth written in depth, then texture in compute, read\n"
     "more waits for depth: texture in compute, then test+depth in depth, depth"},
    /* The first reader's barrier changed the layout; a reader in another stage is ordered after that change, through it. */
    {"a second reader waits for the layout",
     "buffers: {b: {of: uint, count: 8}}\nimages: {depth: {format: d32f, size: frame}, color: "
     "{format: rgba8, size: frame}}",
     "draw, draw: scene, view: camera, writes: [depth]\n"
     "look, dispatch: 8, reads: [depth], writes: [b]\n"
     "show, draw: fullscreen, reads: [depth, b], writes: [color]",
     "show waits for depth: texture in compute, then texture in fragment, read"},
    /* Samplers and texelFetch read in the same way: what one sees, the other sees. */
    {"texels after samples wait for nothing",
     "buffers: {b: {of: uint, count: 8}, c: {of: uint, count: 8}}\nsamplers: {soft: {kind: "
     "filter}}\n"
     "images: {depth: {format: d32f, size: frame}}",
     "draw, draw: scene, view: camera, writes: [depth]\n"
     "look, dispatch: 8, reads: [{name: depth, sampler: soft}], writes: [b]\n"
     "more, dispatch: 8, reads: [depth], writes: [c]",
     "look waits for depth: depth written in depth, then texture in compute, read\n"
     "no more waits for depth"},
    {"drawing into one mip keeps the stores in another",
     "buffers: {b: {of: uint, count: 8}}\nimages: {a: {format: rgba16f, size: [8, 8], mips: 2}}",
     "store, dispatch: 8, writes: [a]\n"
     "draw, draw: fullscreen, writes: [{name: a, mip: 1}]\n"
     "look, dispatch: 8, reads: [a], writes: [b]",
     "order: store draw look"},
    /* A write to one mip waits for no other mip; a read of it waits. */
    {"mips wait for themselves",
     "buffers: {b: {of: uint, count: 8}}\nimages: {a: {format: rgba16f, size: [8, 8], mips: 2}}",
     "first, dispatch: 8, writes: [a]\n"
     "second, dispatch: 8, writes: [{name: a, mip: 1}], after: [first]\n"
     "again, dispatch: 8, updates: [a], writes: [b], after: [second]",
     "first waits for a: nothing in nothing, then store in compute, general, discards\n"
     "no second waits for a\n"
     "again waits for a: store written in compute, then load+store in compute, general"},
    /* The next user of the memory waits for the readers of the last one. */
    {"readers leave nothing to wait for but themselves",
     "buffers: {b: {of: uint, count: 8}}\nimages: {a: {format: rgba16f, size: frame}, next: "
     "{format: rgba16f, size: frame}}",
     "store, dispatch: 8, writes: [a]\n"
     "look, dispatch: 8, reads: [a], writes: [b]\n"
     "last, dispatch: 8, reads: [b], writes: [next]",
     "last waits for next: load in compute, then store in compute, general, discards, memory of a"},
    /* If a reader may be skipped, the write before it may stay unread: the next user waits for it, too. */
    {"... unless they may be skipped",
     "params: {on: {value: 1, live: true}}\nbuffers: {b: {of: uint, count: 8}}\n"
     "images: {a: {format: rgba16f, size: frame}, next: {format: rgba16f, size: frame}}",
     "store, dispatch: 8, writes: [a]\n"
     "look, when: on, dispatch: 8, reads: [a], writes: [b]\n"
     "last, dispatch: 8, reads: [b], writes: [next]",
     "last waits for next: load+store written in compute, then store in compute, general, "
     "discards, memory of a"},
    /* -- memory: of a chain of images of 16,588,800 bytes neighbours overlap, others do not */
    {"a chain takes two slots",
     "images: {i0: {format: rgba16f, size: frame}, i1: {format: rgba16f, size: frame}, i2: "
     "{format: rgba16f, size: frame},\n"
     "  i3: {format: rgba16f, size: frame}, i4: {format: rgba16f, size: frame}}",
     "p0, dispatch: 8, writes: [i0]\n"
     "p1, dispatch: 8, reads: [i0], writes: [i1]\n"
     "p2, dispatch: 8, reads: [i1], writes: [i2]\n"
     "p3, dispatch: 8, reads: [i2], writes: [i3]\n"
     "p4, dispatch: 8, reads: [i3], writes: [i4]",
     "slots: 2\n"
     "bytes: 82944000, aliased 33177600\n"
     "i0: slot 0, shares nothing\n"
     "i1: slot 1, shares nothing\n"
     "i2: slot 0, shares i0\n"
     "i3: slot 1, shares i1\n"
     "i4: slot 0, shares i0\n"
     "p2 waits for i2: load in compute, then store in compute, general, discards, memory of i0"},
    /* Three users of one place; the second is small. No pass reads the first one's write beyond the second: this write is
     * made available for the third. */
    {"a third user waits for unread writes",
     "buffers: {b: {of: uint, count: 8}}\nimages: {big: {format: rgba32f, size: frame}, small: "
     "{format: r32f, size: frame},\n"
     "  next: {format: rgba16f, size: frame}}",
     "draw, draw: fullscreen, writes: [big]\n"
     "store, dispatch: 8, writes: [small]\n"
     "look, dispatch: 8, reads: [small], writes: [b]\n"
     "last, dispatch: 8, writes: [next]",
     "big: slot 0, shares nothing\n"
     "small: slot 0, shares nothing\n"
     "next: slot 0, shares nothing\n"
     "last waits for next: load+color written in compute+color, then store in compute, general, "
     "discards, memory of small"},
    /* Buffer, target, buffer in one place. Synchronization validation does not see that a wait for the target includes the
     * readers of the first buffer. It does see that where another buffer took the whole place in between. */
    {"a buffer waits for the buffer before a target",
     "buffers: {early: {of: uint, count: 4096}, late: {of: uint, count: 4096}, sum: {of: uint, "
     "count: 8}}\n"
     "images: {target: {format: d32f, size: [16, 16]}}",
     "fill, dispatch: 8, writes: [early]\n"
     "look, dispatch: 8, reads: [early], writes: [sum]\n"
     "draw, draw: fullscreen, writes: [target]\n"
     "again, dispatch: 8, reads: [sum], writes: [late]",
     "early: slot 0, shares nothing\n"
     "target: slot 0, shares nothing\n"
     "late: slot 0, shares nothing\n"
     "again waits for late: load+depth written in compute+depth, then store in compute, buffer, "
     "discards, memory of target"},
    {"a buffer waits for what a smaller one left",
     "buffers: {early: {of: uint, count: 4096}, late: {of: uint, count: 4096}, between: {of: uint, "
     "count: 2048},\n"
     "  sum: {of: uint, count: 8}}\nimages: {seen: {format: rgba16f, size: frame}}",
     "fill, dispatch: 8, writes: [early]\n"
     "look, draw: fullscreen, reads: [early], writes: [seen]\n"
     "store, dispatch: 8, writes: [between, sum]\n"
     "again, dispatch: 8, reads: [sum], writes: [late]",
     "again waits for late: load+store written in compute+fragment, then store in compute, buffer, "
     "discards, memory of between"},
    {"... and not for what one of its size covered",
     "buffers: {early: {of: uint, count: 4096}, late: {of: uint, count: 4096}, between: {of: uint, "
     "count: 4096},\n"
     "  sum: {of: uint, count: 8}}\nimages: {seen: {format: rgba16f, size: frame}}",
     "fill, dispatch: 8, writes: [early]\n"
     "look, draw: fullscreen, reads: [early], writes: [seen]\n"
     "store, dispatch: 8, writes: [between, sum]\n"
     "again, dispatch: 8, reads: [sum], writes: [late]",
     "again waits for late: store written in compute, then store in compute, buffer, discards, "
     "memory of between"},
    {"history and the output keep their memory",
     "images: {h: {format: rgba16f, size: frame, history: true}, shown: {format: rgba16f, size: "
     "frame},\n"
     "  later: {format: rgba16f, size: frame}}\noutput: {linear: shown}",
     "p, dispatch: 8, writes: [shown], updates: [h]\n"
     "q, dispatch: 8, writes: [later]",
     "slots: 3\n"
     "later: slot 2, shares nothing\n"
     "no p waits for h"},
    {"the third of a chain takes the first's memory",
     "images: {a: {format: rgba16f, size: frame}, b: {format: rgba16f, size: frame}, c: {format: "
     "rgba16f, size: frame}}",
     "p, dispatch: 8, writes: [a]\n"
     "q, dispatch: 8, reads: [a], writes: [b]\n"
     "r, dispatch: 8, reads: [b], writes: [c]",
     "slots: 2\n"
     "c: slot 0, shares a"},
    {"... which `keep` forbids",
     "images: {a: {format: rgba16f, size: frame, keep: true}, b: {format: rgba16f, size: frame},\n"
     "  c: {format: rgba16f, size: frame}}",
     "p, dispatch: 8, writes: [a]\n"
     "q, dispatch: 8, reads: [a], writes: [b]\n"
     "r, dispatch: 8, reads: [b], writes: [c]",
     "slots: 3\n"
     "c: slot 2, shares nothing"},
};

/* ---- Layout ---------------------------------------------------------------------------------- */

/* OpenGL 4.6, 7.6.2.2: vec3 aligns to 16 but takes 12 bytes, arrays of vec3 stride by 16, arrays of
 * float by 4. */
TEST(test_std430)
{
    static const uint32_t offsets[] = {0, 16, 28, 32, 40, 64, 96, 160};
    struct planned *planned = open_spec("structs: {S: {a: float, b: vec3, c: uint, d: vec2, e: "
                                        "\"float[3]\", f: \"vec3[2]\", g: mat4, h: int}}\n"
                                        "buffers: {b: {of: S, count: 1}}",
                                        "p, dispatch: 8, writes: [b]");
    const struct structure *s = planned->model.pipeline.structs;
    for (int i = 0; i < 8; i++)
        assert_int_equal(s->fields[i].offset, offsets[i]);
    assert_int_equal(s->fields[4].array_stride, 4);
    assert_int_equal(s->fields[5].array_stride, 16);
    assert_int_equal(s->align, 16);
    assert_int_equal(s->stride, 176);
    close_spec(planned);
}

TEST(test_cases)
{
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        print_message("# %s\n", cases[i].name);
        struct planned *planned = open_spec(cases[i].resources, cases[i].passes);
        char *plan = print_plan(planned);
        assert_lines(plan, cases[i].plan);
        free(plan);
        close_spec(planned);
    }
}

TEST(test_std140_live)
{
    static const uint32_t offsets[] = {0, 8, 16, 28, 32, 48, 56};
    struct planned *planned =
        open_spec("params: {a: {value: true, live: true}, b: {value: [1, 2], live: true},\n"
                  "  c: {value: [1, 2, 3], type: vec3, live: true}, d: {value: 0.5, live: true},\n"
                  "  e: {value: 1, type: uint, live: true}, f: 0.5, g: {value: [1, 2], type: "
                  "vec2}, baked: 1}\n"
                  "buffers: {h: {of: uint, count: 8}}",
                  "p, dispatch: 8, writes: [h]");
    struct pipeline *pipeline = &planned->model.pipeline;
    assert_int_equal(pipeline->live_size, 48);
    pipeline->params[5].uniform = pipeline->params[6].uniform = true;
    layout_model(&planned->model);
    for (int i = 0; i < 7; i++)
        assert_int_equal(pipeline->params[i].offset, offsets[i]);
    assert_int_equal(pipeline->live_size, 48);
    assert_int_equal(pipeline->block_size, 64);
    pipeline->param_count = 0;
    layout_model(&planned->model);
    assert_int_equal(pipeline->live_size, 16);
    assert_int_equal(pipeline->block_size, 16);
    close_spec(planned);
}

/* ---- Ranges, and buffers as uniform blocks ---------------------------------------------------- */

/* Pass p reads a buffer `a` through these ranges. `words` and `reads_images`, which bodies tell, are of r0, r1, ... */
static const struct {
    const char *name;
    bool gpu;
    const char *a, *ranges, *keys; /* keys: of the pass, each with a comma behind it */
    int32_t words[6];
    bool reads_images[6];
    const char *plan;
} range_cases[] = {
    {.name = "a short range is copied and unrolled",
     .a = "{of: uint, count: 512}",
     .ranges = "r0: {of: a, count: 32}",
     .plan = "p.r0: shared, unrolled, chunk 32, turn 1"},
    {.name = "a long one is read in place, from a uniform block",
     .a = "{of: vec4, count: 512}",
     .ranges = "r0: {of: a, count: 512}",
     .plan = "p.a: uniform, binding 3\n"
             "p.r0: in place, rolled"},
    {.name = "... that can hold the buffer", /* 80,000 bytes */
     .a = "{of: vec4, count: 5000}",
     .ranges = "r0: {of: a, count: 512}",
     .plan = "p.a: load, binding 0\n"
             "p.r0: in place, rolled"},
    {.name = "... and pads no element", /* std140 would pad each uint */
     .a = "{of: uint, count: 512}",
     .ranges = "r0: {of: a, count: 512}",
     .plan = "p.a: load, binding 0\n"
             "p.r0: in place, rolled"},
    {.name = "the shortest are unrolled, up to 256 elements, none that reads images",
     .a = "{of: uint, count: 512}",
     .ranges = "r0: {of: a, count: 200}, r1: {of: a, count: 33}, r2: {of: a, count: 32}, "
               "r3: {of: a, count: 100}, r4: {of: a, count: 156}",
     .reads_images = {false, true, true},
     .plan = "p.r0: in place, rolled\n"
             "p.r1: in place, rolled\n"
             "p.r2: shared, unrolled, chunk 32, turn 1\n"
             "p.r3: shared, unrolled, chunk 25, turn 1\n"
             "p.r4: shared, unrolled, chunk 26, turn 1"},
    {.name = "a range follows the spec: 75 is 25 * 3, 37 a prime with a short last block",
     .a = "{of: uint, count: 512}",
     .ranges = "r0: {of: a, count: 75, storage: shared, loop: unroll}, "
               "r1: {of: a, count: 37, storage: shared, loop: unroll}, "
               "r2: {of: a, count: 512, storage: shared}, r3: {of: a, count: 512, loop: unroll}",
     .plan = "p.r0: shared, unrolled, chunk 25, turn 1\n"
             "p.r1: shared, unrolled, chunk 32, turn 1\n"
             "p.r2: shared, rolled\n"
             "p.r3: in place, unrolled"},
    {.name = "GPUs copy long ranges",
     .gpu = true,
     .a = "{of: uint, count: 512}",
     .ranges = "r0: {of: a, count: 512}",
     .plan = "p.r0: shared, rolled"},
    {.name = "... while the copies fit",
     .gpu = true,
     .a = "{of: mat4, count: 512}",
     .ranges = "r0: {of: a, count: 512}, r1: {of: a, count: 512}, r2: {of: a, count: 512}, "
               "r3: {of: a, count: 512}, r4: {of: a, count: 512}",
     .plan = "p.r3: shared, rolled\n"
             "p.r4: in place, rolled"},
    {.name = "what the spec unrolls is copied",
     .a = "{of: uint, count: 512}",
     .ranges = "r0: {of: a, count: 64, loop: unroll}",
     .reads_images = {true},
     .plan = "p.r0: shared, unrolled, chunk 32, turn 1"},
    /* What does not fit is a loop, with several elements per turn while they are short: 4880 words, 1120 more, 510 more ... */
    {.name = "on a GPU what is unrolled fits an instruction cache",
     .gpu = true,
     .a = "{of: uint, count: 512}",
     .ranges = "r0: {of: a, count: 8}, r1: {of: a, count: 16}, r2: {of: a, count: 17}, "
               "r3: {of: a, count: 32}, r4: {of: a, count: 64}, r5: {of: a, count: 65}",
     .words = {610, 70, 30, 251, 400, 1},
     .plan = "p.r0: shared, unrolled, chunk 8, turn 1\n"
             "p.r1: shared, rolled, chunk 16, turn 4\n"
             "p.r2: shared, unrolled, chunk 17, turn 1\n"
             "p.r3: shared, rolled, chunk 32, turn 4\n"
             "p.r4: shared, rolled, chunk 64, turn 2\n"
             "p.r5: shared, rolled, chunk 13, turn 4"},
    {.name = "on a CPU a workgroup that copies is large",
     .a = "{of: vec4, count: 512}",
     .ranges = "r0: {of: a, count: 16}",
     .plan = "p.a: uniform, binding 3\n"
             "p: local 256 x 1"},
    {.name = "... unless the spec sets its size",
     .a = "{of: vec4, count: 512}",
     .ranges = "r0: {of: a, count: 16, storage: buffer}",
     .keys = "local: [8, 8], ",
     .plan = "p.a: load, binding 0\n"
             "p: local 8 x 8"},
};

TEST(test_ranges)
{
    for (size_t i = 0; i < sizeof range_cases / sizeof *range_cases; i++) {
        struct text resources = {0}, passes = {0};
        print_message("# %s\n", range_cases[i].name);
        text_add(&resources, "buffers: {a: %s, b: {of: uint, count: 8}}", range_cases[i].a);
        text_add(&passes,
                 "w, dispatch: 8, writes: [a]\n"
                 "p, dispatch: 64, %sreads: [a], writes: [b], ranges: {%s}",
                 range_cases[i].keys ? range_cases[i].keys : "", range_cases[i].ranges);
        struct planned *planned = open_spec(resources.data, passes.data);
        struct pass *pass = &planned->model.pipeline.passes[1];
        planned->model.pipeline.gpu = range_cases[i].gpu;
        for (uint32_t k = 0; k < pass->range_count; k++) {
            pass->ranges[k].words = range_cases[i].words[k];
            pass->ranges[k].reads_images = range_cases[i].reads_images[k];
        }
        char *plan = print_plan(planned);
        assert_lines(plan, range_cases[i].plan);
        free(plan);
        close_spec(planned);
        text_free(&resources);
        text_free(&passes);
    }
}

/* 4096 vec4 fill the 64 KiB of a uniform block on software drivers; std140 would pad a uint array. */
TEST(test_draws_read_small_buffers_as_uniform_blocks)
{
    for (int gpu = 0; gpu < 2; gpu++) {
        struct planned *planned = open_spec(
            "buffers: {fits: {of: vec4, count: 4096}, large: {of: vec4, count: 4097}, uints: {of: "
            "uint, count: 8}}\n"
            "images: {shown: {format: rgba16f, size: frame}}",
            "fill, dispatch: 8, writes: [fits, large, uints]\n"
            "draw, draw: scene, view: camera, reads: [fits, large, uints], writes: [shown]");
        planned->model.pipeline.gpu = gpu;
        char *plan = print_plan(planned);
        assert_lines(plan, gpu ? "draw.fits: load, binding 1\n"
                                 "draw: frame 4, live 5, textures 6, materials 0"
                               : "draw.fits: uniform, binding 5\n"
                                 "draw.large: load, binding 0\n"
                                 "draw.uints: load, binding 1\n"
                                 "draw: frame 2, live 3, textures 6, materials 4 uniform");
        free(plan);
        close_spec(planned);
    }
}

/* Every device has twelve uniform blocks: nine for buffers, and one each for materials, frame and live parameters. Ranges
 * that the plan reads in place are among the nine. */
TEST(test_uniform_blocks_are_few)
{
    for (int ranged = 0; ranged < 2; ranged++) {
        struct text resources = {0}, passes = {0};
        uint32_t blocks = 0;
        text_add(&resources, "buffers: {shown: {of: uint, count: 8}");
        for (int name = 'a'; name <= 'k'; name++)
            text_add(&resources, ", %c: {of: vec4, count: 300}", name);
        text_add(&resources, "}");
        text_add(&passes,
                 "w, dispatch: 8, writes: [a, b, c, d, e, f, g, h, i, j, k]\n"
                 "p, dispatch: 8, reads: [a, b, c, d, e, f, g, h, i, j, k], writes: [shown]");
        for (int name = 'a'; ranged && name <= 'k'; name++)
            text_add(&passes, "%sr_%c: {of: %c, count: 300}", name == 'a' ? ", ranges: {" : ", ",
                     name, name);
        text_add(&passes, ranged ? "}" : "");
        struct planned *planned = open_spec(resources.data, passes.data);
        assert_true(plan_model(&planned->model, planned->diag));
        const struct pass *pass = &planned->model.pipeline.passes[1];
        for (uint32_t i = 0; i < pass->access_count; i++)
            blocks += pass->accesses[i].kind == DT_READ_UNIFORM;
        assert_int_equal(blocks, 9);
        if (ranged)
            assert_int_equal(pass->ranges[0].loop, LOOP_ROLL);
        close_spec(planned);
        text_free(&resources);
        text_free(&passes);
    }
}

static int set_up(void **state)
{
    (void)state;
    if (!mkdtemp(folder))
        return -1;
    write_file("none.glsl", "void main() {}\n");
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    char path[256];
    for (int i = 0; i < 2; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, (const char *[]){"none.glsl", "plan.yaml"}[i]);
        unlink(path);
    }
    return rmdir(folder);
}

RUN_TESTS("plan", set_up, tear_down)
