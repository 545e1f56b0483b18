/* The binary of an FMU: sees that Python runs in the host, then passes every call on to pythonfmu's binary beside it.

   That one has the symbols of Python undefined, so only a host that is Python could load it. Functions and types are
   those of FMI 2.0.4, https://fmi-standard.org. */

#include "interpreter.h"
#include "system.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef _WIN32
#define PASSED_ON_TO "pythonfmu-export.dll"
#else
#define PASSED_ON_TO "libpythonfmu-export.so"
#endif

/* SHA-256 of what this was compiled from: compile.py */
EXPORT const char shipcosim_loader_sources[] = SOURCES;

typedef enum { OK, WARNING, DISCARD, ERROR, FATAL, PENDING } Status;
typedef void (*Logger)(void *environment, const char *name, Status status, const char *category, const char *format, ...);
typedef struct {
    Logger logger;
    void *(*allocate)(size_t n, size_t size);
    void (*free)(void *memory);
    void (*step_finished)(void *environment, Status status);
    void *environment;
} Callbacks;

/* An instance, and what the host gave for it. */
typedef struct Instance {
    Callbacks own, host;
    int tells_all;
    void *component;
    struct Instance *next;
} Instance;

static Instance *instances;

#define REFERENCES void *component, const unsigned *references, size_t n

/* name, parameters, arguments */
#define FUNCTIONS(F) \
    F(SetupExperiment, (void *component, int has_tolerance, double tolerance, double start, int has_stop, double stop), \
      (component, has_tolerance, tolerance, start, has_stop, stop)) \
    F(EnterInitializationMode, (void *component), (component)) \
    F(ExitInitializationMode, (void *component), (component)) \
    F(Terminate, (void *component), (component)) \
    F(Reset, (void *component), (component)) \
    F(GetReal, (REFERENCES, double *values), (component, references, n, values)) \
    F(GetInteger, (REFERENCES, int *values), (component, references, n, values)) \
    F(GetBoolean, (REFERENCES, int *values), (component, references, n, values)) \
    F(GetString, (REFERENCES, const char **values), (component, references, n, values)) \
    F(SetReal, (REFERENCES, const double *values), (component, references, n, values)) \
    F(SetInteger, (REFERENCES, const int *values), (component, references, n, values)) \
    F(SetBoolean, (REFERENCES, const int *values), (component, references, n, values)) \
    F(SetString, (REFERENCES, const char *const *values), (component, references, n, values)) \
    F(GetFMUstate, (void *component, void **state), (component, state)) \
    F(SetFMUstate, (void *component, void *state), (component, state)) \
    F(FreeFMUstate, (void *component, void **state), (component, state)) \
    F(SerializedFMUstateSize, (void *component, void *state, size_t *size), (component, state, size)) \
    F(SerializeFMUstate, (void *component, void *state, char *data, size_t size), (component, state, data, size)) \
    F(DeSerializeFMUstate, (void *component, const char *data, size_t size, void **state), (component, data, size, state)) \
    F(GetDirectionalDerivative, \
      (void *component, const unsigned *unknown, size_t n_unknown, const unsigned *known, size_t n_known, \
       const double *known_change, double *unknown_change), \
      (component, unknown, n_unknown, known, n_known, known_change, unknown_change)) \
    F(SetRealInputDerivatives, (REFERENCES, const int *order, const double *values), (component, references, n, order, values)) \
    F(GetRealOutputDerivatives, (REFERENCES, const int *order, double *values), (component, references, n, order, values)) \
    F(DoStep, (void *component, double time, double step_size, int no_set_before), (component, time, step_size, no_set_before)) \
    F(CancelStep, (void *component), (component)) \
    F(GetStatus, (void *component, int kind, Status *value), (component, kind, value)) \
    F(GetRealStatus, (void *component, int kind, double *value), (component, kind, value)) \
    F(GetIntegerStatus, (void *component, int kind, int *value), (component, kind, value)) \
    F(GetBooleanStatus, (void *component, int kind, int *value), (component, kind, value)) \
    F(GetStringStatus, (void *component, int kind, const char **value), (component, kind, value))

static struct {
    int is_loaded;
    void *(*Instantiate)(const char *, int, const char *, const char *, const Callbacks *, int, int);
    void (*FreeInstance)(void *);
    void (*let_go)(void);
#define FIELD(name, parameters, arguments) Status(*name) parameters;
    FUNCTIONS(FIELD)
} other;

/* pythonfmu's binary calls every exception fatal, after which FMI lets a host call nothing of any instance. The
   instance is as it was before the call, and the others as well: an error. */
static Status not_fatal(Status status)
{
    return status == FATAL ? ERROR : status;
}

/* No component is what a failed fmi2Instantiate gave, and nothing may be loaded then. */
#define PASS_ON(name, parameters, arguments) \
    EXPORT Status fmi2##name parameters \
    { \
        return component ? not_fatal(other.name arguments) : ERROR; \
    }
FUNCTIONS(PASS_ON)

EXPORT const char *fmi2GetTypesPlatform(void)
{
    return "default";
}

EXPORT const char *fmi2GetVersion(void)
{
    return "2.0";
}

/* Python's state in pythonfmu's binary, which it would otherwise drop twice when the process ends. */
static void let_go(void)
{
    other.let_go();
}

static int load_other(char *why, size_t size)
{
    char path[PATH_SIZE], reason[512];
    void *library = NULL;
    int all;

    if (!beside_this_library(PASSED_ON_TO, path, sizeof path))
        snprintf(reason, sizeof reason, "its folder is not known");
    else
        library = load_private(path, reason, sizeof reason);
    if (!library) {
        snprintf(why, size, PASSED_ON_TO " cannot be loaded: %s", reason);
        return 0;
    }
    all = (other.Instantiate = symbol_of(library, "fmi2Instantiate")) != NULL;
    all &= (other.FreeInstance = symbol_of(library, "fmi2FreeInstance")) != NULL;
    all &= (other.let_go = symbol_of(library, "finalizePythonInterpreter")) != NULL;
#define LOOK_UP(name, parameters, arguments) all &= (other.name = symbol_of(library, "fmi2" #name)) != NULL;
    FUNCTIONS(LOOK_UP)
    if (!all)
        snprintf(why, size, PASSED_ON_TO " lacks a function of FMI 2.0");
    else
        at_end(let_go);
    return all;
}

static int is_ready(char *why, size_t size)
{
    lock();
    if (!other.is_loaded)
        other.is_loaded = have_python(why, size) && load_other(why, size);
    unlock();
    return other.is_loaded;
}

/* Hand a text to the host, whose logger takes a format. */
static void tell(const Callbacks *host, const char *name, Status status, const char *category, const char *text)
{
    char *format = host && host->logger ? malloc(2 * strlen(text) + 1) : NULL, *end = format;

    if (!format)
        return;
    for (; *text; ++text) {
        if (*text == '%')
            *end++ = '%';
        *end++ = *text;
    }
    *end = '\0';
    host->logger(host->environment, name, status, category, format);
    free(format);
}

/* What pythonfmu's binary logs. Exceptions have no category there, which hosts may not expect, and a first line that
   only names functions of C. */
static void log_for(void *environment, const char *name, Status status, const char *category, const char *format, ...)
{
    static const char *const categories[] = {"Ok", "Warning", "Discard", "Error", "Error", "Pending"};
    static const char before_exceptions[] = "Fatal py exception encountered: ";
    const Instance *instance = environment;
    va_list values;
    char *text = NULL, *second, own[32];
    int length;

    if (status == OK && !instance->tells_all)
        return;
    va_start(values, format);
    length = vsnprintf(NULL, 0, format, values);
    va_end(values);
    if (length < 0 || !(text = malloc((size_t)length + 1)))
        return;
    va_start(values, format);
    vsnprintf(text, (size_t)length + 1, format, values);
    va_end(values);
    snprintf(own, sizeof own, "logStatus%s", categories[status <= PENDING ? status : ERROR]);
    second = strncmp(text, before_exceptions, sizeof before_exceptions - 1) ? NULL : strchr(text, '\n');
    tell(&instance->host, name, not_fatal(status), category ? category : own, second ? second + 1 : text);
    free(text);
}

/* The place of a component in the list, or of its end. The lock is held. */
static Instance **place_of(const void *component)
{
    Instance **place = &instances;

    while (*place && (*place)->component != component)
        place = &(*place)->next;
    return place;
}

/* pythonfmu's binary is to log all: without debug logging it would be silent about failures too. */
static void *instantiate(const char *name, int type, const char *guid, const char *resources, const Callbacks *host,
                         int visible, int logging)
{
    Instance *made = calloc(1, sizeof *made);

    if (!made)
        return NULL;
    if (host)
        made->own = made->host = *host;
    made->own.logger = log_for;
    made->own.environment = made;
    made->tells_all = logging;
    made->component = other.Instantiate(name, type, guid, resources, &made->own, visible, 1);
    if (!made->component) {
        free(made);
        return NULL;
    }
    lock();
    made->next = instances;
    instances = made;
    unlock();
    return made->component;
}

EXPORT void *fmi2Instantiate(
    const char *name, int type, const char *guid, const char *resources, const Callbacks *callbacks, int visible, int logging)
{
    char why[PATH_SIZE] = "";

    if (is_ready(why, sizeof why))
        return instantiate(name, type, guid, resources, callbacks, visible, logging);
    tell(callbacks, name ? name : "", ERROR, "logStatusError", why);
    return NULL;
}

EXPORT void fmi2FreeInstance(void *component)
{
    Instance **place, *freed;

    if (!component)
        return;
    lock();
    place = place_of(component);
    freed = *place;
    if (freed)
        *place = freed->next;
    unlock();
    other.FreeInstance(component);
    free(freed);
}

/* All categories or none. */
EXPORT Status fmi2SetDebugLogging(void *component, int on, size_t n, const char *const *names)
{
    Instance *instance;

    (void)n, (void)names;
    lock();
    instance = *place_of(component);
    if (instance)
        instance->tells_all = on;
    unlock();
    return instance ? OK : ERROR;
}
