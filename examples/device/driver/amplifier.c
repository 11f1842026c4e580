/* High-voltage amplifier: its voltage follows gain times the command with one time constant, T v' = u − v, where u
 * is held between the limits that the output stage can deliver.
 */
enum { COMMAND, VOLTAGE, STATE, GAIN, TIME_CONSTANT, LOWEST, HIGHEST, N_VALUES };
#define N_INPUTS 1
#define N_OUTPUTS 1
#define N_STATES 1
#define N_SEEN 1
#define GUID "{c1c4d0ad-6f0b-4f0e-9b0a-2f6f6a6e8a11}"
#define START {0, 0, 0, 1000.0, 50e-6, 0, 5e3}
enum { K, T, LEAST, MOST }; /* positions among the parameters */

static void initialize(const double *p, double *x) { (void)p, x[0] = 0; }

/* Short against the time constant: the limit is entered and left between two pieces. */
static double fastest(const double *p) { return p[T] / 64; }

static void see(const double *p, int last, double inputs[][N_INPUTS], double u[][N_SEEN]) {
    double wanted = p[K] * inputs[0][0];
    double limited = wanted < p[LEAST] ? p[LEAST] : wanted > p[MOST] ? p[MOST] : wanted;
    u[0][0] = limited;
    for (int k = 1; k <= last; k++)
        u[k][0] = limited == wanted ? p[K] * inputs[k][0] : 0;
}

static void rates(const double *p, const double *u, const double *x, double *dx) { dx[0] = (u[0] - x[0]) / p[T]; }
static void outputs(const double *p, const double *u, const double *x, double *y) { (void)p, (void)u, y[0] = x[0]; }

#include "linear.h"
