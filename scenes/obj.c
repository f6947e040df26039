/* Indices of OBJ files, which assimp checks without saying which one is wrong, or passes over. */
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
        if (listed[kind].is_wrong || listed[kind].largest > listed[kind].count) {
            report_error(log, "%s:%lu: error: a face has the %s %lld, and the file has %lld", path,
                         listed[kind].line, names[kind], listed[kind].largest, listed[kind].count);
            return false;
        }
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
