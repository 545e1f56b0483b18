/* Engines of others in a program that is not Python. Prints a value after some steps:

   engines libcosim LIBRARY OspSystemStructure.xml COMPONENT REFERENCE STEPS
   engines ecos LIBRARY FILE.ssp COMPONENT::NAME STEP_SIZE STEPS PARAMETER_SET
*/

#include <dlfcn.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void *library;

static void *function(const char *name)
{
    void *found = dlsym(library, name);
    if (!found) {
        fprintf(stderr, "no %s\n", name);
        exit(3);
    }
    return found;
}

static void *checked(void *made, const char *error)
{
    if (!made) {
        fprintf(stderr, "%s\n", ((const char *(*)(void))function(error))());
        exit(1);
    }
    return made;
}

static int with_libcosim(char **words)
{
    struct {
        char name[1024];
        int index;
    } slaves[32];
    void *(*create)(const char *, bool, int64_t) = function("cosim_osp_config_execution_create");
    void *(*observe)(void) = function("cosim_last_value_observer_create");
    int (*add)(void *, void *) = function("cosim_execution_add_observer");
    size_t (*count)(void *) = function("cosim_execution_get_num_slaves");
    int (*list)(void *, void *, size_t) = function("cosim_execution_get_slave_infos");
    int (*step)(void *, size_t) = function("cosim_execution_step");
    int (*get)(void *, int, const uint32_t *, size_t, double *) = function("cosim_observer_slave_get_real");
    void *execution = checked(create(words[0], true, 0), "cosim_last_error_message"), *observer = observe();
    uint32_t reference = (uint32_t)atoi(words[2]);
    double value = 0.0;

    add(execution, observer);
    list(execution, slaves, 32);
    if (step(execution, (size_t)atoi(words[3])))
        checked(NULL, "cosim_last_error_message");
    for (size_t i = 0; i < count(execution); ++i)
        if (!strcmp(slaves[i].name, words[1]))
            get(observer, slaves[i].index, &reference, 1, &value);
    printf("%.17g\n", value);
    ((int (*)(void *))function("cosim_execution_destroy"))(execution);
    return 0;
}

static int with_ecos(char **words)
{
    void *(*create)(const char *, double) = function("ecos_simulation_create_from_ssp");
    bool (*initialise)(void *, double, const char *) = function("ecos_simulation_init");
    double (*step)(void *, size_t) = function("ecos_simulation_step");
    bool (*get)(void *, const char *, double *) = function("ecos_simulation_get_real");
    void *simulation = checked(create(words[0], strtod(words[2], NULL)), "ecos_last_error_msg");
    double value = 0.0;

    if (!initialise(simulation, 0.0, words[4]))
        checked(NULL, "ecos_last_error_msg");
    step(simulation, (size_t)atoi(words[3]));
    get(simulation, words[1], &value);
    printf("%.17g\n", value);
    ((void (*)(void *))function("ecos_simulation_terminate"))(simulation);
    ((void (*)(void *))function("ecos_simulation_destroy"))(simulation);
    return 0;
}

int main(int n, char **words)
{
    if (n < 7 || !(library = dlopen(words[2], RTLD_NOW | RTLD_GLOBAL))) {
        fprintf(stderr, "%s\n", n >= 7 ? dlerror() : "wrong arguments");
        return 2;
    }
    return strcmp(words[1], "ecos") ? with_libcosim(words + 3) : with_ecos(words + 3);
}
