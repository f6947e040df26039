/* Watches the files that a pipeline was made from, and makes it anew when one of them is saved: on
 * a thread of its own, so that frames go on meanwhile. */
#pragma once

#include "spec/pipeline.h"

struct reload;

enum reload_news {
    RELOAD_NONE,
    RELOAD_BEGUN,  /* something was saved */
    RELOAD_DONE,   /* there is a pipeline, maybe the same as before */
    RELOAD_FAILED, /* there is none */
};

/* What came of it. */
struct reload_result {
    struct pipeline pipeline; /* DONE: the caller's to unload */
    char *text; /* DONE, FAILED: the messages of reading it; the caller's to free, may be NULL */
    double ms;  /* from the moment that the change was seen */
};

/* Watches what `pipeline` was made from; NULL, logged, when it cannot. */
struct reload *reload_start(struct console *console, const struct setup *setup,
                            const struct pipeline *pipeline);
/* Makes the pipeline again, with these overrides instead of those of the setup; copies them. False when out of memory,
 * logged. */
bool reload_again(struct reload *reload, const char *const *sets, uint32_t count);
/* Never waits. */
enum reload_news reload_poll(struct reload *reload, struct reload_result *result);
/* Waits for a build that is under way; takes NULL. */
void reload_stop(struct reload *reload);
