"""At night: with bus A lost the azimuth that is left keeps the position in wind from twelve directions."""

import numpy as np
import pytest

import shipcosim as sc


@pytest.mark.parametrize("wind_from", range(0, 360, 30))
def test_position_is_kept_without_bus_a(wind_from):
    weather = {
        "environment.wind_from": f"{wind_from} deg",
        "environment.waves_from": f"{wind_from} deg",
        "environment.current_to": f"{(wind_from + 180) % 360} deg",
        "environment.seed": 4000 + wind_from,
    }
    late = sc.run("failures/bus_a_trips", set=weather).sel(time=slice(200.0, None))
    assert np.hypot(late["vessel.x"], late["vessel.y"]).max() < 5.0
