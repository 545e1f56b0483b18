"""Algebraic loops are found where feedthrough closes a circle, and printed link by link with what breaks them."""

import zipfile

import pytest

from shipcosim.ssp import check_system, read_fmu, read_system
from shipcosim.ssp.flatten.loops import find_loops
from shipcosim.ssp.fmu.feedthrough import feedthrough


@pytest.fixture
def part(shop):
    """Function that makes an FMU of inputs u, v and outputs y, z, whose ModelStructure says what is given."""

    def make(name, start=None, **stated):
        path = shop.fmu(name, "input u Real", "input v Real", "output y Real", "output z Real")
        index = {"u": "1", "v": "2", "y": "3", "z": "4"}
        outputs = ""
        for output in "yz":
            said = stated.get(output)
            listed = (
                "" if said is None else f' dependencies="{" ".join(index[one] for one in said)}"'
            )
            outputs += f'<Unknown index="{index[output]}"{listed}/>'
        with zipfile.ZipFile(path) as archive:
            text = archive.read("modelDescription.xml").decode()
        unknowns = "" if start is None else f"<InitialUnknowns>{start}</InitialUnknowns>"
        structure = f"<ModelStructure><Outputs>{outputs}</Outputs>{unknowns}</ModelStructure>"
        text = text.replace("<ModelStructure/>", structure)
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("modelDescription.xml", text)
        return path

    return make


@pytest.fixture
def system(shop):
    """Function that makes a system of FMUs by lines "a.y -> b.u"; components are named as their FMUs."""

    def make(names, *lines):
        elements = "".join(
            shop.component(n, n, "input u", "input v", "output y", "output z") for n in names
        )
        shop.ssd(elements, "".join(shop.connection(*line.split(" -> ")) for line in lines))
        return read_system(shop.folder)

    return make


def links(loop):
    return [f"{'.'.join(source)} -> {'.'.join(target)}" for source, target in loop.links]


def test_a_circle_of_direct_feedthrough_is_a_loop_with_its_links_in_order(part, system):
    for name in "abc":
        part(name, y="u", z="")
    (loop,) = find_loops(system("abc", "c.y -> a.u", "a.y -> b.u", "b.y -> c.u", "a.z -> b.v"))
    assert sorted(links(loop)) == ["a.y -> b.u", "b.y -> c.u", "c.y -> a.u"]
    following = {source[0]: target[0] for source, target in loop.links}
    assert [following[source[0]] for source, _ in loop.links] == [
        source[0] for source, _ in (*loop.links[1:], loop.links[0])
    ]
    assert (loop.components, loop.silent, loop.breaking, loop.others) == (
        ["a", "b", "c"],
        [],
        ["a", "b", "c"],
        0,
    )


def test_an_output_that_states_no_dependency_breaks_it(part, system):
    part("a", y="u", z="")
    part("b", y="u", z="")
    assert find_loops(system("ab", "a.y -> b.u", "b.z -> a.u")) == []
    assert find_loops(system("ab", "a.y -> b.u", "b.y -> a.v")) == []
    assert len(find_loops(system("ab", "a.y -> b.u", "b.y -> a.u"))) == 1


def test_an_fmu_that_says_nothing_is_taken_to_pass_everything_on(part, system):
    part("a")
    part("b", y="v", z="")
    assert find_loops(system("ab", "a.y -> b.u", "b.y -> a.u")) == []
    (loop,) = find_loops(system("ab", "a.z -> b.v", "b.y -> a.u"))
    assert loop.silent == ["a"]


def test_a_chain_and_a_fan_are_no_loops(part, system):
    for name in "abc":
        part(name)
    assert find_loops(system("abc", "a.y -> b.u", "a.y -> c.u", "b.y -> c.v")) == []


def test_a_component_can_be_a_loop_with_itself(part, system):
    part("a", y="u")
    (loop,) = find_loops(system("a", "a.y -> a.u"))
    assert links(loop) == ["a.y -> a.u"] and loop.breaking == ["a"]


def test_two_loops_that_share_nothing_are_two_and_what_breaks_both_is_named(part, system):
    for name in "abcd":
        part(name)
    assert (
        len(find_loops(system("abcd", "a.y -> b.u", "b.y -> a.u", "c.y -> d.u", "d.y -> c.u"))) == 2
    )
    (both,) = find_loops(system("abc", "a.y -> b.u", "b.y -> a.u", "b.z -> c.u", "c.y -> b.v"))
    assert both.breaking == ["b"] and both.others == 2
    (none,) = find_loops(
        system(
            "abc",
            "a.y -> b.u",
            "b.y -> a.u",
            "b.z -> c.u",
            "c.y -> b.v",
            "a.z -> c.v",
            "c.z -> a.v",
        )
    )
    assert none.breaking == []


def test_a_thousand_components_in_a_ring_are_one_loop(part, system, shop):
    part("a", y="u")
    names = [f"n{i}" for i in range(1000)]
    elements = "".join(shop.component(n, "a", "input u", "output y") for n in names)
    pairs = zip(names, [*names[1:], names[0]], strict=True)
    shop.ssd(elements, "".join(shop.connection(f"{one}.y", f"{other}.u") for one, other in pairs))
    (loop,) = find_loops(read_system(shop.folder))
    assert len(loop.links) == 1000


def test_check_prints_the_loop_as_a_remark_with_what_breaks_it(part, system, shop):
    part("a", y="u")
    part("b")
    system("ab", "a.y -> b.u", "b.y -> a.u")
    (problem,) = [p for p in check_system(shop.folder) if "loop" in p.found]
    assert problem.severity == "remark" and problem.where == f"{shop.folder}: a, b"
    assert "a.y -> b.u" in problem.found and "b.y -> a.u" in problem.found
    assert "delays by one step" in problem.found and "so it is assumed: b." in problem.found
    assert problem.remedy.startswith("To break the loop, one of these FMUs must delay outputs")
    assert problem.remedy.endswith(": a, b.")


def test_what_an_output_follows_at_the_start_alone_is_no_loop_of_the_run(part, system, shop):
    part("a", y="", z="", start='<Unknown index="3" dependencies="1"/>')
    part("b", y="", z="", start='<Unknown index="3"/><Unknown index="4" dependencies=""/>')
    assert find_loops(system("ab", "a.y -> b.u", "b.y -> a.u")) == []
    assert not [p for p in check_system(shop.folder) if "loop" in p.found]


FMI3 = """<fmiModelDescription fmiVersion="3.0" modelName="m" instantiationToken="m">
<CoSimulation modelIdentifier="m"/><ModelVariables>
<Float64 name="u" valueReference="7" causality="input" start="0"/>
<Float64 name="y" valueReference="8" causality="output"/>
<Float64 name="z" valueReference="9" causality="output"/></ModelVariables>
<ModelStructure><Output valueReference="8" dependencies="7"/>
<Output valueReference="9" dependencies=""/></ModelStructure>
</fmiModelDescription>"""


def test_fmi_3_names_dependencies_by_value_reference(shop):
    path = shop.folder / "three.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", FMI3)
    assert feedthrough(read_fmu(path)) == {"y": {"u"}, "z": set()}
