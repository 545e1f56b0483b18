"""Hooks of the site: what MkDocs does to the pages of `docs` before it builds them.

- Pages that lie elsewhere in the repository get a place: the README is the front page, each FMU's README a page of
  the reference, the READMEs of the benches and the changelog pages of their own.
- Links from one of these to another, or to a file of the repository, are turned into links of the site.
- Tables of the reference are made from the code (`look_up.py`).
- The ship that the reader steers, on the page of live runs, is compiled.
- A generated page of `docs/generated` stands below the text on its subject (`BELOW`).
"""

import posixpath
import re
import sys
from pathlib import Path

from mkdocs.structure.files import File
from pymdownx.slugs import slugify

sys.path.insert(0, str(Path(__file__).parent))
import look_up

ROOT = Path(__file__).resolve().parents[2]
CI_PAGE = "continuous-integration.md"
LARGEST = 200_000  # bytes of a file of the repository that comes along
READABLE = (".c", ".csv", ".json", ".py", ".ssd", ".ssv", ".toml")
LINK = re.compile(r"(?<!\\)\]\(([^)\s]+)\)")
CODE = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)


def elsewhere() -> dict[str, str]:
    """Pages of the site that do not lie in `docs`: their path in the repository, and in the site."""
    pages = {"README.md": "index.md"}
    pages |= {
        name: f"project/{name.lower()}"
        for name in ("CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md")
    }
    for kind, folder in (("fmus", "fmus"), ("benches", "tests/bench")):
        for page in sorted((ROOT / folder).glob("*/README.md")):
            pages[page.relative_to(ROOT).as_posix()] = f"{kind}/{page.parent.name}.md"
    return {source: page for source, page in pages.items() if (ROOT / source).is_file()}


BELOW = {
    "dp-loop.md": ["dp-loop"],
    "dp-sensors.md": ["dp-sensors"],
    "thruster-failures.md": ["thruster-failures"],
    "manoeuvres.md": ["manoeuvres"],
    "interoperability.md": ["interoperability"],
    "reports/allocation.md": ["allocation"],
    "reports/prediction.md": ["prediction", "dp_prediction", "drift_prediction"],
    "reports/docking.md": ["docking"],
    "reports/dead-reckoning.md": ["dead-reckoning"],
    "reports/thesis.md": ["thesis"],
    "reports/diagnosis-trial.md": ["diagnosis-trial"],
    "reports/case-gunnerus-2022.md": ["sea-trials-2022"],
}
"""Generated pages that stand below the text of another one."""
ABOVE = {f"docs/generated/{name}.md": page for page, names in BELOW.items() for name in names}
PAGES = elsewhere()
SOURCES = {page: source for source, page in PAGES.items()}


def source_of(page: str) -> str:
    """Path in the repository of a page of the site."""
    return SOURCES.get(page, f"docs/{page}")


def place_of(source: str) -> str:
    """Path in the site of a file of the repository; empty where it has none."""
    if source in PAGES:
        return PAGES[source]
    if source in ABOVE:
        return ABOVE[source]
    path = ROOT / source
    if source.startswith("docs/") and path.is_file():
        return source.removeprefix("docs/")
    if path.suffix in READABLE and path.is_file() and path.stat().st_size < LARGEST:
        return f"files/{source}"
    return ""


def targets(text: str, source: str) -> set[str]:
    """Files of the repository to which a page links."""
    found = (LINK.findall(part) for part in CODE.split(text))
    links = [link.partition("#")[0] for group in found for link in group]
    return {_resolved(link, source) for link in links if link and "://" not in link}


def _resolved(link: str, source: str) -> str:
    return posixpath.normpath(posixpath.join(posixpath.dirname(source), link))


def on_config(config):
    """Put the FMUs and the benches into the navigation, where it has one page for each of them.

    The page of CI services has its place too, in a repository that has it.
    """
    if (ROOT / "docs" / CI_PAGE).is_file() and CI_PAGE not in str(config.nav):
        config.nav[2]["Do"].insert(1, {"Tests in CI": CI_PAGE})
    below = {"fmus.md": "fmus/", "benches.md": "benches/"}
    _spread(config.nav, below)
    return config


def _spread(entries, below):
    for entry in entries:
        for title, content in list(entry.items()) if isinstance(entry, dict) else ():
            if isinstance(content, list):
                _spread(content, below)
            elif content in below:
                names = [page for page in sorted(SOURCES) if page.startswith(below[content])]
                entry[title] = [content, *names]


def on_files(files, config):
    """Add pages and files from outside `docs`, and take out pages that stand below others."""
    for source, page in PAGES.items():
        files.append(File.generated(config, page, content=(ROOT / source).read_text("utf-8")))
    shim = Path(__file__).with_name("iframe-worker.js")
    files.append(File.generated(config, "assets/iframe-worker.js", abs_src_path=str(shim)))
    files.append(File.generated(config, look_up.LIVE, content=look_up.live_file()))
    pages = {file.src_uri: file for file in files if file.src_uri.endswith(".md")}
    wanted = set()
    for page, file in pages.items():
        wanted |= {place_of(t) for t in targets(file.content_string, source_of(page))}
    for source in ABOVE:
        files.remove(files.get_file_from_path(source.removeprefix("docs/")))
    for place in sorted(place for place in wanted if place.startswith("files/")):
        files.append(
            File.generated(config, place, abs_src_path=str(ROOT / place.removeprefix("files/")))
        )
    return files


def on_page_markdown(markdown, page, config, files):
    """Turn links into those of the site, add what stands below, and make the tables of the reference."""
    place = page.file.src_uri
    texts = [_of_site(markdown, source_of(place), place)]
    for name in BELOW.get(place, ()):
        source = f"docs/generated/{name}.md"
        below = (ROOT / source).read_text(encoding="utf-8")
        texts.append(_of_site(below, source, place, deeper=True))
    return look_up.filled("\n\n".join(texts))


def _of_site(text, source, place, deeper=False):
    """A page with its links as they are in the site, and its headings one level deeper."""
    parts = re.split(f"({CODE.pattern})", text, flags=CODE.flags)
    for index in range(0, len(parts), 2):
        if deeper:
            parts[index] = re.sub(r"(?m)^(#+) ", r"#\1 ", parts[index])
        parts[index] = _lists_apart(_with_links(parts[index], source, place))
    return "".join(parts)


def anchor_of(source):
    """Anchor of the title of a page that stands below another one."""
    title = (ROOT / source).read_text(encoding="utf-8").partition("\n")[0].removeprefix("# ")
    return slugify(case="lower")(title, "-")


def _with_links(text, source, page):
    def replaced(match):
        shown, link = match[1], match[2]
        target, hash_, anchor = link.partition("#")
        if "://" in link or not target:
            return match[0]
        file = _resolved(target, source)
        place = place_of(file)
        if not place:
            return shown
        if file in ABOVE and not anchor:
            hash_, anchor = "#", anchor_of(file)
        return (
            f"[{shown}]({posixpath.relpath(place, posixpath.dirname(page) or '.')}{hash_}{anchor})"
        )

    return re.sub(r"\[((?:[^\[\]]|\[[^\[\]]*\])*)\]\(([^)\s]+)\)", replaced, text)


def _lists_apart(text):
    """A blank line between a paragraph and the list below it, which Python-Markdown needs."""
    return re.sub(r"(?m)^((?![-*|#>\s]|\d+\. ).+)\n(?=(?:[-*]|\d+\.) )", r"\1\n\n", text)
