/* Indices of OBJ files, which assimp checks without saying which one is wrong, or passes over; and names
 * of materials, of which it makes up those that no library has. */
#include "mesh.h"

#include "base/log.h"
#include "base/input.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { POSITION, UV, NORMAL, KINDS };

/* What a file has of a kind, and the largest number that a face names. */
struct listed {
    long long count, largest;
    unsigned long line; /* of `largest` */
    bool is_wrong;      /* `largest` is 0, or counts back too far */
};

static void take_index(struct listed *listed, long long index, unsigned long line)
{
    bool back = index < 0 && -index <= listed->count;
    long long place = back ? listed->count + index + 1 : index;
    if (listed->is_wrong || (place > 0 && place <= listed->largest))
        return;
    listed->largest = place;
    listed->line = line;
    listed->is_wrong = place <= 0;
}

/* `f a/b/c a//c a/b`: from 1, or back from the last by -1. */
static void take_face(struct listed listed[KINDS], char *text, unsigned long line)
{
    char *rest = NULL;
    for (char *corner = strtok_r(text, " \t\r\n\\", &rest); corner;
         corner = strtok_r(NULL, " \t\r\n\\", &rest))
        for (int kind = 0; kind < KINDS && corner && *corner; kind++) {
            char *end;
            long long index = strtoll(corner, &end, 10);
            if (end > corner)
                take_index(&listed[kind], index, line);
            corner = *end == '/' ? end + 1 : NULL;
        }
}

static bool report(const struct listed listed[KINDS], const char *path, const struct dt_log *log)
{
    static const char *const names[] = {"vertex", "texture coordinate", "normal"};
    for (int kind = 0; kind < KINDS; kind++)
        if (listed[kind].is_wrong || listed[kind].largest > listed[kind].count)
            return report_error(log, "%s:%lu: error: a face has the %s %lld, and the file has %lld",
                                path, listed[kind].line, names[kind], listed[kind].largest,
                                listed[kind].count);
    return true;
}

bool obj_check(const char *path, const struct dt_log *log)
{
    const char *reason;
    struct listed listed[KINDS] = {{0}};
    FILE *file = input_open(path, MESH_MOST_BYTES, &reason);
    char *line = NULL;
    size_t capacity = 0;
    for (unsigned long number = 1; file && getline(&line, &capacity, file) > 0; number++) {
        char *text = line + strspn(line, " \t");
        int kind = text[1] == 't' ? UV : text[1] == 'n' ? NORMAL : POSITION;
        if (text[0] == 'v' && (kind != POSITION || text[1] == ' ' || text[1] == '\t'))
            listed[kind].count++;
        else if (text[0] == 'f' && (text[1] == ' ' || text[1] == '\t'))
            take_face(listed, text + 1, number);
    }
    free(line);
    if (file)
        fclose(file);
    else
        report_error(log, "%s: %s", path, reason);
    return file && report(listed, path, log);
}

/* ---- Materials ------------------------------------------------------------------------------- */

/* Appends a name and its line end; without memory nothing, which the caller's import tells. */
static void append_name(char **names, const char *name, size_t length)
{
    size_t used = *names ? strlen(*names) : 0;
    char *more = realloc(*names, used + length + 3);
    if (!more)
        return;
    *names = more;
    snprintf(more + used, length + 3, "%s%.*s\n", used ? "" : "\n", (int)length, name);
}

bool obj_has_name(const char *names, const char *name)
{
    size_t length = strlen(name);
    for (const char *at = names ? strstr(names, name) : NULL; at; at = strstr(at + 1, name))
        if (at[-1] == '\n' && at[length] == '\n')
            return true;
    return false;
}

/* What a library says, and scenes do not take; each kind once. */
enum { TWICE, COLOR, ALPHA, BUMP, OPTION, TOLD };

static int kind_of(const char *text, const char *names)
{
    static const char *const bumps[] = {"map_Bump ", "map_bump ", "bump ", "norm "};
    float value[3] = {0};
    if (sscanf(text, "d %f", value) == 1 ? value[0] < 1
                                         : sscanf(text, "Tr %f", value) == 1 && value[0] > 0)
        return ALPHA;
    if (sscanf(text, "Kd %f %f %f", &value[0], &value[1], &value[2]) == 3)
        for (int i = 0; i < 3; i++)
            if (!(value[i] >= 0 && value[i] <= 1))
                return COLOR;
    for (size_t i = 0; i < DT_ARRAY_COUNT(bumps); i++)
        if (strncmp(text, bumps[i], strlen(bumps[i])) == 0)
            return BUMP;
    if (strncmp(text, "map_Kd", 6) == 0 && text[6 + strspn(text + 6, " \t")] == '-')
        return OPTION;
    return strncmp(text, "newmtl ", 7) == 0 && obj_has_name(names, text + 7) ? TWICE : TOLD;
}

static void tell(const char *path, unsigned long line, const char *text, int kind,
                 const struct dt_log *log)
{
    static const char *const words[] = {
        [TWICE] = "a name that an earlier material has",
        [COLOR] = "a colour has numbers from 0 to 1; the nearest are taken",
        [ALPHA] = "transparency is not supported; the material is opaque",
        [BUMP] = "bump maps are not supported; vertices have their normals",
        [OPTION] =
            "options of textures are not supported; they repeat, and are not moved or scaled"};
    report_message(log, DT_WARNING, "%s:%lu: `%.80s`: %s", path, line, text, words[kind]);
}

void obj_read_library(const char *path, char **names, const struct dt_log *log)
{
    const char *reason;
    bool told[TOLD + 1] = {[TOLD] = true};
    FILE *file = input_open(path, MESH_MOST_BYTES, &reason);
    char *line = NULL;
    size_t capacity = 0;
    for (unsigned long number = 1; file && getline(&line, &capacity, file) > 0; number++) {
        char *text = line + strspn(line, " \t");
        size_t length = strlen(text);
        while (length && strchr(" \t\r\n", text[length - 1]))
            text[--length] = 0;
        int kind = kind_of(text, *names);
        if (!told[kind])
            tell(path, number, text, kind, log);
        told[kind] = true;
        if (strncmp(text, "newmtl", 6) == 0) {
            text += 6 + strspn(text + 6, " \t");
            append_name(names, text, strlen(text));
        }
    }
    free(line);
    if (file)
        fclose(file);
}
