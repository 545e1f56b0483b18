"""Archives with something wrong about them: entries elsewhere, links, bombs, wrong sizes."""

import io
import struct
import zipfile
from functools import lru_cache

from fuzz.damage import BYTES
from fuzz.seeds import zipped

SLIPS = [
    *(
        "../evil.ssd",
        "../../../../evil",
        "..\\evil",
        "/evil-from-archive",
        "C:\\evil",
        "a/../../evil",
        "./x",
        "a//b",
        "x\x00y",
    ),
    *(
        "resources/../../evil",
        "SystemStructure.ssd/x",
        "con",
        "x" * 300,
        "/".join(["d"] * 300) + "/x",
        "é\udce9".encode("utf-8", "surrogateescape").decode("latin-1"),
    ),
]


def archive(rng, files):
    """Bytes of an archive of the files, with something wrong about the archive itself."""
    how = rng.randrange(11)
    files = dict(files)
    if how == 0:
        files[rng.choice(SLIPS)] = b"evil"
    elif how == 1:
        return _linked(rng, files)
    elif how == 2:
        return _flagged(rng, files)
    elif how == 3:
        return _with_bomb(rng, files)
    elif how == 4:
        files |= {f"extra/{i}": b"" for i in range(rng.choice((1000, 30_000)))}
    elif how == 5:
        files[rng.choice(list(files))] = zipped(files)
    elif how == 6:
        files = {
            name.replace(
                "SystemStructure.ssd",
                rng.choice(
                    ("systemstructure.ssd", "x/SystemStructure.ssd", "SystemStructure.ssd/")
                ),
            ): data
            for name, data in files.items()
        }
    elif how == 7:
        return rng.choice(BYTES)(rng, zipped(files))
    elif how == 8:
        return (
            b"#!/bin/sh\n"
            + zipped(files)
            + rng.choice((b"", b"trailing", b"PK\x05\x06" + b"\x00" * 18))
        )
    elif how == 9:
        return _wrong_sizes(rng, zipped(files))
    else:
        return _doubled(rng, files)
    return zipped(files)


def _linked(rng, files):
    data = io.BytesIO(zipped(files))
    with zipfile.ZipFile(data, "a") as out:
        entry = zipfile.ZipInfo(rng.choice(("link", "resources/link.fmu", "resources")))
        entry.create_system, entry.external_attr = 3, (0o120777 << 16)
        out.writestr(entry, rng.choice(("/etc/passwd", "../..", "..", "/tmp")))
        out.writestr("link/evil", b"evil")
    return data.getvalue()


def _flagged(rng, files):
    """Marked as encrypted, or packed by a method that nobody knows."""
    data = bytearray(zipped(files))
    for mark, flags in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
        at = data.find(mark)
        if rng.random() < 0.5:
            data[at + flags] |= 1
        else:
            data[at + flags + 2] = rng.choice((1, 9, 12, 14, 93, 97, 99))
    return bytes(data)


def _with_bomb(rng, files):
    name = rng.choice((*files, "resources/zeros"))
    data = io.BytesIO(
        zeros(name, rng.choice((1, 50, 50, 200)) if name in files else rng.choice((200, 1100)))
    )
    with zipfile.ZipFile(data, "a", zipfile.ZIP_DEFLATED) as out:
        for other, content in files.items():
            if other != name:
                out.writestr(other, content)
    return data.getvalue()


@lru_cache(maxsize=64)
def zeros(name, size):
    """Bytes of an archive with one file of so many MiB of zeros."""
    data = io.BytesIO()
    with (
        zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as out,
        out.open(name, "w", force_zip64=True) as file,
    ):
        for _ in range(size):
            file.write(bytes(1 << 20))
    return data.getvalue()


def _wrong_sizes(rng, data):
    changed = bytearray(data)
    at = changed.find(b"PK\x01\x02")
    while at >= 0:
        if rng.random() < 0.5:
            number = rng.choice((0, 1, 0x7FFFFFFF, 0xFFFFFFFF))
            struct.pack_into("<I", changed, at + rng.choice((16, 20, 24, 42)), number)
        at = changed.find(b"PK\x01\x02", at + 4)
    return bytes(changed)


def _doubled(rng, files):
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w") as out:
        for name, content in [*files.items(), *rng.sample(list(files.items()), 1)]:
            out.writestr(zipfile.ZipInfo(name), content)
    return data.getvalue()
