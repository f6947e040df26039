/* Runs one side of a comparison in its own process: a driver gets its own environment, does not
 * disturb another, and may crash alone. The process is forked before any driver is opened and
 * shares pipeline and scene. The parent steps it from stop to stop; bytes go through shared
 * memory. */
#pragma once

#include "run/session.h"

enum worker_stop {
    WORKER_READY,       /* programs and resources exist, no frame has run */
    WORKER_BEFORE_PASS, /* of the first info.stops_before passes */
    WORKER_AFTER_PASS,
    WORKER_FRAME_DONE,
    WORKER_FINISHED /* all frames ran, and the validation layers were silent */
};

/* Times of the last frame; frame_ms of the last frame without a stop inside. */
struct worker_measure {
    double frame_ms;       /* from the call to the finished frame, by the host's clock */
    double record_ms;      /* see struct dt_runtime; NAN: not known */
    const double *pass_ms; /* pass_count values, NAN for a skipped pass; NULL without timing */
};

struct worker_place {
    enum worker_stop stop;
    uint32_t frame, pass; /* as far as they apply to this stop */
};

struct worker_info {
    struct session_info session; /* name_in_log is set by the worker */
    uint32_t frames;             /* the last is frames - 1, counted from 0 */
    uint32_t first_observed;     /* earlier frames run without a stop inside */
    uint32_t stops_before;       /* in an observed frame, it also stops before this many passes */
    /* also stop at the end of frames before first_observed, for worker_measure */
    bool stops_after_frames;
    bool quiet;       /* print warnings and errors only */
    uint32_t threads; /* of Mesa's software drivers; 0: as they choose */
};

struct worker {
    struct worker_info info;
    pid_t process; /* 0: none */
    int socket;
    uint8_t *shared; /* as large as the largest mip or buffer of the pipeline */
    size_t capacity;
    char *device, *driver;     /* known after WORKER_READY; owned */
    struct worker_place place; /* where it stopped last */
    bool running;              /* resumed, and not waited for since */
    bool spoke;                /* it reported an error of its own */
};

/* Every bool verb logs its error, with the side's name. After a failure only worker_close is
 * allowed. While a verb waits, messages of the process are printed on the parent's console, with
 * the label in front. */

/* Starts the process; it runs to WORKER_READY, which worker_wait waits for. */
bool worker_start(struct worker *worker, const struct worker_info *info);
bool worker_wait(struct worker *worker, struct worker_place *place);

/* Continues to the next stop. At WORKER_BEFORE_PASS the action says whether the pass runs;
 * elsewhere it is DT_RUN. */
bool worker_resume(struct worker *worker, enum dt_action action);

/* At a stop: worker_ask requests the content of a resource and worker_take receives it, so that
 * several workers can read at once; worker_read does both. The bytes are the worker's: valid until
 * its next verb, do not free them. */
bool worker_ask(struct worker *worker, uint32_t resource, uint32_t mip);
bool worker_take(struct worker *worker, struct dt_bytes *bytes);
bool worker_read(struct worker *worker, uint32_t resource, uint32_t mip, struct dt_bytes *bytes);

/* At a stop: replaces the content of a resource; see struct dt_runtime. */
bool worker_write(struct worker *worker, uint32_t resource, uint32_t mip,
                  const struct dt_bytes *bytes);

/* At WORKER_FRAME_DONE. pass_ms is the worker's: valid until its
 * next verb. */
bool worker_measure(struct worker *worker, struct worker_measure *measure);

/* Ends the process in any state. At WORKER_FINISHED it closes its device first, and messages from
 * that count. Takes a zeroed worker. */
void worker_close(struct worker *worker);
