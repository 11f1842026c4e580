/* PI controller of the stretch, with damping by a filtered rate of it:
 *
 *     command = i + P (target − stretch) − D w',   i' = I (target − stretch),   F w' = stretch − w
 */
enum { TARGET, STRETCH, COMMAND, INTEGRAL, FILTERED, GAIN_P, GAIN_I, GAIN_D, FILTER, COMMAND_START, N_VALUES };
#define N_INPUTS 2
#define N_OUTPUTS 1
#define N_STATES 2
#define GUID "{9b0c6f37-2a2d-4a1e-8a53-1f0e5d7c94a2}"
#define START {1, 1, 0, 0, 0, 0.5, 0.05, 5.0, 0.5, 0}
enum { P, I, D, F, I_START }; /* positions among the parameters */

static void initialize(const double *p, double *x) { x[0] = p[I_START], x[1] = 1; /* from rest at stretch 1 */ }
static double fastest(const double *p) { return p[F]; }
static void rates(const double *p, const double *u, const double *x, double *dx) {
    dx[0] = p[I] * (u[0] - u[1]);
    dx[1] = (u[1] - x[1]) / p[F];
}
static void outputs(const double *p, const double *u, const double *x, double *y) {
    y[0] = x[0] + p[P] * (u[0] - u[1]) - p[D] * (u[1] - x[1]) / p[F];
}

#include "linear.h"
