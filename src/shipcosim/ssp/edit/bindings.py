"""Bind parameter set files to elements of an SSD, and unbind them."""

from pathlib import Path
from urllib.parse import quote

from shipcosim.errors import suggestion
from shipcosim.ssp.edit.draft import Draft
from shipcosim.ssp.edit.elements import element_named
from shipcosim.ssp.xml.document import AnyPath, children
from shipcosim.ssp.xml.markup import add, drop, ensure


def bind(draft: Draft, source: AnyPath, element: str, prefix: str | None) -> None:
    """Bind a parameter set to an element; see `SystemStructure.bind`."""
    # A file in the package is bound by its own address; any other is copied into it.
    inside = (draft.path.parent / source).resolve()
    there = not Path(source).is_absolute() and (inside in draft.package.held or inside.is_file())
    if not there and not Path(source).is_file():
        raise draft.error(str(source), "There is no such file, in the package or elsewhere.")
    uri = quote(Path(source).as_posix()) if there else draft.resource(Path(source))
    listed = ensure(element_named(draft, element), "ssd:ParameterBindings")
    add(listed, "ssd:ParameterBinding", source=uri, prefix=prefix)


def unbind(draft: Draft, source: AnyPath, element: str) -> None:
    """Remove the binding of a parameter set from an element; see `SystemStructure.unbind`."""
    listed = children(
        element_named(draft, element), "ssd:ParameterBindings", "ssd:ParameterBinding"
    )
    bound = [part for part in listed if part.get("source") == quote(str(source))]
    if not bound:
        sources = [uri for part in listed if (uri := part.get("source"))]
        raise draft.error(str(source), "It is not bound there.", suggestion(str(source), sources))
    for part in bound:
        drop(part)
