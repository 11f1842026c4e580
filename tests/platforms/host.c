/* The smallest host: loads a library of the FMU, runs it and prints what it reads.
 *
 *     host LIBRARY GUID TOLERANCE STEP STEPS [REFERENCE=VALUE ...] [READ ...]
 *
 * sets Reals by value reference, makes STEPS communication steps, and after each prints a line: the bits
 * of the Reals to read as hexadecimal numbers, so that no printing stands between two platforms.
 * Ends with 0 if every call returned fmi2OK, else with 1 and the name of the call.
 */
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef _WIN32
#include <windows.h>
static void *load(const char *path) { return (void *)LoadLibraryA(path); }
static void *find(void *library, const char *name) {
    return (void *)GetProcAddress((HMODULE)library, name);
}
static int unload(void *library) { return FreeLibrary((HMODULE)library) != 0; }
#else
#include <dlfcn.h>
static void *load(const char *path) { return dlopen(path, RTLD_NOW | RTLD_LOCAL); }
static void *find(void *library, const char *name) { return dlsym(library, name); }
static int unload(void *library) { return dlclose(library) == 0; }
#endif

typedef void *Component;
typedef void (*Logger)(void *, const char *, int, const char *, const char *, ...);
typedef struct {
    Logger logger;
    void *(*allocate)(size_t, size_t);
    void (*free)(void *);
    void (*step_finished)(void *, int);
    void *environment;
} Callbacks;

static void log_to_stderr(void *environment, const char *instance, int status, const char *category,
                          const char *message, ...) {
    va_list arguments;
    (void)environment;
    fprintf(stderr, "%s: [%s, status %d] ", instance, category, status);
    va_start(arguments, message);
    vfprintf(stderr, message, arguments);
    va_end(arguments);
    fputc('\n', stderr);
}

static void *needed(void *library, const char *name) {
    void *function = find(library, name);
    if (!function) {
        fprintf(stderr, "no function %s\n", name);
        exit(1);
    }
    return function;
}

static void must(int status, const char *call) {
    if (status != 0) {
        fprintf(stderr, "%s returned %d\n", call, status);
        exit(1);
    }
}

#define MOST 64

int main(int count, char **words) {
    if (count < 6) {
        fprintf(stderr, "usage: host LIBRARY GUID TOLERANCE STEP STEPS [REFERENCE=VALUE ...] [READ ...]\n");
        return 2;
    }
    void *library = load(words[1]);
    if (!library) {
        fprintf(stderr, "cannot load %s\n", words[1]);
        return 1;
    }
    Component (*instantiate)(const char *, int, const char *, const char *, const Callbacks *, int, int) =
        needed(library, "fmi2Instantiate");
    int (*setup)(Component, int, double, double, int, double) = needed(library, "fmi2SetupExperiment");
    int (*enter)(Component) = needed(library, "fmi2EnterInitializationMode");
    int (*leave)(Component) = needed(library, "fmi2ExitInitializationMode");
    int (*set)(Component, const unsigned *, size_t, const double *) = needed(library, "fmi2SetReal");
    int (*get)(Component, const unsigned *, size_t, double *) = needed(library, "fmi2GetReal");
    int (*step)(Component, double, double, int) = needed(library, "fmi2DoStep");
    int (*terminate)(Component) = needed(library, "fmi2Terminate");
    void (*release)(Component) = needed(library, "fmi2FreeInstance");

    const Callbacks callbacks = {log_to_stderr, calloc, free, NULL, NULL};
    Component component = instantiate("host", 1, words[2], "", &callbacks, 0, 1);
    if (!component) {
        fprintf(stderr, "fmi2Instantiate returned NULL\n");
        return 1;
    }
    unsigned reads[MOST];
    double values[MOST];
    size_t read = 0;
    for (int k = 6; k < count; ++k) {
        char *end;
        const unsigned reference = (unsigned)strtoul(words[k], &end, 10);
        if (*end == '=') {
            const double value = strtod(end + 1, NULL);
            must(set(component, &reference, 1, &value), "fmi2SetReal");
        } else if (read < MOST) {
            reads[read++] = reference;
        }
    }
    must(setup(component, 1, strtod(words[3], NULL), 0.0, 0, 0.0), "fmi2SetupExperiment");
    must(enter(component), "fmi2EnterInitializationMode");
    must(leave(component), "fmi2ExitInitializationMode");

    const double length = strtod(words[4], NULL);
    const long steps = strtol(words[5], NULL, 10);
    for (long k = 0; k < steps; ++k) {
        must(step(component, (double)k * length, length, 1), "fmi2DoStep");
        must(get(component, reads, read, values), "fmi2GetReal");
        for (size_t place = 0; place < read; ++place) {
            uint64_t bits;
            memcpy(&bits, &values[place], sizeof bits);
            printf("%s%08lx%08lx", place ? " " : "", (unsigned long)(bits >> 32),
                   (unsigned long)(bits & 0xffffffffu));
        }
        putchar('\n');
    }
    must(terminate(component), "fmi2Terminate");
    release(component);
    if (!unload(library)) {
        fprintf(stderr, "cannot unload %s\n", words[1]);
        return 1;
    }
    return 0;
}
