"""Sizes of arrays that structural parameters set."""

from collections.abc import Iterator, Mapping

from shipcosim.ssp.flatten.system import Component
from shipcosim.ssp.xml.values import Value

RESIZE = "Set it in the SSD or in a parameter set."
"""Remedy for what `resized` finds."""


def resized(component: Component) -> Iterator[str]:
    """Sentences on start values that would resize arrays whose elements are laid out already."""
    for variable in component.variables.values():
        # Only the first element of each array: the others have the same sizes.
        if variable.whole is not None and variable.place == 0:
            for name, size in zip(variable.sizes, variable.whole.dimensions, strict=True):
                wanted = component.start_value(name) if isinstance(name, str) else size
                if wanted != size:
                    yield f"{name} is {wanted}, but {variable.whole.name} has been laid out for {size}."


def sizes_wanted(components: Mapping[str, Component]) -> dict[str, dict[str, Value]]:
    """Values of structural parameters that give sizes, by component and name."""
    wanted = {}
    for name, component in components.items():
        # A size is a number, or the name of the structural parameter that holds it.
        sizes = {size for variable in component.variables.values() for size in variable.sizes}
        structural = {size for size in sizes if isinstance(size, str)}
        values = {size: component.start[size] for size in structural & set(component.start)}
        wanted |= {name: values} if values else {}
    return wanted
