"""Components with swapped FMUs: check the connectors that are wired."""

from difflib import get_close_matches

from shipcosim.errors import MOST_COMPARED, shortened, suggestion
from shipcosim.ssp.flatten.hierarchy import ElementPath, Hierarchy
from shipcosim.ssp.flatten.ports import Key
from shipcosim.ssp.fmu.description import FmuDescription
from shipcosim.ssp.read.structure import KIND_NAMES, Connector

MOST_NAMED = 12  # connectors that an error lists
WHERE = "components"
"""Place that messages name for problems with exchanged FMUs."""


def has_connector(fmu: FmuDescription, connector: Connector) -> bool:
    """True if an FMU has a component's connector: a variable of its name, kind and type."""
    variable = fmu.variables.get(connector.name)
    if variable is None or (connector.kind in KIND_NAMES and connector.kind != variable.causality):
        return False
    return connector.type in (None, variable.kind)


def take_swapped(tree: Hierarchy) -> None:
    """Check swapped FMUs; connectors that they lack and that are not wired are left out.

    Parameters
    ----------
    tree : Hierarchy
        With all components, ports and wires; takes what is wrong.
    """
    paths = {".".join(path): path for path in tree.components}
    wired = {key for wire in tree.wires for key in (wire.source, wire.target)}
    for name in tree.swapped:
        if name not in paths:
            tree.findings.error(
                f"{WHERE}, {name}", f"There is no component '{name}'.", suggestion(name, paths)
            )
        elif (fmu := tree.components[paths[name]][1]) is not None:
            _take(tree, paths[name], fmu, wired)


def _take(tree: Hierarchy, path: ElementPath, fmu: FmuDescription, wired: set[Key]) -> None:
    lacking = [
        key for key, port in tree.ports.items() if key.path == path and port.variable is None
    ]
    # A connector that nothing uses can go; one that is wired makes the FMU unfit.
    missed = [key for key in lacking if key in wired]
    for key in lacking:
        if key not in wired:
            del tree.ports[key]
    if not missed:
        return
    name = ".".join(path)
    lacks = shortened((key.name for key in missed), MOST_NAMED)
    message = (
        f"{fmu.path.name} cannot take the place of '{name}': it lacks {lacks}, which are wired."
    )
    # Offer variables of similar names that are still free.
    close = []
    for key in missed[:MOST_NAMED]:
        names = [name for name in fmu.named(tree.ports[key].kind) if Key(path, name) not in wired][
            :MOST_COMPARED
        ]
        close += [f"{name} ({key.name})" for name in get_close_matches(key.name, names, n=1)]
    has = ", ".join([*fmu.named("input"), *fmu.named("output")][:40])
    remedy = f"Close to them are {', '.join(close)}." if close else f"It has: {has}."
    tree.findings.error(f"{WHERE}, {name}", message, remedy)
