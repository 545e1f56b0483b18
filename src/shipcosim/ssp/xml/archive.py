"""Archives (.ssp, .fmu): unpacked within limits, and packed to the same bytes every time."""

import stat
import zipfile
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path, PurePosixPath

from shipcosim.dialects import LFS_POINTER
from shipcosim.errors import Problem, ShipcosimError, error_at
from shipcosim.ssp.xml.document import LARGEST_FILE, AnyPath
from shipcosim.temporary import replacement

MOST_ENTRIES = 20_000
LARGEST_TOTAL = 2**30  # bytes, unpacked
LARGEST_RATIO = 200  # unpacked to packed; text reaches some 20
SMALL = 64 * 2**20  # bytes; below this size any ratio is harmless


def unpack(path: AnyPath, folder: AnyPath, shown: str | None = None) -> None:
    """Unpack an archive into a folder, within the limits and not outside the folder.

    Parameters
    ----------
    path : path
        The archive.
    folder : path
        Where to; made if it does not exist.
    shown : str, optional
        Name of the archive in messages, where it is not `path`.

    Raises
    ------
    ShipcosimError
        If the archive is damaged, too large, has an entry that would land outside the folder, or finds no room there.
    """
    shown = shown or str(path)
    # Check all entries before the first one is written.
    with _opened(path, shown) as archive:
        _check(archive, shown)
        try:
            for entry in archive.infolist():
                archive.extract(entry, folder)
        except OSError as error:
            raise error_at(
                shown,
                f"Cannot be unpacked into {folder}: {error.strerror}.",
                "Make room there, or name another folder in TMPDIR.",
            ) from None
        except Exception as error:  # of a damaged archive the decompressors raise anything
            raise _damaged(shown, error) from None


def entries(path: AnyPath, shown: str | None = None) -> list[str]:
    """Names of an archive's files, read without unpacking.

    Raises
    ------
    ShipcosimError
        Like `unpack`, except for the room.
    """
    shown = shown or str(path)
    with _opened(path, shown) as archive:
        _check(archive, shown)
        return [entry.filename for entry in archive.infolist() if not entry.is_dir()]


def read_entry(path: AnyPath, name: str, shown: str | None = None) -> bytes | None:
    """Bytes of one file of an archive, or None if it is missing.

    Parameters
    ----------
    path : path
        The archive.
    name : str
        Name within it.
    shown : str, optional
        Name of the archive in messages.

    Returns
    -------
    bytes or None

    Raises
    ------
    ShipcosimError
        If the archive is damaged or the file too large.
    """
    shown = shown or str(path)
    with _opened(path, shown) as archive:
        if name not in archive.namelist():
            return None
        # The stated size first: a large file is never read.
        if archive.getinfo(name).file_size > LARGEST_FILE:
            raise error_at(shown, f"{name} is larger than {LARGEST_FILE >> 20} MiB.")
        try:
            return archive.read(name)
        except Exception as error:  # sizes and places that a damaged directory states can be absurd
            raise _damaged(shown, error) from None


def _opened(path: AnyPath, shown: str) -> zipfile.ZipFile:
    try:
        # zipfile calls a file on a broken disk no archive.
        with Path(path).open("rb") as file:
            is_pointer = file.read(len(LFS_POINTER)) == LFS_POINTER
        archive = zipfile.ZipFile(path)
    except OSError as error:
        raise error_at(shown, f"Cannot be read: {error.strerror}.") from None
    except Exception as error:
        if is_pointer:
            raise error_at(
                shown,
                "This is a pointer of Git LFS, not the file.",
                "Get the file: `git lfs pull` in its repository.",
            ) from None
        raise _damaged(shown, error) from None
    # The first entry must start at 0: otherwise this is the tail of another archive.
    if min((entry.header_offset for entry in archive.infolist()), default=0) > 0:
        archive.close()  # cut off within an archive that it contains, whose directory was taken for its own
        raise _damaged(shown, "its start belongs to no entry")
    return archive


def _damaged(shown: str, error: object) -> ShipcosimError:
    return error_at(
        shown, f"Damaged or incomplete archive: {error}.", "Build, copy or export it again."
    )


def _check(archive: zipfile.ZipFile, shown: str) -> None:
    # Entries outside the folder, too many, too large, or with absurd compression.
    listed = archive.infolist()
    problems = [Problem(shown, complaint) for entry in listed if (complaint := _unsafe(entry))]
    total = sum(e.file_size for e in listed)
    packed = sum(e.compress_size for e in listed)
    if len(listed) > MOST_ENTRIES:
        problems.append(
            Problem(
                shown,
                f"The archive has {len(listed)} entries.",
                f"At most {MOST_ENTRIES} are taken.",
            )
        )
    if total > LARGEST_TOTAL:
        problems.append(
            Problem(
                shown,
                f"Unpacked it has {total >> 20} MiB.",
                f"At most {LARGEST_TOTAL >> 20} are taken.",
            )
        )
    if total > SMALL and total > LARGEST_RATIO * packed:
        problems.append(
            Problem(
                shown, f"It unpacks to {total // max(packed, 1)} times its size; this is no model."
            )
        )
    # Two entries of one name: which one counts would depend on the tool.
    counts = Counter(entry.filename for entry in listed)
    problems += [
        Problem(shown, f"{n} entries are named '{name}'.") for name, n in counts.items() if n > 1
    ]
    if problems:
        raise ShipcosimError(problems[:20])


def _unsafe(entry: zipfile.ZipInfo) -> str | None:
    """Reason why an entry is unsafe, or None."""
    # Paths out of the folder, links and encrypted entries are refused.
    name = PurePosixPath(entry.orig_filename.replace("\\", "/"))
    if (
        name.is_absolute()
        or ".." in name.parts
        or ":" in name.as_posix()
        or "\0" in entry.orig_filename
    ):
        return (
            f"Entry '{entry.orig_filename}' would land outside the folder that it is unpacked into."
        )
    if stat.S_ISLNK(entry.external_attr >> 16):
        return f"Entry '{entry.filename}' is a symbolic link."
    if entry.flag_bits & 1:
        return f"Entry '{entry.filename}' is encrypted."
    return None


def write_archive(path: AnyPath, files: Mapping[str, bytes]) -> None:
    """Write an archive whose bytes depend only on names and contents; complete or not at all.

    Parameters
    ----------
    path : path
        The archive; its folder is made if needed.
    files : mapping of str to bytes
        Contents by name in the archive.

    Raises
    ------
    ShipcosimError
        If it cannot be written.
    """
    # Fixed order, date and attributes: the same files give the same bytes.
    with replaced(Path(path)) as partial, zipfile.ZipFile(partial, "w") as archive:
        for name in sorted(files):
            entry = zipfile.ZipInfo(name, date_time=(1980, 1, 1, 0, 0, 0))
            entry.create_system = 3
            entry.external_attr = 0o644 << 16
            # FMUs and SSPs are compressed already.
            entry.compress_type = (
                zipfile.ZIP_STORED if name.endswith((".fmu", ".ssp")) else zipfile.ZIP_DEFLATED
            )
            archive.writestr(entry, files[name], compresslevel=9)


@contextmanager
def replaced(path: Path) -> Iterator[Path]:
    """Path of a file to write, which then replaces another in one step; its folder is made if needed.

    Raises
    ------
    ShipcosimError
        If it cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with replacement(path) as partial:
            yield partial
    except OSError as error:
        raise error_at(str(path), f"Cannot be written: {error.strerror}.") from None
