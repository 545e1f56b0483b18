"""Ships as files: what they are based on, tables, and one error for all that is wrong."""

from dataclasses import dataclass

import pytest

from shipcosim.errors import ShipcosimError
from shipcosim.models.core.parameters import quantity, required, required_table
from shipcosim.ships import Quantity, read_ship


@dataclass(frozen=True, kw_only=True)
class Screw:
    diameter: float = required("m", "diameter", minimum=0.1)
    pitch: float = required("1", "pitch over diameter")
    curve: str = required_table(("J [1]", "KT [1]"), "rows 'J KT'")
    loss: float = quantity(0.0, "1", "loss of thrust", "neutral", maximum=1.0)


WHOLE = """
diameter = { value = 2, unit = "m", tolerance = 0.01, origin = "drawing" }
pitch = { value = 1.1, unit = "1", origin = "assumed" }
curve = { table = "curve.csv" }
"""
CURVE = "# open water\n# source: tank test\nJ [1],KT [1]\n0,0.40\n1,0.1\n"


@pytest.fixture
def yard(tmp_path):
    """Function that writes files of ships, by path, and gives the folder of the ships."""

    def write(**files):
        for name, text in files.items():
            ship, _, file = name.partition("__")
            path = tmp_path / ship / (f"{file}.csv" if file.startswith("curve") else f"{file}.toml")
            path.parent.mkdir(exist_ok=True)
            path.write_text(text, encoding="utf-8")
        return tmp_path

    return write


def problems_of(folder, component="port"):
    with pytest.raises(ShipcosimError) as error:
        read_ship(folder).parameter_set({component: [Screw]})
    return [str(problem).replace(f"{folder.parent}/", "") for problem in error.value.problems]


def test_a_ship_is_her_numbers_with_origin_and_tolerance_and_her_tables_digit_by_digit(yard):
    folder = yard(
        own__ship='description = "a boat"\nsystems = ["here"]', own__port=WHOLE, own__curve=CURVE
    )
    ship = read_ship(folder / "own")
    assert (ship.name, ship.description, ship.systems) == ("own", "a boat", ("here",))
    found = ship.parameter_set({"port": [Screw]})["port"]
    assert (
        found["diameter"] == Quantity(2.0, "m", 0.01, "drawing", description="diameter")
        and type(found["diameter"].value) is float
    )
    assert found["curve"] == Quantity(
        "0 0.40; 1 0.1", "1", 0.0, "tank test", description="rows 'J KT'"
    )
    assert found["loss"] == Quantity(0.0, "1", 0.0, "neutral", description="loss of thrust")
    assert ship.parameters(Screw, "port") == Screw(diameter=2.0, pitch=1.1, curve="0 0.40; 1 0.1")


def test_a_component_is_like_another_of_the_same_ship_and_a_ship_like_another_but_for_what_she_says(
    yard,
):
    other = 'pitch = { value = 0.9, unit = "1", origin = "measured" }'
    files = {
        "own__ship": 'description = "a boat"\nsystems = ["here"]',
        "own__port": WHOLE,
        "own__curve": CURVE,
    }
    files |= {
        "own__starboard": 'like = "port"\nloss = { value = 0.2, unit = "1", origin = "worn" }'
    }
    folder = yard(**files, twin__ship='based_on = "own"', twin__port=other)
    ship = read_ship(folder / "twin")
    assert ship.systems == ("here",)
    port, starboard = (ship.parameters(Screw, side) for side in ("port", "starboard"))
    assert (port.diameter, port.pitch, port.loss) == (2.0, 0.9, 0.0)
    assert (starboard.diameter, starboard.pitch, starboard.loss) == (2.0, 0.9, 0.2)


def test_a_component_like_several_takes_the_first_that_says_a_number_and_only_what_it_has(yard):
    engine = 'diameter = { value = 9.0, unit = "m", origin = "engine" }\n'
    engine += 'loss = { value = 0.3, unit = "1", origin = "engine" }\n'
    engine += 'stroke = { value = 0.2, unit = "m", origin = "engine" }'
    files = {"own__ship": "", "own__port": WHOLE, "own__curve": CURVE, "own__engine": engine}
    folder = yard(**files, own__starboard='like = ["port", "engine"]')
    ship = read_ship(folder / "own")
    found = ship.parameter_set({"starboard": (Screw,)})["starboard"]
    assert (found["diameter"].value, found["loss"].value) == (2.0, 0.3)
    assert "stroke" not in found


def test_of_a_second_base_only_its_own_files_count(yard):
    wide = 'diameter = { value = 3.0, unit = "m", origin = "drawing" }'
    folder = yard(
        own__ship="",
        own__port=WHOLE,
        own__curve=CURVE,
        wide__ship='based_on = "own"',
        wide__port=wide,
        steep__ship='based_on = "own"',
        steep__port='pitch = { value = 1.4, unit = "1", origin = "drawing" }',
        both__ship='based_on = ["wide", "steep"]',
    )
    both = read_ship(folder / "both").parameters(Screw, "port")
    assert (both.diameter, both.pitch) == (3.0, 1.4)


def test_everything_that_is_missing_is_said_at_once_and_nothing_is_another_ships(yard):
    folder = yard(own__ship="", own__tunnel="")
    (found,) = problems_of(folder / "own")
    assert found.startswith("own/port.toml: nothing says diameter [m], pitch [1], curve")


def test_everything_that_is_wrong_is_said_at_once_by_its_place(yard):
    wrong = """
diametre = { value = 2.0, unit = "m", origin = "drawing" }
diameter = { value = 200.0, unit = "cm", origin = "drawing" }
pitch = { value = 1.1, unit = "1" }
curve = { table = "curve.csv" }
loss = { value = 1.5, unit = "1", origin = "assumed" }
"""
    curve = CURVE.replace("KT [1]", "KQ [1]").replace("0.1", "thick")
    folder = yard(own__ship="", own__port=wrong, own__curve=curve)
    with pytest.raises(ShipcosimError) as error:
        read_ship(folder / "own")
    text = str(error.value)
    assert "port.toml: pitch: 'origin' is missing." in text
    assert "curve.csv, row 2: ['1', 'thick']. A row has 2 numbers." in text
    folder = yard(
        own__port=wrong.replace('"1" }', '"1", origin = "assumed" }'),
        own__curve=curve.replace("thick", "1"),
    )
    found = problems_of(folder / "own")
    assert found == [
        "own/port.toml: diameter: the unit is 'cm'. It must be 'm'.",
        "own/curve.csv: the columns are J [1], KQ [1]. They must be J [1], KT [1].",
        "own/port.toml: loss: found 1.5. It must be at most 1 1.",
        "own/port.toml: diametre: port has no such parameter. There is: curve, diameter, loss, pitch. "
        "Did you mean 'diameter'?",
    ]


DOUBTFUL = (
    WHOLE + 'loss = { value = 0.1, unit = "1", uncertainty = [0.0, 0.3], origin = "two tanks" }'
)


def test_what_sources_disagree_on_is_a_number_beside_its_tolerance(yard):
    folder = yard(own__ship="", own__port=DOUBTFUL, own__curve=CURVE)
    found = read_ship(folder / "own").parameter_set({"port": [Screw]})["port"]
    assert (found["loss"].uncertainty, found["loss"].tolerance) == ((0.0, 0.3), 0.0)
    assert found["diameter"].uncertainty == ()


def test_a_value_outside_its_uncertainty_is_a_mistake(yard):
    folder = yard(
        own__ship="", own__port=DOUBTFUL.replace("[0.0, 0.3]", "[0.2, 0.3]"), own__curve=CURVE
    )
    (found,) = problems_of(folder / "own")
    assert "loss: 0.1 is outside its uncertainty." in found


@pytest.mark.parametrize("uncertainty", ["0.3", "[0.3]", "[0.3, 0.0]", "['a', 'b']"])
def test_an_uncertainty_that_is_no_range_is_said(uncertainty, yard):
    folder = yard(
        own__ship="", own__port=DOUBTFUL.replace("[0.0, 0.3]", uncertainty), own__curve=CURVE
    )
    with pytest.raises(ShipcosimError, match="'uncertainty' is"):
        read_ship(folder / "own")


@pytest.mark.parametrize(
    ("files", "said"),
    [
        ({}, "there is no such file"),
        ({"own__ship": 'based_on = "old"'}, r"old.ship\.toml: there is no such file.*own"),
        ({"own__ship": 'based_on = "own"'}, "based on itself: own -> own"),
        ({"own__ship": "colour = 3"}, "colour: found 3"),
        ({"own__ship": "", "own__port": "like = 'port'"}, "like itself"),
        ({"own__ship": "", "own__port": "like = 3"}, "Name the components"),
        (
            {"own__ship": "", "own__port": "like = 'prot'"},
            "like 'prot', which this ship does not have",
        ),
        ({"own__ship": "", "own__port": "diameter = 2.0"}, r"diameter: found 2\.0\. Write"),
        ({"own__ship": "", "own__port": "diameter"}, "no TOML"),
        (
            {"own__ship": "", "own__port": "curve = { table = 'curve.csv' }"},
            r"there is no file .*curve\.csv",
        ),
        (
            {
                "own__ship": "",
                "own__port": WHOLE,
                "own__curve": CURVE.replace("# source: tank test\n", ""),
            },
            "no line says where the table is from",
        ),
    ],
)
def test_files_that_cannot_be_read_say_where_and_why(files, said, yard):
    with pytest.raises(ShipcosimError, match=said):
        read_ship(yard(**files) / "own")
