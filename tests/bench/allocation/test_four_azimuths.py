"""Four azimuths with forbidden sectors hold the ship in wind from all sides.

`python -m tests.bench.allocation.test_four_azimuths` prints how far off she is, per direction.
"""

import numpy as np

import shipcosim
from tests.bench.allocation.test_consequences import _weather

DIRECTIONS = range(0, 360, 15)  # deg
SETTLED = (
    150.0  # s: at the start all units stand ahead, and turn round where the wind is from astern
)


def distances(speed: float) -> dict[str, np.ndarray]:
    """Largest distance from the set point, whole run and after `SETTLED`, per direction. [m]"""
    found = shipcosim.simulate_many(
        scenario="allocation/four_azimuths",
        variations=[_weather(speed, at) | {"events": []} for at in DIRECTIONS],
        reduce=_reduced,
        stop_time=400.0,
    )
    return {name: found[name].values for name in ("whole", "settled")}


def _reduced(table):
    off = np.hypot(table["vessel.x"].values, table["vessel.y"].values)
    return {"whole": off.max(), "settled": off[table["time"].values > SETTLED].max()}


def test_the_ship_is_held_in_wind_from_every_side():
    off = distances(10.0)
    assert off["whole"].max() < 10.0
    assert off["settled"].max() < 2.5


if __name__ == "__main__":
    for wind in (6.0, 10.0, 14.0):
        off = distances(wind)
        for at, whole, settled in zip(DIRECTIONS, off["whole"], off["settled"], strict=True):
            print(
                f"{wind:4.0f} m/s  {at:3d} deg  {whole:5.1f} m, after {SETTLED:.0f} s {settled:5.1f} m"
            )
        print(
            f"{wind:4.0f} m/s  at most {off['whole'].max():.1f} m, then {off['settled'].max():.1f} m"
        )
