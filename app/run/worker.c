/* Worker processes; see worker.h. Parent and child exchange struct messages over a socket pair;
 * bytes of resources are in shared memory. The child serves commands while it waits at a stop.
 * While the parent waits for an answer, it prints the child's messages. */
#include "run/worker.h"

#include <errno.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "picture/texels.h"

enum { MOST_NOTE = 256 };

enum message_kind {
    /* from the child */
    SAY,      /* code: enum dt_level; text */
    DEVICE,   /* text: its name */
    DRIVER,   /* text: its version */
    STOP,     /* code: enum worker_stop; frame, pass */
    BYTES,    /* good; size and extent of the bytes in shared memory */
    WRITTEN,  /* good */
    MEASURED, /* good; frame_ms, record_ms; pass_ms lie in the shared memory */
    /* from the parent */
    RESUME, /* code: enum dt_action */
    READ,   /* resource, mip */
    WRITE,  /* resource, mip; size, extent */
    MEASURE,
    END
};

struct worker_message {
    enum message_kind kind;
    int code;
    bool good;
    uint32_t frame, pass, resource, mip;
    uint32_t extent[3];
    uint64_t size;
    double frame_ms, record_ms;
    uint64_t text; /* length of the text that follows */
};

/* ---- Messages -------------------------------------------------------------------------------- */

static bool send_all(int socket, const void *data, size_t size)
{
    const char *at = data;
    while (size) {
        ssize_t sent = send(socket, at, size, MSG_NOSIGNAL);
        if (sent < 0 && errno != EINTR)
            return false;
        at += sent > 0 ? sent : 0;
        size -= sent > 0 ? (size_t)sent : 0;
    }
    return true;
}

static bool receive_all(int socket, void *data, size_t size)
{
    char *at = data;
    while (size) {
        ssize_t got = recv(socket, at, size, 0);
        if (got == 0 || (got < 0 && errno != EINTR))
            return false;
        at += got > 0 ? got : 0;
        size -= got > 0 ? (size_t)got : 0;
    }
    return true;
}

static bool send_text(int socket, struct worker_message message, const char *text)
{
    message.text = strlen(text);
    return send_all(socket, &message, sizeof message) && send_all(socket, text, message.text);
}

/* ---- The child ------------------------------------------------------------------------------- */

struct child {
    const struct worker_info *info;
    struct session session;
    int socket;
    uint8_t *shared;
    size_t capacity;
    uint32_t frame;
    double frame_ms; /* of the last frame without a stop inside */
    bool ended;      /* by the parent's command */
};

/* What it does now, in words, behind the shared bytes: for the parent, if it crashes there. */
__attribute__((format(printf, 2, 3))) static void note(const struct child *child,
                                                       const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf((char *)child->shared + child->capacity, MOST_NOTE, format, arguments);
    va_end(arguments);
}

static void note_pass(const struct child *child, uint32_t pass)
{
    note(child, "in pass %s of frame %u", child->info->session.pipeline->info->passes[pass].name,
         child->frame);
}

/* Ends this process when the message cannot be sent: then the parent has ended. */
static void tell_child(const struct child *child, const struct worker_message *message)
{
    if (!send_all(child->socket, message, sizeof *message))
        _exit(EXIT_FAILED);
}

static void say(void *user, enum dt_level level, const char *text)
{
    const struct child *child = user;
    if (!send_text(child->socket, (struct worker_message){.kind = SAY, .code = (int)level}, text))
        _exit(EXIT_FAILED);
}

static void serve_read(struct child *child, const struct worker_message *command)
{
    struct dt_bytes bytes = {0};
    struct worker_message answer = {.kind = BYTES};
    answer.good = child->session.runtime->read(child->session.handle, command->resource,
                                               command->mip, &bytes);
    if (answer.good && bytes.size > child->capacity) {
        report_error(&child->session.log, "%s: %zu bytes, where its extent says at most %zu",
                     child->info->session.pipeline->info->resources[command->resource].name,
                     bytes.size, child->capacity);
        answer.good = false;
    }
    if (answer.good) {
        memcpy(child->shared, bytes.data, bytes.size);
        memcpy(answer.extent, bytes.extent, sizeof answer.extent);
        answer.size = bytes.size;
    }
    free(bytes.data);
    tell_child(child, &answer);
}

static void serve_write(struct child *child, const struct worker_message *command)
{
    const struct session *session = &child->session;
    struct dt_bytes bytes = {.data = child->shared, .size = command->size};
    memcpy(bytes.extent, command->extent, sizeof bytes.extent);
    tell_child(child, &(struct worker_message){
                          .kind = WRITTEN,
                          .good = session->runtime->write(session->handle, command->resource,
                                                          command->mip, &bytes)});
}

static void serve_measure(const struct child *child)
{
    const struct session *session = &child->session;
    struct worker_message answer = {.kind = MEASURED,
                                    .frame_ms = child->frame_ms,
                                    .record_ms = session->runtime->record_ms(session->handle)};
    answer.good = !session->info.timing ||
                  session->runtime->timings(session->handle, (double *)(void *)child->shared);
    tell_child(child, &answer);
}

/* Reports the stop to the parent and serves its commands until it resumes us. */
static enum dt_action stop_at(struct child *child, enum worker_stop stop, uint32_t pass)
{
    struct worker_message message = {
        .kind = STOP, .code = (int)stop, .frame = child->frame, .pass = pass};
    tell_child(child, &message);
    for (;;) {
        if (!receive_all(child->socket, &message, sizeof message))
            _exit(EXIT_FAILED);
        if (message.kind == READ || message.kind == WRITE)
            note(child, "while resources were read or written in frame %u", child->frame);
        switch (message.kind) {
        case READ:
            serve_read(child, &message);
            break;
        case WRITE:
            serve_write(child, &message);
            break;
        case MEASURE:
            serve_measure(child);
            break;
        case RESUME:
            note(child, "at the end of frame %u", child->frame);
            return (enum dt_action)message.code;
        default:
            child->ended = true;
            return DT_STOP;
        }
    }
}

static enum dt_action worker_before_pass(void *user, uint32_t pass)
{
    struct child *child = user;
    enum dt_action action =
        pass < child->info->stops_before ? stop_at(child, WORKER_BEFORE_PASS, pass) : DT_RUN;
    note_pass(child, pass);
    return action;
}

static bool worker_after_pass(void *user, uint32_t pass)
{
    return stop_at(user, WORKER_AFTER_PASS, pass) != DT_STOP;
}

static bool measured_frame(struct child *child)
{
    double start = milliseconds_now();
    bool good = session_frame(&child->session, NULL);
    child->frame_ms = milliseconds_now() - start;
    return good;
}

static bool run_frames(struct child *child)
{
    const struct worker_info *info = child->info;
    const struct dt_observer observer = {
        .before_pass = worker_before_pass, .after_pass = worker_after_pass, .user = child};
    for (child->frame = info->session.first_frame; child->frame < info->frames; child->frame++) {
        bool observed = child->frame >= info->first_observed;
        if (observed)
            note_pass(child, 0);
        else
            note(child, "before frame %u", info->first_observed);
        if (observed ? !session_frame(&child->session, &observer) : !measured_frame(child))
            return false;
        if ((observed || info->stops_after_frames) &&
            stop_at(child, WORKER_FRAME_DONE, 0) == DT_STOP)
            return false;
    }
    note(child, "after the last frame");
    return session_is_silent(&child->session);
}

static bool run_session(struct child *child)
{
    struct session *session = &child->session;
    note(child, "while it opened the device");
    if (!session_open(session, &child->info->session))
        return false;
    if (!send_text(child->socket, (struct worker_message){.kind = DEVICE},
                   session->runtime->device(session->handle)->name) ||
        !send_text(child->socket, (struct worker_message){.kind = DRIVER},
                   session->runtime->device(session->handle)->driver))
        return false;
    note(child, "while it created the programs");
    return session_prepare(session) && stop_at(child, WORKER_READY, 0) != DT_STOP &&
           run_frames(child) && stop_at(child, WORKER_FINISHED, 0) != DT_STOP;
}

static bool choose_threads(const struct child *child)
{
    char number[16];
    snprintf(number, sizeof number, "%u", child->info->threads);
    return !child->info->threads || setenv("LP_NUM_THREADS", number, 1) == 0 ||
           report_error(&child->info->session.console->log, "out of memory");
}

/* Ends without the parent's exit handlers, which must not run here. */
static _Noreturn void be_child(const struct worker *worker, int socket)
{
    struct child child = {.info = &worker->info,
                          .socket = socket,
                          .shared = worker->shared,
                          .capacity = worker->capacity};
    worker->info.session.console->log = (struct dt_log){.message = say, .user = &child};
    bool good = choose_threads(&child) && run_session(&child);
    note(&child, "while it closed the device");
    session_close(&child.session);
    _exit(good || child.ended ? EXIT_FINE : EXIT_FAILED);
}

/* ---- What the parent says about a child ------------------------------------------------------ */

static const struct dt_log *log_of(const struct worker *worker)
{
    return &worker->info.session.console->log;
}

static const char *label_of(const struct worker *worker)
{
    return worker->info.session.side->label;
}

static bool is_crash(int signal)
{
    return signal == SIGSEGV || signal == SIGABRT || signal == SIGBUS || signal == SIGFPE ||
           signal == SIGILL || signal == SIGTRAP || signal == SIGSYS;
}

/* The child closed its end of the socket: it has ended or is ending. */
static void report_end(struct worker *worker)
{
    int status = 0;
    while (waitpid(worker->process, &status, 0) < 0 && errno == EINTR)
        continue;
    worker->process = 0;
    const char *where = (const char *)worker->shared + worker->capacity;
    if (WIFSIGNALED(status))
        report_error(log_of(worker), "%s: the %s (SIG%s) %s", label_of(worker),
                     is_crash(WTERMSIG(status)) ? "driver crashed" : "process was ended",
                     sigabbrev_np(WTERMSIG(status)), where);
    else if (!worker->spoke)
        report_error(log_of(worker), "%s: the process ended by itself, with exit status %d, %s",
                     label_of(worker), WEXITSTATUS(status), where);
}

/* ---- The parent's verbs ---------------------------------------------------------------------- */

static bool command(struct worker *worker, const struct worker_message *message)
{
    if (worker->process && send_all(worker->socket, message, sizeof *message))
        return true;
    if (worker->process)
        report_end(worker);
    return false;
}

static bool receive_text(const struct worker *worker, const struct worker_message *message,
                         char **text)
{
    *text = malloc(message->text + 1);
    if (!*text)
        return report_error(log_of(worker), "out of memory");
    (*text)[message->text] = 0;
    return receive_all(worker->socket, *text, message->text);
}

/* Returns the next answer; prints messages that come before it. False, silently, when the child has
 * ended. */
static bool receive_answer(struct worker *worker, struct worker_message *message)
{
    const struct dt_log *log = log_of(worker);
    for (;;) {
        char *text = NULL;
        if (!receive_all(worker->socket, message, sizeof *message))
            return false;
        if (message->kind != SAY && message->kind != DEVICE && message->kind != DRIVER)
            return true;
        if (!receive_text(worker, message, &text)) {
            free(text);
            return false;
        }
        if (message->kind != SAY) {
            *(message->kind == DEVICE ? &worker->device : &worker->driver) = text;
            continue;
        }
        worker->spoke |= message->code == DT_ERROR;
        if (!worker->info.quiet || message->code >= DT_WARNING)
            log->message(log->user, (enum dt_level)message->code, text);
        free(text);
    }
}

static bool answer(struct worker *worker, struct worker_message *message)
{
    if (receive_answer(worker, message))
        return true;
    report_end(worker);
    return false;
}

/* Size of the shared memory: the largest resource, or the times of all passes. */
static size_t largest_exchange(const struct dt_pipeline *pipeline, const uint32_t size[2])
{
    size_t largest = (pipeline->pass_count + 1) * sizeof(double);
    for (uint32_t i = 0; i < pipeline->resource_count; i++) {
        const struct dt_resource *resource = &pipeline->resources[i];
        uint32_t extent[3] = {1, 1, 1};
        pipeline->extent(pipeline, i, size[0], size[1], extent);
        size_t bytes = (size_t)extent[0] * resource_stride(resource);
        if (resource->kind == DT_IMAGE)
            bytes *= (size_t)extent[1] * extent[2];
        largest = bytes > largest ? bytes : largest;
    }
    return largest;
}

static bool share_memory(struct worker *worker)
{
    const struct session_info *session = &worker->info.session;
    worker->capacity = largest_exchange(session->pipeline->info, session->setup->size);
    worker->shared = mmap(NULL, worker->capacity + MOST_NOTE, PROT_READ | PROT_WRITE,
                          MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (worker->shared != MAP_FAILED)
        return true;
    worker->shared = NULL;
    return report_error(log_of(worker), "%s: %zu bytes cannot be shared with its process: %s",
                        label_of(worker), worker->capacity, strerror(errno));
}

bool worker_start(struct worker *worker, const struct worker_info *info)
{
    int sockets[2];
    *worker = (struct worker){.info = *info, .socket = -1};
    worker->info.session.name_in_log = true;
    if (!share_memory(worker))
        return false;
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets) != 0)
        return report_error(log_of(worker), "%s: no socket for its process: %s", label_of(worker),
                            strerror(errno));
    worker->socket = sockets[0];
    pid_t child = console_fork(info->session.console);
    if (child == 0) {
        close(sockets[0]);
        be_child(worker, sockets[1]);
    }
    close(sockets[1]);
    if (child < 0)
        report_error(log_of(worker), "%s: its process cannot be started: %s", label_of(worker),
                     strerror(errno));
    worker->process = child > 0 ? child : 0;
    return child > 0;
}

bool worker_wait(struct worker *worker, struct worker_place *place)
{
    struct worker_message message;
    if (!answer(worker, &message))
        return false;
    worker->place = (struct worker_place){
        .stop = (enum worker_stop)message.code, .frame = message.frame, .pass = message.pass};
    worker->running = false;
    *place = worker->place;
    return true;
}

bool worker_resume(struct worker *worker, enum dt_action action)
{
    if (!command(worker, &(struct worker_message){.kind = RESUME, .code = (int)action}))
        return false;
    worker->running = true;
    return true;
}

bool worker_ask(struct worker *worker, uint32_t resource, uint32_t mip)
{
    return command(worker,
                   &(struct worker_message){.kind = READ, .resource = resource, .mip = mip});
}

bool worker_take(struct worker *worker, struct dt_bytes *bytes)
{
    struct worker_message message;
    *bytes = (struct dt_bytes){0};
    if (!answer(worker, &message) || !message.good)
        return false;
    *bytes = (struct dt_bytes){.data = worker->shared, .size = message.size};
    memcpy(bytes->extent, message.extent, sizeof bytes->extent);
    return true;
}

bool worker_read(struct worker *worker, uint32_t resource, uint32_t mip, struct dt_bytes *bytes)
{
    return worker_ask(worker, resource, mip) && worker_take(worker, bytes);
}

bool worker_write(struct worker *worker, uint32_t resource, uint32_t mip,
                  const struct dt_bytes *bytes)
{
    struct worker_message message = {
        .kind = WRITE, .resource = resource, .mip = mip, .size = bytes->size};
    if (bytes->size > worker->capacity)
        return report_error(
            log_of(worker), "%s: %s: %zu bytes to write, where its extent says at most %zu",
            label_of(worker), worker->info.session.pipeline->info->resources[resource].name,
            bytes->size, worker->capacity);
    memmove(worker->shared, bytes->data, bytes->size);
    memcpy(message.extent, bytes->extent, sizeof message.extent);
    return command(worker, &message) && answer(worker, &message) && message.good;
}

bool worker_measure(struct worker *worker, struct worker_measure *measure)
{
    struct worker_message message;
    *measure = (struct worker_measure){0};
    if (!command(worker, &(struct worker_message){.kind = MEASURE}) || !answer(worker, &message) ||
        !message.good)
        return false;
    *measure =
        (struct worker_measure){.frame_ms = message.frame_ms, .record_ms = message.record_ms};
    if (worker->info.session.timing)
        measure->pass_ms = (const double *)(const void *)worker->shared;
    return true;
}

void worker_close(struct worker *worker)
{
    struct worker_message message;
    bool finished = worker->process && worker->place.stop == WORKER_FINISHED && !worker->running;
    if (finished && command(worker, &(struct worker_message){.kind = END})) {
        while (receive_answer(worker, &message))
            continue;
        worker->spoke = true; /* else its end would be reported */
        report_end(worker);
    }
    if (worker->process) {
        kill(worker->process, SIGKILL);
        while (waitpid(worker->process, NULL, 0) < 0 && errno == EINTR)
            continue;
    }
    if (worker->shared) {
        munmap(worker->shared, worker->capacity + MOST_NOTE);
        close(worker->socket);
    }
    free(worker->device);
    free(worker->driver);
    *worker = (struct worker){0};
}
