"""Tables as text: what is read, and what is said of a table that cannot be read."""

import pytest

from shipcosim.models.core.tables import columns, parse, text


def test_rows_survive_writing_and_reading():
    rows = ((0.0, -28.611, 0.0), (10.0, 3.5e5, -1.0))
    assert parse(text(rows)) == rows


def test_line_breaks_count_as_blanks():
    assert parse("\n0 1;\n 10\n2;\n") == ((0.0, 1.0), (10.0, 2.0))


@pytest.mark.parametrize(
    "table, said",
    [
        ("0 1; 10 x", "row 2: '10 x'"),
        ("0 1; 10", "row 2: 1 columns"),
        ("0 1 2; 10 1 2", "2 rows and 3 columns"),
        ("0 1", "1 rows"),
        ("0 1; 10 2; 10 3", "row 3: 10 after 10"),
        ("", "1 rows and 0 columns"),
    ],
)
def test_what_is_no_table_is_named(table, said):
    with pytest.raises(ValueError, match=said):
        columns(table, 2)
