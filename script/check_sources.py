#!/usr/bin/env python3
"""Fails when an #include breaks src/lefort/LAYERS, names a library its layer may not use or the world
outside, when headers or TypeScript modules include each other in a cycle, when a line, function or file is too long, when \\cite
and docs/references.bib do not match, when docs/safety.md names a test that does not exist, or when a word is used that
docs/glossary.md replaces. Run from the repository root; it is the ctest `sources`.
"""
import csv
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path("src/lefort")
RATIOS = Path("data/soft_tissue_ratios.csv")  # Its source_key cites, too.
BINDINGS = Path("python/bindings")  # A peer of app, outside the layers.
PYTHON_LAYERS = {"core", "geometry", "image", "anatomy", "mesh", "field", "plan", "io", "pipeline"}
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]')
IMPORT = re.compile(r"""^\s*(?:import|export)\b[^;"']*?["'](\.[^"']+)["']""", re.MULTILINE)
MAX_LINE = 100
MAX_FUNCTION = 60  # Lines; exceptions with reasons: script/long_functions.tsv.
MAX_FILE = 500
NO_FUNCTION = ("namespace", "class", "struct", "enum", "union", "if", "for", "while", "switch", "else", "do", "} ",
               "return", "try", "extern", "#", "/", "TEST")
NO_TS_FUNCTION = re.compile(r"\s*(\}|(if|for|while|switch|else|return|try|do|(export )?(abstract )?(class|interface|type|enum))\b)")
TS_FUNCTION = re.compile(r"\bfunction\b|=> \{$|^\s*((private|public|protected|static|async|get|set|override) )*"
                         r"[\w#]+(<.*>)?\(.*\{$|^\s*\).*\{$")
TEXT = {".h", ".cpp", ".ts", ".mjs", ".md", ".json", ".css", ".html"}
# Where old words are the subject: the glossary, the table of deprecated keys and its tests.
MAY_NAME_OLD_WORDS = {"docs/glossary.md", "docs/reference/renamed-keys.md",
                        "src/lefort/io/deprecated_keys.cpp", "tests/io/test_deprecated_keys.cpp"}
# Only io, report, bench, pipeline, server and app may name these: all else is a pure function of its arguments.
OUTSIDE_WORLD = {"fstream", "iostream", "filesystem", "cstdio"}
MAY_TOUCH_OUTSIDE = {"io", "report", "bench", "pipeline", "server", "app"}
# Libraries stay behind one layer's .cpp files, so that each can be replaced; bench runs some as peers.
# Eigen is for all.
LIBRARIES = {
    "tbb/": {"core"}, "CGAL/": {"mesh", "bench"}, "itk": {"anatomy", "io"}, "gdcm": {"io"},
    "vtk": {"anatomy", "io", "bench"}, "metis.h": {"linear"},
    "nlohmann/": {"io", "bench", "pipeline", "server", "app"}, "valijson/": {"io"}, "CLI/": {"app"}, "httplib.h": {"server"}, "curl/": {"io"},
    "embree3/": {"report", "bench"}, "openvdb/": {"io", "bench"}, "cairo": {"report"}, "pybind11/": set(), "zlib.h": {"io"}, "expat.h": {"io"}, "seccomp.h": {"io"}, "openssl/": {"io"}, "openturns/": {"uncertainty"},
}
MAY_SHOW_LIBRARIES = {"core/parallel.h", "mesh/internal/cgal_surface.h",
                      "io/internal/validated_json.h", "io/internal/rename_keys.h", "io/predicted_poses.h",
                      "bench", "pipeline", "server", "app"}  # Headers (or layers) that may include one.


def read_layers(text: str) -> dict[str, set[str]]:
    """Returns {layer: layers it may include}; checks that every name appears above its use."""
    layers: dict[str, set[str]] = {}
    for line in text.splitlines():
        line = line.split("#", 1)[0].strip()
        if not line:
            continue
        name, _, deps = line.partition(":")
        wanted = set(deps.split())
        unknown = wanted - layers.keys()
        if unknown:
            sys.exit(f"LAYERS: {name.strip()} names {sorted(unknown)}, not declared above it")
        layers[name.strip()] = wanted
    return layers


def violations(root: Path, layers: dict[str, set[str]]) -> list[str]:
    found = []
    for path in sorted(root.rglob("*")):
        if path.suffix not in {".h", ".cpp"}:
            continue
        layer = path.relative_to(root).parts[0]
        if layer not in layers:
            found.append(f"{path}: folder '{layer}' is not in LAYERS")
            continue
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            if len(line) > MAX_LINE:
                found.append(f"{path}:{number}: longer than {MAX_LINE} characters")
            match = INCLUDE.match(line)
            if not match:
                continue
            target = match.group(1)
            if target.startswith("lefort/"):
                other = target.split("/")[1]
                if other != layer and other not in layers[layer]:
                    found.append(f"{path}:{number}: {layer} may not include {other}")
                if "/internal/" in target and other != layer:
                    found.append(f"{path}:{number}: {target} is internal to {other}")
            elif target in OUTSIDE_WORLD and layer not in MAY_TOUCH_OUTSIDE:
                found.append(f"{path}:{number}: <{target}> is for {sorted(MAY_TOUCH_OUTSIDE)} only")
            for prefix, users in LIBRARIES.items():
                if not target.startswith(prefix):
                    continue
                shown = {layer, str(path.relative_to(root))} & MAY_SHOW_LIBRARIES
                if layer not in users:
                    found.append(f"{path}:{number}: <{target}> is for {sorted(users)} only")
                elif path.suffix == ".h" and not shown:
                    found.append(f"{path}:{number}: <{target}> belongs in a .cpp")
    return found


def binding_violations(folder: Path) -> list[str]:
    """As violations(), of the bindings of Python."""
    found = []
    for path in sorted(folder.glob("*")):
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            if len(line) > MAX_LINE:
                found.append(f"{path}:{number}: longer than {MAX_LINE} characters")
            match = INCLUDE.match(line)
            target = match.group(1) if match else ""
            if target.startswith("lefort/") and target.split("/")[1] not in PYTHON_LAYERS:
                found.append(f"{path}:{number}: the bindings may not include {target.split('/')[1]}")
            if "/internal/" in target:
                found.append(f"{path}:{number}: {target} is internal")
            if any(target.startswith(prefix) for prefix in LIBRARIES if prefix != "pybind11/"):
                found.append(f"{path}:{number}: <{target}> is not for the bindings")
    return found


def ratio_rows(table: Path) -> list[dict[str, str]]:
    """The published soft-tissue ratios."""
    with table.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def undocumented_ratios(table: Path, page: Path) -> list[str]:
    """Rows of the table of ratios that the page lacks."""
    text = page.read_text(encoding="utf-8")
    found = []
    for row in ratio_rows(table):
        low, high = row["ratio_low"], row["ratio_high"]
        line = (f"| {row['procedure']} | {row['direction']} | {row['axis']} | {row['soft_landmark']} : "
                f"{row['hard_landmark']} | {low if low == high else f'{low}–{high}'} | [{row['source_key']}] | "
                f"{row['basis']} | {row['note'].replace('+-', '±')} |")
        if line not in text:
            found.append(f"{page}: lacks the row {line}")
    return found


def citation_mismatches(root: Path, references: Path, ratios: Path) -> list[str]:
    """Sources that are cited and not listed, and those listed that nobody cites."""
    listed = set(re.findall(r"^@\w+\{([^,\s]+),", references.read_text(encoding="utf-8"), re.MULTILINE))
    cited: dict[str, Path] = {}
    for path in sorted(root.rglob("*")):
        if path.suffix in {".h", ".cpp"}:
            for key in re.findall(r"\\cite\s+(?:///\s*)?([\w:-]+)", path.read_text(encoding="utf-8")):
                cited.setdefault(key, path)
    for row in ratio_rows(ratios):
        cited.setdefault(row["source_key"], ratios)
    missing = [f"{cited[key]}: \\cite {key} is not in {references}" for key in sorted(cited.keys() - listed)]
    unused = [f"{references}: {key} is cited nowhere" for key in sorted(listed - cited.keys())]
    return missing + unused


def tracked_files(*patterns: str) -> list[Path]:
    listed = subprocess.run(["git", "ls-files", *patterns], check=True, capture_output=True, text=True).stdout
    return [Path(name) for name in listed.splitlines() if Path(name).is_file()]


def read_table(file: Path) -> list[list[str]]:
    """The rows of a file of tab-separated columns; lines that start with # are comments."""
    lines = file.read_text(encoding="utf-8").splitlines()
    return [line.split("\t") for line in lines if line and not line.startswith("#")]


def deprecated_words(words: Path) -> list[str]:
    """Words that docs/glossary.md replaces, wherever a person reads them: code, documents, the page."""
    table = [(re.compile(pattern, re.MULTILINE), instead) for pattern, instead in read_table(words)]
    found = []
    for path in tracked_files("src", "python", "tests", "web/src", "web/tests", "web/e2e", "docs", "contract", "examples", "*.md"):
        if path.suffix not in TEXT or str(path) in MAY_NAME_OLD_WORDS:
            continue
        text = path.read_text(encoding="utf-8")
        present = [(pattern, instead) for pattern, instead in table if pattern.search(text)]  # Few; then line by line.
        for number, line in enumerate(text.splitlines() if present else [], 1):
            for pattern, instead in present:
                match = pattern.search(line)
                if match:
                    found.append(f"{path}:{number}: \"{match.group(0).strip()}\": {instead}")
    return found


def missing_tests(page: Path) -> list[str]:
    """Tests that the table of risks names and that do not exist."""
    heads = "".join(path.read_text(encoding="utf-8") for path in tracked_files("tests/*.cpp"))
    existing = {f"{suite}.{name}" for suite, name in re.findall(r"^TEST(?:_F|_P)?\((\w+), (\w+)\)", heads, re.MULTILINE)}
    named = re.findall(r"`([A-Z]\w+\.[A-Z]\w+)`", page.read_text(encoding="utf-8"))
    return [f"{page}: the test {name} does not exist" for name in named if name not in existing]


def function_lengths(text: str) -> Iterator[tuple[str, int, int]]:
    """Yields (head, first line, number of lines) of each function in clang-formatted C++."""
    lines = text.split("\n")
    for last, line in enumerate(lines):
        if not line.endswith("{") or line.lstrip().startswith(NO_FUNCTION):
            continue
        first = last
        while first > 0 and lines[first - 1].strip() and not lines[first - 1].rstrip().endswith((";", "{", "}", ":")) \
                and not lines[first - 1].lstrip().startswith(("//", "#", "template")):
            first -= 1
        head = " ".join(part.strip() for part in lines[first:last + 1])
        indent = len(lines[first]) - len(lines[first].lstrip())
        before = head.split("(")[0]
        if "(" not in head or indent > 4 or " = " in before or re.search(r"=\s*[\[{]|\[[^\]]*\]\s*\(.*\{$", head) \
                or head.startswith(NO_FUNCTION):
            continue
        end = next((n for n in range(last + 1, len(lines)) if lines[n].startswith(" " * indent + "}")), len(lines) - 1)
        yield head, first + 1, end - first + 1


def typescript_function_lengths(text: str) -> Iterator[tuple[str, int, int]]:
    """As function_lengths(), of TypeScript formatted by Prettier; bodies of arrow functions count, too."""
    lines = text.split("\n")
    for first, line in enumerate(lines):
        if not line.endswith("{") or NO_TS_FUNCTION.match(line) or not TS_FUNCTION.search(line):
            continue
        indent = len(line) - len(line.lstrip())
        end = next((n for n in range(first + 1, len(lines)) if lines[n].startswith(" " * indent + "}")), len(lines) - 1)
        yield line.strip(), first + 1, end - first + 1


def oversized(exceptions: Path) -> list[str]:
    """Functions over MAX_FUNCTION lines and files over MAX_FILE, less those listed with a reason."""
    allowed = {(row[0], row[1]) for row in read_table(exceptions)}
    found, used = [], set()
    for path in tracked_files("src", "python", "web/src"):
        if path.suffix not in {".h", ".cpp", ".ts"} or path.name == "types.gen.ts":
            continue
        text = path.read_text(encoding="utf-8")
        if text.count("\n") > MAX_FILE:
            found.append(f"{path}: longer than {MAX_FILE} lines")
        if path.suffix == ".ts":
            found += [f"{path}:{line}: {head} has {length} lines, must have at most {MAX_FUNCTION}"
                      for head, line, length in typescript_function_lengths(text) if length > MAX_FUNCTION]
            continue
        for head, line, length in function_lengths(text):
            if length <= MAX_FUNCTION:
                continue
            name = re.split(r"[\s&*]", head.split("(")[0])[-1]
            used.add((str(path), name))
            if (str(path), name) not in allowed:
                found.append(f"{path}:{line}: {name}() has {length} lines, must have at most {MAX_FUNCTION}")
    return found + [f"{exceptions}: {name}() of {path} is not over the limit" for path, name in sorted(allowed - used)]


def include_cycles(root: Path) -> list[str]:
    """Cycles among the headers of a layer; between layers LAYERS forbids them."""
    includes = {}
    for path in sorted(root.rglob("*.h")):
        targets = (INCLUDE.match(line) for line in path.read_text(encoding="utf-8").splitlines())
        includes[f"lefort/{path.relative_to(root)}"] = [t.group(1) for t in targets if t]
    return ["include cycle: " + " -> ".join(cycle) for cycle in cycles(includes)]


def import_cycles(root: Path) -> list[str]:
    """Cycles among the TypeScript modules of the page. Imports of types alone vanish, but count: they couple, too."""
    imports = {}
    for path in sorted(root.rglob("*.ts")):
        targets = IMPORT.findall(path.read_text(encoding="utf-8"))
        bare = [os.path.normpath(path.parent / re.sub(r"\.[jt]s$", "", target)) for target in targets]
        imports[str(path)] = [f"{name}/index.ts" if Path(name).is_dir() else f"{name}.ts" for name in bare]
    return ["import cycle: " + " -> ".join(cycle) for cycle in cycles(imports)]


def cycles(targets_of: dict[str, list[str]]) -> list[list[str]]:
    """Depth-first search; names that are not keys are ignored."""
    state: dict[str, int] = {}
    found: list[list[str]] = []

    def visit(name: str, trail: list[str]) -> None:
        if state.get(name) == 1:
            found.append(trail[trail.index(name):] + [name])
        if name in state or name not in targets_of:
            return
        state[name] = 1
        for target in targets_of[name]:
            visit(target, trail + [name])
        state[name] = 2

    for name in targets_of:
        visit(name, [])
    return found


if __name__ == "__main__":
    problems = violations(ROOT, read_layers((ROOT / "LAYERS").read_text(encoding="utf-8")))
    problems += binding_violations(BINDINGS)
    problems += include_cycles(ROOT)
    problems += import_cycles(Path("web/src"))
    problems += citation_mismatches(ROOT, Path("docs/references.bib"), RATIOS)
    problems += undocumented_ratios(RATIOS, Path("docs/reference/soft-tissue-ratios.md"))
    problems += missing_tests(Path("docs/safety.md"))
    problems += oversized(Path("script/long_functions.tsv"))
    problems += deprecated_words(Path("script/deprecated_words.tsv"))
    print("\n".join(problems) or "layers, citations, sizes and words: ok")
    sys.exit(bool(problems))
