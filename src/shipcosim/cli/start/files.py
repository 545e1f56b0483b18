"""New files from templates: a project of one's own, an FMU, a system, a scenario. Nothing is overwritten."""

import json
import re
from collections.abc import Mapping
from contextlib import suppress
from importlib.metadata import PackageNotFoundError, distribution
from importlib.resources import files
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING

from shipcosim import library
from shipcosim.errors import Problem, ShipcosimError, error_at, reading

if TYPE_CHECKING:
    from shipcosim.ssp import System

ORIGIN = (
    "gunnerus_dp"  # what a new system is a copy of, and a new scenario runs, if no other is given
)
SHIP = "my_ship"  # system of a new project
HELD = "The ship keeps her place while the wind rises"
LOADED = 'parameters      = "loaded"                        # a set in the system\'s resources/, over her own numbers\n'
STRUCTURE = "SystemStructure.ssd"

Files = dict[str, str | bytes]
"""Contents by path in the project."""


def write_new(folder: Path, new: Mapping[str, str | bytes]) -> list[Path]:
    """Write files that are not there yet, all or none.

    Parameters
    ----------
    folder : Path
        Made if needed.
    new : mapping of str to str or bytes
        Contents by path in it.

    Returns
    -------
    list of Path

    Raises
    ------
    ShipcosimError
        If one is there already, or cannot be written.
    """
    there = [folder / name for name in new if (folder / name).exists()]
    if there:
        remedy = "Nothing is overwritten: take another name, or move it away."
        raise ShipcosimError([Problem(str(path), "It is there already.", remedy) for path in there])
    written: list[Path] = []
    try:
        for name, content in new.items():
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            written.append(path)
            path.write_bytes(content.encode() if isinstance(content, str) else content)
    except OSError as error:
        for path in written:
            with suppress(OSError):  # what cannot be written cannot be removed either
                path.unlink(missing_ok=True)
        where = str(written[-1] if written else folder)
        raise error_at(where, f"cannot be written: {error.strerror}.") from None
    return written


def project_files(name: str) -> Files:
    """A project that runs as it is: a system, two scenarios, a parameter set, a job for CI, a notebook."""

    def held(name: str, description: str, parameters: str) -> str:
        return _filled(
            "scenario.toml", name=name, description=description, system=SHIP, parameters=parameters
        )

    return {
        "README.md": _filled("readme.md", name=name, origin=ORIGIN),
        ".gitignore": _filled("gitignore"),
        **system_files(SHIP, ORIGIN),
        f"ssp/{SHIP}/resources/loaded.ssv": _filled("set.ssv", system=SHIP),
        "scenarios/hold_position.toml": held("hold_position", HELD, ""),
        "scenarios/loaded.toml": held("loaded", f"{HELD}, with cargo on deck", LOADED),
        ".github/workflows/scenarios.yml": _filled("workflow.yml", **origin_of_package()),
        "first_run.ipynb": notebook(_filled("notebook.md")),
    }


def origin_of_package() -> dict[str, str]:
    """What pip installs in CI, and a comment on it: the repository that this package was installed from, else a wheel.

    pip notes where it has a package from in direct_url.json (PEP 610).
    """
    try:
        noted = json.loads(distribution("shipcosim").read_text("direct_url.json") or "{}")
    except PackageNotFoundError:
        noted = {}
    if "vcs_info" in noted:
        url, version = noted["url"], noted["vcs_info"]
        source = f"git+{url}@{version['commit_id']}"
        comment = "This is the repository that shipcosim was installed from here."
    else:
        source = "--find-links wheels shipcosim"
        comment = (
            "shipcosim is taken from a wheel in this project, or from PyPI once it is there. Put the wheel there once:\n"
            "      #   pip wheel --no-deps --wheel-dir wheels FOLDER_OF_YOUR_CLONE_OF_SHIPCOSIM\n"
            "      # A repository does as well: pip install pytest git+https://HOST/OWNER/shipcosim"
        )
    return {"source": source, "comment": f"      # {comment}"}


def fmu_files(name: str) -> Files:
    """An FMU that can be built as it is."""
    if not (name.isidentifier() and name.isascii()):
        raise error_at(
            name,
            "This cannot name an FMU.",
            "Its name is one of Python: letters, digits and '_', no digit at the start.",
        )
    class_name = "".join(part[:1].upper() + part[1:] for part in name.split("_")) or name
    values = {"name": name, "class_name": class_name}
    return {
        f"fmus/{name}/{name}.py": _filled("fmu.py", **values),
        f"fmus/{name}/README.md": _filled("fmu.md", **values),
    }


def system_files(name: str, origin: str) -> Files:
    """A copy of a system under another name, with the parameter sets and files that it names.

    Parameters
    ----------
    name : str
        Of the new system. Where the old one has one parameter set of its own, that gets this name, too.
    origin : str
        Path or name of a system that is a folder.

    Raises
    ------
    ShipcosimError
        If there is no such system, or the name cannot be one of a folder.
    """
    _check_name(name, "system")
    folder = library.find("system", origin, "--from")
    if not (folder / STRUCTURE).is_file():
        raise error_at(
            origin,
            f"This folder has no {STRUCTURE}, so it is not copied.",
            f"Unpack it into ssp/{name}; an .ssp is a ZIP archive.",
        )
    with reading(folder / STRUCTURE):
        text = (folder / STRUCTURE).read_text(encoding="utf-8")
    named = re.search(r'<(?:\w+:)?System\b[^>]*?\sname="([^"]*)"', text)
    if named:
        text = text.replace(f'name="{named[1]}"', f'name="{name}"', 2)
    sources = [
        source
        for source in dict.fromkeys(re.findall(r'source="([^"]+)"', text))
        if (folder / source).is_file()
    ]
    sets = [source for source in sources if source.endswith(".ssv")]
    copied: Files = {}
    for source in sources:
        target = source
        content = (folder / source).read_bytes()
        if sets == [source]:
            target = f"resources/{name}.ssv"
            text = text.replace(f'source="{source}"', f'source="{target}"')
            content = content.replace(
                f'name="{Path(source).stem}"'.encode(), f'name="{name}"'.encode(), 1
            )
        copied[f"ssp/{name}/{target}"] = content
    return {f"ssp/{name}/{STRUCTURE}": text} | copied


def parameter_files(name: str, origin: str) -> Files:
    """Parameter set and mapping of a system or an FMU, with the values that it has.

    Parameters
    ----------
    name : str
        Of both files.
    origin : str
        Path or name of a system or an FMU.

    Raises
    ------
    ShipcosimError
        If there is none, it cannot be read, or it has no parameters.
    """
    from shipcosim.calls.arguments import Reading
    from shipcosim.ssp import mapping_text, parameters_of, ssv_text

    _check_name(name, "parameter set")
    values = parameters_of(Reading().system(origin))
    if not values:
        raise error_at(origin, "It has no parameters.", "Name a system or an FMU that has some.")
    return {f"{name}.ssv": ssv_text(name, values), f"{name}.ssm": mapping_text(values)}


def scenario_files(name: str, system: str | None) -> Files:
    """A scenario that runs as it is; of a ship that keeps her place, or else of whatever the system is.

    Parameters
    ----------
    name : str
        Of the file, perhaps with folders before it.
    system : str, optional
        Path or name; the first one of the project without, else the ship in DP that the package ships.

    Raises
    ------
    ShipcosimError
        If there is no such system, or it cannot be read.
    """
    from shipcosim.calls.arguments import Reading

    for part in name.split("/"):
        _check_name(part, "scenario")
    system = system or _own_system() or ORIGIN
    read = Reading().system(system)
    text = _filled("scenario.toml", name=name, description=HELD, system=system, parameters="")
    if not _fits(text, read):
        experiment = read.experiment
        outputs = (
            f"{component.name}.{variable.name}"
            for component, variable in read.all_variables()
            if variable.causality == "output"
        )
        text = _filled(
            "plain_scenario.toml",
            name=name,
            system=system,
            stop_time=experiment.stop_time or 60.0,
            step_size=experiment.step_size or 0.05,
            input=next(iter(read.inputs), "component.input"),
            output=next(outputs, "component.output"),
        )
    return {f"scenarios/{name}.toml": text}


def notebook(text: str) -> str:
    """A notebook of a text: its fenced Python blocks are cells of code, the rest cells of Markdown."""
    cells = []
    for number, part in enumerate(re.split(r"^```(?:python)?\n", text, flags=re.MULTILINE)):
        lines = part.strip("\n").splitlines(keepends=True)
        kind = (
            {"cell_type": "code", "execution_count": None, "outputs": []}
            if number % 2
            else {"cell_type": "markdown"}
        )
        cells += (
            [{"id": f"cell-{number}", **kind, "metadata": {}, "source": lines}] if lines else []
        )
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    content = {
        "cells": cells,
        "metadata": {"kernelspec": kernel},
        "nbformat": 4,
        "nbformat_minor": 5,
    }
    return json.dumps(content, indent=1, ensure_ascii=False) + "\n"


def _fits(text: str, system: "System") -> bool:
    """Whether a system has all that a scenario names."""
    from shipcosim.scenario import Scenario, check_scenario
    from shipcosim.scenario.reader import toml_of
    from shipcosim.ssp import with_values

    scenario = Scenario.model_validate(toml_of(text))
    try:
        system = with_values(system, scenario.set, "scenario")
    except ShipcosimError:
        return False
    return not any(problem.is_error for problem in check_scenario(scenario, system))


def _own_system() -> str | None:
    """First system of the project around the working folder."""
    project = library.project_of()
    names = (
        name
        for name, path in library.names("system").items()
        if project and path.is_relative_to(project)
    )
    return next(names, None)


def _check_name(name: str, kind: str) -> None:
    if not re.fullmatch(r"[A-Za-z0-9_][A-Za-z0-9_.-]*", name):
        raise error_at(
            "NAME",
            f"This cannot name a {kind}: '{name}'.",
            "Use letters, digits, '_', '-' and '.'.",
        )


def _filled(template: str, **values: object) -> str:
    text = (
        files("shipcosim.cli.start")
        .joinpath("templates", f"{template}.txt")
        .read_text(encoding="utf-8")
    )
    return Template(text).substitute(values)
