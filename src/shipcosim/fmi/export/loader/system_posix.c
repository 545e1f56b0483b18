/* The operating system: Linux. */

#define _GNU_SOURCE

#include "system.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <link.h>
#include <pthread.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
static char folder[PATH_SIZE];

/* At once, since the path that the host gave may be relative to a folder that it leaves. */
__attribute__((constructor)) static void find_folder(void)
{
    Dl_info info;
    char path[PATH_SIZE], *last;

    if (dladdr(&mutex, &info) && info.dli_fname && strlen(info.dli_fname) < PATH_SIZE && realpath(info.dli_fname, path)) {
        last = strrchr(path, SEPARATOR);
        *last = '\0';
        strcpy(folder, path);
    }
}

int beside_this_library(const char *file, char *path, size_t size)
{
    int length = snprintf(path, size, "%s/%s", folder, file);
    return folder[0] && length > 0 && (size_t)length < size;
}

static void *load(const char *path, int mode, char *why, size_t size)
{
    void *library = dlopen(path, RTLD_NOW | mode);
    const char *said = library ? NULL : dlerror();

    if (!library)
        snprintf(why, size, "%s", said ? said : "it cannot be loaded");
    return library;
}

void *load_private(const char *path, char *why, size_t size)
{
    return load(path, RTLD_LOCAL, why, size);
}

void *load_python(const char *path, char *why, size_t size)
{
    return load(path, RTLD_GLOBAL, why, size);
}

static int promoted(struct dl_phdr_info *info, size_t size, void *found)
{
    const char *name = info->dlpi_name ? strrchr(info->dlpi_name, '/') : NULL;
    (void)size;
    if (!name || strncmp(name, "/libpython3.", 12) || !strncmp(name, "/libpython3.so", 14))
        return 0;
    *(void **)found = dlopen(info->dlpi_name, RTLD_NOW | RTLD_NOLOAD | RTLD_GLOBAL);
    return *(void **)found != NULL;
}

/* The symbols may belong to the program itself, or to a library that was loaded for somebody's use alone. */
void *python_of_this_process(void)
{
    void *found = NULL;

    if (dlsym(RTLD_DEFAULT, "Py_IsInitialized"))
        return dlopen(NULL, RTLD_NOW);
    dl_iterate_phdr(promoted, &found);
    return found;
}

void *symbol_of(void *library, const char *name)
{
    return dlsym(library, name);
}

int answer_of(const char *program, const char *code, char *answer, size_t size)
{
    char *arguments[] = {(char *)program, "-c", (char *)code, NULL};
    posix_spawn_file_actions_t actions;
    int ends[2], failed;
    size_t length = 0;
    ssize_t more;
    pid_t child;

    if (pipe2(ends, O_CLOEXEC))
        return 0;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, ends[1], 1);
    posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
    failed = posix_spawnp(&child, program, &actions, NULL, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    while (!failed && length + 1 < size && (more = read(ends[0], answer + length, size - 1 - length)) > 0)
        length += (size_t)more;
    close(ends[0]);
    answer[length] = '\0';
    if (!failed)
        waitpid(child, NULL, 0);
    return !failed;
}

int is_file(const char *path)
{
    struct stat found;
    return !stat(path, &found) && S_ISREG(found.st_mode);
}

int variable(const char *name, char *value, size_t size)
{
    const char *found = getenv(name);

    if (!found || !*found || strlen(found) >= size)
        return 0;
    strcpy(value, found);
    return 1;
}

void lock(void)
{
    pthread_mutex_lock(&mutex);
}

void unlock(void)
{
    pthread_mutex_unlock(&mutex);
}

long long lock_process(const char *path)
{
    int file = open(path, O_RDONLY | O_CLOEXEC);
    if (file >= 0)
        flock(file, LOCK_EX);
    return file;
}

void unlock_process(long long held)
{
    if (held >= 0)
        close((int)held);
}

void at_end(void (*function)(void))
{
    atexit(function);
}
