/* A second process that compiles shaders of one backend. glslang reads the declarations of all built-in
 * functions anew for each API, and everything else waits for its lock meanwhile, also on other threads; so
 * each process reads one. main.c starts and stops it, shaders.c hands it work and does itself what comes
 * back without SPIR-V, so nothing depends on it but time, and it says nothing. */
#include "helper.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

static struct {
    pid_t process; /* 0: there is none */
    int socket;
    enum backend backend;
} helper;

struct request { /* then of each shader its stage, the length of its GLSL, and that */
    uint32_t count, fast, gpu;
};
struct item {
    uint32_t stage;
    uint64_t length;
};

/* ---- The socket ------------------------------------------------------------------------------ */

static bool send_all(int socket, const void *bytes, size_t size)
{
    for (const char *at = bytes; size;) {
        ssize_t sent = send(socket, at, size, MSG_NOSIGNAL);
        if (sent < 0 && errno == EINTR)
            continue;
        if (sent <= 0)
            return false;
        at += sent;
        size -= (size_t)sent;
    }
    return true;
}

static bool receive_all(int socket, void *bytes, size_t size)
{
    for (char *at = bytes; size;) {
        ssize_t got = recv(socket, at, size, 0);
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            return false;
        at += got;
        size -= (size_t)got;
    }
    return true;
}

/* ---- The helper's side ----------------------------------------------------------------------- */

static bool receive_shader(struct shader *shader)
{
    struct item item;
    if (!receive_all(helper.socket, &item, sizeof item))
        return false;
    char *glsl = malloc(item.length + 1);
    bool good = glsl && receive_all(helper.socket, glsl, item.length);
    if (good) {
        glsl[item.length] = '\0';
        shader->stage = (enum stage)item.stage;
        text_add_bytes(&shader->glsl, glsl, item.length);
    }
    free(glsl);
    return good && !shader->glsl.failed;
}

static bool answer(const struct shader *shader)
{
    uint64_t count = shader->words ? shader->word_count : 0;
    return send_all(helper.socket, &count, sizeof count) &&
           send_all(helper.socket, shader->words, count * sizeof *shader->words);
}

/* One request; all of it is read before anything is compiled, and compiled before anything is sent. */
static bool serve(void)
{
    struct request request;
    bool good = receive_all(helper.socket, &request, sizeof request);
    struct shader *shaders = good ? calloc((size_t)request.count + 1, sizeof *shaders) : NULL;
    good = shaders;
    for (uint32_t i = 0; good && i < request.count; i++)
        good = receive_shader(&shaders[i]);
    if (good)
        shaders_compile_apart(helper.backend, request.fast, request.gpu, shaders, request.count);
    for (uint32_t i = 0; good && i < request.count; i++)
        good = answer(&shaders[i]);
    for (uint32_t i = 0; shaders && i < request.count; i++) {
        text_free(&shaders[i].glsl);
        free(shaders[i].words);
    }
    free(shaders);
    return good;
}

/* Reads no input, writes no output, and does not outlive who started it. */
static void help(pid_t parent)
{
    int nothing = open("/dev/null", O_RDWR);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (nothing >= 0 && dup2(nothing, STDIN_FILENO) >= 0 && dup2(nothing, STDOUT_FILENO) >= 0 &&
        getppid() == parent && spirv_init(helper.backend, helper.backend))
        while (serve())
            ;
    _exit(0);
}

/* ---- The generator's side -------------------------------------------------------------------- */

bool helper_start(enum backend backend)
{
    int sockets[2];
    pid_t parent = getpid();
    if (sysconf(_SC_NPROCESSORS_ONLN) < 2 ||
        socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets) < 0)
        return false;
    pid_t process = fork();
    helper.backend = backend;
    helper.socket = sockets[process == 0];
    close(sockets[process != 0]);
    if (process == 0)
        help(parent);
    if (process < 0)
        close(helper.socket);
    helper.process = process < 0 ? 0 : process;
    return helper.process != 0;
}

bool helper_compiles(enum backend backend)
{
    return helper.process && backend == helper.backend;
}

bool helper_send(bool fast, bool gpu, struct shader *const *shaders, uint32_t count)
{
    struct request request = {count, fast, gpu};
    bool good = send_all(helper.socket, &request, sizeof request);
    for (uint32_t i = 0; good && i < count; i++) {
        struct item item = {shaders[i]->stage, shaders[i]->glsl.length};
        good = send_all(helper.socket, &item, sizeof item) &&
               send_all(helper.socket, shaders[i]->glsl.data, item.length);
    }
    if (!good)
        helper_stop();
    return good;
}

void helper_receive(struct shader *const *shaders, uint32_t count)
{
    bool good = true;
    for (uint32_t i = 0; good && i < count; i++) {
        struct shader *shader = shaders[i];
        uint64_t words = 0;
        good = receive_all(helper.socket, &words, sizeof words);
        if (!good || !words)
            continue;
        shader->words = malloc(words * sizeof *shader->words);
        good = shader->words &&
               receive_all(helper.socket, shader->words, words * sizeof *shader->words);
        if (good) {
            shader->word_count = words;
        } else {
            free(shader->words);
            shader->words = NULL;
        }
    }
    if (!good)
        helper_stop();
}

/* It has nothing to put in order. */
void helper_stop(void)
{
    if (!helper.process)
        return;
    close(helper.socket);
    kill(helper.process, SIGKILL);
    while (waitpid(helper.process, NULL, 0) < 0 && errno == EINTR)
        ;
    helper.process = 0;
}
