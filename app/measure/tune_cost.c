/* `tune --gpu`: judges changes by the figures of a GPU's compiler; see tune.h and cost.h. */
#include <math.h>
#include <stdlib.h>

#include "measure/tune.h"

/* Waves of a SIMD that are enough to hide latency. */
enum { ENOUGH_WAVES = 8 };

void tune_forget(struct estimate *estimate)
{
    cost_gpu_free(&estimate->gpu);
    free(estimate->frame.passes);
    *estimate = (struct estimate){0};
}

bool tune_estimate(struct tuning *tuning, struct estimate *estimate,
                   const struct programme *programme)
{
    struct console *console = tuning->bench.console;
    const struct setup *setup = &programme->options.setup;
    bool good = cost_ask(&estimate->gpu, tuning->chip, NULL, &programme->pipeline, console) &&
                cost_count(&estimate->frame, &programme->pipeline,
                           setup->scene ? &tuning->bench.scene : NULL, setup->size, &console->log);
    if (!good)
        tune_forget(estimate);
    return good;
}

/* Sum, or with `least` the smallest, of a number of all stages of a pass. */
static double sum_of_stages(const struct estimate *estimate, uint32_t pass, enum cost_number number,
                            bool least)
{
    double sum = least ? INFINITY : 0;
    for (uint32_t i = 0; i < estimate->gpu.count; i++) {
        double value = estimate->gpu.stages[i].numbers[number];
        if (estimate->gpu.stages[i].pass == pass)
            sum = least ? fmin(sum, value) : sum + value;
    }
    return sum;
}

double tune_pass_ms(const struct estimate *estimate, uint32_t pass)
{
    struct cost_times times = cost_times(&estimate->gpu, &estimate->frame, pass);
    if (isnan(times.arithmetic))
        return sum_of_stages(estimate, pass, COST_CYCLES, false) / (estimate->gpu.chip->ghz * 1e6);
    return fmax(times.arithmetic, times.latency);
}

double tune_frame_ms(const struct estimate *estimate)
{
    double sum = 0;
    for (uint32_t i = 0; i < estimate->frame.pipeline->info->pass_count; i++)
        sum += tune_pass_ms(estimate, i);
    return sum;
}

/* Whether a change costs what cycles do not show: spills, waves, an instruction cache. */
static bool has_price(const struct estimate *was, const struct estimate *is, uint32_t pass)
{
    double waves = sum_of_stages(is, pass, COST_WAVES, true);
    double code = sum_of_stages(is, pass, COST_CODE, false);
    return sum_of_stages(is, pass, COST_SPILLS, false) >
               sum_of_stages(was, pass, COST_SPILLS, false) ||
           (waves < ENOUGH_WAVES && waves < sum_of_stages(was, pass, COST_WAVES, true)) ||
           (code > is->gpu.chip->code_kib * 1024 &&
            code > sum_of_stages(was, pass, COST_CODE, false));
}

bool tune_judge_estimates(struct tuning *tuning, const struct programme *trial,
                          struct choice **list, uint32_t count)
{
    struct estimate is = {0};
    if (!tune_estimate(tuning, &is, trial))
        return false;
    for (uint32_t i = 0; i < count; i++) {
        struct choice *choice = list[i];
        choice->before = tune_pass_ms(&tuning->was, choice->pass);
        choice->after = tune_pass_ms(&is, choice->pass);
        choice->ratio = choice->after / choice->before;
        if (choice->ratio <= TUNE_MOST_RATIO && !has_price(&tuning->was, &is, choice->pass))
            tune_keep(tuning, choice);
        tune_tell(tuning, choice);
    }
    tune_forget(&is);
    return true;
}
