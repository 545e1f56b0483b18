"""What there is: everything that has a name, a line each, and what the command says without arguments."""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from shipcosim import library
from shipcosim.cli.start.completion import LISTED

Row = tuple[str, str]
BEGIN = """
Begin with:
  shipcosim run four_corner         a ship in DP moves in a square of 20 m; makes a page
  shipcosim diagnose gunnerus_log   what a simulation gets wrong of a measured log, and why
  shipcosim init my-project         a project of your own: system, scenarios, CI, notebook
  shipcosim list                    everything that is there, a line each
  shipcosim docs                    the pages to read
"""


def overview() -> str:
    """Where to begin, and how much there is of each kind in the project around and in the package."""
    project = library.project_of()
    shipped = library.shipped()
    lines = []
    for kind, heading in zip(library.KINDS, LISTED, strict=False):
        paths = library.names(kind)
        of_project = [
            name
            for name, path in paths.items()
            if project not in (None, shipped) and path.is_relative_to(project)
        ]
        others = [name for name in paths if name not in of_project]
        for where, names in (("here", of_project), ("shipcosim", others)):
            if names:
                first = sorted(names, key=lambda name: "/" in name)[:4]
                shown = ", ".join(first) + (", ..." if len(names) > 4 else "")
                lines.append((heading, f"{len(names):>3} {where + ':':<11}{shown}"))
    return f"{BEGIN}\nWhat is there:\n" + "\n".join(f"  {kind:<11}{text}" for kind, text in lines)


def listed(kinds: Sequence[str]) -> str:
    """Everything of some kinds as text, a heading for each and a line for each thing."""
    return "\n\n".join(_section(kind) for kind in kinds or LISTED)


def _section(kind: str) -> str:
    if kind == "causes":
        from shipcosim.diagnose.hypotheses.catalogue import read_catalogue

        causes = [(cause.cause, cause.sentence) for cause in read_catalogue().values()]
        return _table("causes (what `diagnose` can name)", causes)
    if kind == "engines":
        return _table("engines (--engine of `run` and `simulate`)", _engines())
    project = library.project_of()
    shipped = library.shipped()
    entries = library.entries("study" if kind == "studies" else kind.removesuffix("s"))
    of_project = [
        e for e in entries if project not in (None, shipped) and e.path.is_relative_to(project)
    ]
    others = [e for e in entries if e not in of_project]
    tables = [(f"{kind} of {project.name}", of_project)] if of_project and project else []
    tables += (
        [(f"{kind} of shipcosim" if of_project else kind, others)]
        if others or not of_project
        else []
    )
    return "\n\n".join(
        _table(heading, ((e.name, e.line) for e in listed)) for heading, listed in tables
    )


def _engines() -> list[Row]:
    from shipcosim.cosim.engines.registry import ENGINES, engines_missing

    missing = engines_missing()
    notes = {name: f"{problem.found} {problem.remedy}" for name, problem in missing.items()}
    notes |= {"auto": "native for long runs, else fmpy", "fmpy": "our own"}
    notes |= {"native": "our own, with the models compiled"}
    return [(name, notes.get(name, "installed")) for name in ENGINES]


def pages() -> dict[str, Path]:
    """Pages of the documentation that came with shipcosim, by name; tutorials first."""
    folder = library.shipped() / "docs"
    return {
        path.stem: path for part in ("learn", ".") for path in sorted(folder.glob(f"{part}/*.md"))
    }


def site_page(page: Path | None) -> Path | None:
    """File of the built site for a page, else for its front page; None if `make docs` has not built it."""
    root = library.shipped()
    name = page.relative_to(root / "docs").with_suffix(".html") if page else "index.html"
    file = root / "build" / "site" / name
    return file if file.is_file() else None


def table_of_pages(paths: Mapping[str, Path]) -> str:
    """The names of pages with their titles."""
    titles = {
        name: path.read_text(encoding="utf-8").partition("\n")[0] for name, path in paths.items()
    }
    return _table(
        "pages (shipcosim docs PAGE)",
        ((name, title.lstrip("# ")) for name, title in titles.items()),
    )


def _table(heading: str, rows: Iterable[Row]) -> str:
    cells = list(rows)
    width = max((len(name) for name, _ in cells), default=0)
    lines = [f"  {name:<{width}}  {text}".rstrip() for name, text in cells]
    return "\n".join([heading, *(lines or ["  none"])])
