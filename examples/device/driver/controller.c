/* PI controller of the displacement of an edge, with damping by a filtered rate, that has no sensor: it measures
 * charge and voltage of the actuator. Capacitance grows like the fourth power of the stretch, C = C0 (1 + s/L)⁴, so
 *
 *     s = L ((q/(v C0))^(1/4) − 1)
 *     command = i + P (target − s) − D w',   i' = I (target − s),   F w' = s − w
 *
 * Below the least voltage there is nothing to measure: there the displacement counts as 0.
 */
#include <math.h>

enum {
    TARGET, CHARGE, MEASURED_VOLTAGE, COMMAND, ESTIMATE, INTEGRAL, FILTERED,
    GAIN_P, GAIN_I, GAIN_D, FILTER, COMMAND_START, SIDE, CAPACITANCE, LEAST_VOLTAGE, N_VALUES
};
#define N_INPUTS 3
#define N_OUTPUTS 2
#define N_STATES 2
#define N_SEEN 2
#define GUID "{6e5ad5b7-3d3b-4f35-8f5e-0f1d3e0a7c42}"
#define START {0, 0, 0, 0, 0, 0, 0, 2e3, 2e6, 0.5, 50e-6, 0, 20e-3, 1e-10, 100}
enum { P, I, D, F, I_START, L, C0, LEAST }; /* positions among the parameters */
enum { WANTED, SEEN };                      /* positions in u */

static void initialize(const double *p, double *x) { x[0] = p[I_START], x[1] = 0; }
static double fastest(const double *p) { return p[F]; }

/* By power series, whose k-th coefficient is the k-th derivative over k!. */
static void see(const double *p, int last, double inputs[][N_INPUTS], double u[][N_SEEN]) {
    double ratio[last + 1], root[last + 1], factorial = 1;
    int measures = fabs(inputs[0][MEASURED_VOLTAGE]) >= p[LEAST];
    double v[last + 1], q[last + 1];
    for (int k = 0; k <= last; factorial *= ++k) {
        u[k][WANTED] = inputs[k][TARGET];
        v[k] = inputs[k][MEASURED_VOLTAGE] / factorial;
        q[k] = inputs[k][CHARGE] / (factorial * p[C0]);
    }
    factorial = 1;
    for (int k = 0; k <= last; factorial *= ++k) {
        u[k][SEEN] = 0;
        if (!measures)
            continue;
        ratio[k] = q[k];
        for (int j = 1; j <= k; j++)
            ratio[k] -= v[j] * ratio[k - j];
        ratio[k] /= v[0];
        double sum = 0;
        for (int j = 1; j <= k; j++)
            sum += (1.25 * j - k) * ratio[j] * root[k - j];
        root[k] = k ? sum / (k * ratio[0]) : sqrt(sqrt(ratio[0]));
        u[k][SEEN] = p[L] * (k ? factorial * root[k] : root[0] - 1);
    }
}

static void rates(const double *p, const double *u, const double *x, double *dx) {
    dx[0] = p[I] * (u[WANTED] - u[SEEN]);
    dx[1] = (u[SEEN] - x[1]) / p[F];
}
static void outputs(const double *p, const double *u, const double *x, double *y) {
    y[0] = x[0] + p[P] * (u[WANTED] - u[SEEN]) - p[D] * (u[SEEN] - x[1]) / p[F];
    y[1] = u[SEEN];
}

#include "linear.h"
