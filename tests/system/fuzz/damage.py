"""Damage to bytes, texts and tables: from a random generator and sound bytes to others."""

import gzip
from functools import lru_cache

VALUES = [
    *(
        "",
        " ",
        "0",
        "-0",
        "1e308",
        "-1e308",
        "1e400",
        "1e-400",
        "NaN",
        "INF",
        "-INF",
        "inf",
        "nan",
        "infinity",
        "9" * 400,
    ),
    *(
        "9223372036854775808",
        "-9223372036854775809",
        "4294967296",
        "2147483648",
        "1_000",
        "0x10",
        "١٢",
        "1,5",
        "true ",
        "TRUE",
    ),
    *(
        "../../x",
        "..\\..\\x",
        "/etc/passwd",
        "file:///etc/passwd",
        "http://127.0.0.1:9/x",
        "//host/x",
        "%00",
        "%2e%2e/%2e%2e/x",
    ),
    *(
        "resources",
        "resources/",
        ".",
        "..",
        "#",
        "#top",
        "SystemStructure.ssd",
        "system.ssp",
        "resources/numbers.ssv",
        "CON",
        "~",
    ),
    *(
        "a.b",
        "a b",
        "[0]",
        "\u202e",
        "\u0000x".replace("\u0000", "\ufffd"),
        "\ud7ff",
        "😀",
        "é" * 5000,
        "x" * 100_000,
        "{}",
        "%s%n",
        "']]>",
    ),
    *(
        "input",
        "output",
        "parameter",
        "inout",
        "unspecified",
        "constant",
        "structuralParameter",
        "Real",
        "m",
        "km",
        "parsnip",
    ),
    *(
        "1.0",
        "2.0",
        "3.0",
        "application/x-ssp-definition",
        "application/x-ssp-package",
        "text/x-modelica",
        "ModelExchange",
    ),
]


def truncated(rng, data):
    return data[: rng.randrange(len(data) + 1)]


def flipped(rng, data):
    changed = bytearray(data)
    for _ in range(rng.choice((1, 3, 20, 200))):
        if changed:
            changed[rng.randrange(len(changed))] = rng.randrange(256)
    return bytes(changed)


def spliced(rng, data):
    """A piece of it taken out, doubled, or put elsewhere."""
    a, b = sorted(rng.randrange(len(data) + 1) for _ in range(2))
    where = rng.randrange(len(data) + 1)
    return rng.choice(
        (data[:a] + data[b:], data[:b] + data[a:], data[:where] + data[a:b] + data[where:])
    )


def inserted(rng, data):
    where = rng.randrange(len(data) + 1)
    what = rng.choice(
        (
            b"\x00",
            b"\xff\xfe",
            b"\xc3\x28",
            b"\xed\xa0\x80",
            b"&#0;",
            b"&x;",
            b"<",
            b">",
            b'"',
            b"<!--",
            b"<![CDATA[",
        )
    )
    return data[:where] + what + data[where:]


def encoded(rng, data):
    """The same in an encoding that it does not say, or says and has not."""
    text = data.decode("utf-8", "replace")
    name = rng.choice(("utf-16", "utf-32", "latin-1", "utf-8-sig", "utf-7", "cp037"))
    if rng.random() < 0.3:
        return data.replace(b'encoding="UTF-8"', f'encoding="{name}"'.encode())
    return text.encode(name, "replace")


def emptied(rng, data):
    return rng.choice(
        (b"", b"\n", b"\x00" * 1000, b"<", b"<x/>", b"[]", b"{}", b"PK\x03\x04", data * 50)
    )


BYTES = (truncated, flipped, spliced, inserted, encoded, emptied)


@lru_cache
def packed_zeros(size):
    """Bytes of a gzip file of so many MiB of zeros."""
    return gzip.compress(bytes(size << 20), 9)


def text_changed(rng, data):
    """Numbers and words of a text put for hostile ones, lines lost, doubled or mixed."""
    lines = data.decode("utf-8", "replace").split("\n")
    for _ in range(rng.choice((1, 3, 10))):
        at = rng.randrange(len(lines))
        how = rng.randrange(5)
        if how == 0:
            lines[at] = ""
        elif how == 1:
            lines.insert(at, rng.choice(lines))
        elif how == 2:
            cells = lines[at].split(",")
            cells[rng.randrange(len(cells))] = rng.choice(VALUES)
            lines[at] = ",".join(cells)
        elif how == 3:
            words = lines[at].split(" ")
            words[rng.randrange(len(words))] = rng.choice((*VALUES, *"[]{}\"'=#,"))
            lines[at] = " ".join(words)
        else:
            lines[at] = lines[at] * rng.choice((2, 1000))
    return "\n".join(lines).encode("utf-8", "surrogatepass")


def column_changed(rng, data):
    """One column of a table: constant, wild, empty, or of words."""
    rows = [line.split(",") for line in data.decode().split("\n")]
    at = rng.randrange(len(rows[0]))
    make = rng.choice(
        (
            lambda i: rng.choice(VALUES[:30]),
            lambda i: "",
            lambda i: "1e308",
            lambda i: str(-i),
            lambda i: "nan",
            lambda i: "7",
        )
    )
    for i, row in enumerate(rows[1:]):
        if at < len(row):
            row[at] = make(i)
    if rng.random() < 0.3:
        rows[0][at] = rng.choice(VALUES)
    return "\n".join(",".join(row) for row in rows).encode("utf-8", "surrogatepass")


def wide(rng, data):
    """A table of very many columns, or of one row or none."""
    rows = data.decode().split("\n")
    if rng.random() < 0.5:
        return "\n".join(rows[: rng.choice((0, 1, 2, 3))]).encode()
    return "\n".join(",".join([row] * rng.choice((2, 300))) for row in rows).encode()


def packed_text(rng, data):
    """A gzip file: of the text, damaged, or of zeros without end."""
    how = rng.randrange(4)
    if how == 0:
        return gzip.compress(data)
    if how == 1:
        return rng.choice(BYTES)(rng, gzip.compress(data))
    if how == 2:
        return gzip.compress(text_changed(rng, data))
    return packed_zeros(rng.choice((1, 100, 600)))


TEXT = (text_changed, text_changed, *BYTES)
