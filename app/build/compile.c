/* Compiles generated C; see compile.h. Objects of the panels and of the reflection are kept in the
 * cache, by source and flags: most edits change shaders only, whose C is made anew each time, and most
 * of a panel's time goes into the headers of its graphics API. Who waits at a window for what an edit
 * does gets them all from tcc, which takes a tenth of the time; what they call is optimised. */
#include "build/compile.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/files.h"
#include "base/tool.h"

enum { UNITS = 5 };

static const struct {
    const char *end; /* of the source's name */
    bool kept;
} kinds[UNITS] = {/* those that take longest first */
                  {"_gl_shaders.c", false},
                  {"_vk_shaders.c", false},
                  {"_gl.c", true},
                  {"_vk.c", true},
                  {".c", true}};

enum { FLAGS = 3 };
static const char *const flags[FLAGS] = {
    "-std=c11", "-Og", /* two thirds of the time; what it calls is optimised */
    "-fPIC"};
static const char quick_compiler[] = "tcc";

struct unit {
    char *source, *object, *depfile;
    char *argv[17];
    char *folder;         /* of its versions in the cache; NULL: is not kept */
    struct stamped found; /* there */
};

static const char hint[] = "install a C compiler, or name one in the environment variable CC";

static const char *c_compiler(void)
{
    const char *named = getenv("CC");
    return named && *named ? named : "cc";
}

static bool is_quick(const struct build_request *request)
{
    const char *named = getenv("CC");
    return request->hurried && !(named && *named) && tool_is_there(quick_compiler);
}

const char *compiler_of(const struct build_request *request)
{
    return is_quick(request) ? quick_compiler : c_compiler();
}

/* ---- What is to be done ---------------------------------------------------------------------- */

static bool plan_command(struct unit *unit, const struct build_request *request,
                         const char *compiler)
{
    const char *argv[] = {
        compiler, flags[0], flags[1], flags[2],
        /* tcc knows one word only, and leaves the system's headers out by itself */
        strcmp(compiler, quick_compiler) == 0 ? "-MD" : "-MMD", "-MF", unit->depfile, "-I",
        request->headers[0], "-I", request->headers[1], "-c", unit->source, "-o", unit->object,
        NULL};
    _Static_assert(sizeof argv <= sizeof unit->argv, "every word has its place");
    memcpy(unit->argv, argv, sizeof argv);
    return unit->source && unit->object && unit->depfile;
}

/* All that decides what becomes of it, but for the headers that the stamp tells of. */
static bool unit_key(const struct unit *unit, const struct compile_work *work, uint64_t *key)
{
    const struct build_request *request = work->request;
    *key = FILE_HASH_START;
    for (size_t i = 0; i < FLAGS; i++)
        hash_string(key, flags[i]);
    hash_string(key, unit->argv[0]);
    hash_string(key, request->headers[0]);
    hash_string(key, request->headers[1]);
    char *header = format_string("%s/%s.h", work->stamp.folder, work->name);
    bool good = header && hash_file(key, header) && hash_file(key, unit->source);
    free(header);
    return good;
}

/* What was made of it before, if that is still there. */
static bool find(struct unit *unit)
{
    if (!stamp_read(&unit->found, unit->folder))
        return true;
    char *object = format_string("%s/object.o", unit->found.folder);
    bool good = object;
    if (good && file_exists(object)) {
        free(unit->object);
        unit->object = object;
        return true;
    }
    stamped_free(&unit->found);
    free(object);
    return good;
}

static bool plan(struct unit *unit, const struct compile_work *work, int kind, const char *compiler)
{
    const char *folder = work->stamp.folder, *end = kinds[kind].end;
    uint64_t key;
    *unit = (struct unit){.source = format_string("%s/%s%s", folder, work->name, end),
                          .object = format_string("%s/%s%s.o", folder, work->name, end),
                          .depfile = format_string("%s/%s%s.d", folder, work->name, end)};
    if (!plan_command(unit, work->request, compiler))
        return false;
    if (!kinds[kind].kept)
        return true;
    if (!unit_key(unit, work, &key))
        return false;
    unit->folder = format_string("%s/%016" PRIx64, work->base, key);
    return unit->folder && find(unit);
}

static void forget(struct unit *unit)
{
    if (!unit->found.folder && unit->object)
        unlink(unit->object);
    free(unit->source);
    free(unit->object);
    free(unit->depfile);
    free(unit->folder);
    stamped_free(&unit->found);
}

/* ---- Doing it -------------------------------------------------------------------------------- */

/* `optional`: of a failure nothing is said. */
static bool compile(struct unit *units, bool optional, struct console *console)
{
    const struct tool compiler = {
        .what = "compiling the generated C", .hint = hint, .optional = optional};
    char *const *argvs[UNITS];
    uint32_t count = 0;
    for (int i = 0; i < UNITS; i++)
        if (!units[i].found.folder)
            argvs[count++] = units[i].argv;
    return tool_run_all(&compiler, argvs, count, console);
}

/* The runtimes' symbols come from the executable when it is loaded. */
static bool link_objects(const struct unit *units, const char *folder, bool optional,
                         struct console *console)
{
    const struct tool linker = {
        .what = "linking the generated C", .hint = hint, .optional = optional};
    char *object = format_string("%s/panels.so", folder);
    char *argv[UNITS + 5] = {units[0].argv[0], (char *)"-shared", (char *)"-o", object};
    for (int i = 0; i < UNITS; i++)
        argv[4 + i] = units[i].object;
    char *const *only = argv;
    bool good = object && tool_run_all(&linker, &only, 1, console);
    free(object);
    return good;
}

/* Moves a new object into the cache. */
static bool keep(struct unit *unit, const struct compile_work *work, const char *files,
                 const struct dt_log *log)
{
    char *temporary = stamp_temporary(unit->folder);
    char *object = temporary ? format_string("%s/object.o", temporary) : NULL;
    bool good = object && file_make_folders(temporary, log);
    if (!object)
        report_error(log, "out of memory");
    if (good && rename(unit->object, object) != 0) {
        report_error(log, "%s: cannot be renamed to %s: %s", unit->object, object, strerror(errno));
        good = false;
    }
    good = good && stamp_publish(unit->folder, temporary, work->name, files, log);
    if (temporary)
        file_remove_tree(temporary);
    free(object);
    free(temporary);
    return good;
}

/* What the unit was made from, for the pipeline's stamp and for its own. */
static bool account(struct unit *unit, const struct compile_work *work, FILE *files,
                    const struct dt_log *log)
{
    if (unit->found.folder)
        return fputs(unit->found.files, files) >= 0;
    char *lines = NULL;
    size_t size = 0;
    FILE *own = open_memstream(&lines, &size);
    if (!own)
        report_error(log, "out of memory");
    bool good = own && stamp_add(own, unit->depfile, &work->stamp, log);
    if (own && fclose(own) != 0)
        good = false;
    good = good && fputs(lines, files) >= 0 && (!unit->folder || keep(unit, work, lines, log));
    free(lines);
    return good;
}

static bool compile_with(const char *compiler, bool optional, const struct compile_work *work,
                         FILE *files, struct console *console)
{
    struct unit units[UNITS];
    bool good = true;
    for (int i = 0; i < UNITS; i++)
        good = plan(&units[i], work, i, compiler) && good;
    if (!good)
        report_error(&console->log, "%s: what was generated cannot be read back",
                     work->stamp.folder);
    good = good && compile(units, optional, console) &&
           link_objects(units, work->stamp.folder, optional, console);
    for (int i = 0; i < UNITS; i++) {
        good = good && account(&units[i], work, files, &console->log);
        forget(&units[i]);
    }
    return good;
}

/* The quick compiler knows less C than others: what headers of a system ask for may be too much. */
bool compile_pipeline(const struct compile_work *work, FILE *files, struct console *console)
{
    return (is_quick(work->request) && compile_with(quick_compiler, true, work, files, console)) ||
           compile_with(c_compiler(), false, work, files, console);
}
