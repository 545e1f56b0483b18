"""Results on disk: parts during the runs, then one table. Only this module knows Parquet."""

from __future__ import annotations

import io
import json
import platform
import shutil
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import asdict
from math import prod
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Any

import numpy as np

from shipcosim import __version__
from shipcosim.errors import error_at, imported, reading
from shipcosim.scenario.model import Value
from shipcosim.series import write_file
from shipcosim.staging import set_aside
from shipcosim.sweep.plan import ColumnOf, Plan
from shipcosim.sweep.summary import SHARE
from shipcosim.sweep.work import Row
from shipcosim.temporary import clear_killed, replacement

if TYPE_CHECKING:
    import pandas
    import pyarrow

SCHEMA = "shipcosim-study/1"
BETWEEN_PARTS = 5.0
LARGEST_PART = 10_000
"""How long rows wait until they are written [s], and how many of them."""
GROUP = 10_000
"""Rows of the table that are made and written together."""
TABLES = ("runs.parquet", "runs.csv", "summary.csv", "indices.csv", "trials.csv", "tracks.parquet")
FILES = (*TABLES, "study.json", "report.html", "verdict.json", "parts")


def check_installed() -> None:
    """Raise ShipcosimError where pyarrow is missing."""
    with imported("sweep", "The table of runs is a Parquet file, and pyarrow is missing."):
        import pyarrow  # noqa: F401


class Store:
    """Folder of results of a study.

    Parameters
    ----------
    folder : Path
        Made if needed. What is there of the same plan is kept, of another one set aside.
    plan : Plan
    engine : str
    force : bool
        Do runs that are done again, and replace what is there.

    Attributes
    ----------
    done : (runs,) array of bool
        Which runs are done.
    lost : int
        Runs that were done, and whose rows are no longer there or cannot be read.
    """

    def __init__(self, folder: Path, plan: Plan, engine: str, force: bool = False):
        self.folder = Path(folder)
        self._plan = plan
        self._engine = engine
        self._digest = plan.digest(engine)
        self._rows: list[Row] = []
        self._written = monotonic()
        self.done = np.zeros(len(plan), dtype=bool)
        self.failed = 0
        self.lost = 0
        with _naming_file(self.folder):
            self.folder.mkdir(parents=True, exist_ok=True)
            clear_killed(self.folder)
            digest, done = self._plan_there()
            # The same plan: go on from what is there. Another plan: set its results aside.
            if digest == self._digest and not force:
                # Note which runs are done already.
                table = self._collected()
                self.done[table["run"].to_numpy()] = True
                self.lost = max(done - int(self.done.sum()), 0)
                self.failed = sum(bool(error) for error in table["error"].to_pylist())
            else:
                set_aside(self.folder, [*FILES, *self._pages()], force=force)
                for name in [*FILES, *self._pages()]:
                    path = self.folder / name
                    shutil.rmtree(path) if path.is_dir() else path.unlink(missing_ok=True)
                self.write_about()
            self._parts.mkdir(exist_ok=True)

    @property
    def _parts(self) -> Path:
        return self.folder / "parts"

    def add(self, rows: Iterable[Row]) -> None:
        """Keep rows; they are written soon."""
        for row in rows:
            self._rows.append(row)
            self.done[row.number] = True
            self.failed += bool(row.error)
        # Small parts often: little is lost if the process is killed, and few files result.
        if self._rows and (
            monotonic() - self._written > BETWEEN_PARTS or len(self._rows) >= LARGEST_PART
        ):
            self.flush()

    def flush(self) -> None:
        """Write the waiting rows."""
        if not self._rows:
            return
        rows = self._rows
        self._rows = []
        name = f"{min(row.number for row in rows)}-{len(rows)}-{max(row.number for row in rows)}.parquet"
        # Tracks first: a part of runs without its tracks would count as done.
        written = {f"tracks-{name}": self._tracks(rows)} if self._plan.study.tracks else {}
        for file, table in (written | {f"runs-{name}": self._part(rows)}).items():
            _write(table, self._parts / file)
        self._written = monotonic()

    def finish(self) -> None:
        """Write the table of the runs that are done; parts go where all are.

        Raises
        ------
        ShipcosimError
            If the disk is full: all that is done stays in the parts.
        """
        self.flush()
        # The table is written from the parts; they are removed only when all runs are done.
        with _naming_file(self.folder):
            table = self._collected()
            self._write_runs(table)
            self._write_tracks()
            self.write_about()
            if self.done.all():
                shutil.rmtree(self._parts)

    def rows(self) -> pandas.DataFrame:
        """Number, error and quantities of the finished runs."""
        self.flush()
        return self._collected().to_pandas()

    def runs(self) -> pandas.DataFrame:
        """The table of runs."""
        return read_part(self.folder / "runs.parquet")

    def about(self) -> dict[str, Any]:
        """The content of study.json."""
        columns = [asdict(column) for column in [*self._plan.columns, *_of_summaries(self._plan)]]
        counts = {"planned": len(self._plan), "done": int(self.done.sum()), "failed": self.failed}
        return {
            "schema": SCHEMA,
            "name": self._plan.study.name,
            "study": self._plan.study.model_dump(mode="json", exclude_defaults=True, by_alias=True),
            "columns": columns,
            "runs": counts,
            "plan": self._digest,
            "engine": self._engine,
            "seed": self._plan.study.seed,
            "versions": {
                "shipcosim": __version__,
                "python": platform.python_version(),
                "numpy": np.__version__,
            },
        }

    def _plan_there(self) -> tuple[str, int]:
        """Digest of the plan whose results are there, and how many of its runs are done; no digest without results."""
        try:
            content = json.loads((self.folder / "study.json").read_text(encoding="utf-8"))
            return str(content["plan"]), int(content["runs"]["done"])
        except (OSError, ValueError, TypeError, LookupError):
            return "", 0

    def write_about(self, **more: Any) -> dict[str, Any]:
        """Write study.json with additional facts; return its content."""
        about = self.about() | {name: value for name, value in more.items() if value}
        write_file(
            self.folder / "study.json", json.dumps(about, indent=1, ensure_ascii=False).encode()
        )
        return about

    def _pages(self) -> list[str]:
        """Folders of runs that were simulated again."""
        return [page.name for page in self.folder.glob("run-*") if page.is_dir()]

    def _part(self, rows: list[Row]) -> pyarrow.Table:
        import pyarrow

        # One column per quantity, of fixed type, so that parts can be joined.
        columns: dict[str, Any] = {
            "run": pyarrow.array([row.number for row in rows], pyarrow.int64()),
            "error": pyarrow.array([row.error for row in rows], pyarrow.string()),
        }
        for measure in self._plan.measures:
            kind = pyarrow.bool_() if measure.is_truth else pyarrow.float64()
            values = [row.quantities.get(measure.name) for row in rows]
            columns[measure.name] = pyarrow.array(values, kind)
        return pyarrow.table(columns)

    def _tracks(self, rows: list[Row]) -> pyarrow.Table:
        import pyarrow

        signals = self._plan.study.tracks.signals if self._plan.study.tracks else []
        # Failed runs have no track. The number of the run repeats for each of its rows.
        kept = [row for row in rows if row.tracks]
        numbers = np.repeat([row.number for row in kept], [len(row.tracks["time"]) for row in kept])
        columns = {"run": pyarrow.array(numbers, pyarrow.int64())}
        for name in ("time", *signals):
            joined = np.concatenate([row.tracks[name] for row in kept]) if kept else np.empty(0)
            columns[name] = pyarrow.array(joined.astype(float), pyarrow.float64())
        return pyarrow.table(columns)

    def _write_tracks(self) -> None:
        """Write tracks.parquet from the parts of finished runs and what it holds of others; without parts it stays."""
        import pyarrow
        import pyarrow.compute
        import pyarrow.parquet as parquet

        # Only tracks whose runs are written too: others belong to runs that will be repeated.
        rows = sorted(self._parts.glob("runs-*.parquet"))
        parts = [path.with_name(path.name.replace("runs-", "tracks-", 1)) for path in rows]
        if self._plan.study.tracks is None or not parts:
            return
        table = pyarrow.concat_tables([parquet.read_table(path) for path in parts])
        file = self.folder / "tracks.parquet"
        if self._tracked():
            others = ~pyarrow.compute.field("run").isin(table["run"].unique())
            earlier = parquet.read_table(file, columns=table.column_names).cast(table.schema)
            table = pyarrow.concat_tables([earlier.filter(others), table])
        ordered = table.sort_by([("run", "ascending"), ("time", "ascending")])
        _write(ordered, file, compression="zstd")

    def _collected(self) -> pyarrow.Table:
        """Rows of all parts and of the existing table, each once, in the order of the plan."""
        import pyarrow
        import pyarrow.compute
        import pyarrow.parquet as parquet

        schema = self._part([]).schema
        number = pyarrow.compute.field("run")
        is_planned = (number >= 0) & (number < len(self._plan))
        tables = [schema.empty_table()]
        files = sorted(self._parts.glob("runs-*.parquet"))
        # A damaged table is skipped: its runs count as not done. So do runs whose tracks are lost; failed ones have none.
        earlier = self.folder / "runs.parquet"
        for path in [earlier, *files]:
            is_kept = is_planned
            if path == earlier and self._plan.study.tracks is not None:
                is_kept &= (pyarrow.compute.field("error") != "") | number.isin(self._tracked())
            try:
                table = parquet.read_table(path, columns=schema.names).select(schema.names)
                tables.append(table.cast(schema).filter(is_kept))
            except (OSError, pyarrow.ArrowException, KeyError):
                continue
        table = pyarrow.concat_tables(tables)
        # A run may be in the table and in a part: take the first. `unique` also sorts by number.
        _, first = np.unique(table["run"].to_numpy(), return_index=True)
        return table.take(first)

    def _tracked(self) -> list[int]:
        """Runs whose tracks are in tracks.parquet; none where it is damaged."""
        import pyarrow
        import pyarrow.parquet as parquet

        try:
            file = parquet.ParquetFile(self.folder / "tracks.parquet")
            complete = set(self._tracks([]).column_names) <= set(file.schema_arrow.names)
            return file.read(["run"])["run"].unique().to_pylist() if complete else []
        except (OSError, pyarrow.ArrowException):
            return []

    def _write_runs(self, table: pyarrow.Table) -> None:
        """Write runs.parquet and runs.csv, a group of rows at a time."""
        import pyarrow.csv
        import pyarrow.parquet as parquet

        kinds = self._kinds()
        # Group by group, because the inputs of all runs together may exceed the memory.
        first = self._group(table.slice(0, 0), kinds)
        with (
            replacement(self.folder / "runs.parquet") as whole_file,
            replacement(self.folder / "runs.csv") as plain_file,
            parquet.ParquetWriter(whole_file, first.schema, compression="zstd") as whole,
            pyarrow.csv.CSVWriter(plain_file, first.drop_columns(["input"]).schema) as plain,
        ):
            for start in range(0, table.num_rows, GROUP):
                group = self._group(table.slice(start, GROUP), kinds)
                whole.write_table(group, GROUP)
                plain.write_table(group.drop_columns(["input"]))

    def _kinds(self) -> dict[str, Any]:
        """Types of the columns of factors and samples."""
        import pyarrow

        pairs = zip(self._plan.study.factor, self._plan.levels, strict=True)
        kinds = {factor.name: _kind([level.label for level in levels]) for factor, levels in pairs}
        if self._plan.samples is not None:
            kinds["sample"] = pyarrow.int64()
            for column in self._plan.samples.columns:
                kinds[column.name] = pyarrow.int64() if column.is_whole else pyarrow.float64()
        return kinds

    def _group(self, done: pyarrow.Table, kinds: dict[str, Any]) -> pyarrow.Table:
        """Make rows of the table of runs."""
        import pyarrow

        # Inputs are made here again from the plan, not stored with the parts: they are large.
        runs = [self._plan.run(number) for number in done["run"].to_pylist()]
        inputs = [json.dumps(self._plan.input_of(run), ensure_ascii=False) for run in runs]
        columns: dict[str, Any] = {"run": done["run"]}
        for name, kind in kinds.items():
            values: list[Any] = [run.columns[name] for run in runs]
            if kind == pyarrow.string():
                values = list(map(str, values))
            columns[name] = pyarrow.array(values, kind)
        columns |= {measure.name: done[measure.name] for measure in self._plan.measures}
        columns |= {"error": done["error"], "input": pyarrow.array(inputs, pyarrow.string())}
        return pyarrow.table(columns)


def _write(table: pyarrow.Table, path: Path, **options: Any) -> None:
    """Write a table as Parquet; it is there completely or not at all."""
    import pyarrow.parquet as parquet

    content = io.BytesIO()
    parquet.write_table(table, content, **options)
    write_file(path, content.getvalue())


@contextmanager
def _naming_file(folder: Path) -> Iterator[None]:
    """Turn errors of the operating system into one ShipcosimError."""
    try:
        yield
    except OSError as error:
        raise error_at(
            str(folder),
            f"Results cannot be written here: {error.strerror or error}.",
            "Make room and run the study again: it goes on from what is done.",
        ) from error


def _kind(labels: list[Value]) -> Any:
    """Arrow type of labels: numbers if all are numbers, else texts."""
    import pyarrow

    try:
        return pyarrow.array(labels).type
    except pyarrow.ArrowException:
        return pyarrow.string()


def _of_summaries(plan: Plan) -> list[ColumnOf]:
    units = {column.name: column.unit for column in plan.columns}
    names = [
        *(factor.name for factor in plan.study.factor),
        *["sample"][: plan.samples is not None],
    ]
    columns = []
    for summary in plan.study.summary:
        # Shares have no unit; others have that of their quantity.
        unit = {"share": "1", "last_held": None}.get(summary.statistic, units.get(summary.quantity))
        text = summary.description or f"{summary.statistic} of {summary.quantity}"
        if summary.statistic == "last_held":
            # What is meant by held follows from the study, whatever a description says.
            sizes = [
                size for name, size in zip(names, plan.shape, strict=True) if name in summary.over
            ]
            text += f", held in {summary.share or SHARE:.0%} of the runs, {prod(sizes)} a case"
        columns.append(ColumnOf(summary.name, "summary", unit, text))
    return columns


def read_part(path: Path) -> pandas.DataFrame:
    """A table of a study's folder.

    Raises
    ------
    ShipcosimError
        If it is damaged.
    """
    import pandas

    with reading(path, "Delete the folder, or replace it with --force: its runs are made again."):
        return pandas.read_parquet(path)
