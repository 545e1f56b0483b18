"""Which statements become one loop of C text, and where their values are then found."""

import pytest

from shipcosim.native.array_statements import Statement, Term, goes_on, loop_of


def statements(template, *slots, first=10, kind="double"):
    """A statement for each turn, from the terms of each operand in all turns."""
    return [
        Statement(f"v{first + turn}", kind, template, terms)
        for turn, terms in enumerate(zip(*slots, strict=True))
    ]


def elements(base, *indices):
    return [Term(base, index) for index in indices]


def numbers(*texts):
    return [Term(text, is_literal=True) for text in texts]


def longest(given):
    """How many statements from the first on make one loop."""
    for n in range(1, len(given)):
        if not goes_on(given[:n], given[n]):
            return n
    return len(given)


def test_neighbours_in_two_arrays_become_a_loop_at_their_distances():
    given = statements("{} * {}", elements("m", 5, 6, 7, 8), elements("v3", 9, 7, 5, 3))
    assert longest(given) == 4
    lines, found = loop_of(given)
    assert lines == [
        "double v10[4];",
        "for (int i = 0; i < 4; i++) v10[i] = m[i + 5] * v3[-2 * i + 9];",
    ]
    assert found == elements("v10", 0, 1, 2, 3)


def test_a_sum_goes_from_element_to_element_and_begins_with_its_first_operand():
    before = [Term("v1"), Term("v10"), Term("v11"), Term("v12")]
    given = statements("{} + {}", before, elements("v3", 0, 1, 2, 3))
    assert longest(given) == 4
    lines, found = loop_of(given)
    assert lines == [
        "double v10[5];",
        "v10[0] = v1;",
        "for (int i = 0; i < 4; i++) v10[i + 1] = v10[i] + v3[i];",
    ]
    assert found == elements("v10", 1, 2, 3, 4)


def test_numbers_that_change_become_a_table_and_one_that_stays_does_not():
    given = statements("{} - {}", numbers("1.0", "2.5", "4.0", "0.5"), numbers(*4 * ["3.0"]))
    lines, _ = loop_of(given)
    assert lines[-1] == (
        "{ static const double n0[] = {1.0, 2.5, 4.0, 0.5}; "
        "for (int i = 0; i < 4; i++) v10[i] = n0[i] - 3.0; }"
    )


def test_results_are_written_without_a_variable():
    given = [Statement("", "", "m[{}] = {}", (Term("", 3 * k), Term("v4", k))) for k in range(5)]
    assert longest(given) == 5
    assert loop_of(given) == (["for (int i = 0; i < 5; i++) m[3 * i] = v4[i];"], [])


@pytest.mark.parametrize(
    ("given", "n"),
    [
        (statements("{} * {}", elements("m", 5, 6, 8), elements("m", 1, 2, 3)), 2),
        (statements("-{}", [*elements("v3", 0, 1), *elements("v4", 2)]), 2),
        (statements("-{}", [Term("v1"), Term("v2")]), 1),
        (statements("-{}", [*elements("v3", 0), Term("v3")]), 1),
        (statements("-{}", [*numbers("1.0"), Term("v1")]), 1),
        # A value of the run itself that is not the one before has no place in the array yet.
        (statements("-{}", [Term("v1"), Term("v10"), Term("v10")]), 2),
        # Both operands go on from the turn before, but from two first values.
        (statements("{} * {}", [Term("v1"), Term("v10")], [Term("v2"), Term("v10")]), 1),
        # The array of a truth value has no room for the number that it begins with.
        (statements("{} != 2.0", [Term("v1"), Term("v10")], kind="int"), 1),
        ([*statements("-{}", elements("m", 0)), *statements("!{}", elements("m", 1))], 1),
    ],
)
def test_what_is_no_next_turn_ends_the_loop(given, n):
    assert longest(given) == n
