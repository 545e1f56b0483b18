"""Co-simulation in FMI 1.0 and 3.0 by FMUs from C: values of all types, arrays by elements and as a whole."""

import c_fmus
import fmpy.fmi1
import numpy as np
import pytest

from shipcosim.cosim import RunError, RunOptions, simulate
from shipcosim.errors import ShipcosimError
from shipcosim.scenario import Scenario
from shipcosim.ssp import Component, Connection, System, check_system, read_fmu, read_system

NUMBERS = [
    "Float32",
    "Int8",
    "UInt8",
    "Int16",
    "UInt16",
    "Int32",
    "UInt32",
    "Int64",
    "UInt64",
    "Boolean",
]
ZEROS = {"Boolean": "false"}
MADE = "//" + "".join(f" fmi3Set{t}( fmi3Get{t}(" for t in NUMBERS if t != "UInt64")  # by a macro
ECHO = """
typedef struct { char raw[16][16]; char text[64]; uint8_t data[64]; size_t size; double u[9], a[18], y[2];
  char label[2][64]; uint64_t columns; int configuring; } E;
#define ECHO(NAME, T, K) \\
int fmi3Set##NAME(E* m, const R* r, size_t n, const T* v, size_t nv) { \\
  for (size_t k = 0; k < n; k++) ((T*)m->raw[K])[0] = v[k]; return n == nv ? 0 : 3; } \\
int fmi3Get##NAME(E* m, const R* r, size_t n, T* v, size_t nv) { \\
  for (size_t k = 0; k < n; k++) v[k] = ((T*)m->raw[K])[0]; return n == nv ? 0 : 3; }
ECHO(Float32, float, 0) ECHO(Int8, int8_t, 1) ECHO(UInt8, uint8_t, 2) ECHO(Int16, int16_t, 3)
ECHO(UInt16, uint16_t, 4) ECHO(Int32, int32_t, 5) ECHO(UInt32, uint32_t, 6) ECHO(Int64, int64_t, 7)
ECHO(Boolean, bool, 9)
int fmi3SetUInt64(E* m, const R* r, size_t n, const uint64_t* v, size_t nv) {
  for (size_t k = 0; k < n; k++)
    if (r[k] != 140) ((uint64_t*)m->raw[8])[0] = v[k]; else if (m->configuring) m->columns = v[k]; else return 3;
  return 0;
}
int fmi3GetUInt64(E* m, const R* r, size_t n, uint64_t* v, size_t nv) { v[0] = ((uint64_t*)m->raw[8])[0]; return 0; }
int fmi3EnterConfigurationMode(E* m) { m->configuring = 1; return 0; }
int fmi3ExitConfigurationMode(E* m) { m->configuring = 0; return 0; }
static double* at(E* m, R r, size_t* n) {
  *n = r == 200 ? m->columns : r == 201 ? 2 * m->columns : 2; return r == 200 ? m->u : r == 201 ? m->a : m->y;
}
int fmi3SetFloat64(E* m, const R* r, size_t n, const double* v, size_t nv) {
  size_t p = 0, s;
  for (size_t k = 0; k < n; k++) { double* x = at(m, r[k], &s); memcpy(x, v + p, s * 8); p += s; }
  return p == nv ? 0 : 3;
}
int fmi3GetFloat64(E* m, const R* r, size_t n, double* v, size_t nv) {
  size_t p = 0, s;
  for (int i = 0; i < 2; i++) {
    m->y[i] = 0; for (int j = 0; j < m->columns; j++) m->y[i] += m->a[m->columns * i + j] * m->u[j]; }
  for (size_t k = 0; k < n; k++) { double* x = at(m, r[k], &s); memcpy(v + p, x, s * 8); p += s; }
  return p == nv ? 0 : 3;
}
int fmi3SetString(E* m, const R* r, size_t n, const char** v, size_t nv) {
  size_t p = 0;
  for (size_t k = 0; k < n; k++)
    if (r[k] < 300) strcpy(m->text, v[p++]); else { strcpy(m->label[0], v[p++]); strcpy(m->label[1], v[p++]); }
  return p == nv ? 0 : 3;
}
int fmi3GetString(E* m, const R* r, size_t n, const char** v, size_t nv) {
  size_t p = 0;
  for (size_t k = 0; k < n; k++)
    if (r[k] < 300) v[p++] = m->text; else { v[p++] = m->label[0]; v[p++] = m->label[1]; }
  return p == nv ? 0 : 3;
}
int fmi3SetBinary(E* m, const R* r, size_t n, const size_t* s, const uint8_t** v, size_t nv) {
  memcpy(m->data, v[0], m->size = s[0]); return n == nv ? 0 : 3;
}
int fmi3GetBinary(E* m, const R* r, size_t n, size_t* s, const uint8_t** v, size_t nv) {
  s[0] = m->size; v[0] = m->data; return n == nv ? 0 : 3;
}
void* fmi3InstantiateCoSimulation(const char* n, const char* t, const char* w, bool v, bool l, bool x, bool y,
    const R* r, size_t nr, void* e, void* log, void* u) {
  E* m = calloc(1, sizeof(E)); m->a[0] = m->a[4] = 1; m->columns = 3;
  for (int i = 0; i < 3; i++) m->u[i] = i + 1;
  return m;
}
const char* fmi3GetVersion(void) { return "3.0"; }
void fmi3FreeInstance(E* m) { free(m); }
int fmi3EnterInitializationMode(E* m, bool d, double tol, double t, bool s, double stop) { return 0; }
int fmi3ExitInitializationMode(E* m) { return 0; }
int fmi3Terminate(E* m) { return 0; }
int fmi3DoStep(E* m, double t, double h, bool keep, bool* event, bool* ends, bool* early, double* last) {
  *event = *ends = *early = false; *last = t + h; return 0;
}
"""


def _echo_description():
    numbers = "".join(
        f'<{t} name="u{t}" valueReference="{10 * k + 10}" causality="input" start="{ZEROS.get(t, 0)}"/>'
        f'<{t} name="y{t}" valueReference="{10 * k + 11}" causality="output"/>'
        for k, t in enumerate(NUMBERS)
    )
    return (
        '<?xml version="1.0" encoding="UTF-8"?>'
        '<fmiModelDescription fmiVersion="3.0" modelName="echo" instantiationToken="{1}">'
        '<CoSimulation modelIdentifier="echo" canHandleVariableCommunicationStepSize="true"/>'
        f"<ModelVariables>{numbers}"
        '<String name="uString" valueReference="110" causality="input"><Start value="none"/></String>'
        '<String name="yString" valueReference="111" causality="output"/>'
        '<Binary name="uBinary" valueReference="120" causality="input"><Start value="00"/></Binary>'
        '<Binary name="yBinary" valueReference="121" causality="output"/>'
        '<Clock name="tick" valueReference="130" causality="input" intervalVariability="triggered"/>'
        '<UInt64 name="n" valueReference="140" causality="structuralParameter" variability="fixed" start="3"/>'
        '<Float64 name="u" valueReference="200" causality="input" start="1 2 3">'
        '<Dimension valueReference="140"/></Float64>'
        '<Float64 name="A" valueReference="201" causality="parameter" variability="fixed" start="1 0 0 0 1 0">'
        '<Dimension start="2"/><Dimension valueReference="140"/></Float64>'
        '<Float64 name="y" valueReference="202" causality="output"><Dimension start="2"/></Float64>'
        '<String name="labels" valueReference="300" causality="input"><Dimension start="2"/>'
        '<Start value="left"/><Start value="right"/></String>'
        '<String name="shown" valueReference="301" causality="output"><Dimension start="2"/></String>'
        "</ModelVariables><ModelStructure>"
        + "".join(
            f'<Output valueReference="{r}"/>' for r in [*(10 * k + 11 for k in range(12)), 202, 301]
        )
        + "</ModelStructure></fmiModelDescription>"
    )


@pytest.fixture(scope="module")
def echo(tmp_path_factory, needs):
    """FMU of FMI 3.0 that gives back what it gets, and multiplies a vector with a matrix."""
    if c_fmus.compiler() is None:
        needs("a C compiler")
    return c_fmus.build(
        tmp_path_factory.mktemp("echo"),
        "echo",
        "3.0",
        "",
        _echo_description(),
        code=f"{ECHO}{MADE}\n",
    )


@pytest.fixture
def read_ssd(echo, tmp_path):
    """Function: the system of an SSD of SSP 2.0 made of these lines, in which ``echo.fmu`` is at hand."""

    def read(elements, connections="", connectors="", read=read_system):
        text = f"""<ssd:SystemStructureDescription name="arrays" version="2.0"
            xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"
            xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues"
            xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon"><ssd:System name="arrays">
            {connectors}<ssd:Elements>{elements}</ssd:Elements>
            {connections and f"<ssd:Connections>{connections}</ssd:Connections>"}
            </ssd:System></ssd:SystemStructureDescription>"""
        (tmp_path / "SystemStructure.ssd").write_text(text, encoding="utf-8")
        return read(tmp_path, fmus=[echo.parent])

    return read


def part(name, connectors="", values=""):
    connectors = f"<ssd:Connectors>{connectors}</ssd:Connectors>" if connectors else ""
    if values:
        values = (
            "<ssd:ParameterBindings><ssd:ParameterBinding><ssd:ParameterValues>"
            f'<ssv:ParameterSet name="p" version="2.0"><ssv:Parameters>{values}</ssv:Parameters></ssv:ParameterSet>'
            "</ssd:ParameterValues></ssd:ParameterBinding></ssd:ParameterBindings>"
        )
    return f'<ssd:Component name="{name}" source="echo.fmu">{connectors}{values}</ssd:Component>'


def link(source, target, more=""):
    (a, b), (c, d) = (end.split(".") if "." in end else (None, end) for end in (source, target))
    owners = (f'startElement="{a}" ' if a else "") + (f'endElement="{c}" ' if c else "")
    return f'<ssd:Connection {owners}startConnector="{b}" endConnector="{d}" {more}/>'


SCENARIO = Scenario(stop_time=0.4, step_size=0.1)
MATRIX = '<ssv:Parameter name="A"><ssv:Float64 value="1 2 3 4 5 6"/><ssc:Dimension size="2"/><ssc:Dimension size="3"/>'
MATRIX += "</ssv:Parameter>"


@pytest.mark.parametrize(
    ("kind", "value"),
    [
        ("Float32", 0.25),
        ("Int8", -128),
        ("UInt8", 255),
        ("Int16", -32768),
        ("UInt16", 65535),
        ("Int32", -(2**31)),
        ("UInt32", 2**32 - 1),
        ("Int64", -(2**63)),
        ("UInt64", 2**63 - 1),
        ("Boolean", True),
    ],
)
def test_extreme_values_of_each_type_come_back(echo, kind, value):
    parts = {n: Component(n, scalars(echo), {f"u{kind}": value} if n == "a" else {}) for n in "ab"}
    lines = (Connection(("a", f"y{kind}"), ("b", f"u{kind}")),)
    table = simulate(System("two", "two.ssd", parts, lines), SCENARIO)
    assert table[f"a.y{kind}"].values.tolist() == [value] * 5
    assert table[f"b.y{kind}"].values.tolist() == [value] * 5


def scalars(echo):
    """The FMU as a system has it."""
    from shipcosim.ssp.fmu.arrays import without_arrays

    return without_arrays(read_fmu(echo), "echo", None)


@pytest.mark.parametrize(
    ("kind", "to", "value"),
    [
        ("Int16", "Int8", 300),
        ("Int64", "Int32", 2**40),
        ("Int32", "UInt64", -1),
        ("UInt32", "Int32", 2**31),
    ],
)
def test_a_value_that_a_type_cannot_hold_ends_the_run_instead_of_wrapping(echo, kind, to, value):
    parts = {n: Component(n, scalars(echo), {f"u{kind}": value} if n == "a" else {}) for n in "ab"}
    lines = (Connection(("a", f"y{kind}"), ("b", f"u{to}")),)
    with pytest.raises(
        RunError, match=f"b: failed at the end of the initialisation.*u{to} cannot be {value}"
    ):
        simulate(System("two", "two.ssd", parts, lines), SCENARIO)


def test_a_start_value_too_large_for_its_type_is_refused(echo):
    system = System("one", "one.ssd", {"a": Component("a", scalars(echo), {"uInt8": 200})})
    with pytest.raises(RunError, match="a: echo.fmu cannot be started.*uInt8 cannot be 200"):
        simulate(system, SCENARIO)


def test_an_unsigned_value_beyond_63_bits_is_refused(echo):
    system = System("one", "one.ssd", {"a": Component("a", scalars(echo), {"uUInt64": 2**63})})
    with pytest.raises(ShipcosimError, match="a: uUInt64 starts with 9223372036854775808"):
        simulate(system, SCENARIO)


def test_integers_of_fmi_2_and_64_bits_travel_together(make_system, echo):
    counting = make_system({"clock": "clock", "meter": "meter"}).components
    parts = {**counting, "echo": Component("echo", scalars(echo))}
    lines = (
        Connection(("clock", "count"), ("echo", "uInt64")),
        Connection(("echo", "yInt64"), ("meter", "number")),
    )
    table = simulate(System("mixed", "mixed.ssd", parts, lines), SCENARIO)
    assert table["clock.count"].values.tolist() == [0, 1, 2, 3, 4]
    assert table["echo.yInt64"].values.tolist() == [0, 0, 1, 2, 3]
    assert table["meter.number_seen"].values.tolist() == [0, 0, 0, 1, 2]


def test_texts_and_bytes_are_passed_on(echo):
    from shipcosim.cosim.slaves.instances import Instances

    values = {"uString": "søyle", "uBinary": b"\0\xff\0"}
    parts = {n: Component(n, scalars(echo), values if n == "a" else {}) for n in "ab"}
    fmu = parts["b"].fmu
    lines = [Connection(("a", f"y{t}"), ("b", f"u{t}")) for t in ("String", "Binary")]
    kept = {}
    original = Instances._free

    def peek(self, name):
        slave = self._slaves[name]
        kept[name] = [slave.get_strings([fmu.variables[f"y{t}"]])[0] for t in ("String", "Binary")]
        original(self, name)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Instances, "_free", peek)
        simulate(System("two", "two.ssd", parts, tuple(lines)), SCENARIO)
    assert kept["a"] == kept["b"] == ["søyle", b"\0\xff\0"]


def test_a_matrix_multiplies_a_vector_connected_as_a_whole(read_ssd):
    system = read_ssd(
        part("a", values=MATRIX) + part("b"),
        connectors='<ssd:Connectors><ssd:Connector name="v" kind="input"><ssc:Float64/><ssc:Dimension size="3"/>'
        '</ssd:Connector><ssd:Connector name="w" kind="output"><ssc:Float64/><ssc:Dimension size="2"/></ssd:Connector>'
        "</ssd:Connectors>",
        connections=link("v", "a.u") + link("a.y", "w"),
    )
    assert list(system.inputs) == ["v[1]", "v[2]", "v[3]"] and list(system.outputs) == [
        "w[1]",
        "w[2]",
    ]
    events = [{"time": 0.2, "override": {"v[2]": 10.0}}]
    table = simulate(
        system,
        Scenario(stop_time=0.4, step_size=0.1, set={"v[1]": 1.0, "v[3]": -1.0}, events=events),
    )
    before, after = (np.array([[1, 2, 3], [4, 5, 6]]) @ [1.0, v, -1.0] for v in (2.0, 10.0))
    assert np.array_equal(np.array([table["w[1]"], table["w[2]"]]).T, [before] * 3 + [after] * 2)
    assert table["b.y[1]"].values.tolist() == [1.0] * 5


def test_single_elements_are_connected_by_their_indices_and_the_others_keep_their_start(read_ssd):
    lines = link("a.y", "b.u", 'startIndices="2" endIndices="3"') + link(
        "a.y", "b.u", 'startIndices="1" endIndices="1"'
    )
    system = read_ssd(part("a", values=MATRIX) + part("b", values=MATRIX), lines)
    table = simulate(system, SCENARIO)
    y = np.array([[1, 2, 3], [4, 5, 6]]) @ [1.0, 2.0, 3.0]
    assert [table["a.y[1]"][-1], table["a.y[2]"][-1]] == y.tolist()
    assert [table[f"b.y[{k}]"][-1] for k in (1, 2)] == (
        np.array([[1, 2, 3], [4, 5, 6]]) @ [y[0], 2.0, y[1]]
    ).tolist()


def test_a_scalar_is_connected_to_an_element(read_ssd):
    system = read_ssd(part("a") + part("b"), link("a.yFloat32", "b.u", 'endIndices="2"'))
    table = simulate(system, Scenario(stop_time=0.2, step_size=0.1, set={"a.uFloat32": 0.5}))
    assert table["b.y[2]"].values.tolist() == [0.5, 0.5, 0.5]


def test_an_array_of_texts_is_connected_as_a_whole(read_ssd):
    system = read_ssd(part("a") + part("b"), link("a.shown", "b.labels"))
    assert [c.target for c in system.connections] == [("b", "labels[1]"), ("b", "labels[2]")]
    assert simulate(system, SCENARIO).sizes["time"] == 5


@pytest.mark.parametrize(
    ("elements", "connections", "said"),
    [
        (
            part("a") + part("b"),
            link("a.y", "b.u"),
            "an array of 2 cannot be connected to an array of 3",
        ),
        (
            part("a") + part("b"),
            link("a.yFloat32", "b.u"),
            "a scalar cannot be connected to an array of 3",
        ),
        (
            part("a") + part("b"),
            link("a.y", "b.u", 'startIndices="0" endIndices="1"'),
            r"y\[0\] does not exist",
        ),
        (
            part("a") + part("b"),
            link("a.y", "b.u", 'startIndices="1 1" endIndices="1"'),
            r"y\[1,1\] does not exist",
        ),
        (
            part(
                "a",
                '<ssd:Connector name="u" kind="input"><ssc:Float64/><ssc:Dimension size="4"/></ssd:Connector>',
            ),
            "",
            "The connector is an array of 4. Write an array of 3",
        ),
        (
            part("a", values=MATRIX.replace(" 6", "")),
            "",
            "A is an array of 2x3, but has 5 values. Give 6",
        ),
        (
            part("a", values=MATRIX.replace('"3"', '"3000000000"')),
            "",
            "but has 6 values. Give 6000000000",
        ),
        (
            part("a", values=MATRIX.replace('"3"', '"-3"').replace('"2"', '"-2"')),
            "",
            "but has 6 values",
        ),
    ],
    ids=["shapes", "scalar", "index", "indices", "connector", "values", "huge", "negative"],
)
def test_arrays_that_do_not_fit_are_refused_when_they_are_read(
    read_ssd, elements, connections, said
):
    with pytest.raises(ShipcosimError, match=said):
        read_ssd(elements, connections)


@pytest.mark.parametrize("size", [0, -1, 10**12])
def test_a_connector_of_an_absurd_size_is_refused(read_ssd, size):
    vector = f'<ssd:Connector name="v" kind="input"><ssc:Float64/><ssc:Dimension size="{size}"/></ssd:Connector>'
    with pytest.raises(ShipcosimError, match="Arrays have from 1 to 100000 elements"):
        read_ssd(part("a"), connectors=f"<ssd:Connectors>{vector}</ssd:Connectors>")


def test_a_structural_parameter_sets_the_size_of_arrays(read_ssd):
    size = '<ssv:Parameter name="n"><ssv:UInt64 value="2"/></ssv:Parameter>'
    matrix = MATRIX.replace("1 2 3 4 5 6", "1 2 3 4").replace('size="3"', 'size="2"')
    vector = '<ssd:Connector name="v" kind="input"><ssc:Float64/><ssc:Dimension size="2"/></ssd:Connector>'
    lines = link("v", "a.u") + link("b.y", "b.u", 'startIndices="1" endIndices="3"')
    system = read_ssd(
        part("a", values=size + matrix) + part("b"),
        lines,
        f"<ssd:Connectors>{vector}</ssd:Connectors>",
    )
    assert [n for n in system.components["a"].fmu.variables if n[0] == "A"] == [
        "A[1,1]",
        "A[1,2]",
        "A[2,1]",
        "A[2,2]",
    ]
    assert "A[2,3]" in system.components["b"].fmu.variables
    table = simulate(
        system, Scenario(stop_time=0.2, step_size=0.1, set={"v[1]": 1.0, "v[2]": 10.0})
    )
    assert [float(table[f"a.y[{k}]"][-1]) for k in (1, 2)] == [21.0, 43.0]
    with pytest.raises(
        ShipcosimError, match="a: n is 3, but u has been laid out for 2. Set it in the SSD"
    ):
        simulate(system, Scenario(stop_time=0.2, step_size=0.1, set={"a.n": 3}))


def test_a_connected_clock_is_refused(echo):
    parts = {n: Component(n, scalars(echo)) for n in "ab"}
    lines = (Connection(("a", "tick"), ("b", "tick")),)
    with pytest.raises(ShipcosimError, match="b.tick: is a Clock"):
        simulate(System("two", "two.ssd", parts, lines), SCENARIO)


def test_an_ssd_gets_the_form_it_asks_for_or_hears_that_there_is_none(read_ssd):
    asked = part("a").replace("source=", 'implementation="{}" source=')
    assert read_ssd(asked.format("CoSimulation")).components["a"].implementation == "CoSimulation"
    problems = read_ssd(asked.format("ModelExchange"), read=check_system)
    found = [problem for problem in problems if problem.severity == "error"]
    assert [problem.found for problem in found] == ["echo.fmu offers no ModelExchange."]
    assert found[0].remedy == "It offers CoSimulation."


DECAY = """
#define NX 1
#define NZ 0
#define STATES {0}
static void start(M* m) { m->r[0] = 1; m->r[3] = 2; m->i[0] = 1; }
static void equations(M* m) { m->r[1] = m->r[2] - m->r[3] * m->r[0]; m->r[5] = m->r[0] * m->r[0];
  m->i[2] = m->i[0] + m->i[1]; }
static void indicators(M* m, double* z) {}
static void event(M* m) {}
static int completed(M* m) { return 0; }
"""
VARIABLES = [
    ("x", 0, "output", "Real", None),
    ("u", 2, "input", "Real", 0.0),
    ("k", 3, "parameter", "Real", 2.0),
]
VARIABLES += [("flag", 1, "input", "Boolean", "false"), ("sum", 2, "output", "Integer", None)]
VARIABLES += [("square", 5, "output", "Real", None)]


@pytest.fixture(scope="module")
def first(tmp_path_factory, needs):
    """Slave of FMI 1.0: a decay by Euler's method."""
    if c_fmus.compiler() is None:
        needs("a C compiler")
    text = c_fmus.describe("first", "1.0", VARIABLES, ("CoSimulation",))
    minus = '<ScalarVariable name="minus" valueReference="5" causality="output" alias="negatedAlias"><Real/>'
    text = text.replace("</ModelVariables>", f"{minus}</ScalarVariable></ModelVariables>")
    return c_fmus.build(
        tmp_path_factory.mktemp("first"), "first", "1.0", DECAY, text, "CoSimulation"
    )


def test_a_slave_of_fmi_1_steps_and_exchanges_values_of_all_its_types(first):
    system = System("one", "one.ssd", {"m": Component("m", read_fmu(first), {"k": 1.0})})
    events = [{"time": 0.2, "override": {"m.flag": True, "m.u": 3.0}}]
    table = simulate(system, Scenario(stop_time=0.4, step_size=0.1, events=events))
    x = [1.0, 0.9, 0.81]
    x += [x[-1] + 0.1 * (3.0 - x[-1])]
    x += [x[-1] + 0.1 * (3.0 - x[-1])]
    assert np.allclose(table["m.x"], x, rtol=1e-14)
    assert table["m.sum"].values.tolist() == [1, 1, 1, 2, 2]
    assert np.array_equal(table["m.minus"], -table["m.square"]) and np.allclose(
        table["m.square"], np.square(x)
    )


def test_an_error_of_a_slave_of_fmi_1_ends_the_run_with_its_name(first):
    system = System("one", "one.ssd", {"m": Component("m", read_fmu(first))})
    events = [{"time": 0.2, "override": {"m.u": 1e9}}]
    with pytest.raises(
        RunError, match="m: failed in the step from t = 0.3 s.*fmi1DoStep returned 'error'"
    ):
        simulate(system, Scenario(stop_time=0.5, step_size=0.1, events=events))


def test_a_run_of_a_slave_of_fmi_1_can_be_repeated_and_not_stored(first, tmp_path):
    system = System("one", "one.ssd", {"m": Component("m", read_fmu(first))})
    one, two = (simulate(system, SCENARIO)["m.x"] for _ in range(2))
    assert np.array_equal(one, two)
    with pytest.raises(ShipcosimError, match="first.fmu cannot store its state"):
        simulate(system, SCENARIO, RunOptions(store=tmp_path / "x.state"))


@pytest.mark.parametrize("version, state", [("2.0", "FMUstate"), ("3.0", "FMUState")])
def test_a_function_that_an_fmu_lacks_matters_only_where_it_is_called(
    version, state, tmp_path, needs
):
    """It has no texts and cannot get its state, though it says so. FMPy 0.3.29 and later want all functions at once."""
    if c_fmus.compiler() is None:
        needs("a C compiler")
    own = f"fmi{version[0]}"
    lacks = (
        "//"
        + "".join(f" {own}{name}(" for name in ("GetString", "SetString", f"Get{state}"))
        + "\n"
    )
    can = {f"canGetAndSet{state}": "true", f"canSerialize{state}": "true"}
    real = [variable for variable in VARIABLES if variable[3] == "Real"]
    text = c_fmus.describe("bare", version, real, ("CoSimulation",), **can)
    path = c_fmus.build(tmp_path, "bare", version, DECAY, text, "CoSimulation", code=lacks)
    system = System("one", "one.ssd", {"m": Component("m", read_fmu(path))})
    if not hasattr(fmpy.fmi1._FMU, "_loadFunctions"):
        assert np.allclose(
            simulate(system, SCENARIO)["m.x"][:2], [1.0, 1.0 - 2.0 * SCENARIO.step_size]
        )
    with pytest.raises(RunError, match=f"{own}Get(String|{state})"):
        simulate(system, SCENARIO, RunOptions(store=tmp_path / "x.state"))


@pytest.mark.parametrize("version", ["2.0", "3.0"])
@pytest.mark.parametrize("status", [-1, -7, -(2**31), 6, 99])
def test_a_status_that_fmi_does_not_have_is_a_failure(
    version, status, tmp_path, needs, monkeypatch
):
    if c_fmus.compiler() is None:
        needs("a C compiler")
    steps = c_fmus.ADAPTERS[version].replace("if (m->mode != STEP) return 3;", f"return {status};")
    monkeypatch.setitem(c_fmus.ADAPTERS, version, steps)
    real = [variable for variable in VARIABLES if variable[3] == "Real"]
    text = c_fmus.describe("odd", version, real, ("CoSimulation",))
    path = c_fmus.build(tmp_path, "odd", version, DECAY, text, "CoSimulation")
    system = System("one", "one.ssd", {"m": Component("m", read_fmu(path))})
    with pytest.raises(RunError, match=f"DoStep returned '{status}'"):
        simulate(system, SCENARIO)
