/* What lies in a texel of a format and in a field of a type, from formats.def and types.def: for the
 * front, the runtimes, the generator and the app. Not installed. */
#ifndef DIPTYCH_FORMATS_H
#define DIPTYCH_FORMATS_H

#include "diptych.h"

/* The kinds of numbers; KINDS of app/python/diptych/why.py has them by name. */
#define NUMBER_KINDS(KIND)                                                                         \
    KIND(UNORM8, "unorm8")                                                                         \
    KIND(UNORM16, "unorm16")                                                                       \
    KIND(UNORM24, "unorm24") /* depth, in the low bits; the last unorm that is not packed */       \
    KIND(SNORM16, "snorm16")                                                                       \
    KIND(HALF, "half") /* floats from here */                                                      \
    KIND(FLOAT, "float")                                                                           \
    KIND(R11F, "r11f") /* packed into 32 bits from here: floats without a sign, */                 \
    KIND(G11F, "g11f")                                                                             \
    KIND(B10F, "b10f") /* the last float, */                                                       \
    KIND(R10, "r10")   /* and unorm */                                                             \
    KIND(G10, "g10")                                                                               \
    KIND(B10, "b10")                                                                               \
    KIND(A2, "a2")                                                                                 \
    KIND(UINT, "uint") /* integers from here on; of 32 bits without a number */                    \
    KIND(INT, "int")                                                                               \
    KIND(UINT8, "uint8")                                                                           \
    KIND(INT8, "int8")                                                                             \
    KIND(UINT16, "uint16")                                                                         \
    KIND(INT16, "int16")

enum number_kind {
#define NUMBER_ENUMERATOR(KIND, name) NUMBER_##KIND,
    NUMBER_KINDS(NUMBER_ENUMERATOR)
#undef NUMBER_ENUMERATOR
};

static inline const char *number_kind_name(enum number_kind kind)
{
    static const char *const names[] = {
#define NUMBER_NAME(KIND, name) name,
        NUMBER_KINDS(NUMBER_NAME)
#undef NUMBER_NAME
    };
    return names[kind];
}

/* Formats of dumps alone: no spec and no backend makes them. Values of enum dt_format. */
enum { FORMAT_D16 = DT_FORMAT_COUNT, FORMAT_D24, FORMAT_ALL };

struct format_info {
    const char *name;       /* in specs: "rgba16f" */
    const char *enumerator; /* "DT_FORMAT_RGBA16F" */
    uint32_t channels;      /* 1 to 4 */
    uint32_t bytes;         /* per texel */
    enum number_kind kind;  /* of the first channel; those of a packed texel follow */
    const char *qualifier;  /* GLSL's, of a storage image; NULL: it cannot be one */
};

static inline const struct format_info *format_info(enum dt_format format)
{
    static const struct format_info formats[] = {
#define DT_FORMAT(ENUMERATOR, name, channels, bytes, kind, qualifier, ...)                         \
    {name, "DT_FORMAT_" #ENUMERATOR, channels, bytes, NUMBER_##kind, qualifier},
#include "formats.def"
        {"d16", NULL, 1, 2, NUMBER_UNORM16, NULL},
        {"d24", NULL, 1, 4, NUMBER_UNORM24, NULL},
    };
    return &formats[format];
}

static inline bool number_is_integer(enum number_kind kind)
{
    return kind >= NUMBER_UINT;
}

static inline bool number_is_signed_integer(enum number_kind kind)
{
    return kind == NUMBER_INT || kind == NUMBER_INT8 || kind == NUMBER_INT16;
}

static inline bool number_is_snorm(enum number_kind kind)
{
    return kind == NUMBER_SNORM16;
}

static inline bool number_is_packed(enum number_kind kind)
{
    return kind >= NUMBER_R11F && kind <= NUMBER_A2;
}

static inline bool format_is_integer(enum dt_format format)
{
    return number_is_integer(format_info(format)->kind);
}

struct type_info {
    const char *name;       /* in specs and GLSL: "vec3" */
    const char *enumerator; /* "DT_TYPE_VEC3" */
    const char *c;          /* C's type of a number */
    uint32_t components;    /* per column */
    uint32_t columns;       /* 4 for mat4, else 1 */
    uint32_t size, align;   /* bytes; the same in std140 and std430 outside arrays */
    enum dt_type scalar;    /* DT_TYPE_FLOAT, _INT, _UINT or _BOOL */
};

/* Of a vector, or of a column of a matrix: OpenGL 4.6, 7.6.2.2, rules 1 to 3. */
#define TYPE_ALIGN(components) ((components) < 3 ? 4 * (components) : 16)
static inline const struct type_info *type_info(enum dt_type type)
{
    static const struct type_info types[] = {
#define DT_TYPE(ENUMERATOR, name, components, columns, SCALAR, c)                                  \
    {name,                                                                                         \
     "DT_TYPE_" #ENUMERATOR,                                                                       \
     c,                                                                                            \
     components,                                                                                   \
     columns,                                                                                      \
     4 * (components) * (columns),                                                                 \
     TYPE_ALIGN(components),                                                                       \
     DT_TYPE_##SCALAR},
#include "types.def"
    };
    return &types[type];
}

static inline uint32_t type_components(enum dt_type type)
{
    return type_info(type)->components * type_info(type)->columns; /* 1 to 4; 16 for mat4 */
}

#endif
