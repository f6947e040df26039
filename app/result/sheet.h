/* The record of a comparison of two sides, whatever gives their rows. Those who compare fill it; table, JSON, page and
 * JUnit's XML read it. */
#pragma once

#include "console/options.h"
#include "result/contracts.h"
#include "result/difference.h"
#include "picture/strip.h"

struct cJSON;

/* Pictures and histogram of a row. Takes a zeroed one. */
enum { SHOWN_PICTURES = 3 };
struct shown {
    char *strip;       /* --pictures: path of the strip, NULL: none; owned */
    struct strip what; /* that the pictures show */
    /* --html: names of first copy, second copy and difference; of equal copies the first; owned */
    char *files[SHOWN_PICTURES];
    uint64_t bins[DIFFERENCE_BINS];
};

/* --measure: errors of all runs. */
struct row_errors {
    struct errors noise[2], between;
    struct errors
        exact; /* of both sides, against exact twins on equal inputs; no pairs: not judged */
};

/* A resource after a pass. Pointers are borrowed and live as long as the sheet, and may be NULL, unless said. */
struct sheet_row {
    const char *pass;                   /* not NULL */
    const char *name;                   /* not NULL: of the resource, with mip and frame */
    const char *key;                    /* not NULL: in contracts */
    const struct dt_resource *resource; /* not NULL */
    const struct kept_contract *kept;   /* of --contracts */
    int mip;                            /* -1: it has no other */
    uint32_t frame, frames_differing;
    bool differs;  /* bits, in the frame that broke a contract first, else in the last */
    uint64_t hash; /* of the first side's content, in the same frame */
    bool compared;
    struct difference difference; /* of the frame with the largest; `compared` alone */
    const char *verdict;          /* where nothing was compared */
    const char *text;             /* in place of the largest error */
    const char *note;             /* one line below the row */
    const char *body;             /* file of the shader */
    const char *inputs;           /* of the pass: "equal", "differ" */
    const struct difference *own; /* the pass's own error, on equal inputs */
    struct shown shown;           /* owned */
    struct cJSON *why;            /* {"why": [{"name", "text", "before", "after"}]}; owned */
    struct row_errors *errors;    /* owned */
};

/* What happened at a row. */
struct sheet_event {
    const struct sheet_row *row; /* NULL: it did not happen */
    uint32_t frame;
    struct cJSON *more; /* an object, whose members JSON has, too; owned; may be NULL */
};

/* Rows: those before the first frame, the results, and those that the second side alone has. */
struct sheet {
    const char *pipeline;   /* NULL: dumps, without a spec */
    const char *labels[2];  /* of the sides */
    const char *devices[2]; /* or folders of dumps; NULL: not told */
    struct sheet_row *rows;
    uint32_t count, early, alone; /* all, the first, the last */
    bool lone;                    /* all rows are of one pass, whose name is not shown */
    bool blames;                  /* `inputs` and `own` of rows are shown */
    bool agree;
    bool on_equal_inputs; /* the results are the passes' own errors */
    struct sheet_event first_break, guilty, not_repeatable;
    struct sheet_event not_finite; /* both agree, and leave NaN or Inf */
    enum measured_kind kind;       /* of the sides' difference */
    uint32_t runs;                 /* --measure, of each side; 0: was not asked for */
};

bool sheet_begin(struct sheet *sheet, uint32_t rows, const struct dt_log *log); /* false: logged */
void sheet_free(struct sheet *sheet); /* takes a zeroed one */
bool sheet_is_early(const struct sheet *sheet, const struct sheet_row *row);

/* An event with an empty `more`. */
struct sheet_event sheet_event(const struct sheet_row *row, uint32_t frame);
/* Keeps the first of the results whose copies agree in that frame, but have NaN or Inf. */
void sheet_note_odd(struct sheet *sheet, const struct sheet_row *row, uint32_t frame,
                    const struct difference *found);
/* Whether no contract is broken and no number odd. Where the sides differ, nothing is told of odd ones. */
bool sheet_agrees(struct sheet *sheet, bool differs);
/* Prints "both agree; pass NAME leaves NaN". False: no pass does, and nothing is printed. */
bool sheet_print_odd(const struct sheet *sheet);

void sheet_print(const struct sheet *sheet); /* the table, on stdout */

/* The largest error of a row, or its text; free(). */
char *sheet_worst(const struct sheet *sheet, const struct sheet_row *row);
/* "none", "3 differ": the pass's own error. */
void sheet_write_own(const struct sheet_row *row, char text[32]);

/* JSON of a row, and of all; of `count` sheets: a single one stands in the root, of several each in "pairs", and the
 * root has the outcome of the first that differs. */
void sheet_row_json(struct cJSON *root, const struct sheet *sheet, const struct sheet_row *row);
void sheets_json(struct cJSON *root, const struct sheet *const *sheets, uint32_t count);
const struct sheet *sheets_told(const struct sheet *const *sheets, uint32_t count);

/* Adds "pairs": JSON with what the page shows beyond it. */
void sheets_page(struct cJSON *page, const struct sheet *const *sheets, uint32_t count);
/* Writes --html and --junit: app/python/diptych/comparison.py fills templates/report/compare.html and junit.xml. Deletes the
 * page. False: logged. */
bool sheets_write(struct cJSON *page, const struct options *options, struct console *console);

/* Folders of --pictures and --html, or NULL. */
struct sheet_files {
    const char *pictures, *html;
    bool several; /* pairs: names of files have the second side's label */
};
/* Writes what the folders show of two copies of one size, in place of earlier pictures of the row; a histogram for
 * --html. Names of files are like 07.PASS.NAME. Needs no copies where sheet_shows is false. False: logged. */
bool sheet_shows(const struct sheet_files *files, const struct sheet_row *row);
bool sheet_draw(const struct sheet *sheet, struct sheet_row *row, const struct sheet_files *files,
                uint32_t number, const char *name, const struct dt_bytes copies[2],
                const struct dt_log *log);
