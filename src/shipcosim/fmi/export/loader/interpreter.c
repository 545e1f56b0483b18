/* Finds a Python for this process and starts it.

   A host that is Python has one. Elsewhere the candidates are asked by running them, since nothing else knows what a
   virtual environment, a version manager or a distribution made of paths: version, library, whether NumPy can be
   imported. The first one that can do it is loaded for everybody's use, as if the program had been started as this
   interpreter. It is never ended, because several FMUs share it and NumPy cannot be started twice. */

#include "interpreter.h"

#include "system.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CHOICE "SHIPCOSIM_PYTHON"
#define NEEDED "It needs Python 3.11 or newer, with NumPy and with the shared library of Python."

static const int OLDEST = 11; /* of 3. */

/* Python 2 can read it too. No double quotes and no backslashes: system_windows.c. */
static const char QUESTION[] =
    "import os, sys, sysconfig\n"
    "from importlib.util import find_spec\n"
    "known = lambda name: str(sysconfig.get_config_var(name) or '')\n"
    "free = 't' if known('Py_GIL_DISABLED') in ('1', 'True') else ''\n"
    "major, minor = sys.version_info[:2]\n"
    "if os.name == 'nt':\n"
    "    folders, names = [sys.base_prefix], ['python%d%d%s.dll' % (major, minor, free)]\n"
    "else:\n"
    "    beside = os.path.join(os.path.dirname(os.path.realpath(sys.executable)), os.pardir, 'lib')\n"
    "    folders = [known('LIBDIR'), os.path.join(known('LIBDIR'), known('MULTIARCH'))]\n"
    "    folders += [os.path.join(sys.base_exec_prefix, 'lib'), beside]\n"
    "    names = [known('INSTSONAME'), 'libpython%d.%d%s.so.1.0' % (major, minor, free)]\n"
    "    names = [name for name in names if '.so' in name]\n"
    "paths = [os.path.abspath(os.path.join(folder, name)) for folder in folders if folder for name in names]\n"
    "library = ([path for path in paths if os.path.isfile(path)] + [''])[0]\n"
    "lines = ['shipcosim', '%d.%d' % (major, minor), sys.executable, library]\n"
    "lines += ['NumPy' if find_spec('numpy') else '', free]\n"
    "os.write(1, chr(10).join(lines + ['']).encode('utf-8', 'surrogateescape'))\n";

/* Shows at once what FMUs print, since Python is not ended; some libraries want program arguments to be there. */
static const char PREPARE[] =
    "import sys\n"
    "sys.argv = getattr(sys, 'argv', [''])\n"
    "for stream in (sys.stdout, sys.stderr):\n"
    "    getattr(stream, 'reconfigure', dict)(line_buffering=True)\n";

struct candidate {
    int minor;
    char executable[PATH_SIZE], library[PATH_SIZE];
};

static void add(char *text, size_t size, const char *format, ...)
{
    size_t length = strlen(text);
    va_list values;

    va_start(values, format);
    vsnprintf(text + length, size - length, format, values);
    va_end(values);
}

/* The next line of a text, cut off; empty at the end. */
static char *line_of(char **text)
{
    char *line = *text, *end = line + strcspn(line, "\r\n");

    *text = end + strspn(end, "\r");
    *text += **text == '\n';
    *end = '\0';
    return line;
}

/* Whether a program is a Python that FMUs can run in; adds why not. A `minor` of its version other than 0 is wanted. */
static int is_suitable(const char *program, int minor, struct candidate *found, char *why, size_t size)
{
    char answer[3 * PATH_SIZE], *rest = answer, *version, *numpy, *free_threaded;

    add(why, size, "\n  %s", program);
    if (!answer_of(program, QUESTION, answer, sizeof answer) || strcmp(line_of(&rest), "shipcosim")) {
        add(why, size, " does not answer as Python 3 does");
        return 0;
    }
    version = line_of(&rest);
    found->minor = atoi(version + 2);
    snprintf(found->executable, PATH_SIZE, "%s", line_of(&rest));
    snprintf(found->library, PATH_SIZE, "%s", line_of(&rest));
    numpy = line_of(&rest);
    free_threaded = line_of(&rest);
    add(why, size, " is Python %s", version);
    if (found->minor < OLDEST)
        add(why, size, ", which is too old");
    else if (minor && found->minor != minor)
        add(why, size, "; this process has Python 3.%d already", minor);
    else if (*free_threaded)
        add(why, size, " without a global lock, which pythonfmu's binary cannot use");
    else if (!*numpy)
        add(why, size, " without NumPy");
    else if (!*found->library)
        add(why, size, " without a shared library (Debian: package libpython%s; pyenv: --enable-shared)", version);
    else
        return 1;
    return 0;
}

/* The next folder of PATH, or 0 after the last. */
static int next_folder(const char **path, char *folder, size_t size)
{
    const char *end;
    size_t length;

    while (**path) {
        end = strchr(*path, BETWEEN_FOLDERS);
        length = end ? (size_t)(end - *path) : strlen(*path);
        snprintf(folder, size, "%.*s", (int)length, *path);
        *path += length + (end != NULL);
        if (length && length < size)
            return 1;
    }
    return 0;
}

/* Try the programs of a folder; `asked` counts those that are there. */
static int search_folder(const char *folder, int minor, struct candidate *found, char *why, size_t size, int *asked)
{
#ifdef _WIN32
    static const char *const names[] = {"python.exe", "python3.exe", "py.exe"};
#else
    static const char *const names[] = {"python3", "python"};
#endif
    char program[PATH_SIZE];

    for (size_t i = 0; i < sizeof names / sizeof *names; ++i) {
        if ((size_t)snprintf(program, sizeof program, "%s%c%s", folder, SEPARATOR, names[i]) >= sizeof program)
            continue;
        if (is_file(program)) {
            ++*asked;
            if (is_suitable(program, minor, found, why, size))
                return 1;
        }
    }
    return 0;
}

/* What the user chose, that and nothing else; or the first suitable one of PYTHONHOME and PATH. */
static int find(int minor, struct candidate *found, char *why, size_t size)
{
    char value[8 * PATH_SIZE], folder[PATH_SIZE];
    const char *rest = value;
    int asked = 0;

    if (variable(CHOICE, value, sizeof value)) {
        add(why, size, " " CHOICE " names");
        return is_suitable(value, minor, found, why, size);
    }
    add(why, size, " Tried, from PATH:");
    if (variable("PYTHONHOME", value, sizeof value)) {
#ifdef _WIN32
        snprintf(folder, sizeof folder, "%s", value);
#else
        snprintf(folder, sizeof folder, "%.*s/bin", (int)strcspn(value, ":"), value);
#endif
        if (search_folder(folder, minor, found, why, size, &asked))
            return 1;
    }
    if (variable("PATH", value, sizeof value))
        while (next_folder(&rest, folder, sizeof folder))
            if (search_folder(folder, minor, found, why, size, &asked))
                return 1;
    if (!asked)
        add(why, size, " nothing, there is no python3 in it.");
    return 0;
}

/* As Python 3.11 to 3.14 are told who they are. The name has to stay in memory. Files are named in UTF-8, whatever the
   locale of the host. */
static int start_named(void *python, void (*set_name)(const wchar_t *), const char *executable)
{
    wchar_t *(*decode)(const char *, size_t *) = symbol_of(python, "Py_DecodeLocale");
    void (*initialise)(int) = symbol_of(python, "Py_InitializeEx");
    int *utf8_mode = symbol_of(python, "Py_UTF8Mode");
    wchar_t *name;

    if (utf8_mode)
        *utf8_mode = 1;
    name = decode && initialise ? decode(executable, NULL) : NULL;

    if (!name)
        return 0;
    set_name(name);
    initialise(0);
    return 1;
}

/* As later versions are. */
static int start_configured(void *python, const char *executable)
{
    void *(*create)(void) = symbol_of(python, "PyInitConfig_Create");
    int (*set_text)(void *, const char *, const char *) = symbol_of(python, "PyInitConfig_SetStr");
    int (*set_number)(void *, const char *, long long) = symbol_of(python, "PyInitConfig_SetInt");
    int (*initialise)(void *) = symbol_of(python, "Py_InitializeFromInitConfig");
    void *config = create && set_text && set_number && initialise ? create() : NULL;

    return config && !set_number(config, "utf8_mode", 1) && !set_text(config, "executable", executable) &&
           !set_number(config, "use_environment", 1) && !set_number(config, "user_site_directory", 1) &&
           !initialise(config);
}

/* Leaves the lock of Python to whoever calls an FMU next, from any thread. */
static int start(void *python, const struct candidate *found, char *why, size_t size)
{
    int (*is_running)(void) = symbol_of(python, "Py_IsInitialized");
    int (*execute)(const char *) = symbol_of(python, "PyRun_SimpleString");
    void *(*leave)(void) = symbol_of(python, "PyEval_SaveThread");
    void *set_name = symbol_of(python, "Py_SetProgramName");
    long long held = lock_process(found->library);
    int started = is_running && is_running();

    if (!started && is_running && execute && leave) {
        started = set_name ? start_named(python, (void (*)(const wchar_t *))set_name, found->executable)
                           : start_configured(python, found->executable);
        if (started) {
            execute(PREPARE);
            leave();
        }
    }
    unlock_process(held);
    if (!started)
        add(why, size, " %s cannot be started.", found->executable);
    return started;
}

int have_python(char *why, size_t size)
{
    void *python = python_of_this_process();
    int (*is_running)(void) = python ? (int (*)(void))symbol_of(python, "Py_IsInitialized") : NULL;
    const char *(*version)(void) = python ? (const char *(*)(void))symbol_of(python, "Py_GetVersion") : NULL;
    int minor = version ? atoi(version() + 2) : 0;
    struct candidate found;
    char reason[512];

    if (is_running && is_running())
        return 1;
    snprintf(why, size, "there is no Python for this FMU. " NEEDED);
    if (!find(minor, &found, why, size)) {
        add(why, size, "\nThe environment variable " CHOICE " can name the interpreter to use.");
        return 0;
    }
    if (!python && !(python = load_python(found.library, reason, sizeof reason))) {
        snprintf(why, size, "the library of %s cannot be loaded: %s", found.executable, reason);
        return 0;
    }
    return start(python, &found, why, size);
}
