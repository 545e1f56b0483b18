/* A minute of an FMU in a program that is not Python: step_thruster FOLDER, where the FMU is unpacked. */

#include <dlfcn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 600 };
static const double H = 0.1;

/* What describes the unit has no default, see ssp/ships/gunnerus-33m9/port.toml: it is set before the start. */
static const struct {
    const char *name;
    double value;
} numbers[] = {
    {"diameter", 1.9},      {"x", -14.02},         {"y", -2.0},       {"side_force_coefficient", 0.8},
    {"thrust_min", -30e3},  {"thrust_max", 60e3},  {"thrust_rate", 1e3}, {"azimuth_rate", 0.1745},
    {"rpm_max", 203.0},     {"torque_max", 23.5e3}, {"power_max", 500e3}, {"inertia", 600.0},
    {"friction", 10.0},     {"proportional_gain", 3e3}, {"integral_gain", 6e3},
};
static const char *const texts[][2] = {
    {"thrust_polynomial", "31.9 0.8208 -0.6993 0.1895 -0.0743"},
    {"thrust_factors", "-180 0.875; -90 1; 0 1.383; 31.9 0.441; 90 1; 180 0.875"},
    {"torque_polynomial", "31.9 0.0945 -0.039 0.0006 -0.0042"},
    {"torque_factors", "-180 0.813; -90 1; 0 0.742; 31.9 1.74; 45 0.871; 90 1; 180 0.813"},
};

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

/* The value reference of a variable. */
static unsigned reference_of(const char *description, const char *name)
{
    char before[128], reference[16];

    snprintf(before, sizeof before, "name=\"%s\" valueReference=\"", name);
    find(description, before, reference, sizeof reference);
    return (unsigned)atoi(reference);
}

int main(int n, char **words)
{
    static char description[1 << 20], guid[64], path[4096], resources[4096];
    const Callbacks callbacks = {log_line, calloc, free, NULL, NULL};
    double command = 20e3, thrust = 0.0;

    snprintf(path, sizeof path, "%s/modelDescription.xml", n > 1 ? realpath(words[1], resources) : ".");
    fread(description, 1, sizeof description - 1, fopen(path, "r"));
    find(description, "guid=\"", guid, sizeof guid);
    unsigned of_command = reference_of(description, "thrust_cmd"), of_thrust = reference_of(description, "thrust");

    snprintf(path, sizeof path, "%s/binaries/linux64/azimuth_thruster.so", words[1]);
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    void *(*instantiate)() = dlsym(library, "fmi2Instantiate");
    int (*set_up)() = dlsym(library, "fmi2SetupExperiment"), (*step)() = dlsym(library, "fmi2DoStep");
    int (*enter)() = dlsym(library, "fmi2EnterInitializationMode"), (*leave)() = dlsym(library, "fmi2ExitInitializationMode");
    int (*set)() = dlsym(library, "fmi2SetReal"), (*get)() = dlsym(library, "fmi2GetReal");
    int (*set_text)() = dlsym(library, "fmi2SetString");

    snprintf(path, sizeof path, "file://%s/resources", resources);
    void *thruster = instantiate("port", 1, guid, path, &callbacks, 0, 0);
    if (!thruster)
        return 1;
    set(thruster, &of_command, (size_t)1, &command);
    for (size_t k = 0; k < sizeof numbers / sizeof *numbers; ++k) {
        unsigned reference = reference_of(description, numbers[k].name);
        set(thruster, &reference, (size_t)1, &numbers[k].value);
    }
    for (size_t k = 0; k < sizeof texts / sizeof *texts; ++k) {
        unsigned reference = reference_of(description, texts[k][0]);
        set_text(thruster, &reference, (size_t)1, &texts[k][1]);
    }
    int failed = set_up(thruster, 0, 0.0, 0.0, 0, 0.0) || enter(thruster) || leave(thruster);
    for (int k = 0; k < STEPS && !failed; ++k)
        failed = step(thruster, k * H, H, 1);
    failed = failed || get(thruster, &of_thrust, (size_t)1, &thrust);
    printf("%.0f N\n", thrust);
    return failed;
}
