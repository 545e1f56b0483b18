"""Headers of recorders and languages that other ships have: each channel is read, or asked, never taken for another."""

from datetime import datetime, timedelta

import numpy as np
import pytest
from diagnose.log.files.test_missing import MOTION, T, log_of
from diagnose.log.oddities import THRUSTERS, save
from openpyxl import Workbook

from shipcosim.diagnose.log.names.proposal import propose
from shipcosim.diagnose.log.reader import columns_of, read_log

START = datetime(2024, 3, 14, 9, 26)
ROWS = 40
CLOCK = [(START + timedelta(seconds=i)).strftime("%d.%m.%Y %H:%M:%S") for i in range(ROWS)]


def used(folder, header, separator=";", encoding="utf-8", before=()):
    """Guess of each column of a log with some header, in which every column but the first counts rows."""
    cells = [[f"{101.0 + 0.01 * i:.2f}".replace(".", ",")] * (len(header) - 1) for i in range(ROWS)]
    rows = [separator.join([clock, *row]) for clock, row in zip(CLOCK, cells, strict=True)]
    path = save(folder, [*before, separator.join(header), *rows], encoding=encoding)
    return {guess.column: guess for guess in propose(columns_of(path), THRUSTERS).used}


LANGUAGES = {
    "French": "Heure|Cap consigne [°]|Cap vrai [°]>heading|Vitesse fond [nd]>speed_over_ground|"
    "Route fond [°]>course_over_ground|Angle vent apparent [°]>wind_from|Régime hélice bâbord [tr/min]>port_rpm|"
    "Régime hélice tribord [tr/min]>starboard_rpm",
    "Spanish": "Hora|Rumbo verdadero [°]?heading|Rumbo efectivo [°]?course_over_ground|"
    "Velocidad sobre el fondo [nudos]>speed_over_ground|Dirección viento aparente [°]>wind_from|"
    "Revoluciones babor [rpm]>port_rpm|Revoluciones estribor [rpm]>starboard_rpm",
    "Portuguese": "Hora|Rumo verdadeiro [graus]?heading|Vento relativo velocidade [nós]>wind_speed|"
    "Vento relativo direção [graus]>wind_from|Rotação bombordo [rpm]>port_rpm|Rotação boreste [rpm]>starboard_rpm",
    "Dutch": "Tijd|Voorliggende koers [°]>heading|Grondkoers [°]>course_over_ground|"
    "Snelheid over de grond [kn]>speed_over_ground|Toerental BB [omw/min]>port_rpm|Toerental SB [omw/min]>starboard_rpm|"
    "Boegschroef toerental>tunnel_rpm",
    "Italian": "Ora|Prua [°]?heading|Giri elica sinistra>port_rpm|Giri elica dritta>starboard_rpm",
    "Korean": "시간|선수방위 [도]>heading|대지속력 [노트]>speed_over_ground|대지침로 [도]>course_over_ground|"
    "좌현 추진기 회전수>port_rpm|우현 추진기 회전수>starboard_rpm|목표 선수방위",
    "Chinese": "时间|艏向(°)>heading|左舷转速>port_rpm|右舷转速>starboard_rpm|"
    "相对风速(m/s)>wind_speed|相对风向(°)>wind_from|目标艏向",
    "Russian": "Время|Курс [град]?heading|Путевая скорость [уз]>speed_over_ground|Путевой угол [град]>course_over_ground|"
    "Скорость ветра относительная [м/с]>wind_speed|Направление ветра относительное [град]>wind_from",
    "Turkish": "Zaman|Gerçek pruva [°]>heading|Yere göre hız [knot]>speed_over_ground|"
    "Yere göre rota [°]>course_over_ground|"
    "Bağıl rüzgar hızı [m/s]>wind_speed|Bağıl rüzgar yönü [°]>wind_from|İskele makine devri [d/d]?port_rpm",
    "Turkish without accents": "Zaman|GERCEK PRUVA>heading|Yere gore hiz [knot]>speed_over_ground|Rota?course_over_ground",
    "Finnish": "Aika|Keulasuunta [ast]>heading|Nopeus pohjan yli [solmua]>speed_over_ground|"
    "Suunta pohjan yli [ast]>course_over_ground|Suhteellinen tuulen nopeus [m/s]>wind_speed|"
    "Kääntymisnopeus [ast/min]>yaw_rate",
    "Swedish without accents": "Klockslag|Sann kurs [grader]?heading|Fart over grund [knop]>speed_over_ground|"
    "Kurs over grund [grader]>course_over_ground|BB propeller varv [rpm]>port_rpm|Relativ vind styrka [m/s]>wind_speed",
    "Danish": "Tid|Bredde>latitude|Længde>longitude|Retvisende kurs [°]?heading|Fart over grunden [kn]>speed_over_ground|"
    "Kurs over grunden [°]>course_over_ground",
    "Norwegian short forms": "Kl|Rettvisende kurs [°]?heading|Fart o/grunn [kn]>speed_over_ground|"
    "Kurs o/grunn [°]>course_over_ground",
    "German short forms": "Zeit|Kurs rw [°]>heading|Fahrt ü.G. [kn]>speed_over_ground|Kurs ü.G. [°]>course_over_ground",
    "French short forms": "Heure|Cap gyro [deg]>heading|V fond [nds]>speed_over_ground|R fond [deg]>course_over_ground",
    "brackets of full width": "时间|对地速度（节）>speed_over_ground|对地航向（度）>course_over_ground|"
    "转向率（度/分）>yaw_rate",
    "vectors of Fossen": "t|eta_N>north|eta_E>east|eta_psi [rad]>heading|nu_u [m/s]>surge|nu_v [m/s]>sway|"
    "nu_r [rad/s]>yaw_rate",
    "numbered vectors": "t|eta_1?north|eta_2?east|eta_6 [rad]?heading|nu_1 [m/s]?surge|nu_2 [m/s]?sway|"
    "nu_6 [rad/s]?yaw_rate",
    "units without brackets": "Time|Wind Rel deg>wind_from|Wind Rel kts>wind_speed|azi_ps_ang_deg_fb>port_azimuth",
    "velocities of an autopilot": "timestamp|x?north|y?east|heading [deg]>heading|vx [m/s]?north_velocity|"
    "vy [m/s]?east_velocity|vz",
    "a motion sensor": "Time|Motion sensor heading [deg]?heading|Heading of motion [deg]>course_over_ground|"
    "SOG [kn]>speed_over_ground",
    "tags of a DP system": "Timestamp|HDG_ACT>heading|HDG_SET|AZP_PS_RPM_ACT>port_rpm|AZP_PS_RPM_SET|"
    "AZP_SB_RPM_ACT>starboard_rpm|TT_BOW_RPM_ACT>tunnel_rpm|ROT_ACT [°/min]>yaw_rate",
    "feedback and demand": "Time|Heading>heading|Heading dmd|Port rpm dmd|Port rpm fdbk>port_rpm|"
    "Stbd rpm fdbk>starboard_rpm",
    "tags of a historian": "Timestamp|VSL:NAV.GYRO1.HDG.PV>heading|VSL:PROP.PS.RPM.PV>port_rpm|VSL:PROP.PS.RPM.SP",
    "speed made good": "Time|Gyro>heading|SMG [kn]>speed_over_ground|CMG [°]>course_over_ground",
}


@pytest.mark.parametrize("kind", LANGUAGES)
def test_names_of_other_recorders_are_known(tmp_path, kind):
    marked = LANGUAGES[kind].split("|")
    found = used(tmp_path, [mark.partition(">")[0].partition("?")[0] for mark in marked])
    for mark in marked[1:]:
        name, _, role = mark.replace("?", ">").partition(">")
        guess = found.get(name.partition(" [")[0].partition("(")[0].partition("（")[0])
        assert (guess.role if guess else "") == role, mark
        assert guess is None or guess.is_guess == ("?" in mark), mark


@pytest.mark.parametrize(
    ("encoding", "kind"),
    [("gbk", "Chinese"), ("gb18030", "Chinese"), ("cp949", "Korean"), ("euc_kr", "Korean")],
)
def test_east_asian_texts_are_read_in_their_encodings(tmp_path, encoding, kind):
    header = [mark.partition(">")[0] for mark in LANGUAGES[kind].split("|")]
    roles = {guess.role for guess in used(tmp_path, header, encoding=encoding).values()}
    assert {"time", "heading", "port_rpm", "starboard_rpm"} <= roles


@pytest.mark.parametrize("encoding", ["cp1252", "latin-1"])
@pytest.mark.parametrize("kind", ["French", "Spanish", "Portuguese"])
def test_western_texts_stay_western(tmp_path, encoding, kind):
    header = [mark.partition(">")[0].partition("?")[0] for mark in LANGUAGES[kind].split("|")]
    assert "port_rpm" in {
        guess.role for guess in used(tmp_path, header, encoding=encoding).values()
    }


@pytest.mark.parametrize(
    "name",
    [
        "Port RPM %",
        "Port RPM%",
        "RPM % port",
        "rpm port [%]",
        "port_rpm_pct",
        "Port RPM (pct)",
        "% rpm port",
        "Port % RPM",
    ],
)
def test_per_cent_is_never_taken_for_rpm(tmp_path, name):
    assert "port_rpm" not in {
        guess.role for guess in used(tmp_path, ["Time", name, "Heading"]).values()
    }


@pytest.mark.parametrize(
    "name",
    [
        "Sway*100",
        "Surge x10",
        "Sway / 10",
        "ROT/10 deg/min",
        "ROT [deg/s*10]",
        "Surge [kn/10]",
        "Sway (cm/s x10)",
    ],
)
def test_a_factor_in_a_header_is_asked(tmp_path, name):
    found = used(tmp_path, ["Time", name, "Heading"]).values()
    assert all(guess.is_guess for guess in found if guess.role in ("surge", "sway", "yaw_rate"))


@pytest.mark.parametrize(
    "name",
    ["Relative wind direction to", "True wind direction (to)", "Apparent wind angle towards"],
)
def test_where_the_wind_goes_to_is_asked_half_a_turn_off(tmp_path, name):
    guess = next(
        g
        for g in used(tmp_path, ["Time", f"{name} [deg]"]).values()
        if g.role.endswith("wind_from")
    )
    assert guess.is_guess and guess.channel.offset == 180.0


@pytest.mark.parametrize(
    "name", ["Relative wind direction to bow", "True wind direction relative to north"]
)
def test_what_a_wind_is_counted_from_is_not_where_it_goes_to(tmp_path, name):
    found = used(tmp_path, ["Time", f"{name} [deg]"]).values()
    assert all(
        guess.is_guess and guess.channel.offset == 0.0
        for guess in found
        if guess.role.endswith("wind_from")
    )


@pytest.mark.parametrize("values", [True, False])
def test_a_file_for_each_signal_is_named_by_the_file(tmp_path, values):
    column = "Value" if values else "value"
    motion = MOTION | {"THR_PS_RPM_FB": 90.0 + T, "THR_PS_RPM_SP": 120.0 + T}
    for name, cells in motion.items():
        rows = [f"{1710408360 + int(t)};{v:.5f}" for t, v in zip(T, cells, strict=True)]
        save(tmp_path, [f"Time;{column}", *rows], f"{name}.csv")
    log = read_log(tmp_path, None, THRUSTERS)
    for role, cells in MOTION.items():
        assert log[role].values == pytest.approx(cells, abs=1e-4)
    assert log["port_rpm"].values == pytest.approx(90.0 + T)


@pytest.mark.parametrize("has_units", [True, False])
@pytest.mark.parametrize("last", ["Stbd azimuth", "Bow tunnel"])
def test_cells_of_a_workbook_that_are_merged_over_two_rows_name_columns(tmp_path, has_units, last):
    book = Workbook()
    sheet = book.active
    sheet.append(["DP trial of 14 March"])
    sheet.append(["Time", "Position", None, "Gyro", "Port azimuth", None, last, None])
    sheet.append([None, "North", "East", "Heading", "Speed", "Angle", "Speed", "Load"])
    if has_units:
        sheet.append(["[s]", "[m]", "[m]", "[°]", "[rpm]", "[°]", "[rpm]", "[kW]"])
    for i, t in enumerate(T):
        sheet.append(
            [
                t,
                *(float(MOTION[r][i]) for r in ("north", "east", "heading")),
                90.0 + i,
                15.0,
                200.0 + i,
                5.0,
            ]
        )
    book.save(tmp_path / "log.xlsx")
    log = read_log(tmp_path / "log.xlsx", None, THRUSTERS)
    assert log["heading"].values == pytest.approx(MOTION["heading"], abs=1e-4)
    if has_units:
        assert log["port_rpm"].values == pytest.approx(90.0 + T)


@pytest.mark.parametrize("mark", ["'", "\u2019", "\u00a0", "\u202f"])
@pytest.mark.parametrize("decimal", [".", ","])
def test_thousands_are_grouped_by_any_mark(tmp_path, mark, decimal):
    columns = {"time": [f"{t:.1f}" for t in T], "heading": [f"{v:.3f}" for v in MOTION["heading"]]}
    for role, start in (("north", 7035000.0), ("east", 585000.0)):
        columns[role] = [f"{start + v:,.2f}".replace(",", mark) for v in MOTION[role]]
    columns = {
        name: [cell.replace(".", decimal) for cell in cells] for name, cells in columns.items()
    }
    log = log_of(tmp_path, columns, ";")
    assert log["north"].values == pytest.approx(7035000.0 + MOTION["north"], abs=0.01)
    assert np.isfinite(log["east"].values).all()


@pytest.mark.parametrize("role", ["heading", "wind_from", "true_wind_from"])
@pytest.mark.parametrize("middle", [0.1, 1.5, 3.0])
@pytest.mark.parametrize("swing", [0.05, 1.0, 3.0])
@pytest.mark.parametrize("is_signed", [True, False])
def test_directions_within_two_pi_are_asked_where_no_unit_is_stated(
    tmp_path, role, middle, swing, is_signed
):
    angle = middle + swing * np.sin(T / 20.0)
    angle = np.angle(np.exp(1j * angle)) if is_signed else np.mod(angle, 2.0 * np.pi)
    columns = {"time": T, "surge": 1.0 + 0.1 * np.sin(T / 9.0), "sway": 0.1 * np.sin(T / 7.0)}
    log = log_of(tmp_path, columns | {role: angle})
    assert role not in log
    assert "no unit is stated, and no value is beyond 2 pi: rad or deg" in " ".join(
        log.attrs["column_remarks"]
    )
    log = log_of(tmp_path, columns | {f"{role} [deg]": angle})
    assert log[role].values == pytest.approx(angle, abs=1e-4)


@pytest.mark.parametrize("middle", [3.0, 90.0])
def test_a_heading_in_degrees_needs_no_unit(tmp_path, middle):
    # Around north it passes 360; in whole degrees it is in no radians.
    swinging = np.mod(middle + 6.0 * np.sin(T / 20.0), 360.0)
    assert (
        log_of(tmp_path, {"time": T, "surge": T, "heading": swinging})["heading"].values.max() > 7.0
    )
    steady = np.round(3.0 + 2.0 * np.sin(T / 20.0))
    assert "heading" in log_of(tmp_path, {"time": T, "surge": T, "heading": steady})
