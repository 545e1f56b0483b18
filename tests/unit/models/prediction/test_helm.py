"""Prediction of a ship that is steered by hand, against the simulation of hull and thrusters with their drives."""

import math

import numpy as np
import pytest
from ships import parameters

from shipcosim.models.core.motion import Motion
from shipcosim.models.environment.wind_loads import WindParameters, apparent_wind, wind_loads
from shipcosim.models.prediction import helm
from shipcosim.models.propulsion.azimuth import AzimuthParameters, azimuth_loads, azimuth_step
from shipcosim.models.propulsion.drive import at_rest
from shipcosim.models.propulsion.failures import SOUND
from shipcosim.models.propulsion.tunnel import TunnelParameters, tunnel_loads, tunnel_step
from shipcosim.models.ship import vessel
from shipcosim.models.ship.hull import HullParameters

NAME, H = "gunnerus-28m9", 0.05
HULL, WIND = parameters(HullParameters, NAME), parameters(WindParameters, NAME)
HELM, TUNNEL = parameters(helm.HelmParameters, NAME), parameters(TunnelParameters, NAME)
UNITS = (
    parameters(AzimuthParameters, NAME, "port"),
    parameters(AzimuthParameters, NAME, "starboard"),
)
MODEL = {"hull": HULL, "wind": WIND, "helm": HELM}
STILL = Motion(3.0, -2.0, 0.4, 0.0, 0.0, 0.0)


def aboard(
    ship, air=(0.0, 0.0), thrust=(0.0,) * 3, angles=(0.0, 0.0), rpm=(0.0,) * 3, azimuth=(0.0, 0.0)
):
    return helm.Aboard(
        ship, *apparent_wind(ship.psi, ship.u, ship.v, *air), thrust, angles, rpm, azimuth
    )


class Simulated:
    """The ship with her thrusters and their drives, in still water and a steady wind."""

    def __init__(self, ship, air):
        self.ship, self.air = ship, air
        self.units, self.tunnel = [at_rest(0.0), at_rest(0.0)], at_rest(0.5 * math.pi)

    def sail(self, seconds, thrust, angles):
        for _ in range(round(seconds / H)):
            water = self.ship[3:]
            commands = zip(self.units, thrust, angles, UNITS, strict=False)
            self.units = [
                azimuth_step(u, T, a, *water, SOUND, H, unit=unit) for u, T, a, unit in commands
            ]
            self.tunnel = tunnel_step(self.tunnel, thrust[2], water[0], SOUND, H, tunnel=TUNNEL)
            loads = [
                azimuth_loads(u, *water, unit=unit)[2:]
                for u, unit in zip(self.units, UNITS, strict=True)
            ]
            loads.append(tunnel_loads(self.tunnel, water[0], tunnel=TUNNEL)[2:])
            loads.append(wind_loads(*apparent_wind(*self.ship[2:5], *self.air), wind=WIND))
            self.ship = vessel.step(
                self.ship, *map(sum, zip(*loads, strict=True)), 0.0, 0.0, H, hull=HULL
            )

    def known(self, thrust, angles):
        rpm = *(60.0 * unit.n for unit in self.units), 60.0 * self.tunnel.n
        return aboard(
            self.ship, self.air, thrust, angles, rpm, tuple(unit.azimuth for unit in self.units)
        )


MANOEUVRES = {
    "ahead": ((2e4, 2e4, 0.0), (0.0, 0.0), 0.3),
    "turn under way": ((2e4, 1.5e4, 0.0), (0.4, 0.5), 0.3),
    "astern": ((-1.5e4, -1e4, 0.0), (0.0, 0.0), 0.3),
    "to the side": ((8e3, 8e3, 1.2e4), (1.2, -1.4), 4.0),
}
"""Thrust, directions, and how far off in 30 s: 0.3 of 70 to 100 m; where azimuths turn out of the flow while she has
way, the shafts slow down faster in this prediction than the drives let them, 4 of 50 m."""


@pytest.mark.parametrize("name", MANOEUVRES)
def test_prediction_is_the_simulation_while_levers_and_wheel_stay_put(name):
    simulated = Simulated(Motion(0.0, 0.0, 0.4, 3.0, 0.0, 0.0), (-4.0, 3.0))
    simulated.sail(40.0, (1e4, 1e4, 0.0), (0.05, 0.05))
    thrust, angles, near = MANOEUVRES[name]
    simulated.sail(3.0, thrust, angles)  # on the way from the one to the other
    found = helm.predict(simulated.known(thrust, angles), **MODEL)
    for horizon in (10, 20, 30):
        simulated.sail(10.0, thrust, angles)
        assert math.dist(found[horizon - 1][:2], simulated.ship[:2]) < near
        assert math.remainder(
            found[horizon - 1].psi - simulated.ship.psi, 2.0 * math.pi
        ) == pytest.approx(0.0, abs=0.02)


def test_ship_that_lies_still_with_nothing_commanded_stays():
    assert all(
        ship == pytest.approx(STILL, abs=1e-4) for ship in helm.predict(aboard(STILL), **MODEL)
    )


def test_ship_at_rest_in_the_water_goes_with_the_estimated_current():
    u, v = 0.3 * math.cos(0.4), -0.3 * math.sin(0.4)
    known = aboard(STILL._replace(u=u, v=v), (0.3, 0.0))
    found = helm.predict(known, (0.3, 0.0), **MODEL)[-1]
    assert found[:3] == pytest.approx((3.0 + 0.3 * 30.0, -2.0, 0.4), abs=1e-3)


def test_many_starts_at_once_are_each_one_by_itself():
    rng = np.random.default_rng(1)
    rows = rng.uniform(-1.0, 1.0, (5, 16)) * (
        [9, 9, 3, 3, 0.3, 0.03, 8, 3, 9e3, 9e3, 9e3, 3, 3, 90, 90, 900]
    )

    def split(row):
        azimuth = 0.1 * row[11], 0.2 * row[12]
        thrust, angles, rpm = (tuple(row[i:j]) for i, j in ((8, 11), (11, 13), (13, 16)))
        return helm.Aboard(Motion(*row[:6]), row[6], row[7], thrust, angles, rpm, azimuth)

    together = helm.predict(split(rows.T), **MODEL)
    for k, row in enumerate(rows.tolist()):
        for one, all_of_them in zip(
            helm.predict(split(row), **MODEL)[::10], together[::10], strict=True
        ):
            assert [values[k] for values in all_of_them] == pytest.approx(list(one), abs=1e-9)


def test_heading_at_the_start_is_averaged_across_south():
    latest = ()
    for psi in (math.pi - 0.01, -math.pi + 0.01, -math.pi + 0.03):
        latest = helm.remembered(latest, STILL._replace(psi=psi, u=psi))
    ship = helm.smoothed(latest, STILL._replace(psi=-math.pi + 0.03))
    assert ship.psi == pytest.approx(-math.pi + 0.01)
    assert len(latest) == helm.SMOOTHING
