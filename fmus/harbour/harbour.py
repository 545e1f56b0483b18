"""FMU of a harbour: wind and current at the ship's place."""

from shipcosim.fmi import Fmu, Input, Output, Parameters
from shipcosim.models.environment.harbour import HarbourParameters, local_current, local_wind


class Harbour(Fmu):
    """Land, a channel and a river about a berth: from the open sea's wind and current to those at the ship."""

    x = Input("m", "north position of the ship, from the berth")
    y = Input("m", "east position of the ship, from the berth")
    sea_wind_north = Input("m/s", "velocity of the air at the open sea, towards north")
    sea_wind_east = Input("m/s", "velocity of the air at the open sea, towards east")
    sea_current_north = Input("m/s", "velocity of the water at the open sea, towards north")
    sea_current_east = Input("m/s", "velocity of the water at the open sea, towards east")

    wind_north = Output("m/s", "velocity of the air at the ship, towards north")
    wind_east = Output("m/s", "velocity of the air at the ship, towards east")
    current_north = Output("m/s", "velocity of the water at the ship, towards north")
    current_east = Output("m/s", "velocity of the water at the ship, towards east")

    land = Parameters(HarbourParameters)

    def start(self):
        place = self.x, self.y
        wind = (self.sea_wind_north, self.sea_wind_east)
        current = (self.sea_current_north, self.sea_current_east)
        self.wind_north, self.wind_east = local_wind(*place, *wind, harbour=self.land)
        self.current_north, self.current_east = local_current(*place, *current, harbour=self.land)

    def step(self, t, h):
        self.start()
