"""Two runs laid over each other. `shipcosim.report` and `shipcosim report` both come through here."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from shipcosim.calls.arguments import AnyPath
from shipcosim.keywords import with_known_keywords
from shipcosim.results.comparison import RunComparison, table_of
from shipcosim.results.run import Run
from shipcosim.staging import check_targets

if TYPE_CHECKING:
    from xarray import Dataset


@with_known_keywords
def report(
    first: AnyPath | Run | Dataset,
    second: AnyPath | Run | Dataset,
    *,
    out: AnyPath | None = None,
    force: bool = False,
) -> RunComparison:
    """Lay two runs over each other: both ships in one scene, both runs in every plot, and by how much they differ.

    Parameters
    ----------
    first, second : path, Run or Dataset
        Runs, or results of runs: a folder, or a table in it (.nc, .csv).
    out : path, optional
        Folder that gets report.html.
    force : bool
        Replace files of this name there, instead of keeping them in a numbered folder beside it.

    Returns
    -------
    RunComparison

    Raises
    ------
    ShipcosimError
        If a run cannot be read, or the two have no signal in common.

    Examples
    --------
    >>> import shipcosim
    >>> calm = shipcosim.run("gust", stop_time=1.0)
    >>> rough = shipcosim.run("gust", stop_time=1.0, set={"environment.wind_speed": 12.0})
    >>> both = shipcosim.report(calm, rough)
    >>> both.outcome.word, both.plot("vessel.x")
    ('DIFFER', <picture 'vessel.x of A and B': .save("picture.svg") writes it>)
    """
    if out is not None:
        check_targets(Path(out))
    result = RunComparison(names_of(first, second), (table_of(first), table_of(second)))
    result.comparison  # noqa: B018  # what cannot be compared is refused here
    if out is not None:
        result.save(out, force=force)
    return result


def names_of(first: AnyPath | Run | Dataset, second: AnyPath | Run | Dataset) -> tuple[str, str]:
    """Short names of two runs: those of their scenarios, folders or files, else A and B."""
    ways = []
    for run in (first, second):
        if not isinstance(run, (str, Path)):
            ways.append([getattr(run, "name", "")])
            continue
        path = Path(run).resolve()
        parts = list(path.parts[1:]) if path.is_dir() else [*path.parts[1:-1], path.stem]
        if len(parts) > 1 and parts[-1] in ("result", "result-partial"):
            parts.pop()
        ways.append(parts)
    for depth in (1, 2, 3):
        a, b = ("-".join(parts[-depth:]) for parts in ways)
        if a != b and a and b:
            return a, b
    return "A", "B"
