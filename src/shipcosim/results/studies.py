"""Comparisons of engines, replays, calibrations, capabilities, sea trials: what was found, how it shows itself."""

from __future__ import annotations

import io
import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from shipcosim.capability import Capability, as_json, dataset, notation, numbers_table
from shipcosim.cosim.compare import Comparison
from shipcosim.diagnose.calibration_pipeline import CalibratedShip
from shipcosim.diagnose.replays import LogReplay
from shipcosim.diagnose.sea_trials.study import SeaTrialStudy
from shipcosim.results.shown import HtmlPage, Picture, Result, page_of
from shipcosim.series import write_file, write_table
from shipcosim.staging import staged

if TYPE_CHECKING:
    import pandas
    import xarray

    from shipcosim.report.notebook.card import Card

__all__ = ["Calibration", "CapabilityOfShip", "EngineComparison", "Replay", "SeaTrials"]


@dataclass(frozen=True, repr=False, eq=False)
class EngineComparison(Result, Comparison):
    """What `shipcosim.compare` gives back. To start with: ``.agree``, ``.signals``, ``.left_out``."""

    name: str = ""

    def to_pandas(self) -> pandas.DataFrame:
        """A row a signal, the largest difference first: of each engine from ours, and of half the step."""
        import pandas

        rows = [
            {"unit": one.unit, "range": one.range}
            | {engine: difference.largest for engine, difference in one.engines.items()}
            | {"of range": one.worst, "half the step": one.step.largest}
            for one in self.signals
        ]
        return pandas.DataFrame(rows, index=pandas.Index([one.name for one in self.signals], name="signal"))

    def _card(self) -> Card:
        from shipcosim.report.notebook.study_cards import comparison_card

        return comparison_card(self, self.name)


@dataclass(frozen=True, repr=False, eq=False)
class Replay(Result, LogReplay):
    """What `shipcosim.replay` gives back: a log, and predictions of it. ``.tracks`` has the numbers."""

    name: str = "log"
    systems: tuple[str, ...] = ()

    def track(self) -> Picture:
        """The log beside its predictions, each from the measured state."""
        from shipcosim.report.notebook.diagnosis_card import tracks_svg

        return Picture(f"track of {self.name}", tracks_svg(self.tracks, f"track of {self.name}"))

    def page(self) -> HtmlPage:
        """The page of the replay, as `shipcosim replay` writes it."""
        from shipcosim.report.diagnosis.replay_page import write_replay

        facts = dict(zip(self.tracks.predicted, self.systems, strict=False))
        facts |= {"Predictions": f"{self.tracks.horizon:.0f} s"}
        return page_of(f"Replay of {self.name}", lambda path: write_replay(self, path, self.name, facts))

    def to_pandas(self) -> pandas.DataFrame:
        """Root mean square errors by simulation and time since the start of a prediction."""
        from shipcosim.diagnose.validation.tracks import errors_of

        return errors_of(self.tracks).to_dataframe()

    def _card(self) -> Card:
        from shipcosim.report.notebook.study_cards import replay_card

        return replay_card(self, self.name, self.track().svg)


@dataclass(frozen=True, repr=False, eq=False)
class Calibration(Result, CalibratedShip):
    """What `shipcosim.calibrate` gives back. ``.reference`` is what `shipcosim.diagnose` takes."""

    def page(self) -> HtmlPage:
        """The page of the calibration, as `shipcosim calibrate` writes it."""
        from shipcosim.report.calibration.page import write_calibration

        return page_of(f"Calibration of {self.reference.system}", lambda path: write_calibration(self, path))

    def save(self, folder: str | os.PathLike[str], *, force: bool = False) -> Path:
        """Write report.html; ``calibrate(..., out=folder)`` leaves calibrated.ssv and reference.json beside it.

        Parameters
        ----------
        folder : path
            Made if needed.
        force : bool
            Replace files of these names there, instead of keeping them in a numbered folder beside it.
        """
        with staged(Path(folder), force=force) as stage:
            self.page().save(stage / "report.html")
        return Path(folder)

    def _card(self) -> Card:
        from shipcosim.report.notebook.study_cards import calibration_card

        return calibration_card(self)


@dataclass(frozen=True, repr=False, eq=False)
class CapabilityOfShip(Result, Capability):
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
        from shipcosim.report.capability.page import write_capability

        return page_of(f"Capability of {self.vessel.name}", lambda path: write_capability(self, path))

    def to_pandas(self) -> pandas.DataFrame:
        """A row a direction that the weather comes from [deg], a column a case: DP capability numbers."""
        import pandas

        return pandas.read_csv(io.StringIO(numbers_table(self)), index_col=0)

    def save(self, folder: str | os.PathLike[str], *, force: bool = False) -> Path:
        """Write report.html, capability.csv and capability.nc, as `shipcosim capability` does; returns the folder.

        Parameters
        ----------
        folder : path
            Made if needed.
        force : bool
            Replace files of these names there, instead of keeping them in a numbered folder beside it.
        """
        with staged(Path(folder), force=force) as stage:
            write_file(stage / "capability.csv", numbers_table(self).encode())
            write_table(self.table, stage / "capability.nc")
            self.page().save(stage / "report.html")
        return Path(folder)

    def _card(self) -> Card:
        from shipcosim.report.notebook.study_cards import capability_card

        return capability_card(self)


@dataclass(frozen=True, repr=False, eq=False)
class SeaTrials(Result, SeaTrialStudy):
    """What `shipcosim.sea_trials` gives back. To start with: ``.verdict``, ``.findings``, ``.as_json()``."""

    name: str = "log"
    system: str = ""

    def page(self) -> HtmlPage:
        """The page of the trials, as `shipcosim sea-trials` writes it."""
        from shipcosim.report.sea_trials.page import write_sea_trials

        facts = {"Log": self.name, "System": self.system}
        return page_of(f"Sea trials of {self.name}", lambda path: write_sea_trials(self, path, facts))

    def _card(self) -> Card:
        from shipcosim.report.notebook.study_cards import sea_trials_card

        return sea_trials_card(self, self.name)
