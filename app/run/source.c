/* Sides at work; see source.h. */
#include "run/source.h"

bool source_start(struct row_source *source, const struct worker_info *info,
                  struct dump_reader *dump)
{
    *source = (struct row_source){.side = info->session.side, .dump = dump};
    return dump || worker_start(&source->worker, info);
}

bool source_resume(struct row_source *source)
{
    enum dt_action action = source->skips ? DT_SKIP : DT_RUN;
    source->skips = false;
    return source->dump || worker_resume(&source->worker, action);
}

bool source_reach(struct row_source *source, struct worker_place place)
{
    struct worker_place found;
    source->place = place;
    if (source->dump)
        return true;
    if (!worker_wait(&source->worker, &found))
        return false;
    if (found.stop == place.stop && found.frame == place.frame && found.pass == place.pass)
        return true;
    const struct session_info *session = &source->worker.info.session;
    const struct dt_pipeline *pipeline = session->pipeline->info;
    return report_error(
        &session->console->log, "%s: the runtime left out pass %s of frame %u", source->side->label,
        place.pass < pipeline->pass_count ? pipeline->passes[place.pass].name : "", place.frame);
}

bool source_ask(struct row_source *source, const struct row *row)
{
    return source->dump || worker_ask(&source->worker, row->resource, row->mip);
}

bool source_take(struct row_source *source, const struct row *row, struct dt_bytes *bytes)
{
    if (source->dump)
        return dump_reader_read(source->dump, row, source->place.stop == WORKER_BEFORE_PASS, bytes);
    return worker_take(&source->worker, bytes);
}

const char *source_device(const struct row_source *source)
{
    return source->dump ? source->dump->device : source->worker.device;
}

void source_close(struct row_source *source)
{
    worker_close(&source->worker);
    *source = (struct row_source){0};
}
