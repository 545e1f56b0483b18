/* What the loader needs of the operating system: system_posix.c, system_windows.c. Paths are UTF-8. */

#ifndef SYSTEM_H
#define SYSTEM_H

#include <stddef.h>

#define PATH_SIZE 4096

#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#define SEPARATOR '\\'
#define BETWEEN_FOLDERS ';'
#else
#define EXPORT __attribute__((visibility("default")))
#define SEPARATOR '/'
#define BETWEEN_FOLDERS ':'
#endif

/* A file beside this library into `path`; 0 where that cannot be said. */
int beside_this_library(const char *file, char *path, size_t size);

/* Load a library for its own symbols; NULL with the reason in `why`. It stays until the process ends. */
void *load_private(const char *path, char *why, size_t size);

/* Load the library of Python for everybody's use; NULL with the reason in `why`. It stays until the process ends. */
void *load_python(const char *path, char *why, size_t size);

/* The library of Python that this process has already, or NULL. */
void *python_of_this_process(void);

void *symbol_of(void *library, const char *name);

/* What a program, a path or a name in PATH, prints on stdout when asked to run Python code; 0 where it could not be
   started. */
int answer_of(const char *program, const char *code, char *answer, size_t size);

int is_file(const char *path);

/* Value of an environment variable; 0 where it is not set, empty or too long. */
int variable(const char *name, char *value, size_t size);

/* One thread of this library's. */
void lock(void);
void unlock(void);

/* One thread of all libraries like this in the process, which may start Python; `path` is Python's library. */
long long lock_process(const char *path);
void unlock_process(long long held);

/* Call a function when the process ends. */
void at_end(void (*function)(void));

#endif
