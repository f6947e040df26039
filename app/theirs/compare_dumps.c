/* `diptych compare A B...`: dumps of renderers, no spec; the first is compared with each of the others. Python makes dumps of
 * captures (app/python/diptych/rdc/compare.py), and then calls this. */
#include "theirs/compare_dumps.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/files.h"
#include "console/python.h"
#include "theirs/dumps.h"

/* ---- Sides ------------------------------------------------------------------------------------- */

struct comparison {
    struct console *console;
    const struct options *options;
    struct theirs *dumps; /* `runs` of each side, side by side */
    char **folders;       /* of each run; owned */
    bool *versions;       /* per side: its backend is the first side's */
    uint32_t sides, runs;
    struct contracts contracts;
    const char **names; /* that contracts may have; borrowed of matches */
    struct dumps *pairs;
    const struct sheet **sheets; /* of the pairs */
    uint32_t pair_count;
};

static int is_shown(const struct dirent *file)
{
    return file->d_name[0] != '.';
}

/* The folders in a folder, in the order of their names. */
static bool list_runs(const struct comparison *comparison, const char *folder, char **folders)
{
    struct dirent **files = NULL;
    int count = scandir(folder, &files, is_shown, alphasort);
    uint32_t found = 0;
    for (int i = 0; i < count; i++) {
        char *path = format_string("%s/%s", folder, files[i]->d_name);
        struct stat info;
        bool run = path && stat(path, &info) == 0 && S_ISDIR(info.st_mode);
        if (run && found < comparison->runs)
            folders[found] = path;
        else
            free(path);
        found += run;
        free(files[i]);
    }
    free(files);
    if (found != comparison->runs)
        report_error(&comparison->console->log,
                     "%s: --measure %u needs %u dumps, in folders of their own; it has %u", folder,
                     comparison->runs, comparison->runs, found);
    return found == comparison->runs;
}

static bool open_all(struct comparison *comparison)
{
    const struct options *options = comparison->options;
    const struct dt_log *log = &comparison->console->log;
    uint32_t runs = comparison->runs, count = comparison->sides * runs;
    comparison->dumps = calloc(count, sizeof *comparison->dumps);
    comparison->folders = calloc(count, sizeof *comparison->folders);
    comparison->versions = calloc(comparison->sides, sizeof *comparison->versions);
    if (!comparison->dumps || !comparison->folders || !comparison->versions)
        return report_error(log, "out of memory");
    for (uint32_t side = 0; side < comparison->sides; side++) {
        char **folders = &comparison->folders[side * runs];
        if (options->repeats && !list_runs(comparison, options->dumps.items[side], folders))
            return false;
        if (!options->repeats)
            folders[0] = strdup(options->dumps.items[side]);
        for (uint32_t i = 0; i < runs; i++)
            if (!folders[i] || !theirs_open(&comparison->dumps[side * runs + i], folders[i], log))
                return false;
        comparison->versions[side] =
            comparison->dumps[0].manifest && comparison->dumps[side * runs].manifest &&
            !strcmp(comparison->dumps[0].label, comparison->dumps[side * runs].label);
    }
    return true;
}

static bool set_label(struct comparison *comparison, uint32_t side, const char *label)
{
    struct theirs *theirs = &comparison->dumps[side * comparison->runs];
    char *copy = strdup(label);
    if (!copy)
        report_error(&comparison->console->log, "out of memory");
    free(theirs->label);
    theirs->label = copy;
    return copy;
}

/* Sides of one label, as two dumps of one backend have, are "first", "second"...; several runs of a side have its folder's name. */
static bool tell_apart(struct comparison *comparison)
{
    static const char *const names[] = {"first", "second", "third", "fourth", "fifth", "sixth"};
    bool repeated = false;
    for (uint32_t i = 0; i < comparison->sides; i++) {
        struct theirs *theirs = &comparison->dumps[i * comparison->runs];
        const char *folder = comparison->options->dumps.items[i], *slash = strrchr(folder, '/');
        if (comparison->runs > 1 && !theirs->manifest &&
            !set_label(comparison, i, slash && slash[1] ? slash + 1 : folder))
            return false;
        for (uint32_t k = 0; k < i; k++)
            repeated |= !strcmp(theirs->label, comparison->dumps[k * comparison->runs].label);
    }
    for (uint32_t i = 0; i < comparison->sides && repeated; i++) {
        char number[16];
        snprintf(number, sizeof number, "#%u", i + 1);
        if (!set_label(comparison, i, i < DT_ARRAY_COUNT(names) ? names[i] : number))
            return false;
    }
    return true;
}

/* Whether the buffers of floats that contracts name are in the first dump. */
static bool has_margins(const struct comparison *comparison)
{
    const struct contracts *contracts = &comparison->contracts;
    bool good = true;
    for (uint32_t i = 0; i < contracts->count; i++) {
        const struct kept_contract *kept = &contracts->list[i];
        bool found = !kept->margin;
        for (uint32_t k = 0; k < comparison->dumps[0].count && !found; k++) {
            const struct their_entry *entry = &comparison->dumps[0].entries[k];
            found = entry->described ? contracts_margin(kept, &entry->what) >= 0
                                     : !strcmp(entry->resource, kept->margin);
        }
        if (!found)
            report_error(
                &comparison->console->log,
                "%s: %s: margin: the first dump has no buffer of floats, and no float of a buffer, "
                "called %s",
                comparison->options->contracts, kept->name, kept->margin);
        good &= found;
    }
    return good;
}

static bool read_contracts(struct comparison *comparison)
{
    uint32_t count = 0, all = 1;
    for (uint32_t i = 0; i < comparison->pair_count; i++)
        all += 2 * comparison->pairs[i].count;
    comparison->names = calloc(all, sizeof *comparison->names);
    if (!comparison->names)
        return report_error(&comparison->console->log, "out of memory");
    comparison->names[count++] = "default";
    for (uint32_t i = 0; i < comparison->pair_count; i++)
        for (uint32_t k = 0; k < comparison->pairs[i].count; k++) {
            comparison->names[count++] = comparison->pairs[i].matches[k].sides[0]->resource;
            comparison->names[count++] = comparison->pairs[i].matches[k].place;
        }
    return contracts_read(&comparison->contracts, comparison->options->contracts, comparison->names,
                          count, &comparison->console->log) &&
           has_margins(comparison);
}

/* ---- The verb ---------------------------------------------------------------------------------- */

static bool pair_up(struct comparison *comparison)
{
    uint32_t count = comparison->sides - 1, runs = comparison->runs;
    comparison->pairs = calloc(comparison->sides, sizeof *comparison->pairs);
    comparison->sheets = calloc(comparison->sides, sizeof *comparison->sheets);
    if (!comparison->pairs || !comparison->sheets)
        return report_error(&comparison->console->log, "out of memory");
    comparison->pair_count = count;
    for (uint32_t i = 0; i < count; i++) {
        struct dumps *dumps = &comparison->pairs[i];
        struct theirs *other = &comparison->dumps[(i + 1) * runs];
        *dumps = (struct dumps){
            .console = comparison->console,
            .options = comparison->options,
            .contracts = &comparison->contracts,
            .sides = {&comparison->dumps[0], other},
            .runs = runs,
            .several = count > 1,
            .sheet = {.labels = {comparison->dumps[0].label, other->label},
                      .devices = {theirs_source(&comparison->dumps[0]), theirs_source(other)},
                      .runs = comparison->options->repeats,
                      .kind = comparison->versions[i + 1] ? MEASURED_DRIFT : MEASURED_BACKENDS}};
        comparison->sheets[i] = &dumps->sheet;
        if (!dumps_match(dumps))
            return false;
    }
    return !comparison->options->contracts || read_contracts(comparison);
}

static bool write_pages(const struct comparison *comparison)
{
    cJSON *page = cJSON_CreateObject();
    cJSON_AddStringToObject(page, "pipeline", "");
    sheets_page(page, comparison->sheets, comparison->pair_count);
    return sheets_write(page, comparison->options, comparison->console);
}

static bool write_files(const struct comparison *comparison)
{
    const struct options *options = comparison->options;
    const struct sheet *const *sheets = comparison->sheets;
    struct console *console = comparison->console;
    uint32_t count = comparison->pair_count;
    bool good = ((!options->html && !options->junit) || write_pages(comparison)) &&
                (!options->write_contracts ||
                 measured_write(sheets, count, options->write_contracts, console));
    if (good && options->json)
        sheets_json(console->result = cJSON_CreateObject(), sheets, count);
    return good;
}

static bool has_captures(const struct options *options)
{
    for (uint32_t i = 0; i < options->dumps.count; i++) {
        const char *name = options->dumps.items[i];
        size_t length = strlen(name);
        if (length > 4 && !strcmp(name + length - 4, ".rdc"))
            return true;
    }
    return false;
}

static bool check_options(const struct console *console, const struct options *options)
{
    const struct dt_log *log = &console->log;
    const char *wrong = NULL;
    if (options->dumps.count < 2)
        wrong = "two dumps are needed: compare A B";
    else if (options->setup.spec || options->setup.scene || options->setup.against ||
             options->golden || options->bisect)
        wrong = "dumps take --contracts, --measure, --write-contracts, --html, --junit, --pictures "
                "and --json alone";
    else if (options->write_contracts && !options->repeats)
        wrong = "--write-contracts needs --measure N";
    else if (!has_captures(options) &&
             (options->match || options->draws || options->save || options->trust))
        wrong = "--match, --draws, --save and --trust are for captures";
    if (wrong)
        report_error(log, "compare: %s", wrong);
    return !wrong && (!options->html || file_make_folders(options->html, log)) &&
           (!options->pictures || file_make_folders(options->pictures, log)) &&
           (!options->junit || file_can_write(options->junit, log)) &&
           (!options->write_contracts || file_can_write(options->write_contracts, log));
}

static void release(struct comparison *comparison)
{
    for (uint32_t i = 0; i < comparison->pair_count; i++)
        dumps_free(&comparison->pairs[i]);
    free(comparison->pairs);
    free(comparison->sheets);
    for (uint32_t i = 0; i < comparison->sides * comparison->runs; i++) {
        if (comparison->dumps)
            theirs_close(&comparison->dumps[i]);
        if (comparison->folders)
            free(comparison->folders[i]);
    }
    contracts_free(&comparison->contracts);
    free(comparison->names);
    free(comparison->dumps);
    free(comparison->folders);
    free(comparison->versions);
}

int compare_dumps(struct console *console, const struct options *options)
{
    struct comparison comparison = {.console = console,
                                    .options = options,
                                    .sides = options->dumps.count,
                                    .runs = options->repeats ? options->repeats : 1};
    bool differ = false;
    if (!check_options(console, options))
        return EXIT_USAGE;
    if (has_captures(options))
        return python_verb(console, "compare", options_json(options, VERB_COMPARE));
    bool good = open_all(&comparison) && tell_apart(&comparison) && pair_up(&comparison);
    for (uint32_t i = 0; i < comparison.pair_count && good; i++) {
        good = dumps_compare(&comparison.pairs[i]);
        dumps_conclude(&comparison.pairs[i]);
        differ |= !comparison.pairs[i].sheet.agree;
    }
    for (uint32_t i = 0; i < comparison.pair_count && good; i++)
        good = dumps_print(&comparison.pairs[i]);
    good = good && write_files(&comparison);
    release(&comparison);
    return !good ? EXIT_USAGE : differ ? EXIT_DIFFER : EXIT_FINE;
}
