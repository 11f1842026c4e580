/* An FMI 2.0 co-simulation FMU of a linear system, x' = A x + B u, y = C x + D u.
 *
 * A model file names its variables in one enum, inputs first, then outputs, states, parameters, and defines
 *
 *     N_INPUTS, N_OUTPUTS, N_STATES, N_VALUES    how many; the position is the value reference
 *     GUID, START                                start values of all variables
 *     initialize                                 states from parameters, at the start
 *     fastest                                    the smallest time constant
 *     rates, outputs                             A x + B u and C x + D u
 *
 * before it includes this file. Inputs may be polynomials of time (fmi2SetRealInputDerivatives). The step is
 * then solved by the Taylor series of the states, exactly but for rounding: each derivative of a linear system
 * follows from the one before. The same series gives the derivatives of the outputs.
 *
 * A model that measures, that is, whose u is a nonlinear function of its inputs, defines N_SEEN and `see` too:
 * u and its derivatives up to the order `last`, from the inputs and theirs.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"

#define ORDERS 5 /* of inputs: value and four derivatives */
#define TERMS 30 /* of the series, over at most one smallest time constant: the last is below 1e-30 */

typedef struct {
    double value[N_VALUES];
    double input[ORDERS][N_INPUTS]; /* derivatives at the present time; [0] is the value */
    int initialized;
} Instance;

static const double start[N_VALUES] = START;

static double *states(Instance *m) { return m->value + N_INPUTS + N_OUTPUTS; }
static const double *parameters(const Instance *m) { return m->value + N_INPUTS + N_OUTPUTS + N_STATES; }

#ifndef N_SEEN
#define N_SEEN N_INPUTS
static void see(const double *p, int last, double inputs[][N_INPUTS], double u[][N_SEEN]) {
    (void)p, memcpy(u, inputs, (last + 1) * sizeof *u);
}
#endif

/* Derivatives of u and of the states at the present time, up to the order `last`. */
static void series(Instance *m, int last, double u[][N_SEEN], double x[][N_STATES]) {
    double inputs[TERMS + 1][N_INPUTS] = {{0}};
    memcpy(inputs, m->input, sizeof m->input);
    see(parameters(m), last, inputs, u);
    memcpy(x[0], states(m), sizeof x[0]);
    for (int k = 0; k < last; k++)
        rates(parameters(m), u[k], x[k], x[k + 1]);
}

static void refresh(Instance *m) {
    double u[1][N_SEEN], x[1][N_STATES];
    series(m, 0, u, x);
    memcpy(m->value, m->input[0], sizeof m->input[0]);
    outputs(parameters(m), u[0], x[0], m->value + N_INPUTS);
}

/* Over a span that is short for the system. */
static void advance(Instance *m, double span) {
    double u[TERMS + 1][N_SEEN], x[TERMS + 1][N_STATES];
    series(m, TERMS, u, x);
    for (int i = 0; i < N_STATES; i++) {
        double sum = 0;
        for (int k = TERMS; k > 0; k--)
            sum = (sum + x[k][i]) * span / k;
        states(m)[i] += sum;
    }
    for (int k = 0; k < ORDERS; k++)
        for (int i = 0; i < N_INPUTS; i++) {
            double sum = 0;
            for (int j = ORDERS - 1; j > k; j--)
                sum = (sum + m->input[j][i]) * span / (j - k);
            m->input[k][i] += sum;
        }
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging) {
    (void)name, (void)resources, (void)callbacks, (void)visible, (void)logging;
    if (type != fmi2CoSimulation || !guid || strcmp(guid, GUID) != 0)
        return NULL;
    Instance *m = calloc(1, sizeof *m);
    if (m)
        fmi2Reset(m);
    return m;
}

void fmi2FreeInstance(fmi2Component c) { free(c); }

fmi2Status fmi2Reset(fmi2Component c) {
    Instance *m = c;
    memset(m, 0, sizeof *m);
    memcpy(m->value, start, sizeof start);
    memcpy(m->input[0], start, sizeof m->input[0]);
    initialize(parameters(m), states(m));
    refresh(m);
    return fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[]) {
    for (size_t i = 0; i < n; i++)
        if (vr[i] >= N_VALUES)
            return fmi2Error;
    for (size_t i = 0; i < n; i++)
        value[i] = ((Instance *)c)->value[vr[i]];
    return fmi2OK;
}

/* Inputs at any time, parameters before the initialization ends. */
fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real value[]) {
    Instance *m = c;
    for (size_t i = 0; i < n; i++) {
        int is_input = vr[i] < N_INPUTS;
        int is_parameter = vr[i] >= N_INPUTS + N_OUTPUTS + N_STATES && vr[i] < N_VALUES;
        if (!isfinite(value[i]) || !(is_input || (is_parameter && !m->initialized)))
            return fmi2Error;
    }
    for (size_t i = 0; i < n; i++) {
        m->value[vr[i]] = value[i];
        if (vr[i] < N_INPUTS)
            for (int k = 0; k < ORDERS; k++)
                m->input[k][vr[i]] = k ? 0 : value[i];
    }
    if (!m->initialized)
        initialize(parameters(m), states(m));
    refresh(m);
    return fmi2OK;
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                       const fmi2Integer order[], const fmi2Real value[]) {
    for (size_t i = 0; i < n; i++)
        if (vr[i] >= N_INPUTS || order[i] < 1 || order[i] >= ORDERS || !isfinite(value[i]))
            return fmi2Error;
    for (size_t i = 0; i < n; i++)
        ((Instance *)c)->input[order[i]][vr[i]] = value[i];
    return fmi2OK;
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                        const fmi2Integer order[], fmi2Real value[]) {
    for (size_t i = 0; i < n; i++) {
        if (vr[i] < N_INPUTS || vr[i] >= N_INPUTS + N_OUTPUTS || order[i] < 1 || order[i] > TERMS)
            return fmi2Error;
        double u[TERMS + 1][N_SEEN], x[TERMS + 1][N_STATES], y[N_OUTPUTS];
        series(c, order[i], u, x);
        outputs(parameters(c), u[order[i]], x[order[i]], y);
        value[i] = y[vr[i] - N_INPUTS];
    }
    return fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean no_return) {
    Instance *m = c;
    (void)time, (void)no_return;
    if (!(step > 0) || !isfinite(step) || !(fastest(parameters(m)) > 0))
        return fmi2Error;
    double pieces = ceil(step / fastest(parameters(m)));
    for (double piece = 0; piece < pieces; piece++)
        advance(m, step / pieces);
    refresh(m);
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    ((Instance *)c)->initialized = 1;
    return fmi2OK;
}

/* What these models have nothing to say to: fmi2OK where there is nothing to do, else fmi2Error. */
const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }
#define ANSWER(name, arguments, status) \
    fmi2Status name arguments { return status; }
#define REFERENCES fmi2Component c, const fmi2ValueReference vr[], size_t n
ANSWER(fmi2SetDebugLogging, (fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[]), fmi2OK)
ANSWER(fmi2SetupExperiment, (fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance, fmi2Real from,
                             fmi2Boolean stop_defined, fmi2Real stop), fmi2OK)
ANSWER(fmi2EnterInitializationMode, (fmi2Component c), fmi2OK)
ANSWER(fmi2Terminate, (fmi2Component c), fmi2OK)
ANSWER(fmi2GetInteger, (REFERENCES, fmi2Integer value[]), n ? fmi2Error : fmi2OK)
ANSWER(fmi2GetBoolean, (REFERENCES, fmi2Boolean value[]), n ? fmi2Error : fmi2OK)
ANSWER(fmi2GetString, (REFERENCES, fmi2String value[]), n ? fmi2Error : fmi2OK)
ANSWER(fmi2SetInteger, (REFERENCES, const fmi2Integer value[]), n ? fmi2Error : fmi2OK)
ANSWER(fmi2SetBoolean, (REFERENCES, const fmi2Boolean value[]), n ? fmi2Error : fmi2OK)
ANSWER(fmi2SetString, (REFERENCES, const fmi2String value[]), n ? fmi2Error : fmi2OK)
ANSWER(fmi2GetFMUstate, (fmi2Component c, fmi2FMUstate *state), fmi2Error)
ANSWER(fmi2SetFMUstate, (fmi2Component c, fmi2FMUstate state), fmi2Error)
ANSWER(fmi2FreeFMUstate, (fmi2Component c, fmi2FMUstate *state), fmi2Error)
ANSWER(fmi2SerializedFMUstateSize, (fmi2Component c, fmi2FMUstate state, size_t *size), fmi2Error)
ANSWER(fmi2SerializeFMUstate, (fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size), fmi2Error)
ANSWER(fmi2DeSerializeFMUstate, (fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state), fmi2Error)
ANSWER(fmi2GetDirectionalDerivative, (fmi2Component c, const fmi2ValueReference unknown[], size_t unknowns,
                                      const fmi2ValueReference known[], size_t knowns, const fmi2Real seed[],
                                      fmi2Real value[]), fmi2Error)
ANSWER(fmi2CancelStep, (fmi2Component c), fmi2Error)
ANSWER(fmi2GetStatus, (fmi2Component c, const fmi2StatusKind kind, fmi2Status *value), fmi2Discard)
ANSWER(fmi2GetRealStatus, (fmi2Component c, const fmi2StatusKind kind, fmi2Real *value), fmi2Discard)
ANSWER(fmi2GetIntegerStatus, (fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value), fmi2Discard)
ANSWER(fmi2GetBooleanStatus, (fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value), fmi2Discard)
ANSWER(fmi2GetStringStatus, (fmi2Component c, const fmi2StatusKind kind, fmi2String *value), fmi2Discard)
