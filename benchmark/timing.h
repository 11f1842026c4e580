/* How long something takes, for the rivals in C. */
#include <stdlib.h>
#include <time.h>

enum { BATCHES = 7 };

static double now(void)
{
    struct timespec clock;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &clock);
    return clock.tv_sec + 1e-9 * clock.tv_nsec;
}

static int ascending(const void *one, const void *other)
{
    double a = *(const double *)one, b = *(const double *)other;
    return (a > b) - (a < b);
}

/* The median of batches, so that one in which the machine did something else does not count. */
static double median(double *batches)
{
    qsort(batches, BATCHES, sizeof *batches, ascending);
    return batches[BATCHES / 2];
}
