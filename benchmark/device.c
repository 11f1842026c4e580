/* Times the packed FMU in SI units and SUNDIALS once on one scene of the real device and prints rows of CSV.
 *
 *     device milliseconds=10 reference=rows.csv library=….so guid={…} time=… rate=… charge=…
 *            set:0=600 set:4=303e3 … get=53,54,68   c=100 linear=… cubic=… quintic=… phi=… eta=… r=… m1=… tau1=…
 *
 * The rows of the reference are time, stretch, rate and charge, all nondimensional. `time`, `rate` and `charge` are
 * the scales from them to SI units. Errors of rate and charge are over their largest values.
 *
 * CVODE with Adams and fixed-point iteration; CVODE with BDF, and ARKODE with the L-stable method of Kvaerno of order
 * 5, with Newton and a dense matrix. Relative and absolute tolerance are the same number; the absolute ones of rate and
 * charge are scaled by their largest values. Kvaerno's method ends a step at each row: its interpolation is less exact
 * than its steps where RC is small. There its stages must be solved more exactly than by default.
 */
#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <arkode/arkode_arkstep.h>
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_config.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include "fmi2FunctionTypes.h"
#include "timing.h"

enum { MOST_ROWS = 100, MOST_STATES = 6, MOST_START = 60, MOST_STEPS = 3000000 };
static const double LOST = 0.1, LONGEST = 3; /* an error of another motion; seconds that end a method */
static const double SMALL_RC = 1e-2;

static struct {
    double c, linear, cubic, quintic, phi, eta, r, m[3], tau[3];
    int branches, states;
} device;
static double milliseconds, times[MOST_ROWS], exact[MOST_ROWS][3], reached[MOST_ROWS][3], size[3] = {1, 0, 0};
static int rows;

/* The equation of motion times λ⁷, one division; the states are λ, λ', q if r > 0, and g of each branch. */
static int right_hand_side(double t, N_Vector state, N_Vector slope, void *user)
{
    const double *y = NV_DATA_S(state);
    double *d = NV_DATA_S(slope), x = y[0], v = y[1], square = x * x, fourth = square * square;
    double sixth = fourth * square, cubic = device.cubic, constant = square;
    int next = 2;
    (void)t, (void)user;
    if (device.r > 0) {
        constant += square * y[2] * y[2];
        d[2] = (device.phi - y[2] / fourth) / device.r;
        next = 3;
    } else {
        cubic -= device.phi * device.phi;
    }
    double elastic = square * (device.linear + square * (cubic + device.quintic * square));
    double upper = 6 * v * v + constant - sixth * elastic - 6 * device.eta * v * square * square * x;
    for (int k = 0; k < device.branches; k++) {
        double g = y[next + k];
        upper -= device.m[k] * (sixth * square / g - g * g * square);
        d[next + k] = (square - g * g * g / fourth) / (3 * device.tau[k]);
    }
    d[0] = v;
    d[1] = upper / (x * (device.c * sixth + 2));
    return 0;
}

static void record(int row, double stretch, double rate, double charge)
{
    reached[row][0] = stretch, reached[row][1] = rate, reached[row][2] = charge;
}

static double error(void)
{
    double worst = 0;
    for (int row = 0; row < rows; row++)
        for (int k = 0; k < 3; k++) {
            double difference = fabs(reached[row][k] - exact[row][k]) / size[k];
            if (!(difference <= worst))
                worst = difference;
        }
    return worst;
}

/* SUNDIALS */

static SUNContext context;

enum method { OURS, ADAMS, BDF, KVAERNO, METHODS };
static const char *const NAMES[] = {"packed FMU", "CVODE Adams", "CVODE BDF", "ARKODE Kvaerno 5"};

static int by_sundials(enum method method, double tolerance)
{
    N_Vector state = N_VNew_Serial(device.states, context), absolute = N_VClone(state);
    for (int k = 0; k < device.states; k++)
        NV_Ith_S(state, k) = k != 1, NV_Ith_S(absolute, k) = tolerance;
    NV_Ith_S(absolute, 1) *= size[1];
    if (device.r > 0)
        NV_Ith_S(state, 2) = 0, NV_Ith_S(absolute, 2) *= size[2];
    SUNMatrix matrix = SUNDenseMatrix(device.states, device.states, context);
    SUNLinearSolver dense = SUNLinSol_Dense(state, matrix, context);
    SUNNonlinearSolver fixed_point = SUNNonlinSol_FixedPoint(state, 0, context);
    void *solver;
    if (method == KVAERNO) {
        solver = ARKStepCreate(NULL, right_hand_side, 0, state, context);
        ARKStepSetTableNum(solver, ARKODE_KVAERNO_7_4_5, ARKODE_ERK_NONE);
        ARKStepSVtolerances(solver, tolerance, absolute);
        ARKStepSetMaxNumSteps(solver, MOST_STEPS);
        ARKStepSetLinearSolver(solver, dense, matrix);
        ARKStepSetDeduceImplicitRhs(solver, 1);
        if (device.r > 0 && device.r < SMALL_RC) {
            ARKStepSetNonlinConvCoef(solver, 1e-3);
            ARKStepSetMaxNonlinIters(solver, 10);
        }
    } else {
        solver = CVodeCreate(method == BDF ? CV_BDF : CV_ADAMS, context);
        CVodeInit(solver, right_hand_side, 0, state);
        CVodeSVtolerances(solver, tolerance, absolute);
        CVodeSetMaxNumSteps(solver, MOST_STEPS);
        if (method == BDF)
            CVodeSetLinearSolver(solver, dense, matrix);
        else
            CVodeSetNonlinearSolver(solver, fixed_point);
    }
    int done = 1;
    double t, begin = now();
    for (int row = 0; row < rows && done; row++) {
        if (method == KVAERNO)
            ARKStepSetStopTime(solver, times[row]);
        done = method == KVAERNO ? ARKStepEvolve(solver, times[row], state, &t, ARK_NORMAL) >= 0
                                 : CVode(solver, times[row], state, &t, CV_NORMAL) >= 0;
        double stretch = NV_Ith_S(state, 0);
        record(row, stretch, NV_Ith_S(state, 1), device.r > 0 ? NV_Ith_S(state, 2) : device.phi * pow(stretch, 4));
        done = done && now() - begin < 2 * LONGEST;
    }
    method == KVAERNO ? ARKStepFree(&solver) : CVodeFree(&solver);
    SUNNonlinSolFree(fixed_point);
    SUNLinSolFree(dense);
    SUNMatDestroy(matrix);
    N_VDestroy(absolute);
    N_VDestroy(state);
    return done;
}

/* The packed FMU */

static struct {
    fmi2Component instance;
    fmi2ResetTYPE *reset;
    fmi2SetupExperimentTYPE *setup;
    fmi2EnterInitializationModeTYPE *enter;
    fmi2ExitInitializationModeTYPE *leave;
    fmi2SetRealTYPE *set;
    fmi2GetRealTYPE *get;
    fmi2DoStepTYPE *step;
    fmi2ValueReference start[MOST_START], outputs[3];
    double values[MOST_START], time, rate, charge;
    size_t count;
} fmu;

static void quiet(fmi2ComponentEnvironment e, fmi2String name, fmi2Status status, fmi2String kind, fmi2String text, ...)
{
    (void)e, (void)name, (void)status, (void)kind;
    fprintf(stderr, "%s\n", text);
}

static void load(const char *path, const char *guid)
{
    static const fmi2CallbackFunctions callbacks = {quiet, calloc, free, NULL, NULL};
    void *library = dlopen(path, RTLD_NOW);
    if (!library)
        fprintf(stderr, "%s\n", dlerror()), exit(2);
    fmi2InstantiateTYPE *instantiate = (fmi2InstantiateTYPE *)dlsym(library, "fmi2Instantiate");
    fmu.reset = (fmi2ResetTYPE *)dlsym(library, "fmi2Reset");
    fmu.setup = (fmi2SetupExperimentTYPE *)dlsym(library, "fmi2SetupExperiment");
    fmu.enter = (fmi2EnterInitializationModeTYPE *)dlsym(library, "fmi2EnterInitializationMode");
    fmu.leave = (fmi2ExitInitializationModeTYPE *)dlsym(library, "fmi2ExitInitializationMode");
    fmu.set = (fmi2SetRealTYPE *)dlsym(library, "fmi2SetReal");
    fmu.get = (fmi2GetRealTYPE *)dlsym(library, "fmi2GetReal");
    fmu.step = (fmi2DoStepTYPE *)dlsym(library, "fmi2DoStep");
    fmu.instance = instantiate("device", fmi2CoSimulation, guid, "", &callbacks, fmi2False, fmi2False);
    if (!fmu.instance)
        exit(2);
}

static int by_fmu(enum method method, double tolerance)
{
    (void)method;
    fmu.reset(fmu.instance);
    fmu.setup(fmu.instance, fmi2True, tolerance, 0, fmi2False, 0);
    if (fmu.set(fmu.instance, fmu.start, fmu.count, fmu.values) != fmi2OK)
        return 0;
    fmu.enter(fmu.instance);
    if (fmu.leave(fmu.instance) != fmi2OK)
        return 0;
    double before = 0;
    for (int row = 0; row < rows; row++) {
        double time = times[row] * fmu.time, found[3];
        if (fmu.step(fmu.instance, before, time - before, fmi2True) != fmi2OK)
            return 0;
        fmu.get(fmu.instance, fmu.outputs, 3, found);
        record(row, found[0], found[1] / fmu.rate, found[2] / fmu.charge);
        before = time;
    }
    return 1;
}

static void measure(enum method method)
{
    int (*run)(enum method, double) = method == OURS ? by_fmu : by_sundials;
    for (int exponent = 3; exponent <= 13; exponent++) {
        double tolerance = pow(10, -exponent), begin = now(), single, batches[BATCHES];
        int done = run(method, tolerance);
        single = now() - begin;
        if (!done || !(error() <= LOST)) {
            printf("%s,1e-%d,,,not timed: %s\n", NAMES[method], exponent, done ? "another motion" : "failed");
            if (single > LONGEST)
                return;
            continue;
        }
        double found = error();
        if (method == OURS && found > 10 * tolerance + 1e-12)
            fprintf(stderr, "the FMU misses %g at the tolerance %g\n", found, tolerance), exit(3);
        for (int k = 0; k < (single > LONGEST ? 0 : BATCHES); k++) {
            long runs = 0;
            double passed;
            begin = now();
            do {
                run(method, tolerance);
                runs++;
                passed = now() - begin;
            } while (passed < 1e-3 * milliseconds / BATCHES);
            batches[k] = passed / runs;
        }
        double seconds = single > LONGEST ? single : median(batches);
        printf("%s,1e-%d,%.4e,%.4e,\n", NAMES[method], exponent, 1e6 * seconds, found);
        if (single > LONGEST)
            return;
    }
}

static void read_reference(const char *path)
{
    char line[400];
    FILE *file = fopen(path, "r");
    if (!file)
        exit(2);
    while (rows < MOST_ROWS && fgets(line, sizeof line, file)) {
        double *x = exact[rows];
        if (sscanf(line, "%lf,%lf,%lf,%lf", &times[rows], x, x + 1, x + 2) == 4 && times[rows] > 0)
            rows++;
    }
    fclose(file);
    for (int row = 0; row < rows; row++)
        for (int k = 1; k < 3; k++)
            size[k] = fmax(size[k], fabs(exact[row][k]));
}

int main(int count, char **words)
{
    const char *library = "", *guid = "";
    struct { const char *name; double *value; } numbers[] = {
        {"milliseconds", &milliseconds}, {"time", &fmu.time}, {"rate", &fmu.rate}, {"charge", &fmu.charge},
        {"c", &device.c}, {"linear", &device.linear}, {"cubic", &device.cubic}, {"quintic", &device.quintic},
        {"phi", &device.phi}, {"eta", &device.eta}, {"r", &device.r},
        {"m1", device.m}, {"m2", device.m + 1}, {"m3", device.m + 2},
        {"tau1", device.tau}, {"tau2", device.tau + 1}, {"tau3", device.tau + 2},
    };
    if (count == 2 && !strcmp(words[1], "version")) {
        puts(SUNDIALS_VERSION);
        return 0;
    }
    for (int k = 1; k < count; k++) {
        char *value = strchr(words[k], '=');
        *value++ = 0;
        if (!strncmp(words[k], "set:", 4)) {
            fmu.start[fmu.count] = atoi(words[k] + 4);
            fmu.values[fmu.count++] = atof(value);
        }
        if (!strcmp(words[k], "get"))
            sscanf(value, "%u,%u,%u", fmu.outputs, fmu.outputs + 1, fmu.outputs + 2);
        if (!strcmp(words[k], "reference"))
            read_reference(value);
        if (!strcmp(words[k], "library"))
            library = value;
        if (!strcmp(words[k], "guid"))
            guid = value;
        for (size_t n = 0; n < sizeof numbers / sizeof *numbers; n++)
            if (!strcmp(words[k], numbers[n].name))
                *numbers[n].value = atof(value);
    }
    while (device.branches < 3 && device.m[device.branches] > 0)
        device.branches++;
    device.states = 2 + (device.r > 0) + device.branches;
    load(library, guid);
#if SUNDIALS_VERSION_MAJOR >= 7
    SUNContext_Create(SUN_COMM_NULL, &context);
#else
    SUNContext_Create(NULL, &context);
#endif
    for (enum method method = OURS; method < METHODS; method++)
        measure(method);
    SUNContext_Free(&context);
    return 0;
}
