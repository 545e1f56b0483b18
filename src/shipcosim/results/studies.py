"""Comparisons of engines, replays, calibrations and sea trials: what was found, and how it shows itself."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from shipcosim.cosim.compare import Comparison
from shipcosim.diagnose.calibration_pipeline import CalibratedShip
from shipcosim.diagnose.replays import LogReplay
from shipcosim.diagnose.sea_trials.study import SeaTrialStudy
from shipcosim.results.shown import HtmlPage, Picture, Result, made, page_of

if TYPE_CHECKING:
    import pandas

    from shipcosim.report.notebook.card import Card

__all__ = ["Calibration", "EngineComparison", "Replay", "SeaTrials"]


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

    def save(self, folder: str | os.PathLike[str]) -> Path:
        """Write report.html beside the calibrated.ssv and reference.json that ``calibrate(..., out=folder)`` leaves."""
        return self.page().save(made(folder) / "report.html").parent

    def _card(self) -> Card:
        from shipcosim.report.notebook.study_cards import calibration_card

        return calibration_card(self)


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
