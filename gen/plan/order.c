/* The order of execution: finds the dependencies between passes, then sorts them topologically and
 * stably. Reports cycles, writers without an order, and reads before any write. */
#include <string.h>

#include "plan.h"
#include "base/text.h"

struct edge {
    bool exists;
    const struct resource *because; /* NULL: the pass's own `after` */
};

struct graph {
    struct pass *passes;
    uint32_t count;
    struct edge *edges; /* [from * count + to] */
    bool *after;        /* [from * count + to]: transitive closure of `after` */
    /* scratch of one resource: passes that write or update it, in their order */
    uint32_t *modifiers;
    uint32_t modifier_count;
};

struct pass_use pass_use_of(const struct pass *pass, const struct resource *resource)
{
    struct pass_use use = {0};

    if (pass->indirect_resource == resource) {
        use.reads = true;
        use.read_loc = pass->indirect_loc;
    }
    if (pass->index_resource == resource) {
        use.reads = true;
        use.read_loc = pass->indices_loc;
    }
    EACH(access, pass->accesses, pass->access_count) {
        if (access->resource != resource)
            continue;
        use.kinds |= access->kind;
        if (access->mode == MODE_READ) {
            use.reads = true;
            use.read_loc = access->loc;
            continue;
        }
        use.change_loc = access->loc;
        use.updates |= access->mode == MODE_UPDATE;
        use.writes |= access->mode == MODE_WRITE;
        use.written_mips |= access->mode == MODE_WRITE ? 1u << (access->mip_value & 31) : 0;
        use.changed_mips |= 1u << (access->mip_value & 31);
    }
    return use;
}

static void add_edge(struct graph *graph, uint32_t from, uint32_t to,
                     const struct resource *because)
{
    struct edge *edge = &graph->edges[from * graph->count + to];

    if (from != to && !edge->exists)
        *edge = (struct edge){true, because};
}

/* A pass in `after` that a baked `when` removed adds no edge. */
static void add_after_edges(struct graph *graph)
{
    uint32_t n = graph->count;

    for (uint32_t to = 0; to < n; to++) {
        for (uint32_t i = 0; i < graph->passes[to].after_count; i++) {
            for (uint32_t from = 0; from < n; from++) {
                if (strcmp(graph->passes[from].name, graph->passes[to].after[i]) == 0) {
                    add_edge(graph, from, to, NULL);
                    graph->after[from * n + to] = true;
                }
            }
        }
    }
    for (uint32_t via = 0; via < n; via++) {
        for (uint32_t from = 0; from < n; from++)
            for (uint32_t to = 0; graph->after[from * n + via] && to < n; to++)
                graph->after[from * n + to] |= graph->after[via * n + to];
    }
}

static bool ordered(const struct graph *graph, uint32_t first, uint32_t second)
{
    return graph->after[first * graph->count + second];
}

/* In the order of the spec, except for passes that `after` moves. */
static void collect_modifiers(struct graph *graph, const struct resource *resource)
{
    graph->modifier_count = 0;
    for (uint32_t pass = 0; pass < graph->count; pass++) {
        struct pass_use use = pass_use_of(&graph->passes[pass], resource);
        uint32_t place = 0;

        if (!use.writes && !use.updates)
            continue;
        while (place < graph->modifier_count && !ordered(graph, pass, graph->modifiers[place]))
            place++;
        for (uint32_t i = graph->modifier_count++; i > place; i--)
            graph->modifiers[i] = graph->modifiers[i - 1];
        graph->modifiers[place] = pass;
    }
}

static void check_writers(const struct graph *graph, const struct resource *resource,
                          struct diag *diag)
{
    for (uint32_t j = 0; j < graph->modifier_count; j++) {
        const struct pass *second = &graph->passes[graph->modifiers[j]];
        struct pass_use second_use = pass_use_of(second, resource);

        for (uint32_t i = 0; i < j; i++) {
            const struct pass *first = &graph->passes[graph->modifiers[i]];
            struct pass_use first_use = pass_use_of(first, resource);

            if (!(first_use.written_mips & second_use.written_mips) ||
                ordered(graph, graph->modifiers[i], graph->modifiers[j]))
                continue;
            diag_error(
                diag, second_use.change_loc,
                "`%s` is written by `%s` and by `%s` in no defined order; list it in `updates` of "
                "one, or name the other in `after`",
                resource->name, first->name, second->name);
            diag_note(diag, first_use.change_loc, "`%s` is written here too", resource->name);
            return;
        }
    }
}

/* Index in `modifiers` of the pass whose content the reader sees; -1: the content before all of
 * them. */
static int seen_by(const struct graph *graph, uint32_t reader)
{
    int seen = -1;

    for (uint32_t i = 0; i < graph->modifier_count; i++) {
        uint32_t modifier = graph->modifiers[i];

        if (ordered(graph, modifier, reader) ||
            (modifier < reader && !ordered(graph, reader, modifier)))
            seen = (int)i;
    }
    return seen;
}

static void order_reader(struct graph *graph, const struct resource *resource, uint32_t reader,
                         struct loc loc, struct diag *diag)
{
    int seen = seen_by(graph, reader);

    if (seen < 0 && graph->modifier_count == 1 && !resource->history)
        seen = 0;
    if (seen < 0 && !resource->history) {
        diag_error(
            diag, loc, "`%s` reads `%s` before any pass writes it; %s", graph->passes[reader].name,
            resource->name,
            graph->modifier_count
                ? "move it behind the pass that writes the content"
                : "let a pass write it, or give it `file`, `input: true` or `history: true`");
        return;
    }
    if (seen >= 0)
        add_edge(graph, graph->modifiers[seen], reader, resource);
    if (seen + 1 < (int)graph->modifier_count)
        add_edge(graph, reader, graph->modifiers[seen + 1], resource);
}

static void order_resource(struct graph *graph, const struct resource *resource, struct diag *diag)
{
    collect_modifiers(graph, resource);
    check_writers(graph, resource, diag);
    for (uint32_t i = 0; i + 1 < graph->modifier_count; i++)
        add_edge(graph, graph->modifiers[i], graph->modifiers[i + 1], resource);
    if (graph->modifier_count && !resource->history) {
        const struct pass *first = &graph->passes[graph->modifiers[0]];
        struct pass_use use = pass_use_of(first, resource);

        if (use.updates || use.reads) {
            diag_error(diag, use.updates ? use.change_loc : use.read_loc,
                       "`%s` %s `%s` before any pass writes it; list a pass that writes it first, "
                       "or give it `history: true`",
                       first->name, use.updates ? "updates" : "reads", resource->name);
        }
    }
    for (uint32_t pass = 0; pass < graph->count; pass++) {
        struct pass_use use = pass_use_of(&graph->passes[pass], resource);

        if (use.reads && !use.writes && !use.updates)
            order_reader(graph, resource, pass, use.read_loc, diag);
    }
}

static bool ready(const struct graph *graph, const bool *done, uint32_t pass)
{
    for (uint32_t from = 0; from < graph->count; from++)
        if (!done[from] && graph->edges[from * graph->count + pass].exists)
            return false;
    return true;
}

/* Every pass that is not done waits for another such pass, so following the edges back closes a
 * cycle. */
static void report_cycle(struct model *model, const struct graph *graph, const bool *done,
                         struct diag *diag)
{
    uint32_t n = graph->count, length = 0, start = 0, at = 0;
    uint32_t *ring = arena_alloc(model->arena, (n + 1) * sizeof *ring);
    int *place = arena_alloc(model->arena, n * sizeof *place);
    struct text text = {0};

    if (!ring || !place)
        return;
    while (done[at])
        at++;
    while (!place[at]) {
        uint32_t from = 0;

        ring[length++] = at;
        place[at] = (int)length;
        while (done[from] || !graph->edges[from * n + at].exists)
            from++;
        at = from;
    }
    start = (uint32_t)place[at] - 1;
    text_add(&text, "`%s`", graph->passes[at].name);
    for (uint32_t i = length; i-- > start;)
        text_add(&text, " -> `%s`", graph->passes[ring[i]].name);
    diag_error(diag, graph->passes[at].loc, "dependency cycle between passes: %s",
               text.data ? text.data : "");
    text_free(&text);
    for (uint32_t i = length; i-- > start;) {
        uint32_t from = i + 1 < length ? ring[i + 1] : ring[start];
        const struct edge *edge = &graph->edges[from * n + ring[i]];
        const struct pass *later = &graph->passes[ring[i]];

        diag_note(diag, later->loc, "`%s` runs after `%s` because of %s%s%s", later->name,
                  graph->passes[from].name, edge->because ? "`" : "its `after`",
                  edge->because ? edge->because->name : "", edge->because ? "`" : "");
    }
}

static bool sort_passes(struct model *model, const struct graph *graph, struct diag *diag)
{
    struct pipeline *pipeline = &model->pipeline;
    bool *done = arena_alloc(model->arena, graph->count * sizeof *done + 1);

    pipeline->order = arena_alloc(model->arena, graph->count * sizeof *pipeline->order + 1);
    if (!done || !pipeline->order)
        return false;
    for (uint32_t place = 0; place < graph->count; place++) {
        uint32_t next = 0;

        while (next < graph->count && (done[next] || !ready(graph, done, next)))
            next++;
        if (next == graph->count) {
            report_cycle(model, graph, done, diag);
            return false;
        }
        done[next] = true;
        graph->passes[next].index = place;
        pipeline->order[place] = &graph->passes[next];
    }
    return true;
}

static void check_output(const struct pipeline *pipeline, const char *name, struct loc loc,
                         struct diag *diag)
{
    for (uint32_t i = 0; name && i < pipeline->resource_count; i++) {
        bool written = strcmp(pipeline->resources[i].name, name) != 0;

        for (uint32_t p = 0; p < pipeline->pass_count && !written; p++) {
            struct pass_use use = pass_use_of(&pipeline->passes[p], &pipeline->resources[i]);

            written = use.writes || use.updates;
        }
        if (!written)
            diag_error(diag, loc, "no pass writes the output `%s`", name);
    }
}

bool plan_order(struct model *model, struct diag *diag)
{
    struct pipeline *pipeline = &model->pipeline;
    uint32_t n = pipeline->pass_count;
    unsigned errors = diag_error_count(diag);
    struct graph graph = {
        .passes = pipeline->passes,
        .count = n,
        .edges = arena_alloc(model->arena, (size_t)n * n * sizeof *graph.edges + 1),
        .after = arena_alloc(model->arena, (size_t)n * n + 1),
        .modifiers = arena_alloc(model->arena, n * sizeof *graph.modifiers + 1),
    };

    if (!graph.edges || !graph.after || !graph.modifiers)
        return false;
    add_after_edges(&graph);
    EACH(resource, pipeline->resources, pipeline->resource_count)
        order_resource(&graph, resource, diag);
    check_output(pipeline, pipeline->linear_output, pipeline->linear_loc, diag);
    check_output(pipeline, pipeline->display_output, pipeline->display_loc, diag);
    return sort_passes(model, &graph, diag) && diag_error_count(diag) == errors;
}
