/* Starts this program once more; see apart.h. */
#include "compare/apart.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "console/tool.h"

enum { MOST_WORDS = 512 };

/* A command line: NULL behind the last word. */
struct words {
    char *list[MOST_WORDS + 1]; /* owned */
    uint32_t count;
    bool failed;
};

static void add(struct words *words, const char *word)
{
    words->failed =
        words->failed || words->count == MOST_WORDS || !(words->list[words->count] = strdup(word));
    words->count += !words->failed;
}

/* Nothing, where it has no value. */
static void add_option(struct words *words, const char *name, const char *value)
{
    if (!value)
        return;
    add(words, name);
    add(words, value);
}

static void add_edits(struct words *words, const char *edits)
{
    char *copy = strdup(edits ? edits : ""), *rest = NULL;
    words->failed |= !copy;
    for (char *edit = copy ? strtok_r(copy, "\n", &rest) : NULL; edit;
         edit = strtok_r(NULL, "\n", &rest))
        add_option(words, "--set", edit);
    free(copy);
}

static void add_spec(struct words *words, const struct setup *setup, const char *edits)
{
    add_option(words, "--spec", setup->spec);
    for (uint32_t i = 0; i < setup->set_count; i++)
        add_option(words, "--set", setup->sets[i]);
    add_edits(words, edits);
}

static void free_words(struct words *words)
{
    for (uint32_t i = 0; words && i < words->count; i++)
        free(words->list[i]);
    free(words);
}

static void fill(struct words *words, const struct compare_apart *apart)
{
    const struct setup *setup = apart->setup;
    char size[32], frames[16];
    snprintf(size, sizeof size, "%ux%u", apart->size[0], apart->size[1]);
    snprintf(frames, sizeof frames, "%u", apart->frames);
    add_option(words, "/proc/self/exe", "compare");
    add_option(words, "--backend", setup->backend);
    add_spec(words, setup, apart->edits);
    add_option(words, "--scene", setup->scene);
    add_option(words, "--scenes", setup->scenes);
    add_option(words, "--device", setup->device);
    if (setup->glsl)
        add(words, "--glsl");
    for (uint32_t i = 0; i < setup->inputs.count; i++)
        add_option(words, "--input", setup->inputs.items[i]);
    add_option(words, "--size", size);
    add_option(words, "--frames", frames);
    add_option(words, "--motion", apart->motion);
    add_option(words, "--bisect", apart->folder);
}

int compare_apart(struct console *console, const struct compare_apart *apart)
{
    struct words *words = calloc(1, sizeof *words);
    int status = -1;
    if (words)
        fill(words, apart);
    if (!words || words->failed)
        report_error(&console->log, "compare: out of memory, or more than %d words", MOST_WORDS);
    else
        status = tool_status(words->list, console);
    free_words(words);
    return status;
}

bool list_apart(struct console *console, const struct setup *setup, const char *edits,
                const char *gpu, const char *json)
{
    struct words *words = calloc(1, sizeof *words);
    if (words) {
        add_option(words, "/proc/self/exe", "list");
        add_spec(words, setup, edits);
        add_option(words, "--gpu", gpu);
        add_option(words, "--json", json);
    }
    bool good = words && !words->failed && tool_quiet(words->list, console);
    free_words(words);
    return good;
}
