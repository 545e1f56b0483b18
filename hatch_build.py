"""What the packages have beside the source: an editable install uses the repository's own folders.

The README of the repository has links to files beside it, which a page of a package index does not have. `Readme` turns
them into absolute ones where pyproject.toml names the address of the repository, and into names of files elsewhere.
"""

import re
from pathlib import Path

from hatchling.builders.hooks.plugin.interface import BuildHookInterface
from hatchling.metadata.plugin.interface import MetadataHookInterface

SHIPPED = ("fmus", "ssp", "scenarios", "studies", "docs/examples")
LINK = re.compile(r"(!?)\[([^\]]*)\]\((?!https?://|#)([^)\s]+)\)")


class Shipped(BuildHookInterface):
    """Puts ships, systems, scenarios, studies, FMUs and examples into the wheel, where `library` finds them.

    The guides come along as text, since messages name them; reports and pictures do not.
    """

    def initialize(self, version, build_data):
        if version != "editable":
            docs = Path(self.root) / "docs"
            pages = [*docs.glob("*.md"), *docs.glob("learn/*.md")]
            guides = [page.relative_to(self.root).as_posix() for page in pages]
            build_data["force_include"] |= {
                path: f"shipcosim/shipped/{path}" for path in (*SHIPPED, *guides)
            }


class Readme(MetadataHookInterface):
    """The README as a package index shows it, and the addresses of the project."""

    def update(self, metadata):
        repository = self.config.get("repository", "").rstrip("/")
        text = (Path(self.root) / "README.md").read_text(encoding="utf-8")
        metadata["readme"] = {
            "content-type": "text/markdown",
            "text": outside_the_repository(text, repository),
        }
        if repository:
            metadata["urls"] = urls(repository)


def urls(repository):
    """Addresses of the project, by their names on a package index."""
    return {
        "Source": repository,
        "Issues": f"{repository}/issues",
        "Documentation": f"{repository}/tree/main/docs",
        "Changelog": f"{repository}/blob/main/CHANGELOG.md",
        "Security": f"{repository}/blob/main/SECURITY.md",
    }


def outside_the_repository(text, repository):
    """A page with absolute links and pictures; without an address, with the names of the files."""

    def replaced(match):
        picture, shown, target = match.groups()
        if repository:
            return f"{picture}[{shown}]({repository}/{'raw' if picture else 'blob'}/main/{target})"
        return f"*{shown}: `{target}` in the source*" if picture else f"{shown} (`{target}`)"

    return LINK.sub(replaced, text)
