/* What a comparison of two sides shows, whatever is compared: its table, the rows of its page, its pictures,
 * and JUnit's XML. */
#ifndef DIPTYCH_SHEET_H
#define DIPTYCH_SHEET_H

#include "console/console.h"
#include "result/difference.h"
#include "result/strip.h"

/* Pictures and histogram of a row. Takes a zeroed one. */
enum { SHOWN_PICTURES = 3 };
struct shown {
    char *strip;       /* --pictures: path of the strip, NULL: none; owned */
    struct strip what; /* that the pictures show */
    /* --html: names of first copy, second copy and difference; of equal copies the first; owned */
    char *files[SHOWN_PICTURES];
    uint64_t bins[DIFFERENCE_BINS];
};

/* A resource after a pass. All pointers are borrowed and live as long as the sheet; may be NULL unless said. */
struct sheet_row {
    const char *pass, *name;            /* not NULL; name: of the resource, with mip and frame */
    const struct dt_resource *resource; /* NULL: nothing was compared, */
    const struct difference *difference;
    const char *verdict; /* and this stands instead */
    const char *text;    /* in place of the largest error */
    const char *note;    /* one line below the row */
    const char *body;    /* file of the shader */
    char own[40];        /* below struct sheet's `columns` */
    const struct shown *shown;
};

struct sheet {
    const char *title;      /* of the suite in JUnit's XML */
    const char *labels[2];  /* of the sides */
    const char *devices[2]; /* or folders of dumps; NULL: not in the XML */
    const char *columns;    /* heading above `own` of the rows; NULL: none */
    struct sheet_row *rows;
    uint32_t count;
};

void sheet_print(const struct sheet *sheet); /* on stdout */

/* The largest error of a row, or its text; free(). */
char *sheet_worst(const struct sheet *sheet, const struct sheet_row *row);

/* Adds to each object of the list, one per row, what templates/report/compare.html shows beyond --json. */
void sheet_page(const struct sheet *sheet, struct cJSON *results);

/* Writes JUnit's XML, a suite for each sheet. False: logged. */
bool sheet_junit(const struct sheet *sheets, uint32_t count, const char *path,
                 struct console *console);

/* Folders of --pictures and --html, or NULL, and what names of files begin with. */
struct sheet_files {
    const char *pictures, *html, *stem;
};
/* Writes what the folders show of two copies of one size, in place of earlier pictures of the same stem; a histogram for
 * --html. Needs no copies where sheet_shows is false. False: logged. */
bool sheet_shows(const struct sheet_files *files, const struct dt_resource *resource,
                 const struct difference *difference);
bool sheet_draw(struct shown *shown, const struct sheet_files *files,
                const struct dt_resource *resource, const struct difference *difference,
                const struct dt_bytes copies[2], const struct dt_log *log);
void sheet_free_shown(struct shown *shown);

/* Characters other than letters, digits, ".", "-", "+" and "_" become _: for names of files. free(). */
char *sheet_word(const char *text);

#endif
