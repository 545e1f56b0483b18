"""Further forms of logs, thought of after the forty were read: what a stranger's logger may write."""

from __future__ import annotations

from datetime import timedelta

import numpy as np
from diagnose.log.oddities import (
    START,
    UNITS,
    cells,
    lines,
    number,
    on_earth,
    renamed,
    save,
    stamps,
    with_time,
)

STRANGE = {}


def strange(function):
    STRANGE[function.__name__] = function
    return function


@strange
def groups_above_the_names(table, folder):
    groups = ["Clock", "Position", "", "Gyro", "DVL", "", "", *["Thrusters"] * (len(table) - 7)]
    return save(folder, [",".join(groups), *lines(cells(table))])


@strange
def units_in_the_cells(table, folder):
    columns = {
        role: [f"{number(v)} {UNITS[role]}" for v in values] for role, values in table.items()
    }
    return save(folder, lines(columns, ";"))


@strange
def a_number_for_nothing(table, folder):
    columns = cells(table)
    for name in ("surge [m/s]", "heading [deg]", "north [m]"):
        columns[name][40:60] = ["-9999"] * 20
    return save(folder, lines(columns))


@strange
def degrees_times_ten_million(table, folder):
    columns = renamed(table, {}, drop=("north", "east"))
    for name, degrees in zip(("lat", "lon"), on_earth(table), strict=True):
        columns[name] = [f"{1e7 * d:.0f}" for d in degrees]
    return save(folder, lines(columns))


@strange
def an_index_of_pandas(table, folder):
    count = [str(i) for i in range(len(table["time"]))]
    return save(folder, lines({"Unnamed: 0": count} | cells(table)))


@strange
def quotes_around_everything(table, folder):
    rows = lines(cells(table), ";")
    return save(folder, [";".join(f'"{cell}"' for cell in row.split(";")) + ";" for row in rows])


@strange
def months_in_letters(table, folder):
    texts = [text.upper() for text in stamps(table, "%d-%b-%Y %H:%M:%S.%f", 3)]
    return save(folder, lines(with_time(table, "TIME", texts)))


@strange
def days_of_a_spreadsheet(table, folder):
    day = (START - timedelta(days=25569)).timestamp() - (START.timestamp() - 25569 * 86400.0)
    texts = [f"{44861.998263889 + day + t / 86400.0:.10f}" for t in table["time"]]
    return save(folder, lines(with_time(table, "Date Time", texts)))


@strange
def carriage_returns_only(table, folder):
    return save(folder, "\r".join(lines(cells(table))) + "\r")


@strange
def axes_and_angles_of_ros(table, folder):
    names = {
        "time": "Time",
        "surge": "twist.linear.x",
        "sway": "y_left",
        "yaw_rate": "twist.angular.z",
    }
    told = table | {"north": table["east"], "east": table["north"], "sway": -table["sway"]}
    told |= {
        "heading": np.mod(90.0 - table["heading"] + 180.0, 360.0) - 180.0,
        "yaw_rate": -table["yaw_rate"],
    }
    names |= {
        "heading": "yaw [deg]",
        "north": "pose.position.x",
        "east": "pose.position.y",
        "sway": "twist.linear.y",
    }
    return save(folder, lines(renamed(told, names)))


@strange
def date_and_time_between_blanks(table, folder):
    columns = {"date": stamps(table, "%Y-%m-%d"), "time": stamps(table, "%H:%M:%S.%f", 3)}
    return save(folder, lines(columns | renamed(table, {}, drop=("time",)), " "), "log.txt")


@strange
def minutes_and_seconds(table, folder):
    texts = [f"{int(t // 60):02d}:{t % 60:04.1f}" for t in table["time"]]
    return save(folder, lines(with_time(table, "Elapsed", texts)))


@strange
def newest_first(table, folder):
    rows = lines(cells(table))
    return save(folder, [rows[0], *rows[:0:-1]])


@strange
def exponents_of_fortran(table, folder):
    columns = cells(table, "{:.8E}")
    columns = {name: [v.replace("E", "D") for v in values] for name, values in columns.items()}
    return save(
        folder, lines({name.replace(" ", ""): v for name, v in columns.items()}, "  "), "log.dat"
    )


@strange
def a_true_minus(table, folder):
    return save(folder, [line.replace("-", "\u2212") for line in lines(cells(table), ";")])


@strange
def time_last_and_paths_for_names(table, folder):
    names = {role: f"Vessel/Nav/{role.title()}" for role in table}
    columns = renamed(table, names)
    columns["Vessel/Clock/Time"] = columns.pop("Vessel/Nav/Time")
    return save(folder, lines(columns))


@strange
def topic_field_value_and_unit(table, folder):
    topics = {
        "port_rpm": "port",
        "starboard_rpm": "stbd",
        "port_azimuth": "port",
        "starboard_azimuth": "stbd",
    }
    rows = ["stamp,topic,field,value,unit"]
    for i, t in enumerate(table["time"]):
        for role, values in table.items():
            name = role.split("_")[-1] if role in topics else role
            rows += [f"{t},{topics.get(role, 'nav')},{name},{number(values[i])},{UNITS[role]}"] * (
                role != "time"
            )
    return save(folder, rows)


@strange
def two_sensors_of_a_kind(table, folder):
    columns = renamed(
        table,
        {"heading": "Gyro1 Heading [deg]", "north": "GPS1 North [m]", "east": "GPS1 East [m]"},
    )
    return save(
        folder,
        lines(columns | {"Gyro2 Heading [deg]": [number(v + 0.3) for v in table["heading"]]}),
    )


@strange
def side_after_a_number(table, folder):
    columns = renamed(table, {}, drop=("north", "east"))
    for name, degrees, side in zip(("LAT", "LON"), on_earth(table), (" S", "W"), strict=True):
        columns[name] = [f"{-d:.8f}{side}" for d in degrees]
    return save(folder, lines(columns, ";"))


def in_words(table, folder, latitude, longitude, names, separator=","):
    """Positions on the earth and other headings; roles without a heading of their own keep theirs."""
    columns = renamed(table, names, drop=("north", "east"))
    for name, degrees in zip((latitude, longitude), on_earth(table), strict=True):
        columns[name] = [f"{d:.8f}" for d in degrees]
    return save(folder, lines(columns, separator))


@strange
def german_short_forms(table, folder):
    names = {
        "time": "Zeit [s]",
        "heading": "Kurs rw [°]",
        "port_rpm": "Drehzahl BB [U/min]",
        "starboard_rpm": "Drehzahl StB [U/min]",
    }
    return in_words(table, folder, "Breite [°]", "Länge [°]", names, ";")


@strange
def dutch_words(table, folder):
    names = {"time": "Tijd [s]", "heading": "Voorligging [graden]"}
    names |= {"port_rpm": "Toerental bakboord", "starboard_rpm": "Toerental stuurboord"}
    return in_words(table, folder, "Breedtegraad", "Lengtegraad", names)


@strange
def spanish_words(table, folder):
    names = {"time": "Hora [s]", "heading": "Rumbo verdadero (°)"}
    return in_words(table, folder, "Latitud (grados)", "Longitud (grados)", names)


@strange
def french_words(table, folder):
    names = {"time": "Heure [s]", "heading": "Cap (°)"}
    return in_words(table, folder, "Latitude (degrés)", "Longitude (degrés)", names)


@strange
def chinese_words(table, folder):
    return in_words(table, folder, "纬度", "经度", {"time": "时间 [s]", "heading": "船首向(°)"})


@strange
def paths_and_radians_of_signal_k(table, folder):
    drift = np.degrees(np.arctan2(table["sway"], table["surge"]))
    told = {role: v for role, v in table.items() if role not in ("surge", "sway")}
    told |= {
        "heading": np.radians(table["heading"] % 360.0),
        "yaw_rate": np.radians(table["yaw_rate"]),
        "navigation.courseOverGroundTrue": np.radians((table["heading"] + drift) % 360.0),
        "navigation.speedOverGround": np.hypot(table["surge"], table["sway"]),
    }
    names = {"heading": "navigation.headingTrue", "yaw_rate": "navigation.rateOfTurn"}
    place = ("navigation.position.latitude", "navigation.position.longitude")
    return in_words(told, folder, *place, names)


@strange
def days_under_the_name_of_a_clock(table, folder):
    texts = [f"{44861.998263889 + t / 86400.0:.10f}" for t in table["time"]]
    return save(folder, lines(with_time(table, "Utc", texts)))


@strange
def milliseconds_under_a_short_name(table, folder):
    texts = [f"{1666915050000 + 1000.0 * t:.0f}" for t in table["time"]]
    return save(folder, lines(with_time(table, "ts_ms", texts)))


@strange
def units_after_names_of_thrusters(table, folder):
    told = table | {f"{s}_rpm": table[f"{s}_rpm"] / 60.0 for s in ("port", "starboard")}
    names = {"port_rpm": "n_port_rps", "starboard_rpm": "n_stbd_rps"}
    names |= {"port_azimuth": "alpha_port_deg", "starboard_azimuth": "alpha_stbd_deg"}
    return save(folder, lines(renamed(told, names)))


@strange
def speeds_of_engines(table, folder):
    names = {"port_rpm": "ME Port RPM", "starboard_rpm": "ME Stbd RPM"}
    return save(folder, lines(renamed(table, names)))


@strange
def a_gyro_that_counts_to_port(table, folder):
    told = table | {"yaw_rate": -table["yaw_rate"]}
    return save(folder, lines(renamed(told, {"yaw_rate": "gyro_z_dps"})))


@strange
def breadth_and_length_of_the_north(table, folder):
    return in_words(table, folder, "Bredde [°]", "Lengde [°]", {"time": "Tid [s]"}, ";")


@strange
def a_date_and_a_clock_with_one_name(table, folder):
    columns = {"%": stamps(table, "%Y/%m/%d"), "GPST": stamps(table, "%H:%M:%S.%f", 3)}
    rows = lines(columns | renamed(table, {}, drop=("time",)), " ")
    return save(folder, ["% program: post 2.4", rows[0].replace(" [", "["), *rows[1:]], "log.pos")


@strange
def a_true_course_beside_that_over_ground(table, folder):
    drift = np.degrees(np.arctan2(table["sway"], table["surge"]))
    told = {role: v for role, v in table.items() if role not in ("surge", "sway")}
    told["COG [deg]"] = (table["heading"] + drift) % 360.0
    told["SOG [m/s]"] = np.hypot(table["surge"], table["sway"])
    return save(folder, lines(renamed(told, {"heading": "True course [deg]"})))
