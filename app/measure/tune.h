/* Shared by the files of `diptych tune`: tune.c searches, and measures frames; tune_cost.c estimates
 * them for a chip. */
#ifndef DIPTYCH_TUNE_H
#define DIPTYCH_TUNE_H

#include "measure/bench.h"
#include "measure/cost.h"

/* A change is kept if the median of its ratios is at most this, and five of six are below 1: of nine without
 * a difference eight would be in 2 % of all trials. */
#define TUNE_MOST_RATIO 0.97
/* A pass with a smaller share of the frame is left as it is. */
#define TUNE_LEAST_SHARE 0.01

struct choice {
    uint32_t pass;
    char *set;                   /* PATH=VALUE */
    uint32_t turn;               /* its number among those of the pass */
    double before, after, ratio; /* medians, ms; NAN: not measured */
    char *refused;               /* why not, or NULL */
    bool kept;
};

struct tuning {
    struct bench bench; /* console, frames and scene of the lanes */
    struct side side;
    struct programme first, now; /* as the spec is, and with what is kept */
    struct choice *choices;
    uint32_t choice_count;
    struct choice **kept; /* one for each path; room for all */
    uint32_t kept_count;
    /* tune_cost.c: instead of times the estimates for a chip; NULL: times of the side */
    const struct cost_chip *chip;
    struct estimate {
        struct cost_gpu gpu;
        struct cost_frame frame;
    } was; /* of `now` */
};

/* The change is better than what was kept on its path. */
void tune_keep(struct tuning *tuning, struct choice *choice);
void tune_tell(const struct tuning *tuning, const struct choice *choice);

/* ---- tune_cost.c ----------------------------------------------------------------------------- */

/* Estimates a pipeline; log their errors. */
bool tune_estimate(struct tuning *tuning, struct estimate *estimate,
                   const struct programme *programme);
void tune_forget(struct estimate *estimate); /* takes a zeroed one */
/* Milliseconds of a pass: of arithmetic, or of one wave if that is more. Where its count is not known, of
 * one wave on each SIMD. */
double tune_pass_ms(const struct estimate *estimate, uint32_t pass);
double tune_frame_ms(const struct estimate *estimate);
/* Judges changes that `trial` has all of. */
bool tune_judge_estimates(struct tuning *tuning, const struct programme *trial,
                          struct choice **list, uint32_t count);

#endif
