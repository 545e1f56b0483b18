/* A host of FMUs of FMI 2.0 that knows nothing of Python. Commands come from stdin, words separated by tabs; answers,
   failures and what the FMUs log go to stdout, one line each. `load` takes several FMUs, each in a thread of its own:

   global                               FMUs loaded from now on are loaded for everybody's use
   python   LIBRARY 0|1                 loaded for the host alone; 1: started too
   load     {NAME LIBRARY GUID RESOURCES}...
   begin    NAME                        set TYPE of a value: Real Integer Boolean String
   set      NAME TYPE REFERENCE VALUE   get NAME TYPE REFERENCE
   step     NAME TIME STEP_SIZE         log NAME 0|1: debug logging; an FMU starts without
   save     NAME FILE                   restore NAME FILE
   free     NAME                        quit (at once, nothing is freed)
   maps     WORD                        how many libraries of this process have the word in their paths
*/

#include <dlfcn.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MANY 64
#define FUNCTION(instance, name) ((int (*)())look_up(instance->library, "fmi2" name))

typedef struct {
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*free)(void *);
    void *step_finished, *environment;
} Callbacks;
typedef struct {
    char *words[4], name[64];
    void *library, *component;
} Instance;

static Instance instances[MANY];
static int n_instances, mode = RTLD_NOW | RTLD_LOCAL;

static void log_line(void *environment, const char *name, int status, const char *category, const char *format, ...)
{
    char text[8192];
    va_list values;

    va_start(values, format);
    vsnprintf(text, sizeof text, format, values);
    va_end(values);
    for (char *c = text; *c; ++c)
        if (*c == '\n')
            *c = '|';
    printf("log %s %s %d %s: %s\n", (char *)environment, name, status, category, text);
}

static Callbacks callbacks = {log_line, calloc, free, NULL, "host"};

static void *look_up(void *library, const char *name)
{
    void *found = dlsym(library, name);
    if (!found) {
        printf("no %s\n", name);
        exit(3);
    }
    return found;
}

static void *load(void *given)
{
    Instance *one = given;
    void *(*instantiate)(const char *, int, const char *, const char *, const Callbacks *, int, int);

    snprintf(one->name, sizeof one->name, "%s", one->words[0]);
    one->library = dlopen(one->words[1], mode);
    if (!one->library) {
        printf("dlopen: %s\n", dlerror());
        return NULL;
    }
    *(void **)&instantiate = look_up(one->library, "fmi2Instantiate");
    one->component = instantiate(one->name, 1, one->words[2], one->words[3], &callbacks, 0, 0);
    printf("%s %s\n", one->name, one->component ? "instantiated" : "NULL");
    return NULL;
}

static void load_all(char **words, int n)
{
    pthread_t threads[MANY];
    int first = n_instances;

    for (; n >= 4; n -= 4, words += 4)
        memcpy(instances[n_instances++].words, words, 4 * sizeof *words);
    for (int i = first; i < n_instances; ++i)
        pthread_create(&threads[i], NULL, load, &instances[i]);
    for (int i = first; i < n_instances; ++i)
        pthread_join(threads[i], NULL);
}

static void load_python(char **words)
{
    void *library = dlopen(words[0], RTLD_NOW | RTLD_LOCAL);

    if (words[1][0] == '1') {
        ((void (*)(int))look_up(library, "Py_InitializeEx"))(0);
        ((void *(*)(void))look_up(library, "PyEval_SaveThread"))();
    }
}

static int set(Instance *one, const char *type, unsigned reference, const char *value)
{
    double real = strtod(value, NULL);
    int whole = atoi(value);

    if (!strcmp(type, "Real"))
        return FUNCTION(one, "SetReal")(one->component, &reference, (size_t)1, &real);
    if (!strcmp(type, "Integer"))
        return FUNCTION(one, "SetInteger")(one->component, &reference, (size_t)1, &whole);
    if (!strcmp(type, "Boolean"))
        return FUNCTION(one, "SetBoolean")(one->component, &reference, (size_t)1, &whole);
    return FUNCTION(one, "SetString")(one->component, &reference, (size_t)1, &value);
}

static int get(Instance *one, const char *type, unsigned reference)
{
    double real = 0.0;
    const char *text = "";
    int whole = 0, status;

    if (!strcmp(type, "Real")) {
        status = FUNCTION(one, "GetReal")(one->component, &reference, (size_t)1, &real);
        printf("%.17g\n", real);
    } else if (!strcmp(type, "String")) {
        status = FUNCTION(one, "GetString")(one->component, &reference, (size_t)1, &text);
        printf("%s\n", text);
    } else {
        status = !strcmp(type, "Integer") ? FUNCTION(one, "GetInteger")(one->component, &reference, (size_t)1, &whole)
                                          : FUNCTION(one, "GetBoolean")(one->component, &reference, (size_t)1, &whole);
        printf("%d\n", whole);
    }
    return status;
}

static int save(Instance *one, const char *path)
{
    void *state = NULL;
    size_t size = 0;
    int status = FUNCTION(one, "GetFMUstate")(one->component, &state);
    char *data;
    FILE *file;

    status |= FUNCTION(one, "SerializedFMUstateSize")(one->component, state, &size);
    data = malloc(size);
    status |= FUNCTION(one, "SerializeFMUstate")(one->component, state, data, size);
    status |= FUNCTION(one, "FreeFMUstate")(one->component, &state);
    file = fopen(path, "wb");
    fwrite(data, 1, size, file);
    fclose(file);
    free(data);
    return status;
}

static int restore(Instance *one, const char *path)
{
    static char data[1 << 20];
    void *state = NULL;
    FILE *file = fopen(path, "rb");
    size_t size = fread(data, 1, sizeof data, file);
    int status = FUNCTION(one, "DeSerializeFMUstate")(one->component, data, size, &state);

    fclose(file);
    status |= FUNCTION(one, "SetFMUstate")(one->component, state);
    return status | FUNCTION(one, "FreeFMUstate")(one->component, &state);
}

static int begin(Instance *one)
{
    int status = FUNCTION(one, "SetupExperiment")(one->component, 0, 0.0, 0.0, 0, 0.0);
    status |= FUNCTION(one, "EnterInitializationMode")(one->component);
    return status | FUNCTION(one, "ExitInitializationMode")(one->component);
}

static int release(Instance *one)
{
    ((void (*)(void *))look_up(one->library, "fmi2FreeInstance"))(one->component);
    one->component = NULL;
    return dlclose(one->library);
}

static void count_maps(const char *word)
{
    char line[4096];
    FILE *file = fopen("/proc/self/maps", "r");
    int n = 0;

    while (fgets(line, sizeof line, file))
        n += strstr(line, word) && strstr(line, ".so");
    fclose(file);
    printf("maps %d\n", n);
}

static int obey(const char *command, Instance *one, char **words)
{
    if (!strcmp(command, "begin"))
        return begin(one);
    if (!strcmp(command, "set"))
        return set(one, words[2], (unsigned)atoi(words[3]), words[4]);
    if (!strcmp(command, "get"))
        return get(one, words[2], (unsigned)atoi(words[3]));
    if (!strcmp(command, "step"))
        return FUNCTION(one, "DoStep")(one->component, strtod(words[2], NULL), strtod(words[3], NULL), 1);
    if (!strcmp(command, "log"))
        return FUNCTION(one, "SetDebugLogging")(one->component, atoi(words[2]), (size_t)0, NULL);
    if (!strcmp(command, "save"))
        return save(one, words[2]);
    if (!strcmp(command, "restore"))
        return restore(one, words[2]);
    if (!strcmp(command, "free"))
        return release(one);
    return -1;
}

int main(void)
{
    static char line[1 << 16];
    char *words[4 * MANY + 1];

    setvbuf(stdout, NULL, _IOLBF, 0);
    while (fgets(line, sizeof line, stdin)) {
        int n = 0, status = 0;
        Instance *one = NULL;
        char *kept = strdup(line);

        for (char *word = strtok(kept, "\t\n"); word; word = strtok(NULL, "\t\n"))
            words[n++] = word;
        if (!n || !strcmp(words[0], "quit"))
            return 0;
        if (!strcmp(words[0], "maps")) {
            count_maps(words[1]);
            continue;
        }
        if (!strcmp(words[0], "global")) {
            mode = RTLD_NOW | RTLD_GLOBAL;
            continue;
        }
        if (!strcmp(words[0], "load") || !strcmp(words[0], "python")) {
            words[0][0] == 'l' ? load_all(words + 1, n - 1) : load_python(words + 1);
            continue;
        }
        for (int i = 0; i < n_instances; ++i)
            if (!strcmp(instances[i].name, words[1]))
                one = &instances[i];
        status = one ? obey(words[0], one, words) : -1;
        if (status)
            printf("%s %s: status %d\n", words[0], words[1], status);
    }
    return 0;
}
