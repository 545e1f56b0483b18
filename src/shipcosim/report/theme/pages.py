"""Pages from templates: each is one HTML file with everything inside, which opens anywhere and needs no network."""

from functools import cache
from importlib.resources import files
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

import shipcosim
from shipcosim.report.theme.packing import packed_data, packed_text
from shipcosim.report.theme.views import Page


def render(template: str, page: Page, **parts: Any) -> str:
    """Render a page as HTML; texts are escaped, and misspelt names in templates are errors.

    Parameters
    ----------
    template : str
        File below `report/`, as in ``"run/templates/run.html.jinja"``.
    page : Page
        What it shows.
    **parts
        What this page alone shows, by the names in its template.

    Returns
    -------
    str
    """
    return _environment().get_template(template).render(page=page, **parts)


@cache
def _environment() -> Environment:
    made = Environment(
        loader=PackageLoader("shipcosim.report", "."),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.globals |= {
        "asset": _asset,
        "library": _library,
        "packed": packed_data,
        "version": shipcosim.__version__,
    }
    return made


def _asset(path: str) -> Markup:
    """A style sheet or script, as it is."""
    return Markup(files("shipcosim.report").joinpath(path).read_text(encoding="utf-8"))


@cache
def _library(name: str) -> str:
    """A library of `theme/vendor`, compressed, with the licences of all its parts."""
    licences = _asset(f"theme/vendor/{name.upper()}-LICENSES.txt")
    return packed_text(f"/*{licences}*/{_asset(f'theme/vendor/{name}.min.js')}")
