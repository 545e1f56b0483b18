/* What the C text of a model and the functions of FMI 2.0 share. */

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef __clang__
#define PLAIN __attribute__((optnone, noinline))
#else
#define PLAIN
#endif

typedef enum { REAL, INTEGER, BOOLEAN, STRING } Type;
typedef enum { INPUT, OUTPUT, PARAMETER } Causality;
enum { DONE = 0, GIVEN_UP = 1 };

typedef struct {
    const char *name;
    Type type;
    Causality causality;
    int is_tunable, is_required;
    double minimum, maximum, start;
    const char *unit, *text;                    /* of a text its start value */
} Variable;

/* A value that belongs to the code of a variant. */
typedef struct {
    int variable;
    double number;
    const char *text;
} Choice;

/* Memory of numbers: the variables in the order of their value references, time at the start of the run, time and
   length of a step, then the state. */
typedef struct Instance {
    double *m, *kept;
    char **texts;                               /* by variable; NULL where it is no text */
    char *said, *name;                          /* why something failed */
    size_t n_said, room;
    double time;
    int is_initialising, is_initialised, is_stale, variant, is_logging;
    int is_for_others;                          /* it failed because its code is for other numbers */
    void *callbacks;
} Instance;

typedef struct {
    int n_choices, n_memory, n_kept;
    const Choice *choices;
    int (*start)(double *restrict m, double *restrict k, Instance *o);
    int (*step)(double *restrict m, double *restrict k, Instance *o);
} Variant;

/* Add words to what has failed. */
static void say(Instance *o, const char *words)
{
    size_t n = strlen(words);

    if (o->n_said + n + 1 > o->room) {
        size_t room = 2 * (o->n_said + n + 1);
        char *longer = realloc(o->said, room);

        if (!longer)
            return;
        o->said = longer;
        o->room = room;
    }
    memcpy(o->said + o->n_said, words, n + 1);
    o->n_said += n;
}

/* Add a number by a format of printf, as Python writes it. */
static void say_number(Instance *o, double value, const char *format)
{
    char text[400];

    if (isnan(value))
        snprintf(text, sizeof text, "nan");
    else if (isinf(value))
        snprintf(text, sizeof text, value > 0.0 ? "inf" : "-inf");
    else
        snprintf(text, sizeof text, format, value);
    say(o, text);
}

/* Add a float as Python writes it: the fewest digits that give it back. */
static void say_float(Instance *o, double value)
{
    char text[64];
    int exponent = value == 0.0 || !isfinite(value) ? 0 : (int)floor(log10(fabs(value)));

    for (int digits = 1; digits <= 17; digits++) {
        if (exponent < -4 || exponent >= 16)
            snprintf(text, sizeof text, "%.*e", digits - 1, value);
        else
            snprintf(text, sizeof text, "%.*f", digits - 1 - exponent > 1 ? digits - 1 - exponent : 1, value);
        if (!isfinite(value) || strtod(text, NULL) == value)
            break;
    }
    say_number(o, value, text);
}

static void say_truth(Instance *o, double value) { say(o, value != 0.0 ? "True" : "False"); }

static inline double remainder_of(double a, double b)
{
    double m = fmod(a, b);

    if (m != 0.0)
        return ((b < 0.0) != (m < 0.0)) ? m + b : m;
    return copysign(0.0, b);
}

static inline double floor_division(double a, double b)
{
    double m = fmod(a, b), d = (a - m) / b, whole;

    if (m != 0.0 && ((b < 0.0) != (m < 0.0)))
        d -= 1.0;
    if (d == 0.0)
        return copysign(0.0, a / b);
    whole = floor(d);
    return d - whole > 0.5 ? whole + 1.0 : whole;
}

static inline double rounded(double x, double scale) { return rint(x * scale) / scale; }

static inline double interpolated(double x, const double *xs, const double *ys, int n)
{
    int low = 0, high = n - 1;

    if (x <= xs[0])
        return ys[0];
    if (x >= xs[n - 1])
        return ys[n - 1];
    while (high - low > 1) {
        int middle = (low + high) / 2;

        if (x < xs[middle])
            high = middle;
        else
            low = middle;
    }
    return ys[low] + (ys[low + 1] - ys[low]) * (x - xs[low]) / (xs[low + 1] - xs[low]);
}
