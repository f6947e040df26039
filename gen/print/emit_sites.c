/* The last part of NAME.c under --sanitize: the places that may be undefined, and NAME_report(). */
#include "emit_c.h"
#include "plan/sanitize.h"

static void emit_site(const struct c_output *c, const struct dt_site *site)
{
    text_add(c->out, "    {.file = ");
    c_string(c->out, site->file);
    text_add(c->out, ", .pass = ");
    c_string(c->out, site->pass);
    text_add(c->out, ", .kind = ");
    c_string(c->out, site->kind);
    text_add(c->out, ", .line = %d, .column = %d,\n     .text = ", site->line, site->column);
    c_string(c->out, site->text);
    text_add(c->out, ", .name = ");
    c_string(c->out, site->name);
    text_add(c->out,
             ",\n     .resource = %d, .words = %u, .first = %u, .pairs = %s, .allowed = %s},\n",
             site->resource, site->words, site->first, site->pairs ? "true" : "false",
             site->allowed ? "true" : "false");
}

void emit_sites(const struct c_output *c)
{
    const char *name = c->pipeline->name;
    uint32_t count = 0;
    if (!c->model->sanitize)
        return;
    const struct dt_site *sites = sanitize_table(c->model, &count);
    c->out->failed |= !sites;
    text_add(c->out,
             "\n/* ---- Undefined behaviour ---- */\n\nstatic const struct dt_site sites[] = {\n");
    for (uint32_t i = 0; sites && i < count; i++)
        emit_site(c, &sites[i]);
    text_add(
        c->out,
        "};\n\nuint32_t %s_report(const void *reports, size_t size, const struct dt_log *log)\n{\n"
        "    return dt_report_undefined(&%s_pipeline, sites, DT_ARRAY_COUNT(sites), reports, "
        "size,\n"
        "                               log);\n}\n",
        name, name);
}
