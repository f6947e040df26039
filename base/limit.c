/* See limit.h. */
#include "base/limit.h"

#include <sys/resource.h>
#include <unistd.h>

bool limit_memory(unsigned gibibytes)
{
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    (void)gibibytes;
    return true;
#else
    rlim_t most = gibibytes ? (rlim_t)gibibytes << 30
                            : (rlim_t)sysconf(_SC_PHYS_PAGES) * (rlim_t)sysconf(_SC_PAGESIZE);
    struct rlimit limit;
    if (getrlimit(RLIMIT_DATA, &limit) != 0)
        return false;
    if (limit.rlim_cur <= most)
        return true;
    limit.rlim_cur = most;
    return setrlimit(RLIMIT_DATA, &limit) == 0;
#endif
}
