"""C text of a system's wiring: the tables that `native/loop.c` and `desk.c` work on."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from typing import Any

import numpy as np

from shipcosim.cosim.interactive import start_values_of
from shipcosim.cosim.master.compiled import exchange_tables
from shipcosim.cosim.master.instantiate import make_exchanges
from shipcosim.cosim.master.plan import Plan, label
from shipcosim.cosim.master.result import recorded_rows
from shipcosim.cosim.master.signals import Exchange
from shipcosim.errors import Problem, ShipcosimError
from shipcosim.native.export.text import c_text
from shipcosim.native.source import literal
from shipcosim.scenario import Scenario
from shipcosim.ssp import Component
from shipcosim.units import whole_steps

KINDS = ("Real", "Integer", "Boolean")
"""In the order in which a component's memory holds them."""

MOST_STEPS = 4096
"""Steps that one call of the page can make."""


class NotForPages(ShipcosimError):
    """A page cannot run a system: a component has no native code, or an exchanged value is not a number."""


class Wiring:
    """The wiring of a planned system.

    Parameters
    ----------
    plan : Plan
        Of the run; every input that the page may change has a row.
    scenario : Scenario
        Steps and times.
    prefixes : dict of str to (prefix, guid)
        How the C functions of each component's FMU begin, and its GUID.

    Attributes
    ----------
    exchanges : dict of str to Exchange
        By kind.
    kinds : list of str
        In the order of the tables.
    step : Fraction
        Of the exchange. [s]
    steps_per_row : int
        Steps from one recorded row to the next.

    Raises
    ------
    ShipcosimError
        With what the page cannot exchange: texts, connections into parameters, integers of 64 bits.
    """

    def __init__(self, plan: Plan, scenario: Scenario, prefixes: dict[str, tuple[str, str]]):
        self._plan = plan
        self._scenario = scenario
        self._prefixes = prefixes
        _check(plan)
        self.exchanges: dict[str, Exchange] = make_exchanges(plan)
        self.kinds = [*self.exchanges]
        self._lines: list[str] = []
        self.step = step = Fraction(repr(scenario.step_size))
        self.steps_per_row = (
            whole_steps(scenario.output_interval or scenario.step_size, scenario.step_size) or 1
        )
        self._constants = {
            "STEP_NUMERATOR": str(step.numerator),
            "STEP_DENOMINATOR": str(step.denominator),
            "START_TIME": "0.0",
            "STOP_TIME": literal(float(scenario.stop_time)),
            "MOST_STEPS": str(MOST_STEPS),
            "MOST_MULTIPLE": str(max(plan.multiples.values())),
            "N_PARTS": str(len(plan.system.components)),
            "N_INPUTS": str(sum(len(e.inputs) for e in self.exchanges.values())),
        }

    def text(self) -> str:
        """The tables as C."""
        components = [*self._plan.system.components.values()]
        # Each FMU's functions once, however many components use it.
        declared = dict.fromkeys(self._prefixes[component.name] for component in components)
        self._lines = [f"DECLARED({prefix})" for prefix, _ in declared]
        rows = [f'{{"{guid}", FUNCTIONS({prefix})}}' for prefix, guid in declared]
        self._table("static const Fmu fmus[]", rows)
        rows = [self._exchange(n, *pair) for n, pair in enumerate(self.exchanges.items())]
        self._table("static Exchange exchanges[]", rows)
        self._external_values()
        values = [self._part_arrays(n, component) for n, component in enumerate(components)]
        order = [*declared]
        parts = [
            self._part(n, component, order.index(self._prefixes[component.name]))
            for n, component in enumerate(components)
        ]
        self._table("static Part parts[]", parts)
        self._lines.append("static int step_part(double *, double *, Call, void *);")
        self._lines.append("static int give_up(int, int64_t);")
        self._table(
            "static Component components[]",
            [
                self._component(n, component, size)
                for n, (component, size) in enumerate(zip(components, values, strict=True))
            ],
        )
        self._constants["MOST_VALUES"] = str(max(sum(sizes) for sizes in values) + 1)
        self._start_values(components)
        real = self.kinds.index("Real") if "Real" in self.kinds else -1
        self._lines.append(
            f"static System desk = {{{len(self.kinds)}, {len(components)}, exchanges, components, 0, 0, "
            f"{self.steps_per_row}, 0, give_up, {real}, 0}};"
        )
        head = [f"#define {name} {value}" for name, value in self._constants.items()]
        return "\n".join([*head, *self._lines, ""])

    def _table(self, head: str, rows: Sequence[str]) -> None:
        self._lines += [f"{head} = {{", *(f"    {row}," for row in rows), "};"]

    def _array(self, name: str, kind: str, values: Iterable[Any]) -> str:
        """Write an array and return its name; one number more, since C has no empty ones."""
        numbers = [literal(float(v)) if kind == "double" else str(int(v)) for v in values]
        self._lines.append(f"static const {kind} {name}[] = {{{', '.join([*numbers, '0'])}}};")
        return name

    def _exchange(self, number: int, kind: str, exchange: Exchange) -> str:
        """One row of the table of exchanges."""
        external, inputs = recorded_rows(self._plan, kind)
        columns = [len(exchange.outputs) + row for row in external]
        fields: dict[str, Any] = {"is_real": int(kind == "Real")}
        tables = exchange_tables(exchange, [*self.exchanges.values()], columns, inputs)
        for name, value in tables.items():
            if isinstance(value, np.ndarray):
                ctype = "double" if value.dtype.kind == "f" else "int64_t"
                fields[name] = self._array(f"{name}_{number}", ctype, value.tolist())
            else:
                fields[name] = value
        fields |= self._buffers(number, kind, exchange, int(tables["n_columns"]))
        return f"{{{', '.join(f'.{name} = {value}' for name, value in fields.items())}}}"

    def _buffers(
        self, number: int, kind: str, exchange: Exchange, n_columns: int
    ) -> dict[str, str]:
        """Arrays of an exchange's values, of its rows, and of its modifiers: there is room for one a value."""
        n_rows = MOST_STEPS // self.steps_per_row + 2
        ctype = "double" if kind == "Real" else "int32_t"
        n_sources, n_inputs = len(exchange.sources), len(exchange.inputs)
        sizes = {
            "sources": (ctype, n_sources),
            "modified": (ctype, n_sources),
            "transferred": (ctype, len(exchange.transferred)),
            "inputs": (ctype, n_inputs),
            "rows": (ctype, n_rows * n_columns),
        }
        for side, size in (("output", n_sources), ("input", n_inputs)):
            sizes |= {f"{side}_row": ("int64_t", size)}
            sizes |= {f"{side}_{part}": ("double", size) for part in ("scale", "shift")}
        self._lines += [
            f"static {kind} {name}_{number}[{size + 1}];" for name, (kind, size) in sizes.items()
        ]
        return {name: f"{name}_{number}" for name in sizes}

    def _external_values(self) -> None:
        """A function that gives values from outside their start values again."""
        lines = []
        for number, (kind, exchange) in enumerate(self.exchanges.items()):
            ctype = "double" if kind == "Real" else "int32_t"
            n = len(exchange.outputs)
            name = self._array(f"external_{number}", ctype, exchange.external)
            size = f"{len(exchange.external)} * sizeof({ctype})"
            lines.append(f"    memcpy(sources_{number} + {n}, {name}, {size});")
        self._lines += ["static void restore_external(void)", "{", *lines, "}"]

    def _rows(self, component: Component, side: int) -> list[tuple[int, int, int]]:
        """(value reference, exchange, row) of a component's outputs or inputs, in the memory's order."""
        rows = []
        for kind in KINDS:
            if kind not in self.exchanges:
                continue
            first, variables = self._plan.rows(kind, component.name)[side]
            number = self.kinds.index(kind)
            rows += [(v.value_reference, number, first + i) for i, v in enumerate(variables)]
        return rows

    def _part_arrays(self, number: int, component: Component) -> tuple[int, int]:
        """Arrays of a component; how many inputs and outputs it has."""
        outputs, inputs = (self._rows(component, side) for side in (0, 1))
        for word, rows, first in (("input", inputs, 0), ("output", outputs, len(inputs))):
            self._array(f"part_{number}_{word}s", "unsigned", (row[0] for row in rows))
            self._array(f"part_{number}_{word}_place", "int64_t", range(first, first + len(rows)))
            self._array(f"part_{number}_{word}_exchange", "int64_t", (row[1] for row in rows))
            self._array(f"part_{number}_{word}_row", "int64_t", (row[2] for row in rows))
        self._lines.append(f"static double memory_of_{number}[{len(inputs) + len(outputs) + 2}];")
        return len(inputs), len(outputs)

    def _part(self, number: int, component: Component, fmu: int) -> str:
        feeds = any(
            connection.source[0] == component.name and connection.target[0] is not None
            for connection in self._plan.system.connections
        )
        counts = [
            "{" + ", ".join(
                str(len(self._plan.rows(kind, component.name)[side][1]))
                if kind in self.exchanges
                else "0"
                for kind in KINDS
            ) + "}"
            for side in (1, 0)
        ]  # fmt: skip
        arrays = f"part_{number}_inputs, part_{number}_outputs, NULL"
        return f"{{fmus + {fmu}, {c_text(component.name)}, {int(feeds)}, {', '.join(counts)}, {arrays}}}"

    def _component(self, number: int, component: Component, size: tuple[int, int]) -> str:
        """One row of the loop's components; the component itself is what its step gets as `kept`."""
        multiple = self._plan.multiples[component.name]
        fields: list[Any] = [
            "step_part",
            f"memory_of_{number}",
            f"(double *)(void *)(parts + {number})",
            "0",
            sum(size),
            multiple,
            literal(0.0),
            *size,
            *(
                f"part_{number}_{word}_{part}"
                for word in ("input", "output")
                for part in ("place", "exchange", "row")
            ),
        ]
        return f"{{{', '.join(map(str, fields))}}}"

    def _start_values(self, components: Sequence[Component]) -> None:
        """All start values, in the order in which the FMUs get them."""
        rows = []
        outside = {
            end: f"{number}, {row}"
            for number, kind in enumerate(self.kinds)
            for row, end in enumerate(
                self._plan.layouts[kind].external, start=len(self._plan.layouts[kind].outputs)
            )
        }
        numbers = {component.name: number for number, component in enumerate(components)}
        for start in start_values_of(self._plan):
            end = self._plan.system.split(start.signal)
            reference = self._plan.variable(end).value_reference
            is_text = isinstance(start.value, str)
            text = c_text(start.value) if isinstance(start.value, str) else "NULL"
            number = "0.0" if is_text else literal(float(start.value))  # pyright: ignore
            rows.append(
                f"{{{numbers[end[0] or '']}, {reference}, {start.kind.upper()}, {number}, {text}, "
                f"{outside.get(end, '-1, -1')}}}"
            )
        self._constants["N_STARTS"] = str(len(rows))
        self._table("static Start starts[]", [*rows, "{0, 0, 0, 0.0, NULL, -1, -1}"])


def _check(plan: Plan) -> None:
    """Refuse what the loop in C does not exchange."""
    problems = [
        Problem(c.place or label(c.target), "It carries a text.", "Pages exchange numbers alone.")
        for c in plan.string_connections
    ]
    problems += [
        Problem(c.place or label(c.target), "It leads into a parameter.", "Give it a start value.")
        for c in plan.parameter_connections
    ]
    if plan.layouts["Long"].inputs or plan.layouts["Long"].outputs:
        problems.append(
            Problem(plan.system.name, "It exchanges integers of 64 bits.", "Use those of 32 bits.")
        )
    if problems:
        raise NotForPages(problems)
