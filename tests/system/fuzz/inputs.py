"""Input number i of a seed: a file of a kind, damaged in a way; the same for the same numbers."""

import io
import random
import zipfile

from fuzz import damage, damage_archives, damage_xml
from fuzz.endless import endless_connections, endless_systems
from fuzz.seeds import seeds, zipped
from fuzz.typed import write_typed

KINDS = (
    ("ssp",) * 5
    + ("ssd",) * 5
    + ("ssv",) * 2
    + ("ssm", "ssb", "ssb")
    + ("fmu",) * 2
    + ("toml",) * 2
    + ("csv",) * 2
    + ("osp",) * 2
)


def write_input(number, folder, seed=0):
    """Write an input into an empty folder.

    Parameters
    ----------
    number, seed : int
        Which.
    folder : Path
        Where to.

    Returns
    -------
    (Path, str)
        What a user would give to the program, and how it was made.
    """
    if str(seed).startswith("typed"):
        return write_typed(number, folder, seed)
    rng = random.Random(f"{seed} {number}")
    kind = rng.choice(KINDS)
    name, sound = rng.choice(seeds()[kind])
    files, how = MAKERS[kind](rng, name, sound)
    for file, data in files.items():
        path = folder / file
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
    return folder / next(iter(files)), f"{kind}: {how}"


def _system(rng, name, files):
    """A packed system or, in a folder, an unpacked one."""
    how = rng.randrange(10)
    if how < 4:
        data = damage_archives.archive(rng, files)
        return {name: data}, "archive"
    if how == 4:
        made, text = endless_systems(rng), "systems without end"
    elif how == 5:
        made, text = endless_connections(rng), "connections without end"
    else:
        files = dict(files)
        victim = rng.choice([*files, "SystemStructure.ssd"])
        mutate = rng.choice(damage.BYTES if victim.endswith(".fmu") else damage_xml.XML)
        files[victim] = mutate(rng, files[victim])
        made, text = files, f"{mutate.__name__} {victim}"
    if rng.random() < 0.5:
        return {name: zipped(made)}, text
    return {"SystemStructure.ssd": made.pop("SystemStructure.ssd"), **made}, text


def _document(rng, name, data):
    """An SSD, SSV, SSM or SSB by itself."""
    mutate = rng.choice(damage_xml.XML + damage.BYTES[:4])
    return {name: mutate(rng, data)}, mutate.__name__


def _structure(rng, name, data):
    """An SSD with the files that belong to it."""
    mutate = rng.choice(damage_xml.XML)
    name, files = rng.choice(seeds()["ssp"])
    files = dict(files)
    ssd = mutate(rng, files.pop("SystemStructure.ssd"))
    return {"SystemStructure.ssd": ssd, **files}, mutate.__name__


def _fmu(rng, name, data):
    """An FMU with a damaged description, or damaged as an archive."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        files = {entry: archive.read(entry) for entry in archive.namelist()}
    if rng.random() < 0.4:
        return {name: damage_archives.archive(rng, files)}, "archive"
    mutate = rng.choice(damage_xml.XML)
    files["modelDescription.xml"] = mutate(rng, files["modelDescription.xml"])
    return {name: zipped(files)}, mutate.__name__


def _scenario(rng, name, data):
    """A scenario beside its system."""
    mutate = rng.choice(damage.TEXT)
    folder, files = "ssp/case/", dict(rng.choice(seeds()["ssp"])[1])
    made = {
        f"scenarios/{name}": mutate(rng, data),
        **{folder + file: content for file, content in files.items()},
    }
    return made, mutate.__name__


def _log(rng, name, data):
    """A measured log, packed or not."""
    if name.endswith(".gz"):
        return {name: damage.packed_text(rng, data)}, "packed_text"
    mutate = rng.choice((*damage.TEXT, damage.column_changed, damage.column_changed, damage.wide))
    return {name: mutate(rng, data)}, mutate.__name__


def _osp(rng, name, files):
    """A structure of OSP with its FMUs and a scenario, one of the two damaged."""
    files = dict(files)
    victim = rng.choice(("OspSystemStructure.xml", "events.json"))
    mutate = rng.choice(damage.TEXT if victim.endswith(".json") else damage_xml.XML)
    made = {victim: mutate(rng, files.pop(victim)), **files}
    if victim == "events.json" and rng.random() < 0.5:
        made = {"events.yaml": made.pop(victim), **made}
    return made, f"{mutate.__name__} {victim}"


MAKERS = {
    "osp": _osp,
    "ssp": _system,
    "ssd": _structure,
    "ssv": _document,
    "ssm": _document,
    "ssb": _document,
    "fmu": _fmu,
    "toml": _scenario,
    "csv": _log,
}
