/* The operating system: Windows. */

#include "system.h"

#define WIN32_LEAN_AND_MEAN
#include <windows.h>

#include <psapi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <wchar.h>

static SRWLOCK own = SRWLOCK_INIT;

static int wide(const char *text, wchar_t *into, int size)
{
    return MultiByteToWideChar(CP_UTF8, 0, text, -1, into, size);
}

static int narrow(const wchar_t *text, char *into, int size)
{
    return WideCharToMultiByte(CP_UTF8, 0, text, -1, into, size, NULL, NULL);
}

/* Path of a module, its last part replaced by a file. */
static int beside(HMODULE module, const char *file, char *path, size_t size)
{
    wchar_t found[PATH_SIZE];
    DWORD length = GetModuleFileNameW(module, found, PATH_SIZE);
    char *last;

    if (!length || length >= PATH_SIZE || !narrow(found, path, (int)size) || !(last = strrchr(path, SEPARATOR)))
        return 0;
    if ((size_t)(last + 1 - path) + strlen(file) >= size)
        return 0;
    strcpy(last + 1, file);
    return 1;
}

int beside_this_library(const char *file, char *path, size_t size)
{
    HMODULE here;
    DWORD how = GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS | GET_MODULE_HANDLE_EX_FLAG_UNCHANGED_REFCOUNT;
    return GetModuleHandleExW(how, (LPCWSTR)&own, &here) && beside(here, file, path, size);
}

static void *load(const char *path, char *why, size_t size)
{
    wchar_t name[PATH_SIZE];
    HMODULE library = wide(path, name, PATH_SIZE) ? LoadLibraryExW(name, NULL, LOAD_WITH_ALTERED_SEARCH_PATH) : NULL;

    if (!library)
        snprintf(why, size, "%s cannot be loaded: error %lu of Windows", path, GetLastError());
    return library;
}

void *load_private(const char *path, char *why, size_t size)
{
    return load(path, why, size);
}

/* pythonfmu's binary asks for python3.dll, which passes its calls on to the library of one version beside it. */
static void *with_python3(void *python, char *why, size_t size)
{
    char path[PATH_SIZE];

    if (!beside(python, "python3.dll", path, sizeof path)) {
        snprintf(why, size, "there is no python3.dll beside its library");
        return NULL;
    }
    return load(path, why, size) ? python : NULL;
}

void *load_python(const char *path, char *why, size_t size)
{
    void *python = load(path, why, size);
    return python ? with_python3(python, why, size) : NULL;
}

void *python_of_this_process(void)
{
    HMODULE modules[1024];
    DWORD bytes = 0;
    char why[256];

    if (!K32EnumProcessModules(GetCurrentProcess(), modules, sizeof modules, &bytes))
        return NULL;
    for (DWORD i = 0; i < bytes / sizeof *modules && i < 1024; ++i) {
        wchar_t path[PATH_SIZE], *name;
        DWORD length = GetModuleFileNameW(modules[i], path, PATH_SIZE);
        if (!length || length >= PATH_SIZE || !(name = wcsrchr(path, L'\\')))
            continue;
        if (!_wcsnicmp(name, L"\\python3", 8) && _wcsicmp(name, L"\\python3.dll") && GetProcAddress(modules[i], "Py_IsInitialized"))
            return with_python3(modules[i], why, sizeof why);
    }
    return NULL;
}

void *symbol_of(void *library, const char *name)
{
    return (void *)GetProcAddress(library, name);
}

/* As one argument of a command line; the code has no double quotes and no backslashes. */
int answer_of(const char *program, const char *code, char *answer, size_t size)
{
    wchar_t line[2 * PATH_SIZE];
    char text[2 * PATH_SIZE];
    SECURITY_ATTRIBUTES inherited = {sizeof inherited, NULL, TRUE};
    STARTUPINFOW start = {.cb = sizeof start, .dwFlags = STARTF_USESTDHANDLES};
    PROCESS_INFORMATION child;
    HANDLE from, to;
    DWORD more;
    size_t length = 0;
    int started;

    if ((size_t)snprintf(text, sizeof text, "\"%s\" -c \"%s\"", program, code) >= sizeof text)
        return 0;
    if (!wide(text, line, 2 * PATH_SIZE) || !CreatePipe(&from, &to, &inherited, 0))
        return 0;
    SetHandleInformation(from, HANDLE_FLAG_INHERIT, 0);
    start.hStdOutput = to;
    started = CreateProcessW(NULL, line, NULL, NULL, TRUE, CREATE_NO_WINDOW, NULL, NULL, &start, &child);
    CloseHandle(to);
    while (started && length + 1 < size && ReadFile(from, answer + length, (DWORD)(size - 1 - length), &more, NULL) && more)
        length += more;
    CloseHandle(from);
    answer[length] = '\0';
    if (started) {
        WaitForSingleObject(child.hProcess, INFINITE);
        CloseHandle(child.hProcess);
        CloseHandle(child.hThread);
    }
    return started;
}

int is_file(const char *path)
{
    wchar_t name[PATH_SIZE];
    DWORD found = wide(path, name, PATH_SIZE) ? GetFileAttributesW(name) : INVALID_FILE_ATTRIBUTES;
    return found != INVALID_FILE_ATTRIBUTES && !(found & FILE_ATTRIBUTE_DIRECTORY);
}

int variable(const char *name, char *value, size_t size)
{
    wchar_t key[64], found[8 * PATH_SIZE];
    DWORD length = wide(name, key, 64) ? GetEnvironmentVariableW(key, found, 8 * PATH_SIZE) : 0;
    return length && length < 8 * PATH_SIZE && narrow(found, value, (int)size);
}

void lock(void)
{
    AcquireSRWLockExclusive(&own);
}

void unlock(void)
{
    ReleaseSRWLockExclusive(&own);
}

long long lock_process(const char *path)
{
    wchar_t name[64];
    HANDLE held;

    (void)path;
    swprintf(name, 64, L"Local\\shipcosim-python-%lu", GetCurrentProcessId());
    held = CreateMutexW(NULL, FALSE, name);
    if (held)
        WaitForSingleObject(held, INFINITE);
    return (long long)(size_t)held;
}

void unlock_process(long long held)
{
    if (held) {
        ReleaseMutex((HANDLE)(size_t)held);
        CloseHandle((HANDLE)(size_t)held);
    }
}

/* pythonfmu's library sees to its end by itself. */
void at_end(void (*function)(void))
{
    (void)function;
}
