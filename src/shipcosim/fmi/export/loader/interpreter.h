/* Finds a Python for this process and starts it. */

#ifndef INTERPRETER_H
#define INTERPRETER_H

#include <stddef.h>

/* See that Python runs in this process. Returns 1, or 0 with the reason in `why`. */
int have_python(char *why, size_t size);

#endif
