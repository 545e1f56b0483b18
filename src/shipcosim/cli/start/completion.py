"""Completion of names on the command line; where no name fits, the shell completes files."""

from collections.abc import Callable

from shipcosim import library

Names = list[tuple[str, str]]
LISTED = ("scenarios", "studies", "systems", "ships", "fmus", "examples", "causes", "engines")
ENGINES = ("auto", "fmpy", "native", "libcosim", "ecos")


def names_of(*kinds: str) -> Callable[[str], Names]:
    """Function that completes names of these kinds, each with its line."""

    def complete(incomplete: str) -> Names:
        candidates = {
            name: (kind, path) for kind in kinds for name, path in library.names(kind).items()
        }
        fitting = {name: at for name, at in candidates.items() if name.startswith(incomplete)}
        return [(name, library.line_of(*at)) for name, at in fitting.items()]

    return complete


def words_of(*words: str) -> Callable[[str], list[str]]:
    """Function that completes one of some words."""
    return lambda incomplete: [word for word in words if word.startswith(incomplete)]
