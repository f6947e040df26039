/* --run PROGRAM: blame on equal inputs, of other renderers. The second one's passes run again, on the first one's
 * resources:
 *
 *   PROGRAM PASS INPUTS OUTPUTS FRAME
 *
 * INPUTS has what the first dump left before the pass, RESOURCE.raw and RESOURCE.mip1.raw, each in the form in which the
 * second dump has that resource: format, fields, origin. PROGRAM runs the pass and taps it into OUTPUTS, a dump like any
 * other. See dumps.h. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "console/tool.h"
#include "theirs/dumps.h"

struct rerun {
    struct dumps *dumps;
    const struct match *pass; /* its first match */
    char *inputs, *outputs;   /* owned */
};

static bool same_pass(const struct match *a, const struct match *b)
{
    return !strcmp(a->sides[0]->pass, b->sides[0]->pass) &&
           a->sides[0]->frame == b->sides[0]->frame;
}

/* ---- Inputs ------------------------------------------------------------------------------------ */

/* The form in which the second renderer has a resource: that of its last entry before the pass. */
static const struct their_entry *form_of(const struct rerun *rerun, const struct their_entry *entry)
{
    const struct theirs *second = rerun->dumps->sides[1];
    const struct their_entry *form = NULL;
    for (uint32_t i = 0; i < second->count && &second->entries[i] != rerun->pass->sides[1]; i++)
        if (!strcmp(second->entries[i].resource, entry->resource) &&
            second->entries[i].mip == entry->mip)
            form = &second->entries[i];
    return form;
}

static bool write_input(const struct rerun *rerun, struct their_entry *entry)
{
    const struct dt_log *log = &rerun->dumps->console->log;
    const struct their_entry *form = form_of(rerun, entry);
    struct dt_bytes bytes;
    if (!theirs_load(rerun->dumps->sides[0], entry, &bytes))
        return false;
    const char *reason = form ? dumps_into(entry, form, &bytes) : NULL;
    char *mip = entry->mip ? format_string(".mip%u", entry->mip) : strdup("");
    char *word = sheet_word(entry->resource);
    char *path = mip && word ? format_string("%s/%s%s.raw", rerun->inputs, word, mip) : NULL;
    if (reason)
        report_error(log, "--run: %s as the second renderer has it: %s", entry->resource, reason);
    else if (!path)
        report_error(log, "out of memory");
    bool good = !reason && path && file_write(path, bytes.data, bytes.size, log);
    free(path);
    free(word);
    free(mip);
    free(bytes.data);
    return good;
}

/* Later entries of a resource replace earlier ones. */
static bool write_inputs(const struct rerun *rerun)
{
    struct theirs *first = rerun->dumps->sides[0];
    for (struct their_entry *entry = first->entries; entry < rerun->pass->sides[0]; entry++)
        if ((strcmp(entry->pass, rerun->pass->sides[0]->pass) != 0 ||
             entry->frame != rerun->pass->sides[0]->frame) &&
            !write_input(rerun, entry))
            return false;
    return true;
}

/* ---- Outputs ----------------------------------------------------------------------------------- */

/* Its difference from the first dump's is the pass's own error. */
static bool judge(const struct rerun *rerun, struct theirs *outputs, struct match *match)
{
    const struct theirs *const sides[2] = {rerun->dumps->sides[0], outputs};
    struct their_entry wanted = *match->sides[0], *kept = match->sides[1];
    struct dt_bytes copies[2] = {0};
    bool same = false;
    match->sides[1] = dumps_partner(outputs, &wanted, 0);
    wanted.frame = 0;
    if (!match->sides[1])
        match->sides[1] = dumps_partner(outputs, &wanted, 0);
    bool good = match->sides[1] && dumps_load(sides, match, copies, &same);
    if (!match->sides[1])
        report_error(sides[0]->log, "--run: %s left no resource %s of pass %s",
                     rerun->dumps->options->run_second, match->name, wanted.pass);
    else if (good && !same)
        report_error(sides[0]->log, "--run: %s: %s", match->place, match->note);
    good = good && same && dumps_judge(rerun->dumps, sides, match, copies, &match->own);
    free(copies[0].data);
    free(copies[1].data);
    match->row->own = good ? &match->own : NULL;
    if (good && difference_verdict(&match->own) == VERDICT_DIFFERS) {
        if (!rerun->dumps->guilty)
            rerun->dumps->guilty = match;
        if (same_pass(match, rerun->dumps->guilty))
            good = dumps_ask_why(rerun->dumps, sides, match);
    }
    match->sides[1] = kept;
    return good;
}

static bool judge_all(const struct rerun *rerun)
{
    struct theirs outputs = {0};
    struct dumps *dumps = rerun->dumps;
    bool good = theirs_open(&outputs, rerun->outputs, &dumps->console->log);
    for (uint32_t i = 0; i < dumps->count && good; i++)
        if (dumps->matches[i].sides[1] && dumps->matches[i].row->compared &&
            same_pass(&dumps->matches[i], rerun->pass))
            good = judge(rerun, &outputs, &dumps->matches[i]);
    theirs_close(&outputs);
    return good;
}

/* ---- A pass ------------------------------------------------------------------------------------ */

static bool run_program(const struct rerun *rerun)
{
    const struct tool tool = {.what = "running a pass of the second renderer",
                              .hint = "--run takes a program, without arguments"};
    char frame[16];
    snprintf(frame, sizeof frame, "%u", rerun->pass->sides[0]->frame);
    char *const argv[] = {(char *)rerun->dumps->options->run_second,
                          rerun->pass->sides[0]->pass,
                          rerun->inputs,
                          rerun->outputs,
                          frame,
                          NULL};
    return tool_run(&tool, argv, -1, rerun->dumps->console);
}

static bool run_pass(struct dumps *dumps, const struct match *pass)
{
    const char *place = getenv("TMPDIR");
    char *folder = format_string("%s/diptych-XXXXXX", place && *place ? place : "/tmp");
    struct rerun rerun = {.dumps = dumps, .pass = pass};
    if (!folder || !mkdtemp(folder)) {
        report_error(&dumps->console->log, "--run: no temporary folder: %s", strerror(errno));
        free(folder);
        return false;
    }
    console_temporary(dumps->console, folder);
    rerun.inputs = format_string("%s/inputs", folder);
    rerun.outputs = format_string("%s/outputs", folder);
    bool good = rerun.inputs && rerun.outputs &&
                file_make_folders(rerun.inputs, &dumps->console->log) && write_inputs(&rerun) &&
                run_program(&rerun) && judge_all(&rerun);
    file_remove_tree(folder);
    console_forget(dumps->console, folder);
    free(rerun.inputs);
    free(rerun.outputs);
    free(folder);
    return good;
}

/* Whether a resource of the pass differs, and it is the pass's first. */
static bool is_wanted(const struct dumps *dumps, uint32_t index)
{
    bool differs = false;
    for (uint32_t i = 0; i < dumps->count; i++) {
        const struct match *match = &dumps->matches[i];
        if (!same_pass(match, &dumps->matches[index]) || !match->sides[1])
            continue;
        if (i < index)
            return false;
        differs |=
            match->row->compared && difference_verdict(&match->row->difference) == VERDICT_DIFFERS;
    }
    return differs;
}

bool dumps_run(struct dumps *dumps)
{
    if (!dumps->first->row->compared)
        return true; /* of another size or kind: on any inputs */
    dumps->guilty = NULL;
    for (uint32_t i = 0; i < dumps->count; i++)
        if (is_wanted(dumps, i) && !run_pass(dumps, &dumps->matches[i]))
            return false;
    return true;
}
