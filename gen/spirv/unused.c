/* Warnings about names that a pass lists and its shaders do not use. What a module still holds
 * behind spirv_reach is used; names that leave no trace there, since they are constants or
 * targets, count as used where the body has the word. */
#include <spirv/unified1/spirv.h>
#include <string.h>

#include "read/body_files.h"
#include "plan/plan.h"
#include "model/module.h"
#include "model/names.h"
#include "shaders.h"

/* Whether a stage has a resource at the binding. */
static bool has_binding(const struct pass_shaders *shaders, int binding)
{
    for (int stage = 0; stage < 3; stage++) {
        const struct shader *shader = &shaders->stage[stage];
        for (size_t at = SPIRV_HEADER; at < shader->word_count; at += shader->words[at] >> 16)
            if (spirv_is(shader->words + at, SpvOpDecorate) &&
                shader->words[at + 2] == SpvDecorationBinding &&
                shader->words[at + 3] == (uint32_t)binding)
                return true;
    }
    return false;
}

/* Whether a stage has the function `name`, of whatever parameters. */
static bool has_function(const struct pass_shaders *shaders, const char *name)
{
    size_t length = strlen(name);
    for (int stage = 0; stage < 3; stage++) {
        const struct shader *shader = &shaders->stage[stage];
        for (size_t at = SPIRV_HEADER; at < shader->word_count; at += shader->words[at] >> 16) {
            const char *found = (const char *)(shader->words + at + 2);
            if (spirv_is(shader->words + at, SpvOpName) && !strncmp(found, name, length) &&
                found[length] == '(')
                return true;
        }
    }
    return false;
}

static bool mentions(const struct pass *pass, const char *name, const char *ending)
{
    char word[256];
    snprintf(word, sizeof word, "%s%s", name, ending);
    return body_mentions(pass->files, word);
}

static bool reads_by_range(const struct pass *pass, const struct access *access)
{
    EACH(range, pass->ranges, pass->range_count)
        if ((range->of && !strcmp(range->of, access->name) &&
             body_mentions(pass->files, range->name)) ||
            find_word(range->first, access_word(access)))
            return true;
    return false;
}

/* Depth targets, indirect arguments and indices need no name in the body. */
static bool is_silent(const struct pass *pass, const struct access *access)
{
    const struct resource *resource = access->resource;
    return !resource || resource->internal ||
           (resource->kind == DT_IMAGE && resource->format == DT_FORMAT_D32F &&
            access->mode != MODE_READ) ||
           resource == pass->indirect_resource || resource == pass->index_resource;
}

static void check_access(const struct pass *pass, const struct pass_shaders *shaders,
                         const struct access *access, struct diag *diag)
{
    static const char *const lists[] = {"reads", "writes", "updates"};
    const char *word = access_word(access);
    bool target = access->kind & DT_WRITE_COLOR;
    if (is_silent(pass, access) || (target && files_are_whole(pass->files)) ||
        reads_by_range(pass, access) || mentions(pass, word, "_count") ||
        mentions(pass, word, "_size") || (target && body_mentions(pass->files, word)) ||
        (!target && access->binding >= 0 && has_binding(shaders, access->binding)))
        return;
    diag_warning(diag, access->loc, "the pass `%s` lists `%s` in %s but does not use it",
                 pass->name, word, lists[access->mode]);
}

static void check_tools(const struct pipeline *pipeline, const struct pass *pass,
                        const struct pass_shaders *shaders, struct diag *diag)
{
    const unsigned kinds = DECLARED_FUNCTION & ~(unsigned)DECLARED_FILTER;
    for (uint32_t i = 0; i < pass->use_count; i++) {
        const char *name = pass->uses[i];
        bool used = has_function(shaders, name) || !declared_find(pipeline, kinds, name) ||
                    (pass->interleave_name && !strcmp(pass->interleave_name, name));
        EACH(derived, derived_words, DERIVED_WORDS)
            used = used || (derived->kinds & kinds && mentions(pass, name, derived->ending));
        if (!used)
            diag_warning(diag, pass->use_locs[i],
                         "the pass `%s` lists `%s` in uses but does not use it", pass->name, name);
    }
}

void check_listed(const struct model *model, const struct pass_shaders *shaders, struct diag *diag)
{
    const struct pipeline *pipeline = &model->pipeline;
    for (uint32_t p = 0; p < pipeline->pass_count; p++) {
        const struct pass *pass = pipeline->order[p];
        for (uint32_t i = 0; pass->files && i < pass->access_count; i++)
            check_access(pass, &shaders[p], &pass->accesses[i], diag);
        for (uint32_t i = 0; i < pass->range_count; i++)
            if (!body_mentions(pass->files, pass->ranges[i].name))
                diag_warning(diag, pass->ranges[i].loc,
                             "the pass `%s` does not iterate over its range `%s`", pass->name,
                             pass->ranges[i].name);
        EACH(define, pass->defines, pass->define_count)
            if (!define->word && !body_mentions(pass->files, define->name))
                diag_warning(diag, define->loc, "the pass `%s` defines `%s` but does not use it",
                             pass->name, define->name);
        check_tools(pipeline, pass, &shaders[p], diag);
    }
}
