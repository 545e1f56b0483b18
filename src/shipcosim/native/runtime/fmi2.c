/* Functions of FMI 2.0.4 for co-simulation, https://fmi-standard.org, on the model above: what src/shipcosim/fmi does
   for an FMU in Python, with the same words. */

#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif
#ifdef FMI2_FUNCTION_PREFIX
#define JOINED(a, b) a##b
#define NAMED(a, b) JOINED(a, b)
#define FMI(name) NAMED(FMI2_FUNCTION_PREFIX, fmi2##name)
#else
#define FMI(name) fmi2##name
#endif

typedef enum { OK, WARNING, DISCARD, ERROR, FATAL, PENDING } Status;
typedef struct {
    void (*logger)(void *environment, const char *name, Status status, const char *category, const char *format, ...);
    void *(*allocate)(size_t n, size_t size);
    void (*free)(void *memory);
    void (*step_finished)(void *environment, Status status);
    void *environment;
} Callbacks;

/* Where in the memory, after the variables. */
enum { START_TIME = N_VARIABLES, TIME, STEP_SIZE, STATE };

typedef struct {
    int is_initialising, is_initialised, is_stale, variant;
    double time;
    double *m;
    char **texts;
} State;

static const char MARK[] = "native " IDENTIFIER " " GUID "\n";

/* What has failed, without component and time. */
static Status tell(const Callbacks *host, const char *name, Status status, const char *category, const char *text)
{
    if (host && host->logger)
        host->logger(host->environment, name, status, category, "%s", text);
    return status;
}

/* Say what has failed: the component, the time, and what was said. */
static Status failed(Instance *o)
{
    size_t size = strlen(o->name) + o->n_said + 64;
    char *text = malloc(size);

    if (!text)
        return ERROR;
    snprintf(text, size, "%s at t = %.9g s: %s", o->name, o->time, o->said ? o->said : "");
    tell(o->callbacks, o->name, ERROR, "logStatusError", text);
    free(text);
    return ERROR;
}

static void begin(Instance *o)
{
    o->n_said = 0;
    if (o->said)
        o->said[0] = '\0';
}

static Status fail(Instance *o, const char *before, const char *name, const char *after)
{
    begin(o);
    say(o, before);
    say(o, name);
    say(o, after);
    return failed(o);
}

static char *copied(const char *text)
{
    size_t n = strlen(text) + 1;
    char *copy = malloc(n);

    return copy ? memcpy(copy, text, n) : NULL;
}

/* Life of an instance */

static void reset(Instance *o)
{
    memset(o->m, 0, MOST_MEMORY * sizeof *o->m);
    for (int i = 0; i < MOST_KEPT; i++)
        o->kept[i] = NAN;
    for (int i = 0; i < N_VARIABLES; i++) {
        o->m[i] = variables[i].start;
        if (variables[i].type == STRING) {
            free(o->texts[i]);
            o->texts[i] = copied(variables[i].text);
        }
    }
    o->time = 0.0;
    o->is_initialising = o->is_initialised = o->is_stale = 0;
    o->variant = -1;
}

EXPORT const char *FMI(GetTypesPlatform)(void) { return "default"; }
EXPORT const char *FMI(GetVersion)(void) { return "2.0"; }

EXPORT void FMI(FreeInstance)(void *component)
{
    Instance *o = component;

    if (!o)
        return;
    for (int i = 0; o->texts && i < N_VARIABLES; i++)
        free(o->texts[i]);
    free(o->texts);
    free(o->m);
    free(o->kept);
    free(o->said);
    free(o->name);
    free(o->callbacks);
    free(o);
}

EXPORT void *FMI(Instantiate)(const char *name, int type, const char *guid, const char *resources,
                              const Callbacks *callbacks, int visible, int logging)
{
    Instance *o;

    (void)resources, (void)visible;
    name = name ? name : "";
    if (type != 1) {
        tell(callbacks, name, ERROR, "logStatusError", "this FMU is one for co-simulation only");
        return NULL;
    }
    if (guid && strcmp(guid, GUID)) {
        tell(callbacks, name, ERROR, "logStatusError", "the model description belongs to another FMU: its guid is another");
        return NULL;
    }
    o = calloc(1, sizeof *o);
    if (!o)
        return NULL;
    if (callbacks && (o->callbacks = malloc(sizeof *callbacks)))
        memcpy(o->callbacks, callbacks, sizeof *callbacks);
    o->is_logging = logging;
    o->name = copied(*name ? name : IDENTIFIER);
    o->m = malloc(MOST_MEMORY * sizeof *o->m);
    o->kept = malloc((MOST_KEPT + 1) * sizeof *o->kept);
    o->texts = calloc(N_VARIABLES, sizeof *o->texts);
    if (!o->name || !o->m || !o->kept || !o->texts) {
        FMI(FreeInstance)(o);
        return NULL;
    }
    reset(o);
    return o;
}

EXPORT Status FMI(SetDebugLogging)(void *component, int on, size_t n, const char *const *categories)
{
    (void)n, (void)categories;
    ((Instance *)component)->is_logging = on;
    return OK;
}

EXPORT Status FMI(SetupExperiment)(void *component, int has_tolerance, double tolerance, double start, int has_stop, double stop)
{
    Instance *o = component;

    (void)has_tolerance, (void)tolerance, (void)has_stop, (void)stop;
    o->m[START_TIME] = o->time = start;
    return OK;
}

/* The start */

/* What is wrong with the parameters, said; 0 where nothing is. */
static int is_refused(Instance *o)
{
    int missing = 0, wrong = 0;

    begin(o);
    for (int i = 0; i < N_VARIABLES; i++) {
        const Variable *v = variables + i;

        if (!v->is_required || (v->type == STRING ? o->texts[i][0] != '\0' : fabs(o->m[i]) < LEFT_OUT))
            continue;
        say(o, missing++ ? ", " : "parameters left out, which have no value of their own: ");
        say(o, v->name);
        if (v->type != STRING) {
            say(o, " [");
            say(o, v->unit);
            say(o, "]");
        }
    }
    if (missing)
        say(o, ". Give them, as a ship's parameter set does");
    for (int i = 0; i < N_VARIABLES; i++) {
        const Variable *v = variables + i;
        double value = o->m[i];

        if (v->causality != PARAMETER || v->type > INTEGER || (v->is_required && fabs(value) >= LEFT_OUT))
            continue;
        if (value >= v->minimum && value <= v->maximum)
            continue;
        say(o, missing || wrong++ ? "; parameter '" : "parameter '");
        say(o, v->name);
        say(o, "' is ");
        say_number(o, value, "%.9g");
        say(o, value < v->minimum ? ", below its minimum " : ", above its maximum ");
        say_number(o, value < v->minimum ? v->minimum : v->maximum, "%.9g");
        say(o, " [");
        say(o, v->unit);
        say(o, "]");
    }
    return missing || wrong;
}

static int is_chosen(const Instance *o, const Choice *choice)
{
    return choice->text ? !strcmp(o->texts[choice->variable], choice->text) : o->m[choice->variable] == choice->number;
}

static void say_choice(Instance *o, int variable, double number, const char *text)
{
    char part[44];

    if (text) {
        snprintf(part, sizeof part, "'%.36s%s'", text, strlen(text) > 36 ? "..." : "");
        say(o, part);
    } else if (variables[variable].type == BOOLEAN)
        say_truth(o, number);
    else
        say_number(o, number, "%.0f");
}

static int fits(const Instance *o, const Variant *variant)
{
    int same = 0;

    while (same < variant->n_choices && is_chosen(o, variant->choices + same))
        same++;
    return same;
}

/* Say which parameter has a value that no variant has. */
static void say_misfit(Instance *o)
{
    int best = 0, most = -1;
    const Choice *other;

    for (int i = 0; i < N_VARIANTS; i++)
        if (fits(o, variants + i) > most) {
            most = fits(o, variants + i);
            best = i;
        }
    other = variants[best].choices + most;
    say(o, "this native FMU was built with ");
    say(o, variables[other->variable].name);
    say(o, " = ");
    say_choice(o, other->variable, other->number, other->text);
    say(o, ", and not for ");
    say_choice(o, other->variable, o->m[other->variable], o->texts[other->variable]);
    say(o, ": build it again with a system that has this value, or take the FMU in Python");
}

static Status refuse_not_finite_outputs(Instance *o)
{
    double sum = 0.0;

    for (int i = 0; i < N_OUTPUTS; i++)
        sum += o->m[outputs[i]];
    if (isfinite(sum))
        return OK;
    for (int i = 0; i < N_OUTPUTS; i++)
        if (!isfinite(o->m[outputs[i]])) {
            begin(o);
            say(o, "output '");
            say(o, variables[outputs[i]].name);
            say(o, "' is ");
            say_number(o, o->m[outputs[i]], "%g");
            say(o, ", not a finite number");
            return failed(o);
        }
    return OK;
}

/* Start by the first variant whose code is for the parameters. */
static Status start(Instance *o)
{
    int n_fitting = 0;

    if (is_refused(o))
        return failed(o);
    for (int i = 0; i < N_VARIANTS; i++) {
        if (fits(o, variants + i) < variants[i].n_choices)
            continue;
        n_fitting++;
        if (i != o->variant)
            for (int k = 0; k < MOST_KEPT; k++)
                o->kept[k] = NAN;
        o->variant = i;
        o->is_for_others = 0;
        begin(o);
        if (variants[i].start(o->m, o->kept, o) == DONE) {
            o->is_stale = 0;
            return refuse_not_finite_outputs(o);
        }
        if (!o->is_for_others)
            return failed(o);
    }
    if (!n_fitting) {
        begin(o);
        say_misfit(o);
    }
    return failed(o);
}

EXPORT Status FMI(EnterInitializationMode)(void *component)
{
    Instance *o = component;

    o->is_initialising = o->is_stale = 1;
    return OK;
}

EXPORT Status FMI(ExitInitializationMode)(void *component)
{
    Instance *o = component;

    if (o->is_stale && start(o) != OK)
        return ERROR;
    o->is_initialising = 0;
    o->is_initialised = 1;
    return OK;
}

EXPORT Status FMI(Terminate)(void *component)
{
    (void)component;
    return OK;
}

EXPORT Status FMI(Reset)(void *component)
{
    reset(component);
    return OK;
}

/* A step */

EXPORT Status FMI(DoStep)(void *component, double time, double step_size, int no_set_before)
{
    Instance *o = component;

    (void)no_set_before;
    if (o->variant < 0)
        return fail(o, "", "a step before the start: initialise it first", "");
    o->m[TIME] = o->time = time;
    o->m[STEP_SIZE] = step_size;
    begin(o);
    if (variants[o->variant].step(o->m, o->kept, o) != DONE)
        return failed(o);
    o->time = time + step_size;
    return refuse_not_finite_outputs(o);
}

/* Values */

static Status refuse_reference(Instance *o, unsigned reference, Type type)
{
    static const char *const kinds[] = {"Real", "Integer", "Boolean", "String"};
    char text[100];

    snprintf(text, sizeof text, "there is no %s variable with value reference %u", kinds[type], reference);
    return fail(o, text, "", "");
}

static int is_of(unsigned reference, Type type) { return reference < N_VARIABLES && variables[reference].type == type; }

static Status check_set(Instance *o, const unsigned *references, size_t n, Type type)
{
    for (size_t i = 0; i < n; i++)
        if (!is_of(references[i], type))
            return refuse_reference(o, references[i], type);
    if (o->is_initialised)
        for (size_t i = 0; i < n; i++)
            if (variables[references[i]].causality == PARAMETER && !variables[references[i]].is_tunable)
                return fail(o, "parameter '", variables[references[i]].name, "' is fixed, it can only be set before the run");
    return OK;
}

static Status prepare_get(Instance *o, const unsigned *references, size_t n, Type type)
{
    for (size_t i = 0; i < n; i++)
        if (!is_of(references[i], type))
            return refuse_reference(o, references[i], type);
    return o->is_stale ? start(o) : OK;
}

EXPORT Status FMI(SetReal)(void *component, const unsigned *references, size_t n, const double *values)
{
    static const char *const kinds[] = {"input '", "output '", "parameter '"};
    Instance *o = component;

    for (size_t i = 0; i < n; i++)
        if (!isfinite(values[i]) && is_of(references[i], REAL)) {
            begin(o);
            say(o, kinds[variables[references[i]].causality]);
            say(o, variables[references[i]].name);
            say(o, "' was set to ");
            say_number(o, values[i], "%g");
            say(o, ", not a finite number");
            return failed(o);
        }
    if (check_set(o, references, n, REAL) != OK)
        return ERROR;
    for (size_t i = 0; i < n; i++)
        o->m[references[i]] = values[i];
    o->is_stale = o->is_initialising;
    return OK;
}

static Status set_whole(Instance *o, const unsigned *references, size_t n, const int *values, Type type)
{
    if (check_set(o, references, n, type) != OK)
        return ERROR;
    for (size_t i = 0; i < n; i++)
        o->m[references[i]] = type == BOOLEAN ? values[i] != 0 : values[i];
    o->is_stale = o->is_initialising;
    return OK;
}

EXPORT Status FMI(SetInteger)(void *component, const unsigned *references, size_t n, const int *values)
{
    return set_whole(component, references, n, values, INTEGER);
}

EXPORT Status FMI(SetBoolean)(void *component, const unsigned *references, size_t n, const int *values)
{
    return set_whole(component, references, n, values, BOOLEAN);
}

EXPORT Status FMI(SetString)(void *component, const unsigned *references, size_t n, const char *const *values)
{
    Instance *o = component;

    if (check_set(o, references, n, STRING) != OK)
        return ERROR;
    for (size_t i = 0; i < n; i++) {
        char *text = copied(values[i] ? values[i] : "");

        if (!text)
            return fail(o, "there is no memory left", "", "");
        free(o->texts[references[i]]);
        o->texts[references[i]] = text;
    }
    o->is_stale = o->is_initialising;
    return OK;
}

EXPORT Status FMI(GetReal)(void *component, const unsigned *references, size_t n, double *values)
{
    Instance *o = component;

    if (prepare_get(o, references, n, REAL) != OK)
        return ERROR;
    for (size_t i = 0; i < n; i++)
        values[i] = o->m[references[i]];
    return OK;
}

static Status get_whole(Instance *o, const unsigned *references, size_t n, int *values, Type type)
{
    if (prepare_get(o, references, n, type) != OK)
        return ERROR;
    for (size_t i = 0; i < n; i++) {
        double value = o->m[references[i]];

        if (type == INTEGER && !(value >= -2147483648.0 && value < 2147483648.0)) {
            begin(o);
            say(o, "'");
            say(o, variables[references[i]].name);
            say(o, "' is ");
            say_number(o, value, "%.0f");
            say(o, isfinite(value) ? ", which FMI's 32-bit integers cannot hold" : ", not a whole number");
            return failed(o);
        }
        values[i] = type == BOOLEAN ? value != 0.0 : (int)value;
    }
    return OK;
}

EXPORT Status FMI(GetInteger)(void *component, const unsigned *references, size_t n, int *values)
{
    return get_whole(component, references, n, values, INTEGER);
}

EXPORT Status FMI(GetBoolean)(void *component, const unsigned *references, size_t n, int *values)
{
    return get_whole(component, references, n, values, BOOLEAN);
}

EXPORT Status FMI(GetString)(void *component, const unsigned *references, size_t n, const char **values)
{
    Instance *o = component;

    if (prepare_get(o, references, n, STRING) != OK)
        return ERROR;
    for (size_t i = 0; i < n; i++)
        values[i] = o->texts[references[i]];
    return OK;
}

/* State: all numbers and texts. What is kept by its arguments is computed again, to the same bits. */

EXPORT Status FMI(FreeFMUstate)(void *component, void **state)
{
    State *freed = state ? *state : NULL;

    (void)component;
    if (!freed)
        return OK;
    for (int i = 0; freed->texts && i < N_VARIABLES; i++)
        free(freed->texts[i]);
    free(freed->texts);
    free(freed->m);
    free(freed);
    *state = NULL;
    return OK;
}

static State *empty_state(void)
{
    State *made = calloc(1, sizeof *made);
    void *freed = made;

    if (!made)
        return NULL;
    made->m = calloc(MOST_MEMORY, sizeof *made->m);
    made->texts = calloc(N_VARIABLES, sizeof *made->texts);
    if (made->m && made->texts)
        return made;
    FMI(FreeFMUstate)(NULL, &freed);
    return NULL;
}

EXPORT Status FMI(GetFMUstate)(void *component, void **state)
{
    Instance *o = component;
    State *made = empty_state();

    if (!made)
        return fail(o, "there is no memory left", "", "");
    made->is_initialising = o->is_initialising;
    made->is_initialised = o->is_initialised;
    made->is_stale = o->is_stale;
    made->variant = o->variant;
    made->time = o->time;
    memcpy(made->m, o->m, MOST_MEMORY * sizeof *o->m);
    for (int i = 0; i < N_VARIABLES; i++)
        made->texts[i] = o->texts[i] ? copied(o->texts[i]) : NULL;
    FMI(FreeFMUstate)(component, state);
    *state = made;
    return OK;
}

EXPORT Status FMI(SetFMUstate)(void *component, void *state)
{
    Instance *o = component;
    State *stored = state;

    if (!stored)
        return fail(o, "the state cannot be restored: there is none", "", "");
    if (stored->variant != o->variant)
        for (int i = 0; i < MOST_KEPT; i++)
            o->kept[i] = NAN;
    o->is_initialising = stored->is_initialising;
    o->is_initialised = stored->is_initialised;
    o->is_stale = stored->is_stale;
    o->variant = stored->variant;
    o->time = stored->time;
    memcpy(o->m, stored->m, MOST_MEMORY * sizeof *o->m);
    for (int i = 0; i < N_VARIABLES; i++) {
        free(o->texts[i]);
        o->texts[i] = stored->texts[i] ? copied(stored->texts[i]) : NULL;
    }
    return OK;
}

static size_t size_of(const State *state)
{
    size_t size = sizeof MARK - 1 + 4 * sizeof(int32_t) + (MOST_MEMORY + 1) * sizeof(double);

    for (int i = 0; i < N_VARIABLES; i++)
        size += state->texts[i] ? strlen(state->texts[i]) + 1 : 0;
    return size;
}

EXPORT Status FMI(SerializedFMUstateSize)(void *component, void *state, size_t *size)
{
    (void)component;
    *size = size_of(state);
    return OK;
}

EXPORT Status FMI(SerializeFMUstate)(void *component, void *state, char *data, size_t size)
{
    const State *stored = state;
    int32_t phase[] = {stored->is_initialising, stored->is_initialised, stored->is_stale, stored->variant};

    if (size < size_of(stored))
        return fail(component, "the state cannot be stored: there is too little room", "", "");
#define PUT(from, n) (memcpy(data, from, n), data += (n))
    PUT(MARK, sizeof MARK - 1);
    PUT(phase, sizeof phase);
    PUT(&stored->time, sizeof stored->time);
    PUT(stored->m, MOST_MEMORY * sizeof *stored->m);
    for (int i = 0; i < N_VARIABLES; i++)
        if (stored->texts[i])
            PUT(stored->texts[i], strlen(stored->texts[i]) + 1);
    return OK;
}

static Status refuse_state(Instance *o, const char *data, size_t size)
{
    char found[101];
    size_t n = 0;

    for (; n < 100 && n < size && data[n] != '\n' && data[n] >= ' ' && data[n] <= '~'; n++)
        found[n] = data[n];
    found[n] = '\0';
    begin(o);
    say(o, "the state cannot be restored: this is a state of '");
    say(o, found);
    say(o, "', wanted is one of 'native " IDENTIFIER " " GUID "'");
    return failed(o);
}

EXPORT Status FMI(DeSerializeFMUstate)(void *component, const char *data, size_t size, void **state)
{
    const char *end = data + size;
    int32_t phase[4];
    State *made;
    void *freed;

    if (size < sizeof MARK - 1 + sizeof phase + (MOST_MEMORY + 1) * sizeof(double) || memcmp(data, MARK, sizeof MARK - 1))
        return refuse_state(component, data, size);
    freed = made = empty_state();
    if (!made)
        return fail(component, "there is no memory left", "", "");
#define TAKE(to, n) (memcpy(to, data, n), data += (n))
    data += sizeof MARK - 1;
    TAKE(phase, sizeof phase);
    TAKE(&made->time, sizeof made->time);
    TAKE(made->m, MOST_MEMORY * sizeof *made->m);
    made->is_initialising = phase[0];
    made->is_initialised = phase[1];
    made->is_stale = phase[2];
    made->variant = phase[3];
    for (int i = 0; i < N_VARIABLES; i++) {
        if (variables[i].type != STRING)
            continue;
        const char *last = data < end ? memchr(data, '\0', (size_t)(end - data)) : NULL;

        if (!last || made->variant >= N_VARIANTS || made->variant < -1) {
            FMI(FreeFMUstate)(component, &freed);
            return fail(component, "the state cannot be restored: it is cut off", "", "");
        }
        made->texts[i] = copied(data);
        data = last + 1;
    }
    *state = made;
    return OK;
}

/* What FMI has and this FMU does not. */

#define NOT_THERE(name, ...) \
    EXPORT Status FMI(name)(void *component, __VA_ARGS__) \
    { \
        return fail(component, "it has no fmi2" #name, "", ""); \
    }
NOT_THERE(GetDirectionalDerivative, const unsigned *a, size_t b, const unsigned *c, size_t d, const double *e, double *f)
NOT_THERE(SetRealInputDerivatives, const unsigned *a, size_t b, const int *c, const double *d)
NOT_THERE(GetRealOutputDerivatives, const unsigned *a, size_t b, const int *c, double *d)
NOT_THERE(GetStatus, int a, Status *b)
NOT_THERE(GetRealStatus, int a, double *b)
NOT_THERE(GetIntegerStatus, int a, int *b)
NOT_THERE(GetBooleanStatus, int a, int *b)
NOT_THERE(GetStringStatus, int a, const char **b)

EXPORT Status FMI(CancelStep)(void *component) { return fail(component, "it has no step to cancel", "", ""); }
