/* The files of a pass's body: its own, and all that it may include. Which of them a stage includes is
 * glslang's decision: a name counts here in whichever branch of #if it stands. So what is asked of
 * these texts may be "yes" too often, never decides what a shader means, and saves work: which
 * declarations to write, what to read again when a file changes. */
#pragma once

#include <string.h>

#include "base/text.h"
#include "model/source.h"

struct body_file {
    const struct source *source;
    uint32_t number;  /* of #line: place in model->glsl_sources, from 1 */
    const char *name; /* the number as text: its name for glslang */
    const char *text; /* for glslang: that of the source, without #version */
    char *code; /* the text without comments and names of files, line by line; a module's names */
    const uint32_t *words; /* of a module, with its files' numbers; NULL: a text */
    size_t word_count;
};

static inline size_t body_text_length(const struct body_file *file)
{
    return file->words ? 0 : file->source->length;
}

struct body_include { /* #include "name" of a file */
    uint32_t from;    /* number of the file */
    const char *name;
    const struct body_file *file;
};

struct body_files {
    struct body_file *list; /* the body first */
    uint32_t count;
    struct body_include *includes;
    uint32_t include_count;
    bool whole;       /* a shader with #version, or a module, which has declarations of its own */
    unsigned version; /* the highest of the texts, 0: of none */
};

/* Of a pass's files, also NULL. */
static inline bool files_are_whole(const struct body_files *files)
{
    return files && files->whole;
}
/* Whether it is a module, or the text begins with #version, behind blanks and comments. */
bool source_is_whole(const struct source *source);
/* In the model's arena; #version becomes blanks in what `source` of a file holds. Names that lead nowhere are left out: glslang asks for them, or does not.
 * NULL when out of memory. */
const struct body_files *body_files_read(struct model *model, const struct source *body);
/* What `#include "name"` in the file of that number leads to; "": in the body. NULL: nothing. */
const struct body_file *body_include(const struct body_files *files, const char *from,
                                     const char *name);
/* Whether a file has the word as an identifier, not as a member behind a dot. */
bool body_mentions(const struct body_files *files, const char *word);
/* The same of a value's name, in whole shaders also "light_color" of a struct `light`. */
bool body_mentions_value(const struct body_files *files, const char *name);
/* The first place of the word as an identifier: the number of its file; 0: there is none. Later files first: those
 * of the fragment stage. */
uint32_t body_find(const struct body_files *files, const char *word, struct loc *loc);
/* Whether a file has the word behind a dot. */
bool body_mentions_member(const struct body_files *files, const char *word);
/* Whether a file has an identifier that begins so. */
bool body_mentions_prefix(const struct body_files *files, const char *prefix);
/* Whether an #if, #ifdef or #elif asks for the macro. */
bool body_asks_for(const struct body_files *files, const char *macro);

/* Reads the file at `path` once per model, into the table model->glsl_sources; NULL: cannot be read. */
const struct source *glsl_source(struct model *model, const char *path);
/* Adds a file that was read to the table, once. number: for #line, may be NULL. False when out of
 * memory. */
bool glsl_source_add(struct model *model, const struct source *source, uint32_t *number);

/* #version; NULL: the text, without comments, begins with something else. */
char *find_version(char *code);
/* Blanks instead of comments, in place; newlines stay. */
void blank_comments(char *at);
/* First occurrence of `word` as an identifier, not as a member behind a dot; NULL: none. */
const char *find_word(const char *text, const char *word);

/* ---- Scanning -------------------------------------------------------------------------------- */

struct token {
    const char *text; /* into the scanned text */
    size_t length;    /* 0: end of the text */
};
/* The next identifier, number or single character from *cursor; skips blanks, comments and
 * preprocessor lines. */
struct token token_next(const char **cursor);
static inline bool token_is(struct token token, const char *text)
{
    return token.length && *token.text == *text && !strncmp(token.text, text, token.length) &&
           !text[token.length];
}
/* Whether it is an identifier. */
static inline bool token_is_word(struct token token)
{
    return token.length && text_is_word(*token.text) && (*token.text < '0' || *token.text > '9');
}
