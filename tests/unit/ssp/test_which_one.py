"""Where two things could be meant, a remark says which one is used."""

from zipfile import ZipFile

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as some

from shipcosim.ssp import read_system, with_values
from shipcosim.ssp.xml.archive import write_archive

SEVERAL = settings(
    max_examples=40,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)


def deviations(system):
    return [str(remark) for remark in system.deviations]


@pytest.fixture
def two_names(shop):
    """A system of an FMU in which a, b and c are one variable and d is another."""
    path = shop.fmu(
        "m", *(f"parameter {name} Real" for name in "abcd"), "input u Real", "input v Real"
    )
    with ZipFile(path) as archive:
        text = archive.read("modelDescription.xml").decode()
    for number, name in ((1, "b"), (2, "c")):
        text = text.replace(
            f'name="{name}" valueReference="{number}"', f'name="{name}" valueReference="0"'
        )
    text = text.replace('name="v" valueReference="5"', 'name="v" valueReference="4"')
    with ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", text)
    shop.ssd(shop.component("x", "m", "input u", "input v"))
    return shop


@SEVERAL
@given(given=some.lists(some.tuples(some.sampled_from("abcd"), some.integers(1, 2)), max_size=5))
def test_the_last_of_two_names_of_one_variable_is_used_and_the_others_are_named(
    two_names, real, given
):
    sets = []
    for number, (name, value) in enumerate(given):
        sets.append(two_names.ssv(real(f"x.{name}", float(value)), f"resources/s{number}.ssv"))
    by_files = read_system(two_names.folder, sets)
    by_values = two_names.read()
    for name, value in given:
        by_values = with_values(by_values, {f"x.{name}": float(value)})
    # A name that is set again is the last one from then on.
    order = list(dict.fromkeys(name for name, _ in reversed(given)))[::-1]
    values = {name: dict(given)[name] for name in order if name != "d"}
    for system in (by_files, by_values):
        assert list(system.components["x"].start) == order
        found = deviations(system)
        assert len(found) == (len(set(values.values())) > 1)
        if found:
            assert f"that of {[n for n in order if n != 'd'][-1]} is used" in found[0]


def test_a_connected_name_wins_over_a_start_value(two_names, real):
    head = '<ssd:Connectors><ssd:Connector name="w" kind="input"/></ssd:Connectors>'
    parts = two_names.component("x", "m", "input u", "input v")
    two_names.ssd(parts, two_names.connection("w", "x.v"), head=head)
    system = two_names.read(two_names.ssv(real("x.u", 2.0)))
    (found,) = deviations(system)
    assert found.startswith("x.v: u and v are one variable") and "that of v is used" in found


@pytest.mark.parametrize("start", [-2.0, 0.0, 1.0, 3.5])
@pytest.mark.parametrize(("low", "high"), [(None, 1.0), (0.0, None), (0.0, 1.0), (None, None)])
def test_an_fmu_that_starts_outside_its_own_range_is_named(shop, start, low, high):
    bounds = f"{'' if low is None else f'min={low}'} {'' if high is None else f'max={high}'}"
    shop.fmu("m", f"input u Real start={start} {bounds}", "output y Real")
    shop.ssd(shop.component("x", "m", "input u", "output y"))
    is_outside = (low is not None and start < low) or (high is not None and start > high)
    found = [text for text in deviations(shop.read()) if "It starts with" in text]
    assert len(found) == is_outside


def test_two_signals_of_one_full_name_are_refused(shop):
    shop.fmu("deep", "output b.y Real")
    shop.fmu("flat", "output y Real")
    parts = shop.component("a", "deep", "output b.y") + shop.component("a.b", "flat", "output y")
    shop.ssd(parts)
    assert "Two components have a variable whose full name is 'a.b.y'" in shop.refused()
    head = '<ssd:Connectors><ssd:Connector name="a.b.y" kind="output"/></ssd:Connectors>'
    shop.ssd(shop.component("a", "deep", "output b.y"), head=head)
    assert "A connector of the system is called as the variable a.b.y" in shop.refused()


@pytest.mark.parametrize("others", [[], ["Other.ssd"], ["A.ssd", "OspSystemStructure.xml"]])
def test_one_of_several_structures_is_named(shop, tmp_path, others):
    shop.fmu("m", "output y Real")
    ssd = shop.ssd(shop.component("x", "m", "output y"))
    for name in others:
        (shop.folder / name).write_bytes(ssd.read_bytes())
    files = {
        p.relative_to(shop.folder).as_posix(): p.read_bytes() for p in shop.folder.rglob("*.*")
    }
    write_archive(tmp_path / "all.ssp", files)
    for path in (shop.folder, tmp_path / "all.ssp"):
        found = deviations(read_system(path))
        assert len(found) == bool(others)
        if others:
            assert f"SystemStructure.ssd runs, not {', '.join(others)}." in found[0]
    # Who names the file needs no remark.
    assert not deviations(read_system(ssd))
    assert not deviations(read_system(f"{tmp_path / 'all.ssp'}#SystemStructure.ssd"))
