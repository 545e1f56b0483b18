"""A system as WebAssembly: its components' models in C, its wiring, and the loop of the native engine."""

from __future__ import annotations

import os
import sys
import zipfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from importlib.resources import files
from pathlib import Path
from typing import Any

from shipcosim.cosim.master.interrupt import delayed_interrupt
from shipcosim.cosim.master.plan import Plan
from shipcosim.cosim.slaves.instances import Instances
from shipcosim.cosim.webassembly.wiring import NotForPages, Wiring
from shipcosim.errors import Problem
from shipcosim.native.compiler import EXACT, check_installed, kept, run_compiler
from shipcosim.native.export.functions import understood
from shipcosim.native.export.text import source_of_model
from shipcosim.native.export.variants import variant_of
from shipcosim.native.record_cache import OWN_CODE
from shipcosim.native.symbols import Untraceable
from shipcosim.options import CountProgress
from shipcosim.scenario import Scenario
from shipcosim.ssp import Component, System
from shipcosim.temporary import temporary_folder

GOAL = " for WebAssembly"
TARGET = ("-target", "wasm32-wasi", "-Os", "-g0", "-std=c11", EXACT)
CALLS = (
    *("start", "advance", "modify", "release", "give", "change_start"),
    *("step", "rows", "words", "table"),
)
"""What a page calls, in `desk.c`."""

REMEDY = "Run the system with `shipcosim run`, or give this component an FMU that compiles."


def make_module(plan: Plan, scenario: Scenario, progress: CountProgress | None = None) -> bytes:
    """Compile a planned system into WebAssembly without imports from its host.

    Parameters
    ----------
    plan : Plan
        With a row for each input that the page may change.
    scenario : Scenario
        Checked; its values in the units of the signals.
    progress : callable, optional
        Called with (components done, in all).

    Raises
    ------
    NotForPages
        With every component that has no native code, and why; or what the page cannot exchange.
    ShipcosimError
        The compiler is missing or fails.
    """
    check_installed()
    if scenario.order != "jacobi":
        message = f"has the order {scenario.order}; the code of a page steps as jacobi."
        raise NotForPages([Problem(scenario.name or "scenario", message, REMEDY)])
    texts = texts_of(plan.system, progress)
    # Components with the same text share its functions; a text has its GUID in it.
    prefixes = {text: f"fmu{n}_" for n, text in enumerate(dict.fromkeys(texts.values()))}
    of_component = {
        name: (prefixes[text], text.partition('#define GUID "')[2].partition('"')[0])
        for name, text in texts.items()
    }
    wiring = Wiring(plan, scenario, of_component)
    desk = "\n".join(
        [
            files("shipcosim.native").joinpath("loop.c").read_text(encoding="utf-8"),
            _runtime("desk.h"),
            wiring.text(),
            _runtime("desk.c"),
        ]
    )
    return _linked([*prefixes.items(), (desk, "")])


def texts_of(system: System, progress: CountProgress | None = None) -> dict[str, str]:
    """C texts of all components, by name.

    Raises
    ------
    NotForPages
        With every component that has no native code, and why.
    """
    texts = {}
    problems = []
    compiled: dict[Any, str] = {}
    with delayed_interrupt() as check_interrupt, Instances() as instances:
        for done, component in enumerate(system.components.values(), start=1):
            # Components that share FMU and start values share their text.
            key = component.fmu.path, repr(sorted(component.start.items()))
            try:
                if key not in compiled:
                    compiled[key] = _text_of(component, instances)
                texts[component.name] = compiled[key]
            except Untraceable as reason:
                problems.append(Problem(component.name, f"has no native code: {reason}.", REMEDY))
            if progress is not None:
                progress(done, len(system.components))
            check_interrupt()
    if problems:
        raise NotForPages(problems)
    return texts


def _text_of(component: Component, instances: Instances) -> str:
    """C text of a component's FMU, for its start values."""
    # A native FMU brings its text along.
    with zipfile.ZipFile(component.fmu.path) as archive:
        if "sources/all.c" in archive.namelist():
            return archive.read("sources/all.c").decode()
    instance = instances.instance_of(component).python_object
    if instance is None:
        raise Untraceable("it is an FMU of another tool, without a model in C of this package")
    cls: Any = type(instance)
    # The name of an FMU's module is unique to its content.
    key = cls.__module__, cls.__qualname__, sorted(component.start.items()), OWN_CODE
    return kept(key, ".c", lambda: _written(cls, component).encode()).decode()


def _written(cls: Any, component: Component) -> str:
    """Record a component and write it as C."""
    package = cls.__module__.partition(".")[0]
    words = sys.modules[f"{package}.shipcosim.fmi.failures"].text_of
    with understood(package):
        variant = variant_of(cls, component.start, cls.default_step_size)
        return source_of_model(cls, component.fmu.path.stem, [variant], words)


def _runtime(name: str) -> str:
    return files("shipcosim.cosim.webassembly").joinpath(name).read_text(encoding="utf-8")


def _linked(sources: Sequence[tuple[str, str]]) -> bytes:
    """Compile texts, each with a prefix for its functions of FMI, and link them."""
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        objects = list(pool.map(lambda source: _object(*source), sources))
    with temporary_folder() as folder:
        for number, content in enumerate(objects):
            Path(folder, f"{number}.o").write_bytes(content)
        options = [
            "-mexec-model=reactor",
            "-Wl,--strip-all",
            "-Wl,-z,stack-size=4194304",
            "-Wl,--export=__global_base",
        ]
        options += [f"-Wl,--export=desk_{name}" for name in CALLS]
        names = [f"{number}.o" for number in range(len(objects))]
        run_compiler([*TARGET, *options, *names, "-o", "desk.wasm"], folder, GOAL)
        return Path(folder, "desk.wasm").read_bytes()


def _object(source: str, prefix: str) -> bytes:
    """Compile a text."""

    def made() -> bytes:
        with temporary_folder() as folder:
            Path(folder, "all.c").write_text(source, encoding="utf-8")
            named = [f"-DFMI2_FUNCTION_PREFIX={prefix}"] if prefix else []
            run_compiler([*TARGET, *named, "-c", "all.c", "-o", "all.o"], folder, GOAL)
            return Path(folder, "all.o").read_bytes()

    return kept((source, prefix, TARGET), ".wasm.o", made)
