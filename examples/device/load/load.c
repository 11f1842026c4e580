/* A mass, a spring and a dashpot between opposite edges of the actuator, in each of its two directions: the force
 * with which they answer to the motion of the edges, positive outwards,
 *
 *     force = −(m a + b v + k s)
 */
enum { DISPLACEMENT, VELOCITY, ACCELERATION, FORCE, MASS, DASHPOT, SPRING, N_VALUES };
#define N_INPUTS 3
#define N_OUTPUTS 1
#define N_STATES 0
#define GUID "{0c7b8f0e-54f0-4d6b-8b61-3a0a6a3f9d27}"
#define START {0, 0, 0, 0, 0, 0, 0}
enum { M, B, K }; /* positions among the parameters */

static void initialize(const double *p, double *x) { (void)p, (void)x; }
static double fastest(const double *p) { return (void)p, 1e300; /* it has no states */ }
static void rates(const double *p, const double *u, const double *x, double *dx) { (void)p, (void)u, (void)x, (void)dx; }
static void outputs(const double *p, const double *u, const double *x, double *y) {
    (void)x, y[0] = -(p[M] * u[ACCELERATION] + p[B] * u[VELOCITY] + p[K] * u[DISPLACEMENT]);
}

#include "linear.h"
