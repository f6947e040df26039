/* Shaders of slang.h. RetroArch looks at #include and #pragma before the preprocessor does: in every
 * branch of #if. */
#include "import/slang.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "base/log.h"
#include "import/import.h"

enum { MOST_DEPTH = 32, MOST_INCLUDES = 4096, MOST_PARAMS = 8192 };

struct slang_reading {
    struct slang *slang;
    const struct dt_log *log;
    const char *stage; /* macro of the stage whose lines these are; NULL: of both */
    unsigned depth, includes;
};

/* What RetroArch puts into paths: for the driver Vulkan, nothing turned, a wide screen. */
static char *replace_words(const char *path)
{
    static const char *const words[][2] = {{"$VID-DRV$", "vulkan"},
                                           {"$VID-DRV-SHADER-EXT$", "slang"},
                                           {"$VID-DRV-PRESET-EXT$", "slangp"},
                                           {"$CORE-REQ-ROT$", "CORE-REQ-ROT-0"},
                                           {"$VID-ALLOW-CORE-ROT$", "VID-ALLOW-CORE-ROT-OFF"},
                                           {"$VID-USER-ROT$", "VID-USER-ROT-0"},
                                           {"$VID-FINAL-ROT$", "VID-FINAL-ROT-0"},
                                           {"$SCREEN-ORIENT$", "SCREEN-ORIENT-0"},
                                           {"$VIEW-ASPECT-ORIENT$", "VIEW-ASPECT-ORIENT-HORZ"},
                                           {"$CORE-ASPECT-ORIENT$", "CORE-ASPECT-ORIENT-HORZ"}};
    struct text out = {0};
    for (const char *at = path; *at;) {
        size_t i = 0;
        while (i < DT_ARRAY_COUNT(words) && strncmp(at, words[i][0], strlen(words[i][0])) != 0)
            i++;
        text_add(&out, i < DT_ARRAY_COUNT(words) ? "%s" : "%.1s",
                 i < DT_ARRAY_COUNT(words) ? words[i][1] : at);
        at += i < DT_ARRAY_COUNT(words) ? strlen(words[i][0]) : 1;
    }
    return out.data;
}

char *slang_path(const char *from, const char *name)
{
    const char *slash = strrchr(from, '/');
    char *path = *name == '/' || !slash ? format_string("%s", name)
                                        : format_string("%.*s/%s", (int)(slash - from), from, name);
    for (char *at = path; at && *at; at++) /* of Windows */
        if (*at == '\\')
            *at = '/';
    char *replaced = path && strchr(path, '$') ? replace_words(path) : NULL;
    if (replaced && file_exists(replaced)) { /* else a file may have the word itself in its name */
        free(path);
        return replaced;
    }
    free(replaced);
    return path;
}

/* ---- Pragmas --------------------------------------------------------------------------------- */

/* R16G16_SFLOAT is rg16f. */
static const char *format_named(const char *name)
{
    static const struct {
        const char *vulkan, *ours;
    } formats[] = {{"R8_UNORM", "r8"},
                   {"R8_UINT", "r8ui"},
                   {"R8_SINT", "r8i"},
                   {"R8G8_UNORM", "rg8"},
                   {"R8G8_UINT", "rg8ui"},
                   {"R8G8_SINT", "rg8i"},
                   {"R8G8B8A8_UNORM", "rgba8"},
                   {"R8G8B8A8_UINT", "rgba8ui"},
                   {"R8G8B8A8_SINT", "rgba8i"},
                   {"R8G8B8A8_SRGB", "rgba8_srgb"},
                   {"A2B10G10R10_UNORM_PACK32", "rgb10a2"},
                   {"R16_UINT", "r16ui"},
                   {"R16_SINT", "r16i"},
                   {"R16_SFLOAT", "r16f"},
                   {"R16G16_UINT", "rg16ui"},
                   {"R16G16_SINT", "rg16i"},
                   {"R16G16_SFLOAT", "rg16f"},
                   {"R16G16B16A16_UINT", "rgba16ui"},
                   {"R16G16B16A16_SINT", "rgba16i"},
                   {"R16G16B16A16_SFLOAT", "rgba16f"},
                   {"R32_UINT", "r32ui"},
                   {"R32_SINT", "r32i"},
                   {"R32_SFLOAT", "r32f"},
                   {"R32G32_UINT", "rg32ui"},
                   {"R32G32_SINT", "rg32i"},
                   {"R32G32_SFLOAT", "rg32f"},
                   {"R32G32B32A32_UINT", "rgba32ui"},
                   {"R32G32B32A32_SINT", "rgba32i"},
                   {"R32G32B32A32_SFLOAT", "rgba32f"}};
    for (size_t i = 0; i < DT_ARRAY_COUNT(formats); i++)
        if (!strcmp(formats[i].vulkan, name))
            return formats[i].ours;
    return NULL;
}

bool slang_number(const char *text, double *value)
{
    char *end;
    *value = strtod(text, &end);
    return end > text && fabs(*value) <= (double)FLT_MAX;
}

/* IDENTIFIER "DESCRIPTION" INITIAL MINIMUM MAXIMUM [STEP]; the first of a name counts. */
static bool add_param(struct slang *slang, const char *line, const char **why)
{
    struct slang_param param = {.step = 0};
    char numbers[4][64] = {"", "", "", "0"};
    int behind = 0;
    double *const places[] = {&param.value, &param.min, &param.max, &param.step};
    sscanf(line, "%127s \"%n%255[^\"]", param.name, &behind, param.doc);
    const char *quote = behind ? strchr(line + behind, '"') : NULL;
    int fields = quote ? sscanf(quote + 1, "%63s %63s %63s %63s", numbers[0], numbers[1],
                                numbers[2], numbers[3])
                       : 0;
    *why = "#pragma parameter needs NAME \"DESCRIPTION\" INITIAL MINIMUM MAXIMUM";
    for (int i = 0; fields > 2 && i < 4; i++)
        if (!slang_number(numbers[i], places[i])) {
            *why = "INITIAL, MINIMUM, MAXIMUM and STEP of #pragma parameter are finite numbers";
            return false;
        }
    for (uint32_t i = 0; i < slang->param_count; i++)
        if (fields > 2 && !strcmp(slang->params[i].name, param.name)) {
            *why = NULL;
            return true;
        }
    if (slang->param_count == MOST_PARAMS)
        *why = "there are more than 8192 parameters";
    struct slang_param *all = fields < 3 || slang->param_count == MOST_PARAMS
                                  ? NULL
                                  : realloc(slang->params, (slang->param_count + 1) * sizeof *all);
    if (!all)
        return false;
    *why = NULL;
    slang->params = all;
    all[slang->param_count++] = param;
    return true;
}

static void begin_stage(struct slang_reading *reading, const char *stage)
{
    struct text *out = &reading->slang->text;
    if (reading->stage)
        text_add(out, "#endif\n");
    text_add(out, "#ifdef %s\n", stage);
    reading->stage = stage;
}

/* `line`: behind #pragma. False: *why. */
static bool read_pragma(struct slang_reading *reading, const char *line, const char **why)
{
    struct slang *slang = reading->slang;
    char word[32] = "", argument[128] = "";
    sscanf(line, "%31s %127s", word, argument);
    if (!strcmp(word, "stage") && (!strcmp(argument, "vertex") || !strcmp(argument, "fragment"))) {
        begin_stage(reading, *argument == 'v' ? "VERTEX" : "FRAGMENT");
        return true;
    }
    text_add(&slang->text, "\n");
    if (!strcmp(word, "stage"))
        *why = "a stage is vertex or fragment";
    else if (!strcmp(word, "name"))
        snprintf(slang->name, sizeof slang->name, "%s", argument);
    else if (!strcmp(word, "parameter"))
        return add_param(slang, strstr(line, word) + strlen(word), why);
    else if (!strcmp(word, "format") && !(slang->format = format_named(argument)))
        *why = "images do not have this format";
    return !*why;
}

/* ---- Lines ----------------------------------------------------------------------------------- */

static bool read_file(struct slang_reading *reading, const char *path);

/* The word behind `#` and blanks; NULL: another line. */
static const char *directive(const char *line, const char *word)
{
    line += strspn(line, " \t");
    if (*line != '#')
        return NULL;
    line += 1 + strspn(line + 1, " \t");
    return !strncmp(line, word, strlen(word)) ? line + strlen(word) : NULL;
}

static bool read_include(struct slang_reading *reading, const char *from, const char *rest,
                         bool optional, const char **why)
{
    const char *quote = strchr(rest, '"');
    char name[1024];
    if (!quote || sscanf(quote, "\"%1023[^\"]\"", name) != 1) {
        *why = "#include needs a name in quotes";
        return false;
    }
    char *path = slang_path(from, name);
    bool there = path && file_exists(path), good = there || optional;
    if (!good)
        *why = "the included file cannot be read";
    else if (there && ++reading->depth > MOST_DEPTH)
        *why = "files include each other";
    else if (there && ++reading->includes > MOST_INCLUDES)
        *why = "more than 4096 files are included";
    else if (reading->slang->text.length > IMPORT_TEXT_BYTES)
        *why = "the text has more than 16 MiB with all that it includes";
    else if (there)
        good = read_file(reading, path);
    reading->depth -= there;
    free(path);
    return good && !*why;
}

static bool read_line(struct slang_reading *reading, const char *path, const char *line,
                      const char **why)
{
    const char *include = directive(line, "include"), *pragma = directive(line, "pragma");
    const char *optional = pragma ? strstr(pragma, "include_optional") : NULL;
    if (include)
        return read_include(reading, path, include, false, why);
    if (optional)
        return read_include(reading, path, optional, true, why);
    if (pragma)
        return read_pragma(reading, pragma, why);
    text_add(&reading->slang->text, "%s\n", line);
    return true;
}

static bool read_file(struct slang_reading *reading, const char *path)
{
    size_t size = 0;
    char *all = import_text(path, &size, reading->log), *rest = all, *line;
    bool good = all;
    for (unsigned number = 1; good && (line = strsep(&rest, "\n")); number++) {
        const char *why = NULL;
        line[strcspn(line, "\r")] = 0;
        good = read_line(reading, path, line, &why);
        if (why)
            report_error(reading->log, "%s:%u: %s", path, number, why);
    }
    free(all);
    return good;
}

bool slang_read(const char *path, struct slang *slang, const struct dt_log *log)
{
    struct slang_reading reading = {.slang = slang, .log = log};
    *slang = (struct slang){0};
    bool good = read_file(&reading, path);
    if (good && !reading.stage)
        report_error(log, "%s: there is no #pragma stage", path);
    if (good && reading.stage)
        text_add(&slang->text, "#endif\n");
    return good && reading.stage && !slang->text.failed;
}

void slang_free(struct slang *slang)
{
    text_free(&slang->text);
    free(slang->params);
    *slang = (struct slang){0};
}
