"""FMU of a ship whose form is not that of the vessel's law."""

from shipcosim.fmi import Parameters
from shipcosim.interfaces import Ship
from shipcosim.models.core.motion import Load
from shipcosim.models.ship.rough_form import (
    RoughFormParameters,
    form_loads,
    memory_loads,
    rough_wind_loads,
)
from shipcosim.models.ship.vessel import through_water


class RoughVessel(Ship):
    """Ship as the vessel, with drag along the hull, wind round her, powers of speed and a memory of her own."""

    form = Parameters(RoughFormParameters)

    def settle(self) -> None:
        self.remembered = self._velocity()

    def wind_load(self) -> Load:
        return rough_wind_loads(
            self.apparent_wind_speed, self.apparent_wind_from, wind=self.wind, form=self.form
        )

    def form_load(self) -> Load:
        form = form_loads(*self._velocity(), hull=self.hull, form=self.form)
        memory, _ = memory_loads(
            self._velocity(), self.remembered, 0.0, hull=self.hull, form=self.form
        )
        return form[0] + memory[0], form[1] + memory[1], form[2] + memory[2]

    def remember(self, h: float) -> None:
        _, self.remembered = memory_loads(
            self._velocity(), self.remembered, h, hull=self.hull, form=self.form
        )

    def _velocity(self):
        ship = self.state
        u_r, v_r = through_water(ship.psi, ship.u, ship.v, self.current_north, self.current_east)
        return u_r, v_r, ship.r
