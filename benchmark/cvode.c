/* Times SUNDIALS CVODE once on one case and prints rows of CSV, as the Rust side does.
 *
 *     cvode free|steps milliseconds=10 c=100 gamma_s=... reference=case_a.csv
 *
 * Adams with fixed-point iteration and BDF with Newton and a dense matrix, as the
 * examples of SUNDIALS pair them. Relative and absolute tolerance are the same number.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_config.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>
#ifdef WITH_BDF
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#endif

#include "timing.h"

/* MOST_STEPS between two times: enough for every tolerance, and an end for a run that escapes. */
enum { MOST_ROWS = 100, LONGEST = 1, MOST_STEPS = 200000 };
static const double LOST = 0.1; /* an error of a run that follows another motion */

static double c, gamma_s, tau_s, E_s, S, phi, phi_ac, omega_ac, linear, cubic, quintic, milliseconds;
static double times[MOST_ROWS], exact[MOST_ROWS][2], reached[MOST_ROWS][2];
static int rows;
static SUNContext context;

static int right_hand_side(double t, N_Vector state, N_Vector slope, void *voltage)
{
    const double *y = NV_DATA_S(state);
    double *d = NV_DATA_S(slope), x = y[0], v = y[1], square = x * x, sixth = square * square * square;
    double u = *(const double *)voltage + (phi_ac != 0 ? phi_ac * sin(omega_ac * t) : 0);
    double elastic = square * (linear + square * (cubic - u * u + quintic * square));
    d[0] = v;
    d[1] = (6 * v * v + square + sixth * (S * x - elastic)) / (x * (c * sixth + 2));
    return 0;
}

/* A solver at rest at lambda = 1 and what has to be freed with it. */
struct solver {
    void *cvode;
    N_Vector state;
    SUNNonlinearSolver fixed_point;
#ifdef WITH_BDF
    SUNMatrix matrix;
    SUNLinearSolver dense;
#endif
    double voltage;
    int bdf;
};

static void start(struct solver *s, int bdf, double tolerance)
{
    s->bdf = bdf;
    s->voltage = phi;
    s->state = N_VNew_Serial(2, context);
    NV_Ith_S(s->state, 0) = 1;
    NV_Ith_S(s->state, 1) = 0;
    s->cvode = CVodeCreate(bdf ? CV_BDF : CV_ADAMS, context);
    CVodeInit(s->cvode, right_hand_side, 0, s->state);
    CVodeSStolerances(s->cvode, tolerance, tolerance);
    CVodeSetMaxNumSteps(s->cvode, MOST_STEPS);
    CVodeSetUserData(s->cvode, &s->voltage);
#ifdef WITH_BDF
    if (bdf) {
        s->matrix = SUNDenseMatrix(2, 2, context);
        s->dense = SUNLinSol_Dense(s->state, s->matrix, context);
        CVodeSetLinearSolver(s->cvode, s->dense, s->matrix);
        return;
    }
#endif
    s->fixed_point = SUNNonlinSol_FixedPoint(s->state, 0, context);
    CVodeSetNonlinearSolver(s->cvode, s->fixed_point);
}

static void stop(struct solver *s)
{
#ifdef WITH_BDF
    if (s->bdf) {
        SUNLinSolFree(s->dense);
        SUNMatDestroy(s->matrix);
    }
#endif
    if (!s->bdf)
        SUNNonlinSolFree(s->fixed_point);
    CVodeFree(&s->cvode);
    N_VDestroy(s->state);
}

/* A fresh run over the times of the reference; 0 where it fails. */
static int follow(int bdf, double tolerance)
{
    struct solver s;
    double t;
    int row, done = 1;
    start(&s, bdf, tolerance);
    for (row = 0; row < rows && done; row++) {
        done = CVode(s.cvode, times[row], s.state, &t, CV_NORMAL) >= 0;
        memcpy(reached[row], NV_DATA_S(s.state), sizeof reached[row]);
    }
    stop(&s);
    return done;
}

static double error_of(int compared)
{
    double worst = 0;
    for (int row = 0; row < compared; row++)
        for (int k = 0; k < 2; k++) {
            double difference = fabs(reached[row][k] - exact[row][k]);
            if (!(difference <= worst))
                worst = difference;
        }
    return worst;
}

static void free_running(int bdf)
{
    const char *name = bdf ? "CVODE BDF" : "CVODE Adams";
    for (int exponent = 4; exponent <= 13; exponent++) {
        double tolerance = pow(10, -exponent), begin = now(), single, error, passed, batches[BATCHES];
        long runs;
        if (!follow(bdf, tolerance)) {
            printf("%s,1e-%d,,unchanged,,,,failed\n", name, exponent);
            continue;
        }
        single = now() - begin;
        error = error_of(rows);
        if (!(error <= LOST)) {
            printf("%s,1e-%d,,unchanged,,%.4e,,not timed: error above %g\n", name, exponent, error, LOST);
            continue;
        }
        for (int k = 0; k < BATCHES; k++) {
            runs = 0;
            begin = now();
            do {
                follow(bdf, tolerance);
                runs++;
                passed = now() - begin;
            } while (passed < 1e-3 * milliseconds / BATCHES);
            batches[k] = passed / runs;
        }
        printf("%s,1e-%d,,unchanged,%.4e,%.4e,,\n", name, exponent, 1e9 * median(batches) / times[rows - 1], error);
        if (single > LONGEST)
            break;
    }
}

enum pattern { CONTINUED, REINITIALISED };

/* Communication steps over the first `compared` times of the reference. Returns seconds, or NaN where a step fails. */
static double step_by_step(enum pattern pattern, double tolerance, double step, int compared)
{
    struct solver s;
    double t, begin, passed;
    long calls = lround(times[compared - 1] / step);
    int row = 0;
    start(&s, 0, tolerance);
    begin = now();
    for (long call = 0; call < calls; call++) {
        if (pattern != CONTINUED)
            CVodeReInit(s.cvode, call * step, s.state);
        if (CVode(s.cvode, (call + 1) * step, s.state, &t, CV_NORMAL) < 0) {
            stop(&s);
            return NAN;
        }
        for (; row < compared && (call + 1.5) * step > times[row]; row++) {
            int met = fabs((call + 1) * step - times[row]) < 1e-6 * step;
            memcpy(reached[row], met ? NV_DATA_S(s.state) : exact[row], sizeof reached[row]);
        }
    }
    passed = now() - begin;
    stop(&s);
    return passed;
}

static void stepping(void)
{
    static const double steps[] = {0.001, 0.01, 0.1, 1, 10};
    static const char *names[] = {"CVODE Adams continued", "CVODE Adams re-initialised"};
    const double tolerance = 1e-12;
    for (int k = 0; k < 5; k++)
        for (int pattern = CONTINUED; pattern <= REINITIALISED; pattern++) {
            double most = 2e4 * steps[k], batches[BATCHES], error;
            int compared = 1;
            while (compared < rows && times[compared] <= most)
                compared++;
            while (compared > 1 && fabs(remainder(times[compared - 1], steps[k])) > 1e-6 * steps[k])
                compared--;
            int failed = isnan(step_by_step(pattern, tolerance, steps[k], compared));
            error = error_of(compared);
            if (failed || !(error <= LOST)) {
                printf("%s,1e-12,%g,unchanged,,,,%s\n", names[pattern], steps[k],
                       failed ? "failed" : "not timed: another motion");
                continue;
            }
            for (int n = 0; n < BATCHES; n++)
                batches[n] = step_by_step(pattern, tolerance, steps[k], compared);
            printf("%s,1e-12,%g,unchanged,%.4e,%.4e,,\n", names[pattern], steps[k],
                   1e9 * median(batches) / lround(times[compared - 1] / steps[k]), error);
        }
}

static void read_reference(const char *path)
{
    char line[400];
    FILE *file = fopen(path, "r");
    if (!file || !fgets(line, sizeof line, file))
        exit(2);
    while (rows < MOST_ROWS && fgets(line, sizeof line, file))
        if (sscanf(line, "%lf,%lf,%lf", &times[rows], &exact[rows][0], &exact[rows][1]) == 3 && times[rows] > 0)
            rows++;
    fclose(file);
}

int main(int count, char **words)
{
    struct { const char *name; double *value; } numbers[] = {
        {"milliseconds", &milliseconds}, {"c", &c}, {"gamma_s", &gamma_s}, {"tau_s", &tau_s}, {"E_s", &E_s},
        {"S", &S}, {"phi", &phi}, {"phi_ac", &phi_ac}, {"omega_ac", &omega_ac},
    };
    if (count == 2 && !strcmp(words[1], "version")) {
        puts(SUNDIALS_VERSION);
        return 0;
    }
    for (int k = 2; k < count; k++) {
        char *value = strchr(words[k], '=');
        *value++ = 0;
        if (!strcmp(words[k], "reference"))
            read_reference(value);
        for (size_t n = 0; n < sizeof numbers / sizeof *numbers; n++)
            if (!strcmp(words[k], numbers[n].name))
                *numbers[n].value = atof(value);
    }
    linear = 1 + 2 * (gamma_s - tau_s) + E_s;
    cubic = 4 * (tau_s - E_s);
    quintic = 3 * E_s;
#if SUNDIALS_VERSION_MAJOR >= 7
    SUNContext_Create(SUN_COMM_NULL, &context);
#else
    SUNContext_Create(NULL, &context);
#endif
    if (count > 1 && !strcmp(words[1], "steps")) {
        stepping();
    } else {
        free_running(0);
#ifdef WITH_BDF
        free_running(1);
#endif
    }
    SUNContext_Free(&context);
    return 0;
}
