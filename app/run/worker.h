/* One live side of a comparison in a process of its own: a driver gets the environment that it
 * wants, cannot disturb another one, and may crash without taking the comparison along. The process
 * is forked before any driver is opened and shares the pipeline and the scene; the parent drives it
 * from stop to stop with these verbs, and bytes go through shared memory. Called by compare, blame
 * and replay from one thread. */
#ifndef DIPTYCH_WORKER_H
#define DIPTYCH_WORKER_H

#include "run/allocations.h"
#include "run/session.h"

enum worker_stop {
    WORKER_READY,       /* programs and resources are there, no frame has run */
    WORKER_BEFORE_PASS, /* of the first info.stops_before passes */
    WORKER_AFTER_PASS,
    WORKER_FRAME_DONE,
    WORKER_FINISHED /* all frames ran, and the validation layers were silent */
};

/* What the last frame took, frame_ms and allocations: the last without a stop inside. */
struct worker_measure {
    double frame_ms;  /* from the call to the finished frame, by the host's clock */
    double record_ms; /* see struct dt_runtime; NAN: not known */
    struct allocations allocations;
    const double *pass_ms; /* pass_count values, NAN for a skipped pass; NULL without timing */
};

struct worker_place {
    enum worker_stop stop;
    uint32_t frame, pass; /* as far as they mean something at this stop */
};

struct worker_info {
    struct session_info session; /* name_in_log is set by the worker */
    uint32_t frames;             /* the last is frames - 1, counted from 0 */
    uint32_t first_observed;     /* frames before this one run without a stop inside */
    uint32_t stops_before;       /* in an observed frame, before how many passes it stops, too */
    /* frames before first_observed stop at their end, too: worker_measure tells what they took */
    bool stops_after_frames;
    bool quiet; /* hand on warnings and errors only, no news */
};

struct worker {
    struct worker_info info;
    pid_t process; /* 0: none */
    int socket;
    uint8_t *shared; /* as large as the largest mip or buffer of the pipeline */
    size_t capacity;
    char *device;              /* known from WORKER_READY on; owned */
    struct worker_place place; /* where it stopped last */
    bool running;              /* it was resumed and has not been waited for since */
    bool spoke;                /* it reported an error of its own */
};

/* Every bool verb logs its error, which names the side. A worker that failed takes worker_close
 * only. Errors and other messages of the process come out of the parent's console while a verb
 * waits, with the label before them. */

/* Starts the process; it runs to WORKER_READY, which worker_wait waits for. */
bool worker_start(struct worker *worker, const struct worker_info *info);
bool worker_wait(struct worker *worker, struct worker_place *place);

/* From a stop on to the next. At WORKER_BEFORE_PASS the action says what becomes of the pass; it is
 * DT_RUN elsewhere. */
bool worker_resume(struct worker *worker, enum dt_action action);

/* At a stop: asks for the content of a resource and takes it, so that several workers can read at
 * once; worker_read does both. The bytes stay the worker's: valid until its next verb, not to be
 * freed. */
bool worker_ask(struct worker *worker, uint32_t resource, uint32_t mip);
bool worker_take(struct worker *worker, struct dt_bytes *bytes);
bool worker_read(struct worker *worker, uint32_t resource, uint32_t mip, struct dt_bytes *bytes);

/* At a stop: replaces the content of a resource; see struct dt_runtime. */
bool worker_write(struct worker *worker, uint32_t resource, uint32_t mip,
                  const struct dt_bytes *bytes);

/* At WORKER_FRAME_DONE. pass_ms is the worker's: valid until its
 * next verb. */
bool worker_measure(struct worker *worker, struct worker_measure *measure);

/* Ends the process whatever state it is in. One that stands at WORKER_FINISHED closes its device
 * first, and messages from that count. Takes a zeroed worker. */
void worker_close(struct worker *worker);

#endif
