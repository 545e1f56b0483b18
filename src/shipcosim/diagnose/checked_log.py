"""A log as read, with the ship that it is compared with, and with the faults that its own channels show."""

from dataclasses import dataclass

import xarray

from shipcosim.diagnose.finding import Finding
from shipcosim.diagnose.hypotheses.catalogue import Cause
from shipcosim.diagnose.log.checks.examine import examine
from shipcosim.diagnose.log.repair import repaired
from shipcosim.diagnose.ship.model import ShipModel


@dataclass(frozen=True)
class ReadLog:
    """A log as read, and what it is compared with.

    Attributes
    ----------
    log : xarray.Dataset
        Every row of the file, in the units of the roles.
    ship : ShipModel
        The system's ship, with every cause neutral.
    causes : dict of str to Cause
        The catalogue.
    """

    log: xarray.Dataset
    ship: ShipModel
    causes: dict[str, Cause]


@dataclass(frozen=True)
class CheckedLog(ReadLog):
    """A log with the faults that its own channels show.

    Attributes
    ----------
    faults : tuple of Finding
        Of kind ``"data"``.
    repaired : xarray.Dataset
        The log on even rows, these faults corrected or cut out.
    """

    faults: tuple[Finding, ...]
    repaired: xarray.Dataset


def checked(read: ReadLog) -> CheckedLog:
    """A log with the faults that its own channels show, and repaired."""
    faults = tuple(examine(read.log))
    return CheckedLog(read.log, read.ship, read.causes, faults, repaired(read.log, faults))
