"""Small FMUs made from C where a compiler is found: one model, its adapter to a version and form of FMI, a description.

A model is C text that says NX, NZ, STATES (value references of the states; their derivatives are those plus NX), and
start, equations, indicators, event and completed. Adapters refuse calls that FMI does not allow in their mode.
"""

import os
import re
import shutil
import subprocess
import zipfile
from pathlib import Path
from xml.sax.saxutils import quoteattr

HEAD = """
#include <stdbool.h>
#include <stdint.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <stdio.h>
typedef unsigned R;
enum { MADE, INIT, EVENT, CONTINUOUS, STEP };
typedef struct { double r[32]; int i[8]; double time, next; int again, ends, mode, dirty; } M;
"""
DEFAULTS = """
static void refresh(M* m) { if (m->dirty) { equations(m); m->dirty = 0; } }
static const int states[] = STATES;
static double* state(M* m, int k) { return &m->r[states[k]]; }
static double* derivative(M* m, int k) { return &m->r[states[k] + NX]; }
static void settle(M* m) { m->again = 0; m->ends = 0; equations(m); event(m); m->dirty = 1; }
static void euler(M* m, double t, double h) {
  double dx[NX + 1];
  m->time = t; equations(m);
  for (int k = 0; k < NX; k++) dx[k] = *derivative(m, k);
  for (int k = 0; k < NX; k++) *state(m, k) += h * dx[k];
  m->time = t + h; m->dirty = 1;
}
"""
FMI2 = """
typedef struct { void (*log)(void*, const char*, int, const char*, const char*, ...); void *a, *b, *c; void* env; } C;
void* fmi2Instantiate(const char* n, int kind, const char* guid, const char* where, const C* c, int v, int l) {
  M* m = calloc(1, sizeof(M)); m->next = HUGE_VAL; m->dirty = 1; m->i[7] = kind; start(m); return m;
}
const char* fmi2GetVersion(void) { return "2.0"; }
int fmi2SetDebugLogging(M* m, int on, size_t n, const char** categories) { return 0; }
const char* fmi2GetTypesPlatform(void) { return "default"; }
void fmi2FreeInstance(M* m) { free(m); }
int fmi2SetupExperiment(M* m, int d, double tolerance, double t, int s, double stop) { m->time = t; return 0; }
int fmi2EnterInitializationMode(M* m) { m->mode = INIT; return 0; }
int fmi2ExitInitializationMode(M* m) { m->mode = m->i[7] ? STEP : EVENT; return 0; }
int fmi2Terminate(M* m) { return 0; }
int fmi2SetReal(M* m, const R* r, size_t n, const double* v) {
  for (size_t k = 0; k < n; k++) m->r[r[k]] = v[k];
  m->dirty = 1; return 0;
}
int fmi2GetReal(M* m, const R* r, size_t n, double* v) {
  refresh(m); for (size_t k = 0; k < n; k++) v[k] = m->r[r[k]]; return 0;
}
int fmi2SetInteger(M* m, const R* r, size_t n, const int* v) {
  if (m->mode == CONTINUOUS) return 3;
  for (size_t k = 0; k < n; k++) m->i[r[k]] = v[k];
  m->dirty = 1; return 0;
}
int fmi2GetInteger(M* m, const R* r, size_t n, int* v) {
  refresh(m); for (size_t k = 0; k < n; k++) v[k] = m->i[r[k]]; return 0;
}
int fmi2SetBoolean(M* m, const R* r, size_t n, const int* v) { return fmi2SetInteger(m, r, n, v); }
int fmi2GetBoolean(M* m, const R* r, size_t n, int* v) { return fmi2GetInteger(m, r, n, v); }
typedef struct { int again, ends, nominals, values, defined; double next; } Info;
int fmi2EnterEventMode(M* m) { if (m->mode != CONTINUOUS) return 3; m->mode = EVENT; return 0; }
int fmi2NewDiscreteStates(M* m, Info* info) {
  if (m->mode != EVENT) return 3;
  settle(m);
  info->again = m->again; info->ends = m->ends; info->nominals = info->values = 1;
  info->defined = isfinite(m->next) != 0; info->next = m->next;
  return 0;
}
int fmi2EnterContinuousTimeMode(M* m) { if (m->mode != EVENT) return 3; m->mode = CONTINUOUS; return 0; }
int fmi2CompletedIntegratorStep(M* m, int keep, int* event, int* ends) {
  if (m->mode != CONTINUOUS) return 3;
  *event = completed(m); *ends = 0; return 0;
}
int fmi2SetTime(M* m, double t) { if (m->mode != CONTINUOUS) return 3; m->time = t; m->dirty = 1; return 0; }
int fmi2SetContinuousStates(M* m, const double* x, size_t n) {
  if (m->mode != CONTINUOUS || n != NX) return 3;
  for (int k = 0; k < NX; k++) *state(m, k) = x[k];
  m->dirty = 1; return 0;
}
int fmi2GetContinuousStates(M* m, double* x, size_t n) { for (int k = 0; k < NX; k++) x[k] = *state(m, k); return 0; }
int fmi2GetNominalsOfContinuousStates(M* m, double* x, size_t n) { for (int k = 0; k < NX; k++) x[k] = 1; return 0; }
int fmi2GetDerivatives(M* m, double* dx, size_t n) {
  refresh(m); for (int k = 0; k < NX; k++) dx[k] = *derivative(m, k); return 0;
}
int fmi2GetEventIndicators(M* m, double* z, size_t n) { refresh(m); indicators(m, z); return n == NZ ? 0 : 3; }
int fmi2DoStep(M* m, double t, double h, int keep) {
  if (m->mode != STEP) return 3;
  euler(m, t, h); settle(m); return m->ends ? 2 : 0;
}
int fmi2GetBooleanStatus(M* m, int kind, int* value) { *value = kind == 3 && m->ends; return 0; }
int fmi2Reset(M* m) {
  int kind = m->i[7];
  memset(m, 0, sizeof(M)); m->next = HUGE_VAL; m->dirty = 1; m->i[7] = kind; start(m); return 0;
}
"""
FMI3 = """
static M* made(int kind) {
  M* m = calloc(1, sizeof(M)); m->next = HUGE_VAL; m->dirty = 1; m->i[7] = kind; start(m); return m;
}
const char* fmi3GetVersion(void) { return "3.0"; }
int fmi3SetDebugLogging(M* m, bool on, size_t n, const char** categories) { return 0; }
void* fmi3InstantiateModelExchange(const char* n, const char* t, const char* w, bool v, bool l, void* e, void* log) {
  return made(0);
}
void* fmi3InstantiateCoSimulation(const char* n, const char* t, const char* w, bool v, bool l, bool x, bool y,
    const R* r, size_t nr, void* e, void* log, void* u) { return made(1); }
void fmi3FreeInstance(M* m) { free(m); }
int fmi3EnterInitializationMode(M* m, bool d, double tol, double t, bool s, double stop) {
  m->time = t; m->mode = INIT; return 0;
}
int fmi3ExitInitializationMode(M* m) { m->mode = m->i[7] ? STEP : EVENT; return 0; }
int fmi3Terminate(M* m) { return 0; }
int fmi3SetFloat64(M* m, const R* r, size_t n, const double* v, size_t nv) {
  for (size_t k = 0; k < n; k++) m->r[r[k]] = v[k];
  m->dirty = 1; return 0;
}
int fmi3GetFloat64(M* m, const R* r, size_t n, double* v, size_t nv) {
  refresh(m); for (size_t k = 0; k < n; k++) v[k] = m->r[r[k]]; return 0;
}
int fmi3SetInt32(M* m, const R* r, size_t n, const int* v, size_t nv) {
  if (m->mode == CONTINUOUS) return 3;
  for (size_t k = 0; k < n; k++) m->i[r[k] - 100] = v[k];
  m->dirty = 1; return 0;
}
int fmi3GetInt32(M* m, const R* r, size_t n, int* v, size_t nv) {
  refresh(m); for (size_t k = 0; k < n; k++) v[k] = m->i[r[k] - 100]; return 0;
}
int fmi3EnterEventMode(M* m) { if (m->mode != CONTINUOUS) return 3; m->mode = EVENT; return 0; }
int fmi3UpdateDiscreteStates(M* m, bool* again, bool* ends, bool* nominals, bool* values, bool* defined, double* next) {
  if (m->mode != EVENT) return 3;
  settle(m);
  *again = m->again; *ends = m->ends; *nominals = *values = true; *defined = isfinite(m->next) != 0; *next = m->next;
  return 0;
}
int fmi3EnterContinuousTimeMode(M* m) { if (m->mode != EVENT) return 3; m->mode = CONTINUOUS; return 0; }
int fmi3CompletedIntegratorStep(M* m, bool keep, bool* event, bool* ends) {
  if (m->mode != CONTINUOUS) return 3;
  *event = completed(m); *ends = false; return 0;
}
int fmi3SetTime(M* m, double t) { if (m->mode != CONTINUOUS) return 3; m->time = t; m->dirty = 1; return 0; }
int fmi3SetContinuousStates(M* m, const double* x, size_t n) {
  if (m->mode != CONTINUOUS || n != NX) return 3;
  for (int k = 0; k < NX; k++) *state(m, k) = x[k];
  m->dirty = 1; return 0;
}
int fmi3GetContinuousStates(M* m, double* x, size_t n) { for (int k = 0; k < NX; k++) x[k] = *state(m, k); return 0; }
int fmi3GetNominalsOfContinuousStates(M* m, double* x, size_t n) { for (int k = 0; k < NX; k++) x[k] = 1; return 0; }
int fmi3GetContinuousStateDerivatives(M* m, double* dx, size_t n) {
  refresh(m); for (int k = 0; k < NX; k++) dx[k] = *derivative(m, k); return 0;
}
int fmi3GetEventIndicators(M* m, double* z, size_t n) { refresh(m); indicators(m, z); return n == NZ ? 0 : 3; }
int fmi3GetNumberOfContinuousStates(M* m, size_t* n) { *n = NX; return 0; }
int fmi3GetNumberOfEventIndicators(M* m, size_t* n) { *n = NZ; return 0; }
int fmi3DoStep(M* m, double t, double h, bool keep, bool* event, bool* ends, bool* early, double* last) {
  if (m->mode != STEP) return 3;
  euler(m, t, h); settle(m); *event = *early = false; *ends = m->ends; *last = t + h; return 0;
}
"""
FMI1 = """
#define F(name) PASTE(ID, name)
#define PASTE(a, b) PASTE_(a, b)
#define PASTE_(a, b) a##_##b
typedef struct { void (*log)(void*, const char*, int, const char*, const char*, ...); void *a, *b, *c; } C;
static M* made(void) { M* m = calloc(1, sizeof(M)); m->next = HUGE_VAL; m->dirty = 1; start(m); return m; }
const char* F(fmiGetVersion)(void) { return "1.0"; }
int F(fmiSetDebugLogging)(M* m, char on) { return 0; }
int F(fmiSetReal)(M* m, const R* r, size_t n, const double* v) {
  for (size_t k = 0; k < n; k++) m->r[r[k]] = v[k];
  m->dirty = 1; return 0;
}
int F(fmiGetReal)(M* m, const R* r, size_t n, double* v) {
  refresh(m); for (size_t k = 0; k < n; k++) v[k] = m->r[r[k]]; return 0;
}
int F(fmiSetInteger)(M* m, const R* r, size_t n, const int* v) {
  for (size_t k = 0; k < n; k++) m->i[r[k]] = v[k];
  m->dirty = 1; return 0;
}
int F(fmiGetInteger)(M* m, const R* r, size_t n, int* v) {
  refresh(m); for (size_t k = 0; k < n; k++) v[k] = m->i[r[k]]; return 0;
}
int F(fmiSetBoolean)(M* m, const R* r, size_t n, const char* v) {
  for (size_t k = 0; k < n; k++) m->i[r[k]] = v[k];
  m->dirty = 1; return 0;
}
int F(fmiGetBoolean)(M* m, const R* r, size_t n, char* v) {
  refresh(m); for (size_t k = 0; k < n; k++) v[k] = m->i[r[k]] != 0; return 0;
}
"""
FMI1_CS = (
    FMI1
    + """
const char* F(fmiGetTypesPlatform)(void) { return "standard32"; }
void* F(fmiInstantiateSlave)(const char* n, const char* g, const char* w, const char* mime, double timeout, char v,
    char x, C c, char l) { return made(); }
int F(fmiInitializeSlave)(M* m, double t, char s, double stop) { m->time = t; m->mode = STEP; return 0; }
int F(fmiTerminateSlave)(M* m) { return 0; }
int F(fmiResetSlave)(M* m) { memset(m, 0, sizeof(M)); m->next = HUGE_VAL; m->dirty = 1; start(m); return 0; }
void F(fmiFreeSlaveInstance)(M* m) { free(m); }
int F(fmiDoStep)(M* m, double t, double h, char new) { if (m->r[0] > 1e6) return 3; euler(m, t, h); return 0; }
"""
)
FMI1_ME = (
    FMI1
    + """
typedef struct { char converged, references, values, ends, upcoming; double next; } Info;
const char* F(fmiGetModelTypesPlatform)(void) { return "standard32"; }
void* F(fmiInstantiateModel)(const char* n, const char* g, C c, char l) { return made(); }
void F(fmiFreeModelInstance)(M* m) { free(m); }
int F(fmiSetTime)(M* m, double t) { m->time = t; m->dirty = 1; return 0; }
static int update(M* m, Info* info) {
  settle(m);
  info->converged = !m->again; info->references = 0; info->values = 1; info->ends = m->ends;
  info->upcoming = isfinite(m->next) != 0; info->next = m->next; return 0;
}
int F(fmiInitialize)(M* m, char c, double tolerance, Info* info) { m->mode = CONTINUOUS; return update(m, info); }
int F(fmiEventUpdate)(M* m, char intermediate, Info* info) { return update(m, info); }
int F(fmiCompletedIntegratorStep)(M* m, char* event) { *event = completed(m); return 0; }
int F(fmiSetContinuousStates)(M* m, const double* x, size_t n) {
  for (int k = 0; k < NX; k++) *state(m, k) = x[k];
  m->dirty = 1; return 0;
}
int F(fmiGetContinuousStates)(M* m, double* x, size_t n) { for (int k = 0; k < NX; k++) x[k] = *state(m, k); return 0; }
int F(fmiGetNominalContinuousStates)(M* m, double* x, size_t n) { for (int k = 0; k < NX; k++) x[k] = 1; return 0; }
int F(fmiGetDerivatives)(M* m, double* dx, size_t n) {
  refresh(m); for (int k = 0; k < NX; k++) dx[k] = *derivative(m, k); return 0;
}
int F(fmiGetEventIndicators)(M* m, double* z, size_t n) { refresh(m); indicators(m, z); return 0; }
int F(fmiTerminate)(M* m) { return 0; }
"""
)
ADAPTERS = {
    ("1.0", "CoSimulation"): FMI1_CS,
    ("1.0", "ModelExchange"): FMI1_ME,
    "2.0": FMI2,
    "3.0": FMI3,
}
FMI1_NAMES = """
CancelStep CompletedIntegratorStep DoStep EventUpdate FreeModelInstance FreeSlaveInstance GetBoolean GetBooleanStatus
GetContinuousStates GetDerivatives GetEventIndicators GetInteger GetIntegerStatus GetModelTypesPlatform
GetNominalContinuousStates GetReal GetRealOutputDerivatives GetRealStatus GetStateValueReferences GetStatus GetString
GetStringStatus GetTypesPlatform GetVersion Initialize InitializeSlave InstantiateModel InstantiateSlave ResetSlave
SetBoolean SetContinuousStates SetDebugLogging SetInteger SetReal SetRealInputDerivatives SetString SetTime Terminate
TerminateSlave
"""


def compiler():
    """The C compiler, or None."""
    return None if os.name == "nt" else shutil.which("cc")


def build(folder, name, version, model, description, form=None, code=""):
    """Make an FMU.

    Parameters
    ----------
    folder : Path
        Where the FMU goes.
    name, version : str
        Of the FMU and of FMI.
    model : str
        Its C text; empty where `code` is all of it.
    description : str
        modelDescription.xml.
    form : str, optional
        FMI 1.0: which of the two it is.
    code : str, optional
        C text in place of an adapter.
    """
    from fmpy import platform, platform_tuple, sharedLibraryExtension

    text = (
        HEAD
        + (
            model + DEFAULTS + ADAPTERS[(version, form) if version == "1.0" else version]
            if model
            else ""
        )
        + code
    )
    text += "\n".join(
        _stub(n, version, name) for n in functions_of(version) if not _is_there(n, version, text)
    )
    (folder / f"{name}.c").write_text(text)
    library = folder / f"{name}{sharedLibraryExtension}"
    options = [
        "-shared",
        "-fPIC",
        "-O1",
        f"-DID={name}",
        "-o",
        library,
        folder / f"{name}.c",
        "-lm",
    ]
    subprocess.run([compiler(), *options], check=True)
    with zipfile.ZipFile(folder / f"{name}.fmu", "w") as archive:
        archive.writestr("modelDescription.xml", description)
        archive.write(
            library, f"binaries/{platform_tuple if version == '3.0' else platform}/{library.name}"
        )
    return folder / f"{name}.fmu"


def functions_of(version):
    """Names of all functions that an FMU of a version of FMI has; of 2.0 and 3.0 as the headers have them."""
    import fmpy

    if version == "1.0":
        return [f"fmi{name}" for name in FMI1_NAMES.split()]
    own = f"fmi{version[0]}"
    header = (Path(fmpy.__file__).parent / "c-code" / f"{own}Functions.h").read_text(
        encoding="utf-8"
    )
    return sorted(set(re.findall(rf"FMI\d_Export \w+\s+({own}\w+);", header)))


def _stub(function, version, name):
    return (
        f"int {name}_{function}(void) {{ return 3; }}"
        if version == "1.0"
        else f"int {function}(void) {{ return 3; }}"
    )


def _is_there(function, version, text):
    return (
        f"F({function})" in text if version == "1.0" else f" {function}(" in text.replace("*", " ")
    )


def describe(
    name, version, variables, forms=("ModelExchange",), n_states=0, n_indicators=0, **attributes
):
    """modelDescription.xml.

    Parameters
    ----------
    variables : iterable of (name, value reference, causality, type, start)
        Types as in FMI 2.0. Derivatives are those variables that are called ``der(x)`` after their state.
    forms : collection of str
        The FMU's; in FMI 1.0 one of them.
    n_states, n_indicators : int
        For model exchange.
    **attributes
        Of the elements of the forms.
    """
    root = {"fmiVersion": version, "modelName": name}
    root["instantiationToken" if version == "3.0" else "guid"] = "{1}"
    if version == "1.0":
        root |= {"modelIdentifier": name, "numberOfContinuousStates": n_states}
    if version != "3.0":
        root["numberOfEventIndicators"] = n_indicators
    own = _attributes({"modelIdentifier": name} | attributes)
    elements = (
        ""
        if version == "1.0"
        else "".join(f"<{form} {own}/>" for form in sorted(forms, reverse=True))
    )
    references = {variable[0]: variable[1] for variable in variables}
    shown = "".join(_variable(version, references, *variable) for variable in variables)
    tail = _structure(version, variables, n_indicators)
    if version == "1.0" and "CoSimulation" in forms:
        tail = "<Implementation><CoSimulation_StandAlone><Capabilities/></CoSimulation_StandAlone></Implementation>"
    return (
        f'<?xml version="1.0" encoding="UTF-8"?><fmiModelDescription {_attributes(root)}>{elements}'
        f"<ModelVariables>{shown}</ModelVariables>{tail}</fmiModelDescription>"
    )


def _attributes(values):
    return " ".join(f"{name}={quoteattr(str(value))}" for name, value in values.items())


def _variable(version, references, name, reference, causality, kind, start):
    given = "" if start is None else f' start="{start}"'
    if version == "3.0":
        kind = {"Real": "Float64", "Integer": "Int32"}.get(kind, kind)
        state = f' derivative="{references[_state_of(name)]}"' if name.startswith("der(") else ""
        reference += 100 * (kind == "Int32")
        return f'<{kind} name="{name}" valueReference="{reference}" causality="{causality}"{given}{state}/>'
    if version == "1.0":
        how = {"local": "", "parameter": ' variability="parameter"'}.get(
            causality, f' causality="{causality}"'
        )
        return f'<ScalarVariable name="{name}" valueReference="{reference}"{how}><{kind}{given}/></ScalarVariable>'
    if name.startswith("der("):
        given += f' derivative="{list(references).index(_state_of(name)) + 1}"'
    variability = ' variability="fixed"' if causality == "parameter" else ""
    variability = ' variability="discrete"' if kind != "Real" and not variability else variability
    place = f'name="{name}" valueReference="{reference}" causality="{causality}"{variability}'
    return f"<ScalarVariable {place}><{kind}{given}/></ScalarVariable>"


def _state_of(name):
    return name.removeprefix("der(").removesuffix(")")


def _structure(version, variables, n_indicators):
    if version == "1.0":
        return ""
    outputs = [(i, v) for i, v in enumerate(variables, start=1) if v[2] == "output"]
    derivatives = [(i, v) for i, v in enumerate(variables, start=1) if v[0].startswith("der(")]
    if version == "3.0":
        shown = "".join(
            f'<Output valueReference="{v[1] + 100 * (v[3] == "Integer")}"/>' for _, v in outputs
        )
        shown += "".join(
            f'<ContinuousStateDerivative valueReference="{v[1]}"/>' for _, v in derivatives
        )
        return f"<ModelStructure>{shown}</ModelStructure>"
    shown = "".join(
        _unknowns(part, found)
        for part, found in (("Outputs", outputs), ("Derivatives", derivatives))
    )
    return f"<ModelStructure>{shown}</ModelStructure>"


def _unknowns(part, found):
    inside = "".join(f'<Unknown index="{i}"/>' for i, _ in found)
    return f"<{part}>{inside}</{part}>" if found else ""
