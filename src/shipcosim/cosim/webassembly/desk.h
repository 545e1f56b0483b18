/* A system of native FMUs that runs without Python: its parts, and the tables that wiring.py writes between this text
   and desk.c. The loop over the steps is that of native/loop.c, which stands before. */

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

typedef void (*Logger)(void *environment, const char *name, int status, const char *category, const char *format, ...);
typedef struct {
    Logger logger;
    void *(*allocate)(size_t n, size_t size);
    void (*free)(void *memory);
    void (*step_finished)(void *environment, int status);
    void *environment;
} Callbacks;

/* The functions of FMI 2.0 that a run needs. */
typedef struct {
    const char *guid;
    void *(*instantiate)(const char *name, int type, const char *guid, const char *resources, const Callbacks *callbacks,
                         int visible, int logging);
    void (*free_instance)(void *instance);
    int (*setup)(void *instance, int has_tolerance, double tolerance, double start, int has_stop, double stop);
    int (*enter)(void *instance);
    int (*leave)(void *instance);
    int (*do_step)(void *instance, double time, double step_size, int no_set_before);
    int (*set_real)(void *instance, const unsigned *references, size_t n, const double *values);
    int (*set_integer)(void *instance, const unsigned *references, size_t n, const int *values);
    int (*set_boolean)(void *instance, const unsigned *references, size_t n, const int *values);
    int (*set_string)(void *instance, const unsigned *references, size_t n, const char *const *values);
    int (*get_real)(void *instance, const unsigned *references, size_t n, double *values);
    int (*get_integer)(void *instance, const unsigned *references, size_t n, int *values);
    int (*get_boolean)(void *instance, const unsigned *references, size_t n, int *values);
} Fmu;

#define DECLARED(p) \
    extern void *p##fmi2Instantiate(const char *, int, const char *, const char *, const Callbacks *, int, int); \
    extern void p##fmi2FreeInstance(void *); \
    extern int p##fmi2SetupExperiment(void *, int, double, double, int, double); \
    extern int p##fmi2EnterInitializationMode(void *); \
    extern int p##fmi2ExitInitializationMode(void *); \
    extern int p##fmi2DoStep(void *, double, double, int); \
    extern int p##fmi2SetReal(void *, const unsigned *, size_t, const double *); \
    extern int p##fmi2SetInteger(void *, const unsigned *, size_t, const int *); \
    extern int p##fmi2SetBoolean(void *, const unsigned *, size_t, const int *); \
    extern int p##fmi2SetString(void *, const unsigned *, size_t, const char *const *); \
    extern int p##fmi2GetReal(void *, const unsigned *, size_t, double *); \
    extern int p##fmi2GetInteger(void *, const unsigned *, size_t, int *); \
    extern int p##fmi2GetBoolean(void *, const unsigned *, size_t, int *);

#define FUNCTIONS(p) \
    p##fmi2Instantiate, p##fmi2FreeInstance, p##fmi2SetupExperiment, p##fmi2EnterInitializationMode, \
    p##fmi2ExitInitializationMode, p##fmi2DoStep, p##fmi2SetReal, p##fmi2SetInteger, p##fmi2SetBoolean, \
    p##fmi2SetString, p##fmi2GetReal, p##fmi2GetInteger, p##fmi2GetBoolean

enum { REAL, INTEGER, BOOLEAN, STRING, N_KINDS };

/* A start value: of a text `text`, else `number`. That of an input that nothing feeds is a value from outside, too:
   `row` of the sources of `exchange`, else -1. */
typedef struct {
    int part;
    unsigned reference;
    int kind;
    double number;
    const char *text;
    int exchange, row;
} Start;

/* A component. Its memory holds inputs and outputs, reals before integers before booleans. */
typedef struct {
    const Fmu *fmu;
    const char *name;
    int feeds;                                  /* whether its outputs lead to a component */
    int n_inputs[3], n_outputs[3];
    const unsigned *inputs, *outputs;           /* value references in the order of the memory */
    void *instance;
} Part;
