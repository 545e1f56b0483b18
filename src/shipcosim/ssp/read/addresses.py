"""Non-standard addresses: outside the package, with backslashes, absolute, by a proxy of an FMU."""

from collections.abc import Iterator
from pathlib import Path
from urllib.parse import parse_qs, unquote, urlsplit
from urllib.request import url2pathname

PROXY = "proxyfmu"
"""Scheme of OSP's, Ecos' and Vico's addresses of FMUs that run in a process of their own."""

ENDINGS = (".fmu", ".ssv", ".ssm", ".ssb", ".ssd", ".ssp")
"""Endings of files that are read where they lie outside an unpacked package."""


def path_of(uri: str) -> str | None:
    """Path of a file address, or None if the file is not on this machine.

    Examples
    --------
    >>> path_of("proxyfmu://localhost?file=../fmus/hull.fmu"), path_of("resources\\\\hull.fmu"), path_of("http://x/y.fmu")
    ('../fmus/hull.fmu', 'resources/hull.fmu', None)
    """
    parts = urlsplit(uri)
    # A proxy on this machine names a file.
    if parts.scheme == PROXY and (parts.hostname in (None, "localhost", "127.0.0.1")):
        return next(iter(parse_qs(parts.query).get("file", ())), None)
    if parts.scheme == "file":
        return url2pathname(parts.path) or None
    # Any other scheme needs a network.
    if parts.scheme or parts.netloc:
        return None
    return unquote(uri).replace("\\", "/") or None


def meant(uri: str, base: Path, folder: Path, outside: bool) -> Path | None:
    """The only file that a non-standard address can mean, or None.

    Parameters
    ----------
    uri : str
        The address.
    base : Path
        Folder of the file that it stands in.
    folder : Path
        Root of the package.
    outside : bool
        Whether files outside the package can be meant: it is no archive.
    """
    # Files outside a package only if it is no archive, and only of kinds that systems refer to.
    text = path_of(uri)
    if text is None:
        return None
    for path in _candidates(text, base, folder, rooted=uri.startswith("/")):
        inside = path.is_relative_to(folder)
        if path.is_file() and (inside or (outside and path.suffix.lower() in ENDINGS)):
            return path
    return None


def _candidates(text: str, base: Path, folder: Path, rooted: bool) -> Iterator[Path]:
    """Candidate files of a path, the likeliest first; a rooted path starts at the package's top."""
    # As it stands, from the top of the package, then with other upper and lower case.
    yield (base / text).resolve()
    if rooted:
        yield (folder / text.lstrip("/")).resolve()
    yield from (path.resolve() for path in differing_in_case(base / text))


def differing_in_case(path: Path) -> list[Path]:
    """The only file of a folder whose name is this one except for upper and lower case, or none."""
    if not path.parent.is_dir():
        return []
    files = [file for file in path.parent.iterdir() if file.name.lower() == path.name.lower()]
    return files if len(files) == 1 else []
