/* See watchdog.h. C++ for the handler of failed allocations. */
extern "C" {
#include "watchdog.h"
}

#include <csignal>
#include <cstring>
#include <ctime>
#include <new>

#include <unistd.h>

namespace
{

enum { MOST_LABELS = 16 };
const char *volatile labels[MOST_LABELS]; /* a pass is compiled while its label is in here */
timer_t timer;
bool running;
int exit_status;
struct sigaction former_action, former_fault;
thread_local char fault_stack[1 << 16]; /* a handler needs room where the stack has none left */
thread_local stack_t former_stack;      /* of the thread, which may free it when it ends */
thread_local unsigned stack_users;
std::new_handler former_handler;

void say(const char *text)
{
    if (write(STDERR_FILENO, text, strlen(text)) < 0)
        return; /* nobody is left to tell */
}

[[noreturn]] void end(const char *what)
{
    say("error: ");
    say(what);
    const char *said = nullptr;
    for (const char *label : labels) /* both backends may compile one pass */
        if (label && (!said || strcmp(label, said))) {
            say(said ? " or " : ", while compiling the pass ");
            say(label);
            said = label;
        }
    say("\n");
    _exit(exit_status);
}

void out_of_time(int)
{
    end("the spec takes more processor time than the limit: a macro, a loop or a switch is too "
        "large");
}

void out_of_stack(int)
{
    end("the compiler ended by a fault: an expression or a block is nested too deeply");
}

void give_stack()
{
    stack_t stack = {};
    stack.ss_sp = fault_stack;
    stack.ss_size = sizeof fault_stack;
    if (!stack_users++)
        sigaltstack(&stack, &former_stack);
}

void take_stack()
{
    if (stack_users && !--stack_users)
        sigaltstack(&former_stack, nullptr);
}

void out_of_memory()
{
    end("out of memory");
}

} // namespace

bool watchdog_start(unsigned seconds, int status)
{
    struct sigevent event = {};
    struct sigaction action = {};
    struct itimerspec time = {};
    event.sigev_notify = SIGEV_SIGNAL;
    event.sigev_signo = SIGXCPU;
    action.sa_handler = out_of_time;
    time.it_value.tv_sec = static_cast<time_t>(seconds);
    if (running || timer_create(CLOCK_PROCESS_CPUTIME_ID, &event, &timer) != 0)
        return running;
    if (sigaction(SIGXCPU, &action, &former_action) != 0 ||
        timer_settime(timer, 0, &time, nullptr) != 0) {
        timer_delete(timer);
        return false;
    }
    exit_status = status;
    former_handler = std::set_new_handler(out_of_memory);
    action.sa_handler = out_of_stack;
    action.sa_flags = SA_ONSTACK;
    sigaction(SIGSEGV, &action, &former_fault);
    give_stack();
    running = true;
    return true;
}

void watchdog_stop(void)
{
    if (!running)
        return;
    timer_delete(timer);
    sigaction(SIGXCPU, &former_action, nullptr);
    sigaction(SIGSEGV, &former_fault, nullptr);
    take_stack();
    std::set_new_handler(former_handler);
    running = false;
}

void watchdog_begin(const char *label)
{
    if (running)
        give_stack();
    for (const char *volatile &slot : labels)
        if (__sync_bool_compare_and_swap(&slot, static_cast<const char *>(nullptr), label))
            return;
}

void watchdog_end(const char *label)
{
    take_stack();
    for (const char *volatile &slot : labels)
        if (__sync_bool_compare_and_swap(&slot, label, static_cast<const char *>(nullptr)))
            return;
}
