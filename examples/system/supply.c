/* High-voltage supply: its voltage follows the command with one time constant, T v' = command − v. */
enum { COMMAND, VOLTAGE, STATE, TIME_CONSTANT, N_VALUES };
#define N_INPUTS 1
#define N_OUTPUTS 1
#define N_STATES 1
#define GUID "{5d1f4a0e-0d5c-4a51-9f0b-7d6a3c1e52b1}"
#define START {0, 0, 0, 1.0}
enum { T }; /* positions among the parameters */

static void initialize(const double *p, double *x) { (void)p, x[0] = 0; }
static double fastest(const double *p) { return p[T]; }
static void rates(const double *p, const double *u, const double *x, double *dx) { dx[0] = (u[0] - x[0]) / p[T]; }
static void outputs(const double *p, const double *u, const double *x, double *y) { (void)p, (void)u, y[0] = x[0]; }

#include "linear.h"
