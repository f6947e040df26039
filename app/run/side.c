/* Reads the sides of a comparison; see side.h. */
#include "run/side.h"

#include <stdlib.h>
#include <string.h>

#include "base/nearest.h"

static const struct {
    const char *name, *backend, *context;
} drivers[] = {
    {"gl", "gl", NULL},
    {"vk", "vk", NULL},
    {"osmesa", "gl", "osmesa"},
    {"zink", "gl", "zink"},
};
enum { DRIVERS = DT_ARRAY_COUNT(drivers) };

static bool find_driver(struct side *side, const char *name, const struct dt_log *log)
{
    const char *names[DRIVERS];
    for (uint32_t i = 0; i < DRIVERS; i++) {
        names[i] = drivers[i].name;
        if (strcmp(name, drivers[i].name) == 0) {
            side->backend = drivers[i].backend;
            side->context = drivers[i].context;
            return true;
        }
    }
    return report_error(
        log, "--backend %s: unknown backend \"%s\"%s", side->label, name,
        name_hint('"', name, names, DRIVERS, "; there are gl, vk, osmesa and zink").text);
}

/* The text behind the driver's name; NULL: none. */
static bool refine(struct side *side, const char *form, const char *device,
                   const struct dt_log *log)
{
    bool vulkan = strcmp(side->backend, "vk") == 0;
    if (form && strcmp(form, "glsl") != 0)
        return report_error(log, "--backend %s: unknown form \"+%s\"; there is +glsl", side->label,
                            form);
    if (form && vulkan)
        return report_error(log, "--backend %s: only OpenGL takes GLSL text", side->label);
    if (device && (!vulkan || !*device))
        return report_error(log, "--backend %s: %s", side->label,
                            vulkan ? "the device's name is missing behind the @"
                                   : "only vk takes a device");
    side->glsl = form;
    side->device = device;
    return true;
}

bool side_read(struct side *side, const char *entry, const struct setup *setup,
               const struct dt_log *log)
{
    *side = (struct side){.label = strdup(entry), .text = strdup(entry)};
    if (!side->label || !side->text)
        return report_error(log, "out of memory");
    char *device = strchr(side->text, '@');
    if (device)
        *device++ = 0;
    char *form = strchr(side->text, '+');
    if (form)
        *form++ = 0;
    if (!find_driver(side, side->text, log) || !refine(side, form, device, log))
        return false;
    if (strcmp(side->backend, "vk") == 0) {
        side->device = side->device ? side->device : setup->device;
    } else {
        side->context = side->context ? side->context : setup->context;
        side->glsl = side->glsl || setup->glsl;
    }
    return true;
}

void side_free(struct side *side)
{
    free(side->label);
    free(side->text);
    *side = (struct side){0};
}

/* ---- The sides of a comparison --------------------------------------------------------------- */

static bool make_label_unique(struct sides *sides, uint32_t index, const struct dt_log *log)
{
    struct side *side = &sides->list[index];
    uint32_t times = 1;
    for (uint32_t i = 0; i < index; i++) {
        const char *label = sides->list[i].label;
        size_t length = strcspn(label, "#");
        times += strncmp(label, side->label, length) == 0 && !side->label[length];
    }
    if (times == 1)
        return true;
    char *label = format_string("%s#%u", side->label, times);
    if (!label)
        return report_error(log, "out of memory");
    free(side->label);
    side->label = label;
    return true;
}

/* The next side, zeroed, or NULL. */
static struct side *append_side(struct sides *sides, const struct dt_log *log)
{
    struct side *grown = realloc(sides->list, (sides->count + 1) * sizeof *grown);
    if (!grown) {
        report_error(log, "out of memory");
        return NULL;
    }
    sides->list = grown;
    grown[sides->count] = (struct side){0};
    return &grown[sides->count++];
}

bool sides_heed(const struct side *list, uint32_t count, const struct setup *setup,
                const struct dt_log *log)
{
    bool vulkan = false, opengl = false;
    for (uint32_t i = 0; i < count; i++) {
        vulkan |= list[i].backend && strcmp(list[i].backend, "vk") == 0;
        opengl |= list[i].backend && strcmp(list[i].backend, "gl") == 0;
    }
    if (setup->device && !vulkan)
        report_error(log, "--device %s: --backend names no side that takes a device; vk does",
                     setup->device);
    else if ((setup->context || setup->glsl) && !opengl)
        report_error(log, "%s: --backend names no OpenGL", setup->context ? "--context" : "--glsl");
    else
        return true;
    return false;
}

static bool read_entries(struct sides *sides, const char *list, const struct setup *setup,
                         const struct dt_log *log)
{
    for (const char *at = list;; at++) {
        size_t length = strcspn(at, ",");
        char *entry = strndup(at, length);
        struct side *side = entry ? append_side(sides, log) : NULL;
        if (entry && !length)
            report_error(log, "--backend %s: must be names with one comma between, like gl,vk",
                         list);
        bool good = side && length && side_read(side, entry, setup, log) &&
                    make_label_unique(sides, sides->count - 1, log);
        free(entry);
        if (!good)
            return false;
        at += length;
        if (!*at)
            return true;
    }
}

static bool add_dump(struct sides *sides, const char *folder, const struct dt_log *log)
{
    struct side *side = append_side(sides, log);
    if (!side)
        return false;
    *side = (struct side){.label = strdup("dump"), .folder = folder};
    return side->label || report_error(log, "out of memory");
}

static const char *backend_list(const struct setup *setup)
{
    return setup->backend ? setup->backend : "gl,vk";
}

bool sides_read_each(struct sides *sides, const struct setup *setup, const struct dt_log *log)
{
    *sides = (struct sides){0};
    return (!setup->against || add_dump(sides, setup->against, log)) &&
           read_entries(sides, backend_list(setup), setup, log) &&
           sides_heed(sides->list, sides->count, setup, log);
}

bool sides_read(struct sides *sides, const struct setup *setup, const struct dt_log *log)
{
    if (!sides_read_each(sides, setup, log))
        return false;
    return sides->count > 1 ||
           report_error(
               log,
               "--backend %s: a comparison needs two sides; name two, like gl,vk, or a dump with "
               "--against",
               backend_list(setup));
}

void sides_free(struct sides *sides)
{
    for (uint32_t i = 0; i < sides->count; i++)
        side_free(&sides->list[i]);
    free(sides->list);
    *sides = (struct sides){0};
}
