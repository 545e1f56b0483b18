"""Ships as folders of files: parameters of each component with unit, origin and tolerance.

A folder holds a ``ship.toml``, one parameter file a component (``vessel.toml``) and tables as CSV. A ship may be based
on others, a component like others of the same ship: no number stands twice. See docs/your-own-ship.md.
"""

import math
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import MISSING, Field, dataclass, fields
from pathlib import Path
from typing import Any, TypeVar

from shipcosim.errors import Problem, ShipcosimError, raise_errors, suggestion
from shipcosim.ships.capability_numbers import capability_entries
from shipcosim.ships.described import describe
from shipcosim.ships.entries import Quantity, table_entry
from shipcosim.ships.file import ShipFile

Kind = TypeVar("Kind")
_SHIP_KEYS = {"description": str, "source": str, "based_on": list, "systems": list}
_SECTIONS = set(ShipFile.model_fields) - set(_SHIP_KEYS)


@dataclass(frozen=True)
class Ship:
    """A ship's files, with those of the ships that she is based on.

    Attributes
    ----------
    name, description : str
        Name of the folder, one line of text.
    folder : Path
    systems : tuple of str
        Systems in ``ssp/`` that have a parameter set of her.
    entries : mapping of str to mapping of str to Quantity
        What the files say, by component and parameter.
    """

    name: str
    description: str
    folder: Path
    systems: tuple[str, ...]
    entries: Mapping[str, Mapping[str, Quantity]]

    def parameter_set(
        self, components: Mapping[str, Iterable[type]]
    ) -> dict[str, dict[str, Quantity]]:
        """Check and return all parameters of components: complete, known, with units and bounds.

        Parameters
        ----------
        components : mapping of str to iterable of type
            By component its classes of parameters, dataclasses with fields made by `shipcosim.models.core.parameters`.

        Returns
        -------
        dict of dict of Quantity
            By component and parameter, in the order of the classes.

        Raises
        ------
        ShipcosimError
            With everything that is wrong.
        """
        # Collect the problems of all components before raising.
        problems: list[Problem] = []
        values = {
            name: self._values(name, tuple(kinds), problems) for name, kinds in components.items()
        }
        for name, kinds in components.items():
            self._find_unknown(name, kinds, problems)
        raise_errors(problems)
        return values

    def parameters(self, kind: type[Kind], component: str) -> Kind:
        """Parameters of a component as the dataclass of the models.

        Parameters
        ----------
        kind : type
            Class of parameters.
        component : str
            Component that has them.

        Returns
        -------
        instance of kind

        Raises
        ------
        ShipcosimError
            With everything that is wrong.
        """
        problems: list[Problem] = []
        values = self._values(component, (kind,), problems)
        raise_errors(problems)
        return kind(**{name: quantity.value for name, quantity in values.items()})

    def _values(
        self, component: str, kinds: tuple[type, ...], problems: list[Problem]
    ) -> dict[str, Quantity]:
        # Parameters without a default must be in the ship's files.
        entries = self.entries.get(component, {})
        declared = [field for kind in kinds for field in fields(kind) if field.init]
        missing = [f for f in declared if f.name not in entries and f.default is MISSING]
        if missing:
            names = ", ".join(f"{f.name} [{f.metadata['unit']}]" for f in missing)
            where = str(self.folder / f"{component}.toml")
            problems.append(
                Problem(
                    where,
                    f"nothing says {names}.",
                    "They describe the ship, so they have no default.",
                )
            )
        # All others take the file's value or the default.
        present = [
            field for field in declared if field.name in entries or field.default is not MISSING
        ]
        return {
            field.name: _quantity(field, entries.get(field.name), problems) for field in present
        }

    def _find_unknown(self, component: str, kinds: Iterable[type], problems: list[Problem]) -> None:
        # Inherited entries may be unknown here: a base has them for its own components.
        names = {field.name for kind in kinds for field in fields(kind)}
        for name, entry in self.entries.get(component, {}).items():
            if name not in names and not entry.inherited:
                problems.append(
                    Problem(
                        entry.where, f"{component} has no such parameter.", suggestion(name, names)
                    )
                )


def read_ship(folder: str | Path) -> Ship:
    """Read a ship's folder, and the folders of the ships that she is based on.

    Parameters
    ----------
    folder : path
        Folder with a ``ship.toml``.

    Returns
    -------
    Ship

    Raises
    ------
    ShipcosimError
        With everything that cannot be read.
    """
    problems: list[Problem] = []
    folder = Path(folder)
    # Folders from the most basic to the ship herself: later ones override earlier ones.
    layers = _layers(folder, (), problems)
    names = dict.fromkeys(
        file.stem
        for layer in layers
        for file in sorted(layer.glob("*.toml"))
        if file.stem != "ship"
    )
    # Parameter files of each component in every folder.
    files = {name: [_read(layer / f"{name}.toml", problems) for layer in layers] for name in names}
    entries = {name: _entries(name, files, (), problems) for name in names}
    about = [_about(layer, []) for layer in layers]
    # A described ship adds estimates; parameter files come before them.
    for layer in layers:
        for name, described in _described(layer, problems).items():
            entries[name] = described | entries.get(name, {})
    if problems:
        raise ShipcosimError(list(dict.fromkeys(problems)))
    # The last folder that names systems decides.
    systems = next((head["systems"] for head in reversed(about) if "systems" in head), [])
    return Ship(folder.name, about[-1].get("description", ""), folder, tuple(systems), entries)


def _described(folder: Path, problems: list[Problem]) -> dict[str, dict[str, Quantity]]:
    """Entries of a ship file with particulars, by component; empty without particulars."""
    file = folder / "ship.toml"
    if not {"particulars", "thrusters"} & set(_toml(file, []) if file.is_file() else ()):
        return {}
    try:
        ship = describe(folder)
    except ShipcosimError as error:
        problems += error.problems
        return {}
    return ship.entries | capability_entries(ship)


def _layers(folder: Path, above: tuple[Path, ...], problems: list[Problem]) -> list[Path]:
    """Folders that describe a ship, later ones over earlier ones.

    Of the first base everything counts, its bases included; of a further base only its own files.
    """
    if folder in above:
        circle = " -> ".join(ship.name for ship in (*above, folder))
        problems.append(Problem(str(folder / "ship.toml"), f"based on itself: {circle}.", ""))
        return []
    # Bases are neighbours of the folder.
    bases = [folder.parent / name for name in _about(folder, problems).get("based_on", [])]
    if not bases:
        return [folder]
    # Further bases add only their own files.
    further = [base for base in bases[1:] if _about(base, problems) is not None]
    return [*_layers(bases[0], (*above, folder), problems), *further, folder]


def _about(folder: Path, problems: list[Problem]) -> dict[str, Any]:
    """Head of a ``ship.toml``, with lists for single names."""
    file = folder / "ship.toml"
    if not file.is_file():
        near = [path.parent.name for path in folder.parent.glob("*/ship.toml")]
        problems.append(
            Problem(str(file), "there is no such file.", f"Ships: {suggestion(folder.name, near)}")
        )
        return {}
    head = {}
    for key, value in _toml(file, problems).items():
        # Sections of a described ship are read elsewhere.
        if key in _SECTIONS:
            continue
        # A single name counts as a list of one.
        if key == "based_on" and isinstance(value, str):
            value = [value]
        if isinstance(value, _SHIP_KEYS.get(key, ())):
            head[key] = value
        else:
            problems.append(
                Problem(f"{file}: {key}", f"found {value!r}.", suggestion(key, _SHIP_KEYS))
            )
    return head


def _toml(file: Path, problems: list[Problem]) -> dict[str, Any]:
    try:
        return tomllib.loads(file.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        problems.append(Problem(str(file), f"no TOML: {error}."))
        return {}


def _read(file: Path, problems: list[Problem]) -> dict[str, Any]:
    """Entries of a parameter file by name, and ``like`` as a list; empty without a file."""
    if not file.is_file():
        return {}
    content = _toml(file, problems)
    # Components that this one is like.
    like_entry = content.pop("like", [])
    entries = {name: _entry(file, name, value, problems) for name, value in content.items()}
    like = [like_entry] if isinstance(like_entry, str) else like_entry
    if not isinstance(like, list) or not all(isinstance(name, str) for name in like):
        problems.append(
            Problem(
                f"{file}: like",
                f"found {like_entry!r}.",
                "Name the components that this one is like.",
            )
        )
        like = []
    return {"like": like} | {name: entry for name, entry in entries.items() if entry is not None}


def _entry(file: Path, name: str, content: Any, problems: list[Problem]) -> Quantity | None:
    """An entry of a file: a value, or a table in a CSV file."""
    where = f"{file}: {name}"
    is_table = isinstance(content, dict) and "table" in content
    if wrong := _wrong_keys(content, _TABLE_KEYS if is_table else _VALUE_KEYS):
        remedy = 'Write { value = 1.0, unit = "m", tolerance = 0.1, origin = "drawing" }, or { table = "file.csv" }.'
        problems.append(Problem(where, f"{'; '.join(wrong)}.", remedy))
        return None
    if is_table:
        return table_entry(file.parent / content["table"], where, problems)
    uncertainty = tuple(map(float, content.get("uncertainty", ())))
    return Quantity(
        content["value"],
        content["unit"],
        float(content.get("tolerance", 0.0)),
        content["origin"],
        (),
        where,
        uncertainty,
    )


def _wrong_keys(content: Any, keys: Mapping[str, Any]) -> list[str]:
    """Problems with the keys of an entry and their values."""
    if not isinstance(content, dict):
        return [f"found {content!r}"]
    wrong = [f"'{key}' is no key" for key in content if key not in keys]
    wrong += [f"'{key}' is missing" for key in keys if key not in content and key not in _OPTIONAL]
    wrong += [
        f"'{key}' is {content[key]!r}"
        for key, is_right in keys.items()
        if key in content and not is_right(content[key])
    ]
    return wrong


def _entries(
    name: str, files: Mapping[str, list], above: tuple[str, ...], problems: list[Problem]
) -> dict[str, Quantity]:
    """Entries of a component: its own, over those of the components that it is like."""
    layers = files.get(name, [])
    entries = {}
    # The last folder that says what the component is like decides.
    likes = next((layer["like"] for layer in reversed(layers) if layer.get("like")), [])
    # In reverse order, so that the first of them wins.
    for like in reversed(likes):
        if like in (*above, name) or like not in files:
            wrong = (
                "like itself" if like in files else f"like '{like}', which this ship does not have"
            )
            problems.append(
                Problem(f"{name}.toml", f"{wrong}.", suggestion(like, set(files) - {name, *above}))
            )
            continue
        taken = _entries(like, files, (*above, name), problems)
        # Inherited entries need not exist in this component.
        entries |= {key: entry._replace(inherited=True) for key, entry in taken.items()}
    # Entries of the folders in turn; only the ship's own files must be known exactly.
    for layer in layers:
        entries |= {
            key: entry._replace(inherited=layer is not layers[-1])
            for key, entry in layer.items()
            if key != "like"
        }
    return entries


def _quantity(field: Field, entry: Quantity | None, problems: list[Problem]) -> Quantity:
    about = field.metadata
    # No entry: the default of the model.
    if entry is None:
        return Quantity(
            field.default,
            about["unit"],
            about["tolerance"],
            about["origin"],
            description=about["description"],
        )
    # Whole numbers are fine for a float.
    value = (
        float(entry.value) if about["kind"] is float and _is_number(entry.value) else entry.value
    )
    message, remedy = _wrong(value, entry, about)
    if message:
        problems.append(Problem(entry.where, message, remedy))
    return Quantity(
        value,
        about["unit"],
        entry.tolerance,
        entry.origin,
        uncertainty=entry.uncertainty,
        description=about["description"],
    )


def _wrong(value: Any, entry: Quantity, about: Mapping[str, Any]) -> tuple[str, str]:
    """Problem of a value and its remedy; both empty where it is right."""
    kind = about["kind"]
    low = about["minimum"]
    high = about["maximum"]
    # Type, and a table where a table is needed.
    if type(value) is not kind or (entry.columns and not about["columns"]):
        wanted = (
            f"a table with the columns {', '.join(about['columns'])}"
            if about["columns"]
            else kind.__name__
        )
        return f"found {str(value)[:60]!r}.", f"Give {wanted}."
    # Columns and unit must be those that the model declares.
    if entry.columns != about["columns"]:
        return (
            f"the columns are {', '.join(entry.columns)}.",
            f"They must be {', '.join(about['columns'])}.",
        )
    if entry.unit != about["unit"]:
        return f"the unit is '{entry.unit}'.", f"It must be '{about['unit']}'."
    # NaN and infinity would spread through the simulation.
    if kind is float and not math.isfinite(value):
        return f"found {value}.", "Give a finite number."
    # Bounds of the model.
    if kind is not str and (low is not None and value < low or high is not None and value > high):
        bounds = [
            f"at least {low:g}" if low is not None else "",
            f"at most {high:g}" if high is not None else "",
        ]
        return (
            f"found {value!r}.",
            f"It must be {' and '.join(filter(None, bounds))} {about['unit']}.",
        )
    # The value must lie within its own uncertainty.
    if (
        kind is float
        and entry.uncertainty
        and not entry.uncertainty[0] <= value <= entry.uncertainty[1]
    ):
        return (
            f"{value!r} is outside its uncertainty.",
            "Give the least and the largest value, with it in between.",
        )
    return "", ""


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _is_text(value: Any) -> bool:
    return isinstance(value, str)


def _is_range(value: Any) -> bool:
    return (
        isinstance(value, list)
        and len(value) == 2
        and all(map(_is_number, value))
        and value[0] <= value[1]
    )


_VALUE_KEYS: Mapping[str, Any] = {
    "value": lambda value: isinstance(value, (bool, int, float, str)),
    "unit": _is_text,
    "tolerance": lambda value: _is_number(value) and value >= 0.0,
    "uncertainty": _is_range,
    "origin": _is_text,
}
_OPTIONAL = ("tolerance", "uncertainty")
_TABLE_KEYS: Mapping[str, Any] = {"table": _is_text}
