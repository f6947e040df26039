/* See link.h. */
#include "link.h"

#include <pthread.h>
#include <spirv/unified1/GLSL.std.450.h>
#include <spirv/unified1/spirv.h>
#include <stdlib.h>
#include <string.h>

#include "exact_library.h" /* made of templates/glsl/exact.glsl by the build */

struct entry {
    const char *name; /* mangled */
    uint32_t function;
};

static struct {
    struct spirv module;
    struct entry *entries; /* sorted by name */
    uint32_t count;
} library;

static int by_name(const void *a, const void *b)
{
    return strcmp(((const struct entry *)a)->name, ((const struct entry *)b)->name);
}

static void read_library(void)
{
    struct spirv *module = &library.module;
    if (!spirv_open(module, exact_library, sizeof exact_library / sizeof *exact_library))
        return;
    library.entries = calloc(module->function_count + 1, sizeof *library.entries);
    for (uint32_t i = 0; library.entries && i < module->function_count; i++) {
        const char *name = spirv_name(module, module->functions[i].id);
        if (name)
            library.entries[library.count++] = (struct entry){name, i};
    }
    if (library.entries)
        qsort(library.entries, library.count, sizeof *library.entries, by_name);
}

bool spirv_library_start(void)
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    return !pthread_once(&once, read_library) && library.entries;
}

uint32_t spirv_library_hash(void)
{
    uint32_t hash = 2166136261u; /* FNV-1a, by words */
    for (size_t i = 0; i < sizeof exact_library / sizeof *exact_library; i++)
        hash = (hash ^ exact_library[i]) * 16777619u;
    return hash;
}

void spirv_link_begin(struct spirv_link *link, struct spirv_edit *edit)
{
    *link = (struct spirv_link){.edit = edit, .more = &library.module};
    edit->failed |= !spirv_library_start();
    if (edit->failed)
        return;
    link->ids = spirv_edit_alloc(edit, library.module.words[3], sizeof *link->ids);
    link->wanted = spirv_edit_alloc(edit, library.module.function_count, sizeof *link->wanted);
}

/* A type, constant or variable. */
static uint32_t link_declaration(struct spirv_link *link, const uint32_t *declaration)
{
    enum { MOST_OPERANDS = 60 };
    uint32_t operands[MOST_OPERANDS], count = 0, result = spirv_result_word(declaration);
    uint32_t opcode = spirv_opcode(declaration);
    if (!spirv_is_shared(opcode) || spirv_length(declaration) > MOST_OPERANDS) {
        link->ids[declaration[result]] = link->edit->bound++;
        spirv_link_copy(link, &link->edit->declarations, declaration);
        return link->ids[declaration[result]];
    }
    uint32_t type = result == 2 ? spirv_link_id(link, declaration[1]) : 0;
    for (uint32_t word = result + 1; word < spirv_length(declaration); word++)
        operands[count++] = spirv_is_literal(declaration, word)
                                ? declaration[word]
                                : spirv_link_id(link, declaration[word]);
    return spirv_declare(link->edit, opcode, type, operands, count);
}

static uint32_t want(struct spirv_link *link, uint32_t index)
{
    uint32_t id = library.module.functions[index].id;
    const char *name = spirv_name(&library.module, id);
    const struct spirv_function *own = NULL; /* diptych_zero() is the module's, where it has one */
    if (name && !strcmp(name, "diptych_zero("))
        own = spirv_find_function(link->edit->from, name);
    if (own)
        return link->ids[id] = own->id;
    link->wanted[link->wanted_count++] = index;
    return link->ids[id] = link->edit->bound++;
}

uint32_t spirv_link_id(struct spirv_link *link, uint32_t id)
{
    const struct spirv *more = link->more;
    size_t at = more->definitions[id];
    const uint32_t *i = more->words + at;
    if (link->ids[id])
        return link->ids[id];
    if (link->wanted && spirv_is(i, SpvOpFunction))
        return want(link, (uint32_t)(spirv_function_of(more, id) - more->functions));
    return link->ids[id] = link->wanted && spirv_is(i, SpvOpExtInstImport)
                               ? spirv_glsl(link->edit->from)
                           : at >= more->declarations && at < more->code ? link_declaration(link, i)
                                                                         : link->edit->bound++;
}

void spirv_link_copy(struct spirv_link *link, struct spirv_words *to, const uint32_t *instruction)
{
    for (uint32_t word = 1; word < spirv_length(instruction); word++)
        if (!spirv_is_literal(instruction, word))
            spirv_link_id(link, instruction[word]);
    spirv_copy_mapped(link->edit, to, instruction, link->ids);
}

uint32_t spirv_link_function(struct spirv_link *link, const char *name)
{
    struct entry wanted = {.name = name};
    const struct entry *entry =
        bsearch(&wanted, library.entries, library.count, sizeof wanted, by_name);
    if (!entry)
        return 0;
    uint32_t id = link->ids[library.module.functions[entry->function].id];
    return id ? id : want(link, entry->function);
}

static void copy_function(struct spirv_link *link, const struct spirv_function *function)
{
    struct spirv_edit *edit = link->edit;
    const char *name = spirv_name(&library.module, function->id);
    spirv_put_name(edit, link->ids[function->id], name ? name : "exact");
    SPIRV_EACH(&library.module, instruction, function->begin, function->end)
        if (!spirv_is(instruction, SpvOpLine) && !spirv_is(instruction, SpvOpNoLine))
            spirv_link_copy(link, &edit->code, instruction);
}

/* Marks the arithmetic of the library's code, from `begin` on; its min and max are NMin and NMax. */
static void mark_code(struct spirv_edit *edit, size_t begin)
{
    const struct spirv_words *code = &edit->code;
    for (size_t at = begin; !edit->failed && at < code->count;
         at += spirv_length(code->data + at)) {
        uint32_t *i = code->data + at;
        bool most = spirv_is(i, SpvOpExtInst) && i[4] == GLSLstd450FMax;
        bool least = spirv_is(i, SpvOpExtInst) && i[4] == GLSLstd450FMin;
        if (most || least)
            i[4] = most ? GLSLstd450NMax : GLSLstd450NMin;
        if (most || least || spirv_is_arithmetic(i))
            SPIRV_PUT(edit, &edit->annotations, SpvOpDecorate, i[2], SpvDecorationNoContraction);
    }
}

void spirv_link_end(struct spirv_link *link)
{
    size_t begin = link->edit->code.count;
    for (uint32_t i = 0; i < link->wanted_count; i++)
        copy_function(link, &library.module.functions[link->wanted[i]]);
    mark_code(link->edit, begin);
}
