"""Forty logs as they come: one real motion, written in forty ways that loggers and people have."""

from __future__ import annotations

import gzip
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import pandas

from shipcosim.diagnose.log.degree_size import metres_per_degree

ROOT = Path(__file__).resolve().parents[4]
TRIALS = ROOT.parent / "shared" / "measured" / "gunnerus_trials_2022" / "trials.csv"
EXAMPLE = ROOT / "docs" / "examples" / "gunnerus_log.csv.gz"
THRUSTERS = {"port": ("rpm", "azimuth"), "starboard": ("rpm", "azimuth"), "tunnel": ("rpm",)}
UNITS = {
    "time": "s",
    "north": "m",
    "east": "m",
    "heading": "deg",
    "surge": "m/s",
    "sway": "m/s",
    "yaw_rate": "deg/s",
}
UNITS |= {
    "port_rpm": "rpm",
    "starboard_rpm": "rpm",
    "port_azimuth": "deg",
    "starboard_azimuth": "deg",
}
START = datetime(2022, 10, 27, 23, 57, 30)
KNOT = 1852.0 / 3600.0
CASES = {}


def truth():
    """The motion, by roles: full-scale trials where they are beside the project, else the example log."""
    if TRIALS.is_file():
        rows = pandas.read_csv(TRIALS).iloc[3000:3600]
        names = {
            "north": "N",
            "east": "E",
            "heading": "psi",
            "surge": "u",
            "sway": "v",
            "yaw_rate": "r",
        }
        table = {role: rows[name].to_numpy() for role, name in names.items()}
        table = {"time": rows["tvec"].to_numpy() - rows["tvec"].iloc[0]} | table
        for side in ("port", "starboard"):
            table |= {
                f"{side}_rpm": rows["RPM"].to_numpy(),
                f"{side}_azimuth": rows["Azi"].to_numpy(),
            }
        table["heading"] = np.mod(table["heading"], 360.0)
        table["starboard_rpm"] = table["starboard_rpm"] + 2.0
        return table
    with gzip.open(EXAMPLE, "rt") as file:
        rows = pandas.read_csv(file).iloc[:600]
    rows.columns = [name.partition(" [")[0] for name in rows.columns]
    return {role: rows[role].to_numpy(float) for role in UNITS}


def case(function):
    CASES[function.__name__] = function
    return function


def number(value):
    return f"{value:.7g}" if np.isfinite(value) else ""


def cells(table, digits="{:.7g}"):
    """The table as texts, by `name [unit]`."""
    return {f"{n} [{UNITS[n]}]": [digits.format(v) for v in values] for n, values in table.items()}


def lines(columns, separator=","):
    rows = zip(*columns.values(), strict=True)
    return [separator.join(columns), *(separator.join(row) for row in rows)]


def save(folder, text, name="log.csv", encoding="utf-8"):
    path = folder / name
    path.write_bytes((text if isinstance(text, str) else "\n".join(text) + "\n").encode(encoding))
    return path


def renamed(table, names, drop=()):
    """Columns under other headers, as texts; those of `drop` are not there."""
    return {
        names.get(r, r): [number(v) for v in values] for r, values in table.items() if r not in drop
    }


def stamps(table, form, cut=0):
    moments = [START + timedelta(seconds=float(t)) for t in table["time"]]
    return [m.strftime(form)[: -cut or None] for m in moments]


def with_time(table, header, texts, **names):
    plain = renamed(table, names, drop=("time",))
    return {header: texts, **plain}


def on_earth(table):
    """Latitude and longitude of the motion, south and west of zero. [deg]"""
    origin = (table["north"][0], table["east"][0])
    meridian, parallel = metres_per_degree(-33.9)
    return -33.9 + (table["north"] - origin[0]) / meridian, -18.4 + (
        table["east"] - origin[1]
    ) / parallel


@case
def semicolons(table, folder):
    return save(folder, lines(cells(table), ";"))


@case
def tabs(table, folder):
    return save(folder, lines(cells(table), "\t"), "log.txt")


@case
def several_blanks(table, folder):
    columns = {name.replace(" ", ""): values for name, values in cells(table).items()}
    width = [max(len(name), *map(len, values)) + 2 for name, values in columns.items()]
    rows = [columns, *zip(*columns.values(), strict=True)]
    return save(
        folder,
        ["".join(c.rjust(w) for c, w in zip(r, width, strict=True)) for r in rows],
        "log.dat",
    )


@case
def decimal_comma_between_semicolons(table, folder):
    return save(folder, [line.replace(".", ",") for line in lines(cells(table), ";")])


@case
def decimal_comma_between_tabs(table, folder):
    columns = {name: [v.replace(".", ",") for v in values] for name, values in cells(table).items()}
    return save(folder, lines(columns, "\t"), "log.tsv")


@case
def decimal_comma_in_quotes(table, folder):
    columns = {
        name: [f'"{v.replace(".", ",")}"' for v in values] for name, values in cells(table).items()
    }
    return save(folder, lines(columns, ","))


@case
def thousands_grouped(table, folder):
    columns = cells(table, "{:,.5f}")
    return save(folder, lines(columns, ";"))


@case
def units_in_a_second_row(table, folder):
    names = lines(renamed(table, {}))
    return save(folder, [names[0], ",".join(UNITS[name] for name in table), *names[1:]])


@case
def units_in_parentheses(table, folder):
    return save(
        folder,
        lines(
            renamed(
                table | {"surge": table["surge"] / KNOT},
                {"surge": "surge (knots)"}
                | {role: f"{role} ({unit})" for role, unit in UNITS.items() if role != "surge"},
            )
        ),
    )


@case
def units_after_an_underscore(table, folder):
    names = {"time": "time_ms", "heading": "heading_rad", "surge": "surge_kn", "sway": "sway_m_s"}
    names |= {"yaw_rate": "yaw_rate_rad_s", "north": "north_m", "east": "east_m"}
    told = table | {"time": 1e3 * table["time"], "heading": np.radians(table["heading"])}
    told |= {"surge": table["surge"] / KNOT, "yaw_rate": np.radians(table["yaw_rate"])}
    return save(folder, lines(renamed(told, names)))


@case
def units_in_other_spellings(table, folder):
    names = {
        "time": "Time [sec]",
        "heading": "Heading [°]",
        "surge": "Surge [kts]",
        "sway": "Sway [m s-1]",
    }
    names |= {"yaw_rate": "ROT [°/min]", "north": "North [metres]", "port_rpm": "Port RPM [1/min]"}
    told = table | {"surge": table["surge"] / KNOT, "yaw_rate": 60.0 * table["yaw_rate"]}
    return save(folder, lines(renamed(told, names)))


@case
def header_in_a_comment(table, folder):
    rows = lines(cells(table), " ")
    head = "# " + " ".join(name.replace(" ", "") for name in cells(table))
    return save(folder, ["# logger 4.2", "# R/V", head, *rows[1:]], "log.txt")


@case
def lines_before_the_header(table, folder):
    before = [
        "Vessel: Gunnerus",
        "Date: 27.10.2022, 23:57",
        "Rate, 2 Hz",
        "",
        "Operator: A. B., C. D.",
    ]
    return save(folder, [*before, *lines(cells(table))])


@case
def comments_between_rows(table, folder):
    rows = lines(cells(table))
    return save(
        folder, [*rows[:100], "# turn begins", *rows[100:200], "", "# turn ends", *rows[200:]]
    )


@case
def words_for_nothing(table, folder):
    columns = cells(table)
    for i, word in enumerate(("N/A", "null", "---", "#N/A", "NaN", "-", "Missing")):
        columns["surge [m/s]"][10 + i] = word
    return save(folder, lines(columns))


@case
def upper_case(table, folder):
    return save(
        folder,
        [line.upper() if i == 0 else line for i, line in enumerate(lines(renamed(table, {})))],
    )


@case
def latin_1(table, folder):
    names = {
        "heading": "Heading (°)",
        "port_azimuth": "Azimuth Port (°)",
        "starboard_azimuth": "Azimuth Stbd (°)",
    }
    return save(folder, lines(renamed(table, names)), encoding="latin-1")


@case
def utf_16(table, folder):
    return save(folder, lines(cells(table), "\t"), "log.txt", "utf-16")


@case
def byte_order_mark(table, folder):
    return save(folder, "\ufeffsep=;\r\n" + "\r\n".join(lines(cells(table), ";")) + "\r\n")


@case
def excel(table, folder):
    frame = pandas.DataFrame({f"{n} [{UNITS[n]}]": v for n, v in table.items()})
    frame.to_excel(folder / "log.xlsx", index=False)
    return folder / "log.xlsx"


@case
def excel_with_dates_on_the_second_sheet(table, folder):
    frame = pandas.DataFrame({n: v for n, v in table.items() if n != "time"})
    frame.insert(0, "Date/Time", [START + timedelta(seconds=float(t)) for t in table["time"]])
    with pandas.ExcelWriter(folder / "log.xlsx") as book:
        pandas.DataFrame({"Vessel": ["Gunnerus"], "Rate": [2]}).to_excel(
            book, sheet_name="About", index=False
        )
        frame.to_excel(book, sheet_name="Data", index=False)
    return folder / "log.xlsx"


@case
def dates_with_slashes(table, folder):
    return save(
        folder, lines(with_time(table, "Date Time", stamps(table, "%d/%m/%Y %H:%M:%S.%f", 3)))
    )


@case
def american_dates(table, folder):
    texts = [
        f"{d} {h}"
        for d, h in zip(stamps(table, "%m/%d/%Y"), stamps(table, "%I:%M:%S.%f %p"), strict=True)
    ]
    return save(folder, lines(with_time(table, "Timestamp", texts)))


@case
def iso_with_a_zone(table, folder):
    return save(
        folder, lines(with_time(table, "timestamp", stamps(table, "%Y-%m-%dT%H:%M:%S.%f+02:00")))
    )


@case
def german_dates(table, folder):
    columns = with_time(table, "Zeit", stamps(table, "%d.%m.%Y %H:%M:%S,%f", 3))
    columns = {
        n: [v.replace(".", ",") if n != "Zeit" else v for v in values]
        for n, values in columns.items()
    }
    return save(folder, lines(columns, ";"))


@case
def epoch_in_ms(table, folder):
    texts = [f"{1666915050000 + 1000 * t:.0f}" for t in table["time"]]
    return save(folder, lines(with_time(table, "epoch", texts)))


@case
def ros_in_ns(table, folder):
    texts = [str(1666915050000000000 + int(1e9 * t)) for t in table["time"]]
    names = {
        "surge": "twist.surge",
        "sway": "twist.sway",
        "yaw_rate": "twist.yaw_rate",
        "heading": "pose.heading",
    }
    return save(folder, lines(with_time(table, "%time", texts, **names)))


@case
def ros_seconds_and_nanoseconds(table, folder):
    seconds = [str(1666915050 + int(t)) for t in table["time"]]
    rest = [str(int(round(1e9 * (t % 1.0)))) for t in table["time"]]
    plain = renamed(table, {}, drop=("time",))
    return save(folder, lines({"header.stamp.secs": seconds, "header.stamp.nsecs": rest, **plain}))


@case
def clock_past_midnight(table, folder):
    return save(folder, lines(with_time(table, "Clock", stamps(table, "%H:%M:%S.%f", 4))))


@case
def date_and_clock_apart(table, folder):
    columns = {"Date": stamps(table, "%d/%m/%y"), "Time": stamps(table, "%H:%M:%S.%f", 4)}
    return save(folder, lines(columns | renamed(table, {}, drop=("time",))))


@case
def nmea_with_hemispheres(table, folder):
    columns = renamed(table, {}, drop=("north", "east"))
    for name, degrees, sides in zip(("Lat", "Lon"), on_earth(table), ("NS", "EW"), strict=True):
        size = np.abs(degrees)
        columns[name] = [f"{int(d) * 100 + d % 1 * 60:.6f}" for d in size]
        columns[sides[0] + "/" + sides[1]] = [sides[1] if d < 0 else sides[0] for d in degrees]
    return save(folder, lines(columns))


@case
def positions_in_degrees_and_minutes(table, folder):
    columns = renamed(table, {}, drop=("north", "east"))
    for name, degrees, sides in zip(
        ("Latitude", "Longitude"), on_earth(table), ("NS", "EW"), strict=True
    ):
        columns[name] = [
            f"{int(abs(d))}° {abs(d) % 1 * 60:.6f}' {sides[int(d < 0)]}" for d in degrees
        ]
    return save(folder, lines(columns, ";"))


def with_quaternion(table, yaw):
    half = np.radians(yaw) / 2.0
    columns = renamed(table, {}, drop=("heading",))
    zero = np.zeros(len(half))
    parts = {"x": zero, "y": zero, "z": np.sin(half), "w": np.cos(half)}
    return columns | {
        f"orientation.{k}": [f"{v:.9f}" for v in values] for k, values in parts.items()
    }


@case
def quaternion(table, folder):
    return save(folder, lines(with_quaternion(table, table["heading"])))


@case
def speed_and_course_over_ground(table, folder):
    velocity = (table["surge"] + 1j * table["sway"]) * np.exp(1j * np.radians(table["heading"]))
    columns = renamed(table, {"heading": "HDT"}, drop=("surge", "sway"))
    columns["SOG [kn]"] = [f"{v:.8f}" for v in np.abs(velocity) / KNOT]
    columns["COG"] = [f"{v:.7f}" for v in np.mod(np.degrees(np.angle(velocity)), 360.0)]
    return save(folder, lines(columns))


@case
def velocities_north_and_east(table, folder):
    velocity = (table["surge"] + 1j * table["sway"]) * np.exp(1j * np.radians(table["heading"]))
    columns = renamed(table, {}, drop=("surge", "sway"))
    columns["v_north (m/s)"] = [f"{v:.9f}" for v in velocity.real]
    columns["v_east (m/s)"] = [f"{v:.9f}" for v in velocity.imag]
    return save(folder, lines(columns))


@case
def pulses_beside_the_motion(table, folder):
    columns = renamed(table, {}, drop=("port_rpm", "starboard_rpm"))
    columns["thr_port_pwm"] = [f"{1500 + v:.0f}" for v in table["port_rpm"]]
    columns["Stbd throttle [%]"] = [f"{v / 3:.1f}" for v in table["starboard_rpm"]]
    return save(folder, lines(columns))


@case
def command_beside_feedback(table, folder):
    columns = renamed(table, {"port_rpm": "port_rpm_fb", "starboard_rpm": "stbd rpm measured"})
    columns["port_rpm_cmd"] = [number(v + 10) for v in table["port_rpm"]]
    columns["stbd rpm order"] = [number(v - 10) for v in table["starboard_rpm"]]
    return save(folder, lines(columns))


@case
def one_value_a_row(table, folder):
    rows = ["timestamp;topic;value"]
    for i, t in enumerate(table["time"]):
        rows += [
            f"{t};{name};{number(values[i])}" for name, values in table.items() if name != "time"
        ]
    return save(folder, rows)


@case
def one_sensor_a_row(table, folder):
    groups = [("north", "east"), ("heading", "yaw_rate"), ("surge", "sway")]
    groups += [("port_rpm", "port_azimuth", "starboard_rpm", "starboard_azimuth")]
    rows = [",".join(table)]
    for i, t in enumerate(table["time"]):
        for k, group in enumerate(groups):
            later = [name if name == "time" or name in group else None for name in table]
            rows.append(
                ",".join(
                    ""
                    if n is None
                    else f"{t + 0.001 * k:.3f}"
                    if n == "time"
                    else number(table[n][i])
                    for n in later
                )
            )
    return save(folder, rows)


@case
def short_names_of_the_bridge(table, folder):
    names = {
        "time": "t",
        "heading": "HDG",
        "yaw_rate": "ROT",
        "port_rpm": "ptside_RPM",
        "port_azimuth": "bb azi",
    }
    names |= {
        "starboard_rpm": "stbd_rpm",
        "starboard_azimuth": "SB_AZI",
        "north": "Northing",
        "east": "Easting",
    }
    return save(folder, lines(renamed(table | {"yaw_rate": 60.0 * table["yaw_rate"]}, names)))


@case
def letters_of_the_textbook(table, folder):
    names = {
        "time": "t",
        "north": "N",
        "east": "E",
        "heading": "psi",
        "surge": "u",
        "sway": "v",
        "yaw_rate": "r",
    }
    told = table | {"yaw_rate": np.radians(table["yaw_rate"])}
    return save(folder, lines(renamed(told, names)))


@case
def names_twice_and_a_column_without_a_value(table, folder):
    rows = lines(cells(table))
    text = [rows[0] + ",status,status,roll [deg]", *(f"{row},1,0," for row in rows[1:])]
    return save(folder, text)


@case
def a_restart_and_a_line_cut_off(table, folder):
    rows = lines(cells(table))
    return save(
        folder, "\n".join([*rows[:300], rows[0], *rows[300:], rows[-1][: len(rows[-1]) // 2]])
    )


SAID = {"pulses_beside_the_motion": {"port_rpm", "starboard_rpm"}}
"""Case: roles that cannot be read, and must be said."""
