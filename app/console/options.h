/* The options of all verbs in one table, read by base/command.h. */
#pragma once

#include "console/console.h"
#include "console/setup.h"

/* A verb's bit in the option table. */
enum verb_id {
    VERB_RENDER = 1,
    VERB_COMPARE = 2,
    VERB_REPLAY = 4,
    VERB_SWEEP = 8,
    VERB_REFERENCE = 16,
    VERB_METRICS = 32,
    VERB_BENCH = 64,
    VERB_REPORT = 128,
    VERB_VIEW = 256,
    VERB_FLICKER = 512,
    VERB_LIST = 1024,
    VERB_HELP = 2048,
    VERB_TUNE = 4096,
    VERB_IMPORT = 8192,
    VERB_COST = 16384,
    VERB_CAPTURE = 32768
};

/* Options of all verbs. Those that the table does not give to a verb stay at their defaults.
 * Strings point into argv. */
struct options {
    struct setup setup;
    const char *output;
    const char *with;       /* overlay of sets, which stand in set_list */
    char *with_text;        /* owned */
    uint32_t frame;         /* reference: of the motion */
    struct text_list dumps; /* compare: folders of dumps, or captures; capture: a command line */
    const char *contracts;
    const char *write_contracts;
    uint32_t repeats;     /* compare: runs of each side; 0: not measured */
    const char *files[3]; /* import: one or two, then NULL */
    const char *picture;
    const char *dump;
    const char *timings;
    const char *show;
    const char *json;
    const char *pictures;
    const char *html;   /* folder */
    const char *junit;  /* file */
    const char *golden; /* folder */
    bool update;
    const char *bisect; /* folder to write */
    uint32_t repeat;    /* compare: 0: not given */
    const char *folder; /* of an earlier bisect, or of a bundle's run */
    uint32_t spp;       /* reference: 0: not given */
    uint32_t seed;
    uint32_t threads; /* 0: one per processor */
    const char *noise;
    const char *bounces;
    const char *from_bounce;
    const char *quantity; /* these three: one of the choices in the table, or NULL */
    const char *filter;
    const char *sampler;
    const char *checkpoint;
    const char *vpls;
    bool emission;
    const char *reference; /* picture files; flicker: patterns of them */
    const char *test;
    const char *flip;
    bool every_frame;
    double exposure;             /* factor; 0: of the reference's log-average luminance */
    double pixels_per_degree;    /* metrics: 0: not given */
    uint32_t block;              /* flicker: 0: not given */
    struct text_list scene_list; /* sweep, report: instead of scene and size */
    struct text_list size_list;
    struct text_list grid;
    const char *topic;         /* help: a verb, or NULL */
    const char *measure;       /* sweep: of agree,time,error,own; NULL: agree */
    const char *x;             /* sweep: path of a grid; NULL: the first */
    uint32_t jobs, run_frames; /* 0: not given; sweep, bench, view */
    const char *profile;       /* sweep, report: of Snakemake */
    uint32_t warmup;
    bool collect;
    const char *screenshot; /* view; like the next two */
    const char *present;
    uint32_t window[2];           /* 0: not given */
    const char *outline;          /* report: NULL: the one beside the spec */
    const char *gpu;              /* cost, tune: names of chips */
    const char *earlier;          /* cost: an earlier --json */
    const char *bench;            /* cost: a --json of bench */
    const char *limit;            /* cost: a percentage */
    bool trust;                   /* replay, compare: without a sandbox */
    struct text_list environment; /* capture: of the program */
    double after;                 /* capture: seconds; 0: not given */
    const char *match;            /* compare: captures; file, or NULL; like the next two */
    const char *draws;
    const char *save;
    bool help;
};

enum { OPTIONS_MAX_FRAMES = OPTIONS_MAX_COUNT };

struct verb {
    const char *name;
    enum verb_id id;
    const char *summary; /* one line */
    const char *details; /* for --help: output and exit statuses */
    int (*run)(struct console *console, const struct options *options);
    int failed; /* exit status of a failure */
};

int verb_render(struct console *console, const struct options *options);
int verb_compare(struct console *console, const struct options *options);
int verb_replay(struct console *console, const struct options *options);
int verb_reference(struct console *console, const struct options *options);
int verb_metrics(struct console *console, const struct options *options);
int verb_flicker(struct console *console, const struct options *options);
int verb_bench(struct console *console, const struct options *options);
int verb_report(struct console *console, const struct options *options);
int verb_view(struct console *console, const struct options *options);
int verb_list(struct console *console, const struct options *options);
int verb_cost(struct console *console, const struct options *options);
int verb_tune(struct console *console, const struct options *options);
int verb_capture(struct console *console, const struct options *options);
int verb_import(struct console *console, const struct options *options);
int verb_sweep(struct console *console, const struct options *options);

/* Reads argv[0..argc) after the verb. On false the error and a hint are logged. options_free either
 * way. */
bool options_parse(struct options *options, const struct verb *verb, int argc, char **argv,
                   const struct dt_log *log);
void options_free(struct options *options);
void options_help(const struct verb *verb);     /* on stdout */
void options_describe(const struct verb *verb); /* see command_describe */
