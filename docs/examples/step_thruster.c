/* A minute of an FMU in a program that is not Python: step_thruster FOLDER, where the FMU is unpacked. */

#include <dlfcn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 600 };
static const double H = 0.1;

typedef struct {
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*free)(void *);
    void *step_finished, *environment;
} Callbacks;

static void log_line(void *environment, const char *name, int status, const char *category, const char *format, ...)
{
    va_list values;

    va_start(values, format);
    vfprintf(stderr, format, values);
    va_end(values);
    fputc('\n', stderr);
}

/* What stands in the model description between a text and the next quotation mark. */
static void find(const char *description, const char *before, char *found, size_t size)
{
    const char *start = strstr(description, before) + strlen(before);
    snprintf(found, size, "%.*s", (int)strcspn(start, "\""), start);
}

int main(int n, char **words)
{
    static char description[1 << 20], guid[64], reference[16], path[4096], resources[4096];
    const Callbacks callbacks = {log_line, calloc, free, NULL, NULL};
    double command = 20e3, thrust = 0.0;
    unsigned of_command, of_thrust;

    snprintf(path, sizeof path, "%s/modelDescription.xml", n > 1 ? realpath(words[1], resources) : ".");
    fread(description, 1, sizeof description - 1, fopen(path, "r"));
    find(description, "guid=\"", guid, sizeof guid);
    find(description, "name=\"thrust_cmd\" valueReference=\"", reference, sizeof reference);
    of_command = (unsigned)atoi(reference);
    find(description, "name=\"thrust\" valueReference=\"", reference, sizeof reference);
    of_thrust = (unsigned)atoi(reference);

    snprintf(path, sizeof path, "%s/binaries/linux64/azimuth_thruster.so", words[1]);
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    void *(*instantiate)() = dlsym(library, "fmi2Instantiate");
    int (*set_up)() = dlsym(library, "fmi2SetupExperiment"), (*step)() = dlsym(library, "fmi2DoStep");
    int (*enter)() = dlsym(library, "fmi2EnterInitializationMode"), (*leave)() = dlsym(library, "fmi2ExitInitializationMode");
    int (*set)() = dlsym(library, "fmi2SetReal"), (*get)() = dlsym(library, "fmi2GetReal");

    snprintf(path, sizeof path, "file://%s/resources", resources);
    void *thruster = instantiate("port", 1, guid, path, &callbacks, 0, 0);
    if (!thruster)
        return 1;
    set(thruster, &of_command, (size_t)1, &command);
    int failed = set_up(thruster, 0, 0.0, 0.0, 0, 0.0) || enter(thruster) || leave(thruster);
    for (int k = 0; k < STEPS && !failed; ++k)
        failed = step(thruster, k * H, H, 1);
    failed = failed || get(thruster, &of_thrust, (size_t)1, &thrust);
    printf("%.0f N\n", thrust);
    return failed;
}
