/* What a page calls: start, advance, and changes between two steps. It behaves as shipcosim's own master
   (src/shipcosim/cosim/master/algorithm.py): the same start, the same order, the same events. */

enum { WARNING = 1, MOST_WORDS = 2000, MOST_ITERATIONS = 200 };

static char words[MOST_WORDS];                  /* why it failed */
static double window[MOST_STEPS + MOST_MULTIPLE + 1];
static int64_t now;                             /* number of the next step */

static void log_message(void *environment, const char *name, int status, const char *category, const char *format, ...)
{
    va_list values;

    (void)environment, (void)name, (void)category;
    if (status <= WARNING)
        return;
    va_start(values, format);
    vsnprintf(words, sizeof words, format, values);
    va_end(values);
}

static const Callbacks callbacks = {log_message, calloc, free, NULL, NULL};

/* The double nearest to the true time of a step. */
static double time_of(int64_t step) { return START_TIME + (double)(step * STEP_NUMERATOR) / (double)STEP_DENOMINATOR; }

static int set_values(Part *p, const double *memory)
{
    const unsigned *references = p->inputs;
    int whole[MOST_VALUES];

    if (p->n_inputs[REAL] && p->fmu->set_real(p->instance, references, (size_t)p->n_inputs[REAL], memory) > WARNING)
        return 1;
    for (int kind = INTEGER; kind <= BOOLEAN; kind++) {
        int n = p->n_inputs[kind];

        references += p->n_inputs[kind - 1], memory += p->n_inputs[kind - 1];
        for (int i = 0; i < n; i++)
            whole[i] = (int)memory[i];
        if (n && (kind == INTEGER ? p->fmu->set_integer : p->fmu->set_boolean)(p->instance, references, (size_t)n, whole) > WARNING)
            return 1;
    }
    return 0;
}

static int get_values(Part *p, double *memory)
{
    const unsigned *references = p->outputs;
    int whole[MOST_VALUES];

    if (p->n_outputs[REAL] && p->fmu->get_real(p->instance, references, (size_t)p->n_outputs[REAL], memory) > WARNING)
        return 1;
    for (int kind = INTEGER; kind <= BOOLEAN; kind++) {
        int n = p->n_outputs[kind];

        references += p->n_outputs[kind - 1], memory += p->n_outputs[kind - 1];
        if (n && (kind == INTEGER ? p->fmu->get_integer : p->fmu->get_boolean)(p->instance, references, (size_t)n, whole) > WARNING)
            return 1;
        for (int i = 0; i < n; i++)
            memory[i] = whole[i];
    }
    return 0;
}

/* A step of a component, as the loop calls it; `kept` is the component itself. */
static int step_part(double *memory, double *kept, Call call, void *host)
{
    Part *p = (Part *)(void *)kept;
    int n_inputs = p->n_inputs[0] + p->n_inputs[1] + p->n_inputs[2];
    int n_outputs = p->n_outputs[0] + p->n_outputs[1] + p->n_outputs[2];
    const double *time = memory + n_inputs + n_outputs;

    (void)call, (void)host;
    if (set_values(p, memory) || p->fmu->do_step(p->instance, time[0], time[1], 1) > WARNING)
        return 1;
    return get_values(p, memory + n_inputs);
}

/* The loop calls this where a step failed: the words are there unless an input was not finite. */
static int give_up(int component, int64_t step)
{
    if (!words[0])
        snprintf(words, sizeof words, "%s at t = %.9g s: an input is not a finite number", parts[component].name, time_of(step));
    return 1;
}

static void fill_inputs(const Component *c)
{
    for (int64_t i = 0; i < c->n_inputs; i++) {
        const Exchange *e = exchanges + c->input_exchange[i];

        c->memory[c->input_place[i]] = get(e, e->inputs, c->input_row[i]);
    }
}

static int write_part(int i)
{
    fill_inputs(components + i);
    return set_values(parts + i, components[i].memory);
}

static int read_part(int i)
{
    if (get_values(parts + i, components[i].memory + components[i].n_inputs))
        return 1;
    read_outputs(&desk, components + i);
    return 0;
}

static void transfer_all(int64_t count)
{
    for (int64_t x = 0; x < desk.n_exchanges; x++)
        transfer(&desk, exchanges + x, count);
}

static int set_start(const Start *s)
{
    Part *p = parts + s->part;
    int whole = (int)s->number;

    switch (s->kind) {
    case REAL: return p->fmu->set_real(p->instance, &s->reference, 1, &s->number) > WARNING;
    case INTEGER: return p->fmu->set_integer(p->instance, &s->reference, 1, &whole) > WARNING;
    case BOOLEAN: return p->fmu->set_boolean(p->instance, &s->reference, 1, &whole) > WARNING;
    default: return p->fmu->set_string(p->instance, &s->reference, 1, &s->text) > WARNING;
    }
}

static int64_t changed_inputs(double *before)
{
    int64_t changed = 0;

    for (int64_t x = 0; x < desk.n_exchanges; x++)
        for (int64_t i = 0; i < exchanges[x].n_inputs; i++, before++) {
            double value = get(exchanges + x, exchanges[x].inputs, i);

            changed += *before != value;
            *before = value;
        }
    return changed;
}

/* Begin anew: every component with its start values, until each input equals what feeds it. 0 where that went well. */
EXPORT int desk_start(void)
{
    static double inputs[N_INPUTS + 1];

    words[0] = '\0';
    now = 0;
    for (int i = 0; i < N_PARTS; i++) {
        Part *p = parts + i;

        if (p->instance)
            p->fmu->free_instance(p->instance);
        p->instance = p->fmu->instantiate(p->name, 1, p->fmu->guid, "", &callbacks, 0, 0);
        if (!p->instance)
            return 1;
    }
    for (int64_t x = 0; x < desk.n_exchanges; x++)
        exchanges[x].n_output_modifiers = exchanges[x].n_input_modifiers = 0;
    for (int i = 0; i < N_STARTS; i++)
        if (set_start(starts + i))
            return 1;
    restore_external();
    for (int i = 0; i < N_STARTS; i++)
        if (starts[i].row >= 0)
            put(exchanges + starts[i].exchange, exchanges[starts[i].exchange].sources, starts[i].row, starts[i].number);
    /* Outputs exist only in the initialisation mode, so all enter it first. */
    for (int i = 0; i < N_PARTS; i++)
        if (parts[i].fmu->setup(parts[i].instance, 0, 0.0, START_TIME, 1, STOP_TIME) > WARNING
            || parts[i].fmu->enter(parts[i].instance) > WARNING || read_part(i))
            return 1;
    transfer_all(0);
    changed_inputs(inputs);
    for (int iteration = 0;; iteration++) {
        if (iteration && !changed_inputs(inputs))
            break;
        if (iteration > MOST_ITERATIONS + N_PARTS) {
            snprintf(words, sizeof words, "the start does not settle: the components form a loop of direct feedthrough");
            return 1;
        }
        for (int i = 0; i < N_PARTS; i++)
            if (parts[i].feeds && (write_part(i) || read_part(i)))
                return 1;
        transfer_all(0);
    }
    for (int i = 0; i < N_PARTS; i++)
        if (write_part(i) || parts[i].fmu->leave(parts[i].instance) > WARNING || read_part(i))
            return 1;
    transfer_all(0);
    return 0;
}

/* Make n steps, at most MOST_STEPS; rows are recorded where they are due. 0 where that went well. */
EXPORT int desk_advance(int n)
{
    int64_t reached = now;
    int status;

    for (int i = 0; i <= n + MOST_MULTIPLE; i++)
        window[i] = time_of(now + i);
    desk.clock = window - now;
    desk.n_rows = 0;
    status = run(&desk, now, now + n, &reached);
    if (status == NOT_FINITE && !words[0])
        snprintf(words, sizeof words, "a value is not a finite number at t = %.9g s", time_of(reached));
    now = reached;
    return status;
}

/* Hold or shift a signal from now on: scale * value + shift. */
EXPORT void desk_modify(int exchange, int is_input, int row, double scale, double shift)
{
    Exchange *e = exchanges + exchange;
    int64_t *n = is_input ? &e->n_input_modifiers : &e->n_output_modifiers;
    int64_t *rows = (int64_t *)(is_input ? e->input_row : e->output_row), i = 0;

    while (i < *n && rows[i] != row)
        i++;
    *n += i == *n;
    rows[i] = row;
    ((double *)(is_input ? e->input_scale : e->output_scale))[i] = scale;
    ((double *)(is_input ? e->input_shift : e->output_shift))[i] = shift;
    refresh_all(&desk);
}

/* Let a signal follow its source again. */
EXPORT void desk_release(int exchange, int is_input, int row) { desk_modify(exchange, is_input, row, 1.0, 0.0); }

/* Give a value from outside; it is there from the present row on. */
EXPORT void desk_give(int exchange, int row, double value)
{
    put(exchanges + exchange, exchanges[exchange].sources, row, value);
    transfer_all(now);
}

/* Change a number that the next start takes. */
EXPORT void desk_change_start(int i, double value) { starts[i].number = value; }

EXPORT int64_t desk_step(void) { return now; }
EXPORT int64_t desk_rows(void) { return desk.n_rows; }
EXPORT const char *desk_words(void) { return words; }
EXPORT const void *desk_table(int exchange) { return exchanges[exchange].rows; }
