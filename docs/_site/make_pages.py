#!/usr/bin/env python3
"""Collects the pages of the site in build/docs/source: the documents of docs/, checked and with links that the
site can follow, and the generated reference. script/docs runs it from the repository root.
"""
import argparse
import re
import shutil
import sys
from pathlib import Path

from bibliography import read_bibliography, write_bibliography
from cli_reference import write_cli_reference
from cpp_reference import anchor, write_cpp_reference
from python_reference import write_python_reference
from schema_reference import write_schema_reference

DOCS = Path("docs")
PROJECT_PAGES = ["CONTRIBUTING.md", "CHANGELOG.md", "SECURITY.md", "CODE_OF_CONDUCT.md"]
SECTIONS = [("Guide", "guide"), ("Theory", "theory"), ("Reference", "reference"), ("Studies", "studies"),
            ("Decisions", "decisions")]
ORDER = ["index", "install", "surgeon", "researcher", "planner", "import", "osteotomies", "landmarks", "tissue-mesh", "compare",
         "validate", "solve", "python", "materials", "elements", "locking", "distance-field", "contact", "equilibrium", "cli"]
TOP = ["architecture", "conventions", "glossary", "roadmap"]
LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)\s]+)\)")


def is_fence(line: str) -> bool:
    return line.lstrip().startswith("```")


def rewrite_links(text: str, source: Path, problems: list[str]) -> str:
    """Checks each link of a document. Links to files that the site does not show become their plain text."""
    lines, in_code = [], False

    def replace(match: re.Match) -> str:
        bang, label, target = match.groups()
        if re.match(r"[a-z]+:", target) or target.startswith("#"):
            return match.group(0)
        name, _, anchor = target.partition("#")
        path = (source.parent / name).resolve().relative_to(Path.cwd())
        if not path.exists():
            problems.append(f"{source}: link to {target}, which does not exist")
            return match.group(0)
        shown = path.is_file() and (DOCS in path.parents or str(path) in PROJECT_PAGES) and path.suffix != ".bib"
        if bang or (shown and source.parent.resolve() != Path.cwd()):
            inner = f"project/{path}" if str(path) in PROJECT_PAGES else str(path.relative_to(DOCS))
            here = source.parent.relative_to(DOCS) if DOCS in source.parents else Path("project")
            up = "../" * len(here.parts)
            return f"{bang}[{label}]({up}{inner}{'#' + anchor if anchor else ''})"
        if shown:  # A page of the project, which moves from the root to project/.
            inner = path.name if str(path) in PROJECT_PAGES else f"../{path.relative_to(DOCS)}"
            return f"[{label}]({inner}{'#' + anchor if anchor else ''})"
        return label

    for line in text.splitlines():
        in_code ^= is_fence(line)
        lines.append(line if in_code else LINK.sub(replace, line))
    return "\n".join(lines) + "\n"


def link_citations(text: str, keys: set[str]) -> str:
    """Links "[key]" and "[key, section 3; other]" to the list of references."""

    def replace(match: re.Match) -> str:
        inside = re.sub(r"[\w:-]+", lambda word: f"[{word[0]}]({anchor(word[0])})" if word[0] in keys else word[0], match[1])
        return f"\\[{inside}\\]" if inside != match[1] else match[0]

    return re.sub(r"(?<![\]\w`])\[([^\][()`\n]+)\](?![(\[])", replace, text)


def copy_documents(output: Path, keys: set[str], problems: list[str]) -> None:
    for file in sorted(DOCS.rglob("*")):
        inner = file.relative_to(DOCS)
        if not file.is_file() or inner.parts[0] == "_site":
            continue
        target = output / inner
        target.parent.mkdir(parents=True, exist_ok=True)
        if file.suffix == ".md":
            text = rewrite_links(file.read_text(encoding="utf-8"), file, problems)
            target.write_text(link_citations(text, keys), encoding="utf-8")
        else:
            shutil.copy(file, target)
    (output / "project").mkdir()
    for name in PROJECT_PAGES:
        if Path(name).exists():
            text = rewrite_links(Path(name).read_text(encoding="utf-8"), Path(name), problems)
            (output / "project" / name).write_text(text, encoding="utf-8")


def toctree(caption: str, pages: list[str]) -> str:
    return "\n```{toctree}\n:hidden:\n:caption: " + caption + "\n\n" + "\n".join(pages) + "\n```\n"


def pages_in(output: Path, folder: str) -> list[str]:
    """Pages of a folder: those of ORDER first, the others by name."""
    found = {p.stem for p in (output / folder).glob("*.md")}
    return [f"{folder}/{name}" for name in [n for n in ORDER if n in found] + sorted(found - set(ORDER))]


def write_contents(output: Path, cpp: list[str]) -> None:
    index = output / "index.md"
    text = index.read_text(encoding="utf-8")
    for caption, folder in SECTIONS:
        text += toctree(caption, pages_in(output, folder))
    if cpp:
        text += toctree("C++", [f"reference/{page}" for page in cpp])
    listed = [name for name in TOP if (output / f"{name}.md").exists()]
    others = sorted(p.stem for p in output.glob("*.md") if p.stem not in {*TOP, "index"})
    text += toctree("Project", listed + others + pages_in(output, "project"))
    index.write_text(text, encoding="utf-8")


def read_layers() -> dict[str, str]:
    lines = (line.split("#", 1)[0].strip() for line in Path("src/lefort/LAYERS").read_text().splitlines())
    return {name.strip(): ", ".join(rest.split()) for name, _, rest in (line.partition(":") for line in lines if line)}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--output", type=Path, required=True)
    parser.add_argument("--doxygen", type=Path, help="Doxygen's XML; none: no C++ reference")
    parser.add_argument("--program", help="lefort; none: no command-line reference")
    parser.add_argument("--python", type=Path, help="folder of the Python package; none: no Python reference")
    options = parser.parse_args()

    problems: list[str] = []
    reference = options.output / "reference"
    reference.mkdir(parents=True)
    rewrite_links(Path("README.md").read_text(encoding="utf-8"), Path("README.md"), problems)  # Checked, not shown.
    entries = read_bibliography(DOCS / "references.bib")
    copy_documents(options.output, set(entries), problems)
    write_bibliography(entries, options.output / "references.md")
    write_schema_reference(Path("contract"), reference)
    if options.program:
        write_cli_reference(options.program, reference)
    if options.python:
        write_python_reference(options.python, reference)
    cpp = []
    if options.doxygen:
        cpp = write_cpp_reference(options.doxygen, read_layers(), set(entries), reference / "cpp")
    write_contents(options.output, cpp)
    print("\n".join(problems), file=sys.stderr, end="\n" if problems else "")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
