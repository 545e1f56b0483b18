"""Projects that tests of studies lay out: built once, and taken into the folder of each test."""

from shipcosim.library import build_stale


def built_project(project, files):
    """A project of files, text by path, with its FMUs built."""
    for path, text in files.items():
        (project / path).parent.mkdir(parents=True, exist_ok=True)
        (project / path).write_text(text)
    build_stale(project)
    return project


def work_in(folder, built, monkeypatch):
    """Make a folder the working folder, with all of a built project but studies and results."""
    for name in ("fmus", "ssp", "scenarios", "build"):
        (folder / name).symlink_to(built / name)
    monkeypatch.chdir(folder)
    return folder
