/* The master's loop between two events: what src/shipcosim/cosim/master does step by step, for components in C.
   The structures are filled by src/shipcosim/native/loop.py, which declares the same fields in the same order. */

#include <math.h>
#include <stdint.h>
#include <string.h>
#include <time.h>

#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

typedef int (*Call)(void *host, int number, const double *arguments, double *kept);
typedef int (*Step)(double *memory, double *kept, Call call, void *host);
typedef int (*Host)(int component, int64_t step);

typedef struct {
    int is_real;                                /* values are double, else int32 */
    int64_t n_sources, n_outputs, n_inputs, n_transferred;
    void *sources, *modified, *transferred, *inputs;
    int64_t n_connections;
    const int64_t *source, *target, *period;    /* of each connection, those of one period together */
    const double *factor, *offset;
    const int64_t *mapped;                      /* number of its mapping, or -1 */
    const int64_t *mapping_first;               /* where the pairs of each mapping begin; the last ends the last one */
    const double *mapping_from, *mapping_to;
    int64_t n_sums;
    const int64_t *sum_row, *sum_first, *sum_end;
    int64_t n_changes;
    const int64_t *change_row, *change_exchange, *change_source;
    int64_t n_output_modifiers, n_input_modifiers;
    const int64_t *output_row, *input_row;
    const double *output_scale, *output_shift, *input_scale, *input_shift;
    const void *external;                       /* (steps + 1, external) values over time, or NULL */
    void *rows;                                 /* (rows, columns) of the table */
    int64_t n_columns, n_external_columns, n_input_columns;
    const int64_t *external_columns, *input_columns;
    int64_t version;                            /* grows whenever an input changes */
} Exchange;

typedef struct {
    Step step;                                  /* NULL: stepped by the host */
    double *memory, *kept;
    Call call;
    int64_t n_memory, multiple;
    double fixed_step;                          /* 0: the difference of two times */
    int64_t n_inputs, n_outputs;
    const int64_t *input_place, *input_exchange, *input_row;
    const int64_t *output_place, *output_exchange, *output_row;
} Component;

typedef struct {
    int64_t n_exchanges, n_components;
    Exchange *exchanges;
    Component *components;
    const double *clock;
    int64_t first, steps_per_row, n_rows;
    Host host;
    int64_t real;                               /* number of the exchange of reals, or -1 */
    int64_t stop;                               /* set by the host: end after this step */
    double *seconds;                            /* of each component's steps, exchange, recording; NULL: not counted */
} System;

enum { DONE = 0, FAILED = 1, NOT_FINITE = 2 };

/* Add the time since `began` to a count, and give the time now. In a page there is no clock, and nothing is counted. */
static double count(System *s, int64_t place, double began) {
#ifdef __wasm__
    (void)s, (void)place, (void)began;
    return 0.0;
#else
    struct timespec at;
    if (s->seconds == 0) return 0.0;
    timespec_get(&at, TIME_UTC);
    double now = (double)at.tv_sec + 1e-9 * (double)at.tv_nsec;
    if (place >= 0) s->seconds[place] += now - began;
    return now;
#endif
}

static double get(const Exchange *e, const void *array, int64_t row) {
    return e->is_real ? ((const double *)array)[row] : (double)((const int32_t *)array)[row];
}

static void put(const Exchange *e, void *array, int64_t row, double value) {
    if (e->is_real) ((double *)array)[row] = value; else ((int32_t *)array)[row] = (int32_t)value;
}

static int64_t size(const Exchange *e) { return e->is_real ? 8 : 4; }

static void refresh(Exchange *e) {
    int changed = 0;
    for (int64_t i = 0; i < e->n_inputs; i++) {
        double value = get(e, e->transferred, i);
        int64_t modifier = 0;
        for (; modifier < e->n_input_modifiers; modifier++)
            if (e->input_row[modifier] == i)
                value = e->input_scale[modifier] * value + e->input_shift[modifier];
        if (!e->is_real) changed |= get(e, e->inputs, i) != (double)(int32_t)value;
        put(e, e->inputs, i, value);
    }
    e->version += changed;
}

static void transfer(System *s, Exchange *e, int64_t count) {
    for (int64_t i = 0; i < e->n_changes; i++) {
        const Exchange *other = s->exchanges + e->change_exchange[i];
        put(e, e->sources, e->n_outputs + e->change_row[i], get(other, other->modified, e->change_source[i]));
    }
    memcpy(e->modified, e->sources, e->n_sources * size(e));
    for (int64_t i = 0; i < e->n_output_modifiers; i++) {
        int64_t row = e->output_row[i];
        put(e, e->modified, row, e->output_scale[i] * get(e, e->modified, row) + e->output_shift[i]);
    }
    int64_t period = 0;
    int due = 0;
    for (int64_t i = 0; i < e->n_connections; i++) {
        if (e->period[i] != period) {
            period = e->period[i];
            due = count % period == 0;
        }
        if (!due) continue;
        double value = get(e, e->modified, e->source[i]);
        if (e->mapped[i] >= 0)
            for (int64_t j = e->mapping_first[e->mapped[i]]; j < e->mapping_first[e->mapped[i] + 1]; j++)
                if (e->mapping_from[j] == value) { value = e->mapping_to[j]; break; }
        if (e->factor[i] != 1.0 || e->offset[i] != 0.0) value = e->factor[i] * value + e->offset[i];
        put(e, e->transferred, e->target[i], value);
    }
    for (int64_t i = 0; i < e->n_sums; i++) {
        double total = 0.0;
        for (int64_t j = e->sum_first[i]; j < e->sum_end[i]; j++) total += get(e, e->transferred, j);
        put(e, e->transferred, e->sum_row[i], total);
    }
    refresh(e);
}

static void record(System *s) {
    for (int64_t x = 0; x < s->n_exchanges; x++) {
        Exchange *e = s->exchanges + x;
        char *row = (char *)e->rows + s->n_rows * e->n_columns * size(e);
        memcpy(row, e->modified, e->n_outputs * size(e));
        for (int64_t i = 0; i < e->n_external_columns; i++)
            put(e, row, e->n_outputs + i, get(e, e->modified, e->external_columns[i]));
        for (int64_t i = 0; i < e->n_input_columns; i++)
            put(e, row, e->n_outputs + e->n_external_columns + i, get(e, e->inputs, e->input_columns[i]));
    }
    s->n_rows++;
}

static int step_natively(System *s, Component *c, int64_t k) {
    double sum = 0.0;
    for (int64_t i = 0; i < c->n_inputs; i++) {
        const Exchange *e = s->exchanges + c->input_exchange[i];
        double value = get(e, e->inputs, c->input_row[i]);
        c->memory[c->input_place[i]] = value;
        sum += value;
    }
    if (!isfinite(sum)) return 1;
    c->memory[c->n_memory] = s->clock[k];
    c->memory[c->n_memory + 1] = c->fixed_step > 0.0 ? c->fixed_step : s->clock[k + c->multiple] - s->clock[k];
    return c->step(c->memory, c->kept, c->call, 0);
}

static void read_outputs(System *s, Component *c) {
    for (int64_t i = 0; i < c->n_outputs; i++) {
        Exchange *e = s->exchanges + c->output_exchange[i];
        put(e, e->sources, c->output_row[i], c->memory[c->output_place[i]]);
    }
}

static int step_all(System *s, int64_t k) {
    for (int64_t n = 0; n < s->n_components; n++) {
        Component *c = s->components + n;
        if (k % c->multiple) continue;
        double began = count(s, -1, 0.0);
        int to_host = c->step == 0 || step_natively(s, c, k);
        count(s, n, began);
        if (to_host && s->host((int)n, k)) return FAILED;
    }
    for (int64_t n = 0; n < s->n_components; n++) {
        Component *c = s->components + n;
        if ((k + 1) % c->multiple) continue;
        if (c->step) read_outputs(s, c);
        else if (s->host((int)(-1 - n), k)) return FAILED;
    }
    return DONE;
}

/* Bring the inputs up to date after a change of overrides and biases. */
EXPORT void refresh_all(System *s) {
    for (int64_t x = 0; x < s->n_exchanges; x++) refresh(s->exchanges + x);
}

/* Steps `from` to `to`, with rows where they are due; the last row of the run is the caller's. */
EXPORT int run(System *s, int64_t from, int64_t to, int64_t *reached) {
    for (int64_t k = from; k < to; k++) {
        *reached = k;
        double began = count(s, -1, 0.0);
        if (k % s->steps_per_row == 0) record(s);
        count(s, s->n_components + 1, began);
        int status = step_all(s, k);
        if (status != DONE) return status;
        began = count(s, -1, 0.0);
        for (int64_t x = 0; x < s->n_exchanges; x++) {
            Exchange *e = s->exchanges + x;
            if (e->external) {
                int64_t bytes = (e->n_sources - e->n_outputs) * size(e);
                memcpy((char *)e->sources + e->n_outputs * size(e),
                       (const char *)e->external + (k + 1 - s->first) * bytes, bytes);
            }
        }
        for (int64_t x = 0; x < s->n_exchanges; x++) transfer(s, s->exchanges + x, k + 1);
        count(s, s->n_components, began);
        if (s->real >= 0) {
            const Exchange *e = s->exchanges + s->real;
            const double *values = e->modified;
            for (int64_t i = 0; i < e->n_sources; i++)
                if (!isfinite(values[i])) { *reached = k + 1; return NOT_FINITE; }
        }
        *reached = k + 1;
        if (s->stop) break;
    }
    return DONE;
}
