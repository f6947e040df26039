/* The last part of NAME.c under --sanitize: the places that may be undefined, and NAME_report(). */
#include "emit_c.h"
#include "plan/sanitize.h"

static void emit_site(const struct c_output *c, const struct dt_site *site)
{
    c_add(c,
          "    {.file = @q, .pass = @q, .kind = @q, .line = @u, .column = @u,\n"
          "     .text = @q, .name = @q,\n",
          site->file, site->pass, site->kind, site->line, site->column, site->text, site->name);
    text_add(c->out,
             "     .resource = %d, .words = %u, .first = %u, .pairs = %s, .allowed = %s},\n",
             site->resource, site->words, site->first, site->pairs ? "true" : "false",
             site->allowed ? "true" : "false");
}

void emit_sites(const struct c_output *c)
{
    uint32_t count = 0;
    if (!c->model->sanitize)
        return;
    const struct dt_site *sites = sanitize_table(c->model, &count);
    c->out->failed |= !sites;
    text_add(c->out,
             "\n/* ---- Undefined behaviour ---- */\n\nstatic const struct dt_site sites[] = {\n");
    for (uint32_t i = 0; sites && i < count; i++)
        emit_site(c, &sites[i]);
    c_add(
        c,
        "};\n\nuint32_t @n_report(const void *reports, size_t size, const struct dt_log *log)\n{\n"
        "    return dt_report_undefined(&@n_pipeline, sites, DT_ARRAY_COUNT(sites), reports, "
        "size,\n"
        "                               log);\n}\n");
}
