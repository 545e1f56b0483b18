"""Comparisons of engines, replays, calibrations, capabilities, sea trials: what was found, how it shows itself."""

from __future__ import annotations

import io
import json
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

from shipcosim.capability import Capability, as_json, dataset, notation, numbers_table
from shipcosim.cosim.compare import Comparison, Signal
from shipcosim.diagnose.calibration_pipeline import CalibratedShip
from shipcosim.diagnose.replays import LogReplay
from shipcosim.diagnose.sea_trials.study import SeaTrialStudy
from shipcosim.errors import Problem
from shipcosim.results.shown import (
    Check,
    HtmlPage,
    Picture,
    Result,
    SavedResult,
    finite,
    passed_or_failed,
)
from shipcosim.series import write_file

if TYPE_CHECKING:
    import pandas
    import xarray

    from shipcosim.diagnose.validation.tracks import Tracks
    from shipcosim.report.notebook.card import Card


@dataclass(frozen=True, repr=False, eq=False)
class EngineComparison(Result, Comparison):
    """What `shipcosim.compare` gives back. To start with: ``.agree``, ``.signals``, ``.left_out``."""

    name: str = ""
    flaws: tuple[Problem, ...] = ()
    """Where the system breaks a standard though it can mean one thing only, and remarks on events of OSP."""

    @property
    def passed(self) -> bool:
        """Whether all engines agree."""
        return self.agree

    @property
    def checks(self) -> tuple[Check, ...]:
        """That each engine got to its end, and that they agree on each signal."""
        ran = [Check(f"{name} runs to its end", "passed") for name in self.seconds]
        for name, why in self.left_out.items():
            status = "error" if name in self.failed else "skipped"
            ran.append(Check(f"{name} runs to its end", status, why))
        return (*ran, *map(self._check_of, self.signals))

    def _check_of(self, signal: Signal) -> Check:
        """That the engines agree on a signal."""
        worst = max(signal.engines.items(), key=lambda entry: entry[1].relative, default=None)
        message = "only our own engine has it"
        if worst is not None:
            engine, difference = worst
            message = (
                f"{engine} differs from ours by {difference.largest:.3g} {signal.unit} at {difference.time:g} s, "
                f"{difference.relative:.1e} of its range; limit {self.tolerance:g}"
            )
        return Check(signal.name, passed_or_failed(signal.worst <= self.tolerance), message)

    def as_json(self) -> dict[str, Any]:
        """The comparison, as `shipcosim compare --json` prints it; numbers that JSON does not know are texts."""
        values = {field.name: getattr(self, field.name) for field in fields(Comparison)}
        return finite(asdict(Comparison(**values)) | {"agree": self.agree})

    def to_pandas(self) -> pandas.DataFrame:
        """A row a signal, the largest difference first: of each engine from ours, and of half the step."""
        import pandas

        rows = [
            {"unit": signal.unit, "range": signal.range}
            | {engine: difference.largest for engine, difference in signal.engines.items()}
            | {
                "of range": signal.worst,
                "half the step": signal.step.largest if signal.step else "not tried",
            }
            for signal in self.signals
        ]
        return pandas.DataFrame(
            rows, index=pandas.Index([signal.name for signal in self.signals], name="signal")
        )

    def _card(self) -> Card:
        from shipcosim.report.notebook.study_cards import comparison_card

        return comparison_card(self, self.name)


@dataclass(frozen=True, repr=False, eq=False)
class Replay(SavedResult, LogReplay):
    """What `shipcosim.replay` gives back: a log, and predictions of it. ``.tracks`` has the numbers."""

    name: str = "log"
    systems: tuple[str, ...] = ()

    def track(self) -> Picture:
        """The log beside its predictions, each from the measured state."""
        from shipcosim.report.notebook.diagnosis_card import tracks_svg

        return Picture(f"track of {self.name}", tracks_svg(self.tracks, f"track of {self.name}"))

    def page(self) -> HtmlPage:
        """The page of the replay, as `shipcosim replay` writes it."""
        from shipcosim.report.replay.page import render

        facts = dict(zip(self.tracks.predicted, self.systems, strict=False))
        facts |= {"Predictions": f"{self.tracks.horizon:.0f} s"}
        return HtmlPage(f"Replay of {self.name}", render(self, self.name, facts))

    def to_pandas(self) -> pandas.DataFrame:
        """Root mean square errors by simulation and time since the start of a prediction."""
        from shipcosim.diagnose.validation.tracks import errors_of

        return errors_of(self.tracks).to_dataframe()

    def _card(self) -> Card:
        from shipcosim.report.notebook.study_cards import replay_card

        return replay_card(self, self.name, lambda: self.track().svg)

    def write(self, stage: Path) -> None:
        """Write report.html, errors.csv and replay.nc into a folder that is there."""
        self.to_pandas().reset_index().to_csv(stage / "errors.csv", index=False)
        # Made in memory: on a full disk HDF5 ends the process.
        content = series_of(self.tracks).to_netcdf(engine="h5netcdf")
        write_file(stage / "replay.nc", bytes(content))
        super().write(stage)


@dataclass(frozen=True, repr=False, eq=False)
class Calibration(SavedResult, CalibratedShip):
    """What `shipcosim.calibrate` gives back. ``.reference`` is what `shipcosim.diagnose` takes."""

    @property
    def passed(self) -> bool:
        """Whether the logs make a reference."""
        return not self.refusals

    def as_json(self) -> dict[str, Any]:
        """The reference, as `shipcosim calibrate --json` prints it."""
        return json.loads(self.reference.as_json())

    def page(self) -> HtmlPage:
        """The page of the calibration, as `shipcosim calibrate` writes it."""
        from shipcosim.report.calibration.page import render

        return HtmlPage(f"Calibration of {self.reference.system}", render(self))

    def _card(self) -> Card:
        from shipcosim.report.notebook.study_cards import calibration_card

        return calibration_card(self)


@dataclass(frozen=True, repr=False, eq=False)
class CapabilityOfShip(SavedResult, Capability):
    """What `shipcosim.capability` gives back. To start with: ``.notation``, ``.elements()``, ``.numbers()``."""

    @property
    def notation(self) -> str:
        """As the standard writes it: ``"DP capability-L1(5, 4, 0, 0)"``."""
        return notation(self)

    @property
    def table(self) -> xarray.Dataset:
        """Numbers and shares of thrust by basis, case, condition and direction."""
        return dataset(self)

    def as_json(self) -> dict[str, Any]:
        """The numbers, as `shipcosim capability --json` prints them."""
        return as_json(self)

    def page(self) -> HtmlPage:
        """The page of the capability, as `shipcosim capability` writes it."""
        from shipcosim.report.capability.page import render

        return HtmlPage(f"Capability of {self.vessel.name}", render(self))

    def to_pandas(self) -> pandas.DataFrame:
        """A row a direction that the weather comes from [deg], a column a case: DP capability numbers."""
        import pandas

        return pandas.read_csv(io.StringIO(numbers_table(self)), index_col=0)

    def write(self, stage: Path) -> None:
        """Write report.html, capability.csv and capability.nc into a folder that is there."""
        write_file(stage / "capability.csv", numbers_table(self).encode())
        write_file(stage / "capability.nc", bytes(self.table.to_netcdf(engine="h5netcdf")))
        super().write(stage)

    def _card(self) -> Card:
        from shipcosim.report.notebook.study_cards import capability_card

        return capability_card(self)


@dataclass(frozen=True, repr=False, eq=False)
class SeaTrials(SavedResult, SeaTrialStudy):
    """What `shipcosim.sea_trials` gives back. To start with: ``.verdict``, ``.findings``, ``.as_json()``."""

    name: str = "log"
    system: str = ""
    orders: bool = False
    json_name = "sea_trials.json"

    def page(self) -> HtmlPage:
        """The page of the trials, as `shipcosim sea-trials` writes it."""
        from shipcosim.report.sea_trials.page import render

        thrusters = "orders" if self.orders else "feedback"
        facts = {"Log": self.name, "System": self.system, "Thrusters": thrusters}
        return HtmlPage(f"Sea trials of {self.name}", render(self, facts))

    def _card(self) -> Card:
        from shipcosim.report.notebook.study_cards import sea_trials_card

        return sea_trials_card(self, self.name)


def series_of(tracks: Tracks) -> xarray.Dataset:
    """All that a replay draws in one table: measured over time, predicted over the time since each start."""
    import xarray

    parts = [
        tracks.measured.rename({name: f"measured_{name}" for name in tracks.measured.data_vars})
    ]
    for name, predicted in tracks.predicted.items():
        renamed = {variable: f"{name}_{variable}" for variable in predicted.data_vars}
        parts.append(predicted.rename(renamed | {"time": "since_start"}))
    return xarray.merge(parts, compat="no_conflicts", join="outer")
