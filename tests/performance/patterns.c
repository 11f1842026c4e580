/* The calls of a host that must be fast, for callgrind to count their instructions.
 *
 *   patterns LIBRARY GUID PATTERN COUNT NAME=REFERENCE...
 *
 * Runs PATTERN COUNT times inside `measured`; what comes before and after is not counted. Prints the stretch at the
 * end. */
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"

#define FUNCTIONS(X)                                                                                         \
    X(fmi2Instantiate) X(fmi2SetupExperiment) X(fmi2EnterInitializationMode) X(fmi2ExitInitializationMode)   \
    X(fmi2SetReal) X(fmi2GetReal) X(fmi2DoStep) X(fmi2GetFMUstate) X(fmi2SetFMUstate) X(fmi2FreeFMUstate)    \
    X(fmi2FreeInstance)
#define DECLARE(name) static name##TYPE *call_##name;
#define LOAD(name) call_##name = (name##TYPE *)find(library, #name);
#define OK(call)                                                                                             \
    do {                                                                                                     \
        if ((call) != fmi2OK) fail(#call);                                                                   \
    } while (0)

FUNCTIONS(DECLARE)

static int references;
static char **reference_of;
static fmi2Component component;
static double now;

static void fail(const char *what)
{
    fprintf(stderr, "%s failed\n", what);
    exit(1);
}

static void *find(void *library, const char *name)
{
    void *found = dlsym(library, name);
    if (!found) fail(name);
    return found;
}

static fmi2ValueReference reference(const char *name)
{
    size_t length = strlen(name);
    for (int i = 0; i < references; ++i)
        if (!strncmp(reference_of[i], name, length) && reference_of[i][length] == '=')
            return (fmi2ValueReference)strtoul(reference_of[i] + length + 1, NULL, 10);
    fail(name);
    return 0;
}

static void set(const char *name, double value)
{
    fmi2ValueReference known = reference(name);
    OK(call_fmi2SetReal(component, &known, 1, &value));
}

static void set_up(const char *pattern)
{
    if (strstr(pattern, "device_")) {
        set("voltage", 500.0);
        return;
    }
    set("gamma_s", 0.05);
    set("tau_s", 0.05);
    set("E_s", 0.2);
    if (strstr(pattern, "_ac")) {
        set("phi_ac", 0.3);
        set("omega_ac", 0.1438);
    } else {
        set("phi", 0.5);
    }
}

static void step(double length)
{
    OK(call_fmi2DoStep(component, now, length, fmi2True));
    now += length;
}

/* Communication steps under inputs that stay. */
static void steps(int count, double length)
{
    for (int i = 0; i < count; ++i) step(length);
}

static void changed_steps(int count, double length)
{
    fmi2ValueReference phi = reference("phi"), lambda = reference("lambda");
    for (int i = 0; i < count; ++i) {
        double voltage = 0.3 + 1e-4 * (i % 100), stretch;
        OK(call_fmi2SetReal(component, &phi, 1, &voltage));
        step(length);
        OK(call_fmi2GetReal(component, &lambda, 1, &stretch));
    }
}

static void readings(int count, const char *name)
{
    fmi2ValueReference known = reference(name);
    double value;
    for (int i = 0; i < count; ++i) OK(call_fmi2GetReal(component, &known, 1, &value));
}

/* A host that records all of the actuator in SI units reads so much in one call. */
static void device_readings(int count)
{
    static const char *const names[] = {
        "lambda", "lambda3", "edge_distance", "edge_velocity", "charge", "supply_current",
        "capacitance", "membrane_voltage", "electric_field", "electrical_power",
    };
    enum { COUNT = sizeof names / sizeof *names };
    fmi2ValueReference known[COUNT];
    double values[COUNT];
    for (int k = 0; k < COUNT; ++k) known[k] = reference(names[k]);
    for (int i = 0; i < count; ++i) OK(call_fmi2GetReal(component, known, COUNT, values));
}

static void states(int count)
{
    fmi2FMUstate state = NULL;
    for (int i = 0; i < count; ++i) {
        OK(call_fmi2GetFMUstate(component, &state));
        OK(call_fmi2SetFMUstate(component, state));
    }
    OK(call_fmi2FreeFMUstate(component, &state));
}

static void run(const char *pattern, int count)
{
    if (!strcmp(pattern, "step") || !strcmp(pattern, "step_ac")) steps(count, 0.01);
    else if (!strcmp(pattern, "set_step_get")) changed_steps(count, 0.01);
    else if (!strcmp(pattern, "long_step_dc") || !strcmp(pattern, "long_step_ac")) steps(count, 25.0);
    else if (!strcmp(pattern, "get")) readings(count, "lambda3");
    else if (!strcmp(pattern, "get_threshold")) readings(count, "phi_pull_in");
    else if (!strcmp(pattern, "device_get")) device_readings(count);
    else if (!strcmp(pattern, "save_restore")) states(count);
    else fail(pattern);
}

/* What callgrind counts. */
__attribute__((noinline)) void measured(const char *pattern, int count)
{
    run(pattern, count);
}

static void logger(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                   fmi2String message, ...)
{
    (void)environment, (void)name, (void)status, (void)category;
    fprintf(stderr, "%s\n", message);
}

int main(int argc, char **argv)
{
    if (argc < 5) fail("the command line");
    const char *pattern = argv[3];
    const fmi2CallbackFunctions callbacks = {logger, calloc, free, NULL, NULL};
    references = argc - 5;
    reference_of = argv + 5;
    void *library = dlopen(argv[1], RTLD_NOW | RTLD_LOCAL);
    if (!library) fail(argv[1]);
    FUNCTIONS(LOAD)
    component = call_fmi2Instantiate("actuator", fmi2CoSimulation, argv[2], NULL, &callbacks, fmi2False, fmi2False);
    if (!component) fail("fmi2Instantiate");
    OK(call_fmi2SetupExperiment(component, fmi2True, 1e-9, 0.0, fmi2False, 0.0));
    OK(call_fmi2EnterInitializationMode(component));
    set_up(pattern);
    OK(call_fmi2ExitInitializationMode(component));
    /* The first time round takes what later ones find ready. */
    run(pattern, 10);
    measured(pattern, atoi(argv[4]));
    fmi2ValueReference lambda = reference("lambda");
    double stretch;
    OK(call_fmi2GetReal(component, &lambda, 1, &stretch));
    printf("%.17g\n", stretch);
    call_fmi2FreeInstance(component);
    return 0;
}
