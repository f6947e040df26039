/* Starts this program once more; see apart.h. */
#include "compare/apart.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "console/tool.h"

static void add_edits(struct words *words, const char *edits)
{
    char *copy = strdup(edits ? edits : ""), *rest = NULL;
    words->failed |= !copy;
    for (char *edit = copy ? strtok_r(copy, "\n", &rest) : NULL; edit;
         edit = strtok_r(NULL, "\n", &rest))
        words_pair(words, "--set", edit);
    free(copy);
}

static void fill(struct words *words, const struct compare_apart *apart)
{
    const struct setup *setup = apart->setup;
    char size[32], frames[16];
    snprintf(size, sizeof size, "%ux%u", apart->size[0], apart->size[1]);
    snprintf(frames, sizeof frames, "%u", apart->frames);
    words_pair(words, "/proc/self/exe", "compare");
    words_pair(words, "--backend", setup->backend);
    words_pair(words, "--spec", setup->spec);
    for (uint32_t i = 0; i < setup->set_count; i++)
        words_pair(words, "--set", setup->sets[i]);
    add_edits(words, apart->edits);
    words_pair(words, "--scene", setup->scene);
    words_pair(words, "--scenes", setup->scenes);
    words_pair(words, "--device", setup->device);
    if (setup->glsl)
        words_add(words, "--glsl");
    for (uint32_t i = 0; i < setup->inputs.count; i++)
        words_pair(words, "--input", setup->inputs.items[i]);
    words_pair(words, "--size", size);
    words_pair(words, "--frames", frames);
    words_pair(words, "--motion", apart->motion);
    words_pair(words, "--bisect", apart->folder);
}

int compare_apart(struct console *console, const struct compare_apart *apart)
{
    struct words words = {0};
    int status = -1;
    fill(&words, apart);
    if (words.failed)
        report_error(&console->log, "compare: out of memory, or more than %d words", TOOL_WORDS);
    else
        status = tool_status(words.list, console);
    words_free(&words);
    return status;
}
