"""A ship file for tests, and what is planted in it."""

SUPPLY = """
description = "supply ship"
source = "general arrangement"

[particulars]
length = "60 m"
breadth = "14 m"
draught = "4.5 m"
displacement = "2650 t"
service_speed = "12 kn"

[wind]
kind = "offshore supply vessel"

[[thrusters]]
name = "port"
kind = "azimuth"
x = "-27 m"
y = "-3.5 m"
diameter = "2.4 m"
power = "1200 kW"
ducted = true

[[thrusters]]
name = "starboard"
kind = "azimuth"
x = "-27 m"
y = "3.5 m"
diameter = "2.4 m"
power = "1200 kW"
ducted = true

[[thrusters]]
name = "bow"
kind = "tunnel"
x = "25 m"
diameter = "1.7 m"
power = "500 kW"
"""
BOAT = """
description = "twin-screw boat with maps of her tunnels"

[particulars]
length = "24 m"
breadth = "7 m"
draught = "2.2 m"
block_coefficient = 0.5

[[thrusters]]
name = "left"
kind = "fixed"
x = -10.5
y = -1.8
diameter = 1.2
power = "300 kW"

[[thrusters]]
name = "right"
kind = "fixed"
x = -10.5
y = 1.8
diameter = 1.2
power = "300 kW"

[[thrusters]]
name = "bow"
kind = "map"
x = 9.0
y = 0.0
direction = "90 deg"
time_constant = 1.0
table = [[-100, -12000], [0, 0], [100, 12000]]

[[thrusters]]
name = "stern"
kind = "map"
x = -9.0
y = 0.0
direction = "90 deg"
table = [[-100, -9000], [0, 0], [100, 9000]]
"""
COASTER = """
description = "coaster with a rudder"

[particulars]
length = "80 m"
breadth = "13 m"
draught = "5.2 m"
displacement = "4000 t"
service_speed = "13 kn"

[[thrusters]]
name = "propeller"
kind = "rudder"
x = "-38 m"
y = 0
diameter = "3 m"
"""
FILES = {"supply": SUPPLY, "boat": BOAT, "coaster": COASTER}
