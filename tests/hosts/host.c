/* A small host in C for the packed library: what valgrind, the race checkers and the memory curves run.
 *
 *   host LIBRARY GUID scenes N     N scenes one after the other, each in an instance of its own
 *   host LIBRARY GUID threads N    N scenes at once, each in a thread of its own
 *   host LIBRARY GUID later N      the same after a first scene
 *   host LIBRARY GUID loads N      N times: load the library, a scene, unload it
 *   host LIBRARY GUID instances N  N times: instantiate and free
 *
 * Any answer that is not the expected one ends it with status 1. `loads` and `instances` print the resident
 * memory, in KiB, ten times on the way. */
#include <dlfcn.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "fmi2Functions.h"

#define FUNCTIONS(DO) \
    DO(fmi2Instantiate) DO(fmi2SetupExperiment) DO(fmi2EnterInitializationMode) \
    DO(fmi2ExitInitializationMode) DO(fmi2SetReal) DO(fmi2GetReal) DO(fmi2DoStep) \
    DO(fmi2SetRealInputDerivatives) DO(fmi2GetRealOutputDerivatives) DO(fmi2GetFMUstate) \
    DO(fmi2SetFMUstate) DO(fmi2FreeFMUstate) DO(fmi2SerializedFMUstateSize) DO(fmi2SerializeFMUstate) \
    DO(fmi2DeSerializeFMUstate) DO(fmi2GetDirectionalDerivative) DO(fmi2Terminate) DO(fmi2Reset) \
    DO(fmi2FreeInstance) DO(fmi2SetDebugLogging) DO(fmi2NewDiscreteStates) \
    DO(fmi2EnterContinuousTimeMode) DO(fmi2SetTime) DO(fmi2SetContinuousStates) DO(fmi2GetDerivatives) \
    DO(fmi2GetEventIndicators) DO(fmi2GetContinuousStates) DO(fmi2CompletedIntegratorStep)
#define LOAD(name) name##TYPE *name = functions.name
#define EXPECT(status, call)                                                                             \
    do {                                                                                                 \
        fmi2Status answer = (call);                                                                      \
        if (answer != (status)) fail(#call, answer);                                                     \
    } while (0)
#define OK(call) EXPECT(fmi2OK, call)

enum { PHI = 0, S = 1, STEPS = 60, ALL = 29 };

static const char *guid;
static void *library;

/* Looked up once: the lock that dlsym takes would order the threads for the race checkers, and hide races. */
static struct {
#define MEMBER(name) name##TYPE *name;
    FUNCTIONS(MEMBER)
} functions;

static void fail(const char *what, int answer)
{
    fprintf(stderr, "%s gave %d\n", what, answer);
    exit(1);
}

static void *find(const char *name)
{
    void *found = dlsym(library, name);
    if (!found) fail(name, -1);
    return found;
}

static void open_library(const char *path)
{
    library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!library) fail(dlerror(), -1);
#define FIND(name) functions.name = (name##TYPE *)find(#name);
    FUNCTIONS(FIND)
}

/* Formats as a host would, and counts the lines. */
static void logger(fmi2ComponentEnvironment lines, fmi2String name, fmi2Status status, fmi2String category,
                   fmi2String message, ...)
{
    char text[1000];
    va_list arguments;
    va_start(arguments, message);
    vsnprintf(text, sizeof text, message, arguments);
    va_end(arguments);
    if (!name || !category || !*text) fail("logger", status);
    ++*(int *)lines;
}

/* Co-simulation with everything that has memory of its own: inputs and their derivatives, states, their
 * bytes, a collapse, refused calls. The same stretch whenever it is run. */
static double co_simulation(const fmi2CallbackFunctions *callbacks)
{
    LOAD(fmi2Instantiate); LOAD(fmi2SetupExperiment); LOAD(fmi2EnterInitializationMode);
    LOAD(fmi2ExitInitializationMode); LOAD(fmi2SetReal); LOAD(fmi2GetReal); LOAD(fmi2DoStep);
    LOAD(fmi2SetRealInputDerivatives); LOAD(fmi2GetRealOutputDerivatives); LOAD(fmi2GetFMUstate);
    LOAD(fmi2SetFMUstate); LOAD(fmi2FreeFMUstate); LOAD(fmi2SerializedFMUstateSize);
    LOAD(fmi2SerializeFMUstate); LOAD(fmi2DeSerializeFMUstate); LOAD(fmi2GetDirectionalDerivative);
    LOAD(fmi2Terminate); LOAD(fmi2Reset); LOAD(fmi2FreeInstance); LOAD(fmi2SetDebugLogging);

    fmi2Component c = fmi2Instantiate("actuator", fmi2CoSimulation, guid, NULL, callbacks, fmi2False, fmi2True);
    if (!c) fail("fmi2Instantiate", -1);
    const char *categories[] = {"logEvents", "logStatusError"};
    OK(fmi2SetDebugLogging(c, fmi2True, 2, categories));
    const fmi2ValueReference inputs[] = {PHI, S};
    const fmi2Real start[] = {0.5, 0.1}, slope = 0.002, one = 1;
    OK(fmi2SetupExperiment(c, fmi2True, 1e-9, 0, fmi2False, 0));
    OK(fmi2EnterInitializationMode(c));
    OK(fmi2SetReal(c, inputs, 2, start));
    OK(fmi2ExitInitializationMode(c));

    fmi2FMUstate state = NULL, copy = NULL;
    fmi2ValueReference all[ALL];
    fmi2Real values[ALL], then = 0, now = 0, derivative;
    const fmi2Integer order = 1;
    size_t size;
    for (fmi2ValueReference i = 0; i < ALL; ++i) all[i] = i;
    for (int step = 0; step < STEPS; ++step) {
        if (step % 20 == 7) OK(fmi2SetRealInputDerivatives(c, inputs, 1, &order, &slope));
        if (step % 20 == 15) OK(fmi2SetReal(c, inputs, 2, start));
        OK(fmi2DoStep(c, step * 0.5, 0.5, fmi2False));
        if (step == 30) OK(fmi2GetFMUstate(c, &state));
        /* What is no real, or is undefined, is refused. */
        fmi2GetReal(c, all, ALL, values);
        EXPECT(fmi2Error, fmi2DoStep(c, -7, 0.5, fmi2True));
    }
    fmi2ValueReference lambda = 0;
    for (; lambda < ALL; ++lambda)
        if (fmi2GetRealOutputDerivatives(c, &lambda, 1, &order, &derivative) == fmi2OK) break;
    OK(fmi2GetReal(c, &lambda, 1, &then));
    OK(fmi2GetDirectionalDerivative(c, &lambda, 1, inputs, 1, &one, &derivative));

    OK(fmi2SerializedFMUstateSize(c, state, &size));
    fmi2Byte *bytes = malloc(size);
    OK(fmi2SerializeFMUstate(c, state, bytes, size));
    OK(fmi2Terminate(c));
    OK(fmi2Reset(c));
    OK(fmi2DeSerializeFMUstate(c, bytes, size, &copy));
    bytes[size / 2] ^= 1;
    EXPECT(fmi2Error, fmi2DeSerializeFMUstate(c, bytes, size, &copy));
    free(bytes);
    OK(fmi2SetFMUstate(c, copy));
    OK(fmi2FreeFMUstate(c, &state));
    OK(fmi2FreeFMUstate(c, &copy));
    for (int step = 31; step < STEPS; ++step) {
        if (step % 20 == 7) OK(fmi2SetRealInputDerivatives(c, inputs, 1, &order, &slope));
        if (step % 20 == 15) OK(fmi2SetReal(c, inputs, 2, start));
        OK(fmi2DoStep(c, step * 0.5, 0.5, fmi2True));
    }
    OK(fmi2GetReal(c, &lambda, 1, &now));
    if (now != then) fail("the restored motion", -1);
    /* Pull-in. */
    const fmi2Real high = 0.9;
    OK(fmi2SetReal(c, inputs, 1, &high));
    OK(fmi2DoStep(c, STEPS * 0.5, 100, fmi2True));
    OK(fmi2Terminate(c));
    fmi2FreeInstance(c);
    return now;
}

static void model_exchange(const fmi2CallbackFunctions *callbacks)
{
    LOAD(fmi2Instantiate); LOAD(fmi2SetupExperiment); LOAD(fmi2EnterInitializationMode);
    LOAD(fmi2ExitInitializationMode); LOAD(fmi2SetReal); LOAD(fmi2NewDiscreteStates);
    LOAD(fmi2EnterContinuousTimeMode); LOAD(fmi2SetTime); LOAD(fmi2SetContinuousStates);
    LOAD(fmi2GetDerivatives); LOAD(fmi2GetEventIndicators); LOAD(fmi2GetContinuousStates);
    LOAD(fmi2CompletedIntegratorStep); LOAD(fmi2Terminate); LOAD(fmi2FreeInstance);

    fmi2Component c = fmi2Instantiate("actuator", fmi2ModelExchange, guid, "", callbacks, fmi2False, fmi2False);
    if (!c) fail("fmi2Instantiate", -1);
    const fmi2ValueReference phi = PHI;
    const fmi2Real start = 0.5;
    fmi2EventInfo info;
    fmi2Real states[2], slopes[2], indicators[2];
    fmi2Boolean enter, terminate;
    OK(fmi2SetupExperiment(c, fmi2False, 0, 0, fmi2True, 10));
    OK(fmi2EnterInitializationMode(c));
    OK(fmi2SetReal(c, &phi, 1, &start));
    OK(fmi2ExitInitializationMode(c));
    OK(fmi2NewDiscreteStates(c, &info));
    OK(fmi2EnterContinuousTimeMode(c));
    OK(fmi2GetContinuousStates(c, states, 2));
    for (int step = 1; step <= 100; ++step) {
        OK(fmi2GetDerivatives(c, slopes, 2));
        for (int i = 0; i < 2; ++i) states[i] += 0.01 * slopes[i];
        OK(fmi2SetTime(c, 0.01 * step));
        OK(fmi2SetContinuousStates(c, states, 2));
        OK(fmi2GetEventIndicators(c, indicators, 2));
        OK(fmi2CompletedIntegratorStep(c, fmi2True, &enter, &terminate));
    }
    OK(fmi2Terminate(c));
    fmi2FreeInstance(c);
}

static double scene(void)
{
    int lines = 0;
    const fmi2CallbackFunctions callbacks = {logger, calloc, free, NULL, &lines};
    LOAD(fmi2Instantiate);
    if (fmi2Instantiate("actuator", fmi2CoSimulation, "another", NULL, &callbacks, 0, 1)) fail("GUID", -1);
    double stretch = co_simulation(&callbacks);
    model_exchange(&callbacks);
    if (lines < STEPS + 2) fail("lines in the log", lines);
    return stretch;
}

static void *thread(void *stretch)
{
    *(double *)stretch = scene();
    return NULL;
}

static void threads(int count)
{
    pthread_t *running = malloc(count * sizeof *running);
    double *stretches = malloc(count * sizeof *stretches);
    for (int i = 0; i < count; ++i)
        if (pthread_create(&running[i], NULL, thread, &stretches[i])) fail("pthread_create", i);
    for (int i = 0; i < count; ++i) {
        pthread_join(running[i], NULL);
        if (stretches[i] != stretches[0]) fail("the stretch in a thread", i);
    }
    free(running);
    free(stretches);
}

static void print_memory(int done, int count)
{
    if (done * 10 / count == (done - 1) * 10 / count) return;
    long pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (!file || fscanf(file, "%*d %ld", &pages) != 1) fail("statm", -1);
    fclose(file);
    printf("%d %ld\n", done, pages * (sysconf(_SC_PAGESIZE) / 1024));
}

static void loads(const char *path, int count)
{
    for (int i = 1; i <= count; ++i) {
        open_library(path);
        scene();
        if (dlclose(library)) fail("dlclose", i);
        if (dlopen(path, RTLD_NOW | RTLD_NOLOAD)) fail("the library stays loaded, cycle", i);
        print_memory(i, count);
    }
}

static void instances(int count)
{
    int lines = 0;
    const fmi2CallbackFunctions callbacks = {logger, calloc, free, NULL, &lines};
    LOAD(fmi2Instantiate); LOAD(fmi2FreeInstance);
    for (int i = 1; i <= count; ++i) {
        fmi2FreeInstance(fmi2Instantiate("actuator", fmi2CoSimulation, guid, NULL, &callbacks, 0, 0));
        print_memory(i, count);
    }
}

int main(int argc, char **argv)
{
    if (argc != 5) fail("host LIBRARY GUID WHAT COUNT: the number of arguments", argc);
    const char *what = argv[3];
    int count = atoi(argv[4]);
    guid = argv[2];
    if (!strcmp(what, "loads")) {
        loads(argv[1], count);
        return 0;
    }
    open_library(argv[1]);
    if (!strcmp(what, "scenes")) for (int i = 0; i < count; ++i) scene();
    else if (!strcmp(what, "threads")) threads(count);
    else if (!strcmp(what, "later")) {
        scene();
        threads(count);
    }
    else if (!strcmp(what, "instances")) instances(count);
    else fail(what, -1);
    return dlclose(library) != 0;
}
