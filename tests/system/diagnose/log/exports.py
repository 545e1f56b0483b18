"""Tables as the tools of ships export them: headings, units and forms by their conventions, written from one motion."""

from __future__ import annotations

from datetime import datetime, timedelta

import numpy as np

from shipcosim.diagnose.log.degree_size import metres_per_degree

SHIP = {
    "bow1": ("rpm",),
    "bow2": ("rpm",),
    "port": ("rpm", "azimuth"),
    "starboard": ("rpm", "azimuth"),
}
COUNT = 240
START = datetime(2024, 3, 14, 9, 26, 0)
KNOT = 1852.0 / 3600.0


def motion():
    """A turn at some 2 m/s off Ålesund, by role, in the units of the roles; 1 Hz."""
    t = np.arange(float(COUNT))
    heading = 40.0 + 60.0 * np.sin(t / 60.0)
    velocity = (2.0 + 0.5 * np.sin(t / 25.0)) * np.exp(1j * np.radians(heading + 5.0))
    way = np.concatenate(([0.0], np.cumsum(0.5 * (velocity[1:] + velocity[:-1]))))
    meridian, parallel = metres_per_degree(62.333)
    body = velocity * np.exp(-1j * np.radians(heading))
    return {
        "time": t,
        "latitude": 62.333 + way.real / meridian,
        "longitude": 6.21 + way.imag / parallel,
        "north": way.real,
        "east": way.imag,
        "heading": heading % 360.0,
        "yaw_rate": np.cos(t / 60.0),
        "surge": body.real,
        "sway": body.imag,
        "speed_over_ground": np.abs(velocity),
        "course_over_ground": (heading + 5.0) % 360.0,
        "north_velocity": velocity.real,
        "east_velocity": velocity.imag,
        "wind_speed": 8.0 + np.sin(t / 9.0),
        "wind_from": 45.0 + 20.0 * np.sin(t / 13.0),
        "true_wind_speed": 9.0 + np.sin(t / 9.0),
        "true_wind_from": 300.0 + 20.0 * np.sin(t / 13.0),
        "port_rpm": 120.0 + 9.0 * np.sin(t / 20.0),
        "starboard_rpm": 131.0 + 9.0 * np.cos(t / 20.0),
        "bow1_rpm": 210.0 + 90.0 * np.sin(t / 15.0),
        "bow2_rpm": -220.0 + 90.0 * np.cos(t / 15.0),
        "port_azimuth": 15.0 + 9.0 * np.sin(t / 30.0),
        "starboard_azimuth": 345.0 + 9.0 * np.cos(t / 30.0),
    }


def _stamps(form, cut=None):
    return [(START + timedelta(seconds=t)).strftime(form)[:cut] for t in range(COUNT)]


def _minutes(role, sides):
    return [f"{int(v)}°{60.0 * (v % 1.0):07.4f}'{sides}".replace(".", ",") for v in motion()[role]]


_TEXTS = {
    "iso": lambda: _stamps("%Y-%m-%dT%H:%M:%S.%fZ"),
    "german": lambda: _stamps("%d.%m.%Y %H:%M:%S"),
    "slashes": lambda: _stamps("%Y/%m/%d %H:%M:%S"),
    "clock": lambda: _stamps("%H:%M:%S"),
    "date": lambda: _stamps("%Y-%m-%d"),
    "lat'": lambda: _minutes("latitude", "N"),
    "lon'": lambda: _minutes("longitude", "E"),
    "secs": lambda: [str(1710408360 + t) for t in range(COUNT)],
    "nsecs": lambda: ["0"] * COUNT,
    "ns": lambda: [str(1710408360000000000 + t * 1000000000) for t in range(COUNT)],
    "count": lambda: [str(t) for t in range(COUNT)],
    "zero": lambda: ["0.0"] * COUNT,
}
_FACTORS = {
    "kn": 1.0 / KNOT,
    "rad": np.pi / 180.0,
    "/min": 60.0,
    "Hz": 1.0 / 60.0,
    "": 1.0,
    "-": -1.0,
}


def texts_of(source, decimal="."):
    """Cells of a source such as ``iso``, ``heading`` or ``surge:kn`` (in knots)."""
    if source in _TEXTS:
        return _TEXTS[source]()
    role, _, unit = source.partition(":")
    return [f"{_FACTORS[unit] * v:.8f}".replace(".", decimal) for v in motion()[role]]


def table(columns, separator=",", decimal=".", units=None, before=()):
    """Text of a table of (header, source, ...) and perhaps a row of units."""
    rows = zip(*(texts_of(source, decimal) for _, source, *_ in columns), strict=True)
    heads = [separator.join(name for name, *_ in columns)]
    heads += [separator.join(units)] if units else []
    return "\n".join([*before, *heads, *map(separator.join, rows)]) + "\n"


def _plain(text):
    """Columns of lines ``header | source | role``; the role is left out for none, ``?role`` is to be asked."""
    return [tuple(part.strip() for part in line.split("|")) for line in text.strip().splitlines()]


_COMMA = {"separator": ";", "decimal": ","}
TABLES = {
    "CF names and units": (
        """time [seconds since 2024-03-14 09:26:00] | time | time
        lat [degrees_north] | latitude | latitude
        lon [degrees_east] | longitude | longitude
        platform_orientation [degree] | heading | heading
        platform_yaw_rate [degree s-1] | yaw_rate | yaw_rate
        platform_speed_wrt_ground [m s-1] | speed_over_ground | speed_over_ground
        platform_course [degree] | course_over_ground | course_over_ground
        relative_platform_azimuth [degree] | wind_from |""",
        {},
    ),
    "CF with plain names": (
        """time (s) | time | time
        latitude (degrees_north) | latitude | latitude
        longitude (degrees_east) | longitude | longitude
        heading (degree) | heading | heading
        yaw_rate (degree s-1) | yaw_rate | yaw_rate
        speed_over_ground (m s-1) | speed_over_ground | speed_over_ground
        course_over_ground (degrees) | course_over_ground | course_over_ground""",
        {},
    ),
    "DP export, decimal comma": (
        """Time | german | time
        Latitude | lat' | latitude
        Longitude | lon' | longitude
        Heading [deg] | heading | heading
        Rate of turn [deg/min] | yaw_rate:/min | yaw_rate
        BT1 RPM | bow1_rpm | bow1_rpm
        BT2 RPM | bow2_rpm | bow2_rpm
        Az PS rpm | port_rpm | port_rpm
        Az PS azimuth | port_azimuth | port_azimuth
        Az SB rpm | starboard_rpm | starboard_rpm
        Az SB azimuth | starboard_azimuth | starboard_azimuth""",
        _COMMA,
    ),
    "thrusters in full words": (
        """Timestamp | iso | time
        Gyro Heading | heading | heading
        PS Azimuth RPM | port_rpm | port_rpm
        STBD Azimuth RPM | starboard_rpm | starboard_rpm
        Azimuth Angle Port | port_azimuth | port_azimuth
        Starboard Azimuth Angle | starboard_azimuth | starboard_azimuth
        Bow Thruster 1 RPM | bow1_rpm | bow1_rpm
        RPM Bow Thruster No. 2 | bow2_rpm | bow2_rpm""",
        {},
    ),
    "thrusters with feedback words": (
        """time | time | time
        heading | heading | heading
        AZ_PS_RPM_FB | port_rpm | port_rpm
        AZ_PS_RPM_SP | starboard_rpm |
        AZ_STBD_RPM_FB | starboard_rpm | starboard_rpm
        AZ_PS_ANGLE_FB | port_azimuth | port_azimuth
        AZ_STBD_ANGLE_FB | starboard_azimuth | starboard_azimuth
        BT_1_RPM_FB | bow1_rpm | bow1_rpm
        BT_2_RPM_FB | bow2_rpm | bow2_rpm""",
        {},
    ),
    "thrusters by number alone": (
        """time | time | time
        heading | heading | heading
        Thr1 RPM | bow1_rpm | ?bow1_rpm
        Thr2 RPM | bow2_rpm | ?bow2_rpm
        Thr3 RPM | port_rpm | ?port_rpm
        Thr4 RPM | starboard_rpm | ?starboard_rpm""",
        {},
    ),
    "thruster 1 and 2 alone": (
        """time | time | time
        heading | heading | heading
        T1_rpm | port_rpm |
        T2_rpm | starboard_rpm |""",
        {},
    ),
    "propellers by number": (
        """time | time | time
        heading | heading | heading
        rpm1 | port_rpm | ?bow1_rpm
        rpm2 | starboard_rpm | ?bow2_rpm""",
        {},
    ),
    "two header rows": (
        """Date Time | slashes | time
        LAT | latitude | latitude
        LON | longitude | longitude
        HDG | heading | heading
        SOG | speed_over_ground:kn | speed_over_ground
        COG | course_over_ground | course_over_ground
        ROT | yaw_rate:/min | yaw_rate""",
        {"units": ["UTC", "deg", "deg", "deg T", "knots", "deg T", "deg/min"]},
    ),
    "two header rows, CF": (
        """time | secs | time
        latitude | latitude | latitude
        longitude | longitude | longitude
        heading | heading | heading
        rate of turn | yaw_rate | yaw_rate
        relative wind speed | wind_speed | wind_speed
        relative wind direction | wind_from | wind_from""",
        {
            "units": [
                "s",
                "degrees_north",
                "degrees_east",
                "degree",
                "degree s-1",
                "m s-1",
                "degree",
            ]
        },
    ),
    "two header rows in brackets, tabs": (
        """Time | time | time
        Heading | heading | heading
        Surge speed | surge:kn | surge
        Sway speed | sway:kn | sway
        Port main propeller | port_rpm | port_rpm
        Stbd main propeller | starboard_rpm | starboard_rpm""",
        {"separator": "\t", "units": ["[s]", "[deg]", "[kn]", "[kn]", "[rpm]", "[rpm]"]},
    ),
    "Norwegian": (
        """Tid | german | time
        Breddegrad | latitude | latitude
        Lengdegrad | longitude | longitude
        Kurs over grunn [grader] | course_over_ground | course_over_ground
        Fart over grunn [knop] | speed_over_ground:kn | speed_over_ground
        Heading [grader] | heading | heading
        Svinghastighet [grader/s] | yaw_rate | yaw_rate
        Relativ vindhastighet [m/s] | wind_speed | wind_speed
        Relativ vindretning [grader] | wind_from | wind_from
        Turtall babord [o/min] | port_rpm | port_rpm
        Turtall styrbord [o/min] | starboard_rpm | starboard_rpm""",
        _COMMA,
    ),
    "Norwegian, plain words": (
        """Tidspunkt | iso | time
        Bredde | latitude | latitude
        Lengde | longitude | longitude
        Kurs | course_over_ground |
        Fart | speed_over_ground:kn |
        Vindstyrke | wind_speed | ?wind_speed
        Vindretning | wind_from | ?wind_from
        Kompasskurs | heading | ?heading
        Turtall BB | port_rpm | port_rpm
        Turtall SB | starboard_rpm | starboard_rpm""",
        {},
    ),
    "German": (
        """Zeit | german | time
        Breite [°] | latitude | latitude
        Länge [°] | longitude | longitude
        Fahrt über Grund [kn] | speed_over_ground:kn | speed_over_ground
        Kurs über Grund [°] | course_over_ground | course_over_ground
        Rechtweisender Kurs [°] | heading | heading
        Drehrate [°/min] | yaw_rate:/min | yaw_rate
        Scheinbare Windgeschwindigkeit [m/s] | wind_speed | wind_speed
        Scheinbarer Windwinkel [°] | wind_from | wind_from
        Drehzahl Backbord [1/min] | port_rpm | port_rpm
        Drehzahl Steuerbord [1/min] | starboard_rpm | starboard_rpm""",
        _COMMA,
    ),
    "German, plain words": (
        """Datum/Uhrzeit | german | time
        Geschwindigkeit [kn] | speed_over_ground:kn |
        Kurs [°] | course_over_ground |
        Steuerkurs [°] | heading | ?heading
        Windgeschwindigkeit [m/s] | wind_speed | ?wind_speed
        Windrichtung [°] | wind_from | ?wind_from""",
        _COMMA,
    ),
    "Japanese": (
        """時刻 | slashes | time
        緯度 | latitude | latitude
        経度 | longitude | longitude
        対地速力[kn] | speed_over_ground:kn | speed_over_ground
        対地針路[deg] | course_over_ground | course_over_ground
        船首方位[deg] | heading | heading
        回頭角速度[deg/s] | yaw_rate | yaw_rate
        相対風速[m/s] | wind_speed | wind_speed
        相対風向[deg] | wind_from | wind_from
        左舷プロペラ回転数[rpm] | port_rpm | port_rpm
        右舷プロペラ回転数[rpm] | starboard_rpm | starboard_rpm""",
        {},
    ),
    "Japanese, plain words": (
        """日時 | slashes | time
        船速(kn) | speed_over_ground:kn |
        針路 | course_over_ground |
        風速(m/s) | wind_speed | ?wind_speed
        風向(deg) | wind_from | ?wind_from
        船首方位(deg) | heading | heading""",
        {},
    ),
    "bag to CSV": (
        """Time | secs | ?time
        header.seq | count |
        header.stamp.secs | secs | time
        header.stamp.nsecs | nsecs |
        header.frame_id | count |
        pose.pose.position.x | east | ?east
        pose.pose.position.y | north | ?north
        pose.pose.position.z | zero |
        pose.pose.orientation.x | zero | 
        twist.twist.linear.x | surge | ?surge
        twist.twist.linear.y | sway:- | ?sway
        twist.twist.angular.z | yaw_rate:rad |""",
        {},
    ),
    "rostopic echo": (
        """%time | ns | time
        field.header.seq | count |
        field.header.stamp | ns |
        field.latitude | latitude | latitude
        field.longitude | longitude | longitude
        field.altitude | zero |
        field.position_covariance0 | zero |""",
        {},
    ),
    "Signal K": (
        """timestamp | iso | time
        navigation.position.latitude | latitude | latitude
        navigation.position.longitude | longitude | longitude
        navigation.headingTrue (rad) | heading:rad | heading
        navigation.speedOverGround (m/s) | speed_over_ground | speed_over_ground
        navigation.courseOverGroundTrue (rad) | course_over_ground:rad | course_over_ground
        navigation.rateOfTurn (rad/s) | yaw_rate:rad | yaw_rate
        environment.wind.speedApparent (m/s) | wind_speed | wind_speed
        environment.wind.angleApparent (rad) | wind_from:rad | wind_from
        propulsion.port.revolutions (Hz) | port_rpm:Hz | port_rpm
        propulsion.starboard.revolutions (Hz) | starboard_rpm:Hz | starboard_rpm""",
        {},
    ),
    "a DP system's own log": (
        """time [s] | time | time
        DP Pos North (m) | north | north
        DP Pos East (m) | east | east
        Gyro 1 (deg) | heading | heading
        Surge Speed (kn) | surge:kn | surge
        Sway Speed (kn) | sway:kn | sway
        Azi Port RPM FB (rpm) | port_rpm | port_rpm
        Azi Port Dir FB (deg) | port_azimuth | port_azimuth""",
        {},
    ),
    "SAMOS": (
        """time [s] | time | time
        lat [degrees (+N)] | latitude | latitude
        lon [degrees (+E)] | longitude | longitude
        PL_HD [degrees (clockwise from true north)] | heading | heading
        PL_CRS [degrees (clockwise towards true north)] | course_over_ground | course_over_ground
        PL_SPD [meters/second] | speed_over_ground | speed_over_ground
        PL_WDIR [degrees (clockwise from bow)] | wind_from | wind_from
        PL_WSPD [meters/second] | wind_speed | wind_speed""",
        {},
    ),
    "one name in two units": (
        """Date/Time (UTC) | slashes | time
        Lat [°N] | latitude | latitude
        Lon [°E] | longitude | longitude
        Hdg [°T] | heading | heading
        Port Azi [rpm] | port_rpm | port_rpm
        Port Azi [°] | port_azimuth | port_azimuth
        Stbd Azi [rpm] | starboard_rpm | starboard_rpm
        Stbd Azi [°] | starboard_azimuth | starboard_azimuth""",
        {},
    ),
    "Signal K without units": (
        """timestamp | iso | time
        navigation.headingTrue | heading:rad | heading
        navigation.position.latitude | latitude | latitude
        navigation.position.longitude | longitude | longitude
        navigation.speedOverGround | speed_over_ground | speed_over_ground
        navigation.courseOverGroundTrue | course_over_ground:rad | course_over_ground
        propulsion.port.revolutions | port_rpm:Hz | port_rpm
        propulsion.starboard.revolutions | starboard_rpm:Hz | starboard_rpm""",
        {},
    ),
    "wind over ground named with its frame": (
        """time | time | time
        heading | heading | heading
        True Wind Speed [kn] | true_wind_speed:kn | true_wind_speed
        True Wind Direction [deg] | true_wind_from | true_wind_from
        Relative Wind Speed [kn] | wind_speed:kn | wind_speed
        Relative Wind Dir [deg] | wind_from | wind_from""",
        {},
    ),
    "tags of an open format": (
        """timestamp | iso | time
        positioningsystem_latitude_deg_1 | latitude | latitude
        positioningsystem_longitude_deg_1 | longitude | longitude
        positioningsystem_sog_mps_1 | speed_over_ground | speed_over_ground
        positioningsystem_cog_deg_1 | course_over_ground | course_over_ground
        gyro_heading_deg_1 | heading | heading
        anemometer_aws_mps | wind_speed | wind_speed
        anemometer_awa_deg | wind_from | wind_from
        azimuththruster_speed_rpm_1 | port_rpm | ?port_rpm
        azimuththruster_angle_deg_1 | port_azimuth | ?port_azimuth
        azimuththruster_speed_rpm_2 | starboard_rpm | ?starboard_rpm
        tunnelthruster_power_kw_1 | port_rpm |""",
        {},
    ),
    "a vessel's own report": (
        """Date | date | 
        UTC Time | clock | time
        Vessel Latitude (deg) | latitude | latitude
        Vessel Longitude (deg) | longitude | longitude
        Vessel Heading (deg) | heading | heading
        Heading Setpoint (deg) | course_over_ground |
        Surge Deviation (m) | surge |
        Wind Speed 1 (m/s) | wind_speed | ?wind_speed
        Wind Direction 1 (deg) | wind_from | ?wind_from
        Thruster 1 Force (kN) | port_rpm |
        Power Consumption (kW) | port_rpm |""",
        {},
    ),
    "places within other places": (
        """time | time | time
        heading | heading | heading
        BT PS rpm | bow1_rpm | ?port_rpm
        BT SB rpm | bow2_rpm | ?starboard_rpm
        Tunnel Thruster Aft rpm | bow2_rpm |
        ME PORT SPEED | port_rpm | ?port_rpm
        Starboard pump rpm | starboard_rpm |
        Radar Target Course | heading |
        AIS heading | course_over_ground |
        Gyro deviation | yaw_rate |""",
        {},
    ),
    "set points in other languages": (
        """Zeit | iso | time
        Kreiselkompass | heading | heading
        Sollkurs | course_over_ground |
        船首方位設定 | course_over_ground |
        Settpunkt kurs | course_over_ground |
        Fahrt durchs Wasser [kn] | surge |
        対水速力[kn] | surge |
        Hovedpropell BB turtall | port_rpm | port_rpm
        Drehzahl SB | starboard_rpm | starboard_rpm
        Bugstrahlruder 2 Drehzahl | bow2_rpm | bow2_rpm
        バウスラスタ1回転数 | bow1_rpm | bow1_rpm""",
        {},
    ),
    "groups above names and units": (
        """Time | slashes | time
        Heading | heading | heading
        RPM | port_rpm | port_rpm
        Angle | port_azimuth | port_azimuth
        RPM | starboard_rpm | starboard_rpm
        Angle | starboard_azimuth | starboard_azimuth""",
        {
            "units": ["", "deg", "rpm", "deg", "rpm", "deg"],
            "before": [",Gyro,Az PS,,Az SB,"],
        },
    ),
    "degrees and minutes in columns of their own": (
        """time | time | time
        heading | heading | heading
        Lat deg | latitude | ?latitude
        Lat min | latitude |
        Lon deg | longitude | ?longitude
        Lon min | longitude |""",
        {},
    ),
    "a water current beside the course": (
        """time | time | time
        COG | course_over_ground | course_over_ground
        Current Speed [kn] | speed_over_ground:kn | ?speed_over_ground
        Current Direction [deg] | heading |
        heading | heading | heading""",
        {},
    ),
    "topics in one table": (
        """__time | secs | time
        /gps/fix/latitude | latitude | latitude
        /gps/fix/longitude | longitude | longitude
        /imu/angular_velocity/z | yaw_rate:rad | ?yaw_rate
        /odom/pose/pose/position/x | east |
        /cmd_vel/linear/x | surge |
        /thruster/port/rpm/data | port_rpm | port_rpm
        /thruster/starboard/cmd/data | starboard_rpm |""",
        {},
    ),
    "set points alone": (
        """time | time | time
        heading | heading | heading
        heading setpoint | course_over_ground |
        Desired surge speed | surge |
        Ref latitude | latitude |
        Port RPM order | port_rpm | port_rpm
        Stbd RPM order | starboard_rpm | starboard_rpm""",
        {},
    ),
    "words within other words": (
        """time | time | time
        heading | heading | heading
        latitude | latitude | latitude
        longitude | longitude | longitude
        Crane Wire Speed [m/s] | surge |
        Target SOG | speed_over_ground |
        Target COG | course_over_ground |
        Current Speed [kn] | speed_over_ground:kn |
        Current Direction [deg] | course_over_ground |
        Wave Heading [deg] | true_wind_from |
        ROV Heading [deg] | true_wind_from |
        Engine Room Fan Port RPM | port_rpm |
        Shaft Generator RPM | starboard_rpm |""",
        {},
    ),
}
