#!/usr/bin/env python3
"""Writes the comments of C++ declarations into a C++ header, for the docstrings of the Python module.

    extract_docs.py OUTPUT HEADERS:HEADERS... SOURCE...

The sources (python/bindings) name a declaration as doc("geometry::TriangleMesh"). Its comment is found in the
public headers below the folders HEADERS. A name without a declaration, or a declaration without a comment, stops the build.
"""
import re
import sys
from collections.abc import Iterator
from pathlib import Path

USE = re.compile(r'\bdoc\(\s*"([\w:]+)"')
SCOPE = re.compile(r"^(?:template <[^>]*> )?(?:inline )?(namespace|struct|class|enum class|enum|union)\s+([\w:]*)")
WIDTH = 100


class Header:
    """Finds the declarations of one clang-formatted header, and their comments."""

    def __init__(self, text: str) -> None:
        self.found: dict[str, str] = {}
        self.parameters: dict[str, str] = {}
        self._scopes: list[tuple[str, str]] = []  # Kind and name.
        self._buffer = ""                         # The declaration so far.
        self._above: list[str] = []               # The comment above it.
        self._last: list[str] = []                # Names that a trailing comment belongs to.
        self._skip = 0                            # Open braces of a body or initial value.
        for line in text.splitlines():
            self._read_line(line)

    def _read_line(self, line: str) -> None:
        stripped = line.strip()
        if stripped.startswith("///<"):
            self._add_trailing(stripped[4:].strip())
        elif stripped.startswith("///"):
            if not self._buffer and not self._skip:
                self._above.append(stripped[3:].removeprefix(" "))
        elif not stripped or stripped.startswith("#"):
            if not self._buffer:
                self._above = []
        elif not stripped.startswith("//"):
            code, _, trailing = stripped.partition("///<")
            self._last = []
            self._read_code(code.partition(" // ")[0].rstrip() + " ")
            if trailing:
                self._add_trailing(trailing.strip())

    def _read_code(self, code: str) -> None:
        for character in code:
            if self._skip:
                self._skip += (character == "{") - (character == "}")
                if not self._skip and ")" in self._buffer and "=" not in self._buffer:
                    self._end_declaration()  # The body of a function.
            elif character == "{":
                self._open()
            elif character == "}":
                self._end_declaration()
                if self._scopes:
                    self._scopes.pop()
            elif character == ";" or (character == "," and self._scopes and self._scopes[-1][0].startswith("enum")):
                self._end_declaration()
            elif not (character == " " and not self._buffer):
                self._buffer += character

    def _open(self) -> None:
        match = SCOPE.match(self._buffer)
        if match is None or "(" in self._buffer:
            self._skip = 1
            return
        kind, name = match.groups()
        if kind != "namespace":
            self._register(name)
        self._scopes.append((kind, name))
        self._buffer, self._above = "", []

    def _end_declaration(self) -> None:
        text = re.sub(r"\[\[\w+\]\]", "", self._buffer).strip()
        is_plain = text and not text.startswith(("public", "private", "friend", "static_assert"))
        if is_plain:
            for name in declared_names(text):
                self._register(name)
        if text:
            self._above = []
        self._buffer = ""

    def _register(self, name: str) -> None:
        scopes = "::".join(scope for _, scope in self._scopes if scope)
        full = f"{scopes}::{name}".removeprefix("lefort::")
        self._last.append(full)
        if self._above and full not in self.found:
            self.found[full] = "\n".join(self._above)
        else:
            self.found.setdefault(full, "")

    def _add_trailing(self, text: str) -> None:
        names = self._last or ([] if not self.found else [next(reversed(self.found))])
        for name in names:
            self.found[name] = f"{self.found[name]}\n{text}".strip()


def declared_names(text: str) -> Iterator[str]:
    """The names in a declaration: one of a function or type, one or several of variables or enumerators."""
    if text.startswith("using "):
        yield text.split()[1]
        return
    head = re.sub(r"<[^()]*>", "", text)
    if "(" in head and "=" not in head.partition("(")[0]:
        match = re.search(r"(\w+)\s*\(", head)
        if match:
            yield match.group(1)
        return
    for part in re.sub(r"\([^)]*\)", "", head).split(","):
        match = re.search(r"(\w+)(?:\[\w*\])?$", part.partition("=")[0].strip())
        if match:
            yield match.group(1)


def python_name(match: re.Match[str]) -> str:
    """kFileNotFound is FileNotFound if it is an error, kSoftTissue is SOFT_TISSUE otherwise."""
    return match.group(1) if match.group(1) in ERRORS else re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", match.group(1)).upper()


ERRORS: set[str] = set()


def as_docstring(comment: str) -> str:
    """Doxygen's commands in words."""
    text = re.sub(r"\s*\\cite\s+([\w:-]+)", r" [\1]", comment)
    text = re.sub(r"\bk([A-Z]\w+)", python_name, text)
    text = re.sub(r"[a-z_/]+\.h\b", lambda m: f"{m.group(0)} of the C++ library", text)
    lines, has_parameters = [], False
    for line in text.splitlines():
        if line.startswith("\\param"):
            if not has_parameters:
                lines += ["", "Parameters:"]
                has_parameters = True
            line = re.sub(r"^\\param(?:\[\w+\])?\s+([\w, ]+?)\s\s+", r"    \1: ", line)
            line = re.sub(r"^\\param\s+(\w+)\s+", r"    \1: ", line)
        elif line.startswith("\\returns"):
            lines.append("")
            line = "Returns" + line.removeprefix("\\returns")
        line = re.sub(r"\\(note|pre|throws|post)\b\s*", lambda m: {"note": "Note: ", "pre": "Required: ",
                                                                    "throws": "Raises ", "post": "Then "}[m.group(1)], line)
        lines.append(line)
    return "\n".join(lines).strip()


def literal(text: str) -> str:
    """Adjacent literals, one a line."""
    lines = text.split("\n")
    quoted = []
    for number, line in enumerate(lines):
        end = "\\n" if number + 1 < len(lines) else ""
        quoted.append('"' + line.replace("\\", "\\\\").replace('"', '\\"') + end + '"')
    return "\n     ".join(quoted)


def main() -> None:
    output, sources = Path(sys.argv[1]), [Path(name) for name in sys.argv[3:]]
    roots = [Path(name) for name in sys.argv[2].split(":")]
    names = sorted({name for source in sources for name in USE.findall(source.read_text(encoding="utf-8"))})
    comments: dict[str, str] = {}
    for header in sorted(header for root in roots for header in root.rglob("*.h")):
        if "internal" in header.parts:
            continue
        for name, comment in Header(header.read_text(encoding="utf-8")).found.items():
            if comment or name not in comments:
                comments[name] = comments.get(name) or comment
    ERRORS.update(name.rpartition("::")[2].removeprefix("k") for name in comments if name.startswith("ErrorCode::"))
    missing = [name for name in names if not comments.get(name)]
    for name in missing:
        print(f"python/bindings: {name} " + ("has no comment in its header" if name in comments else
                                             f"is declared in no public header"), file=sys.stderr)
    if missing:
        sys.exit(1)
    text = ("// Generated by cmake/extract_docs.py.\n#pragma once\n\n#include <array>\n#include <string_view>\n\n"
            "namespace lefort::python {\n\nstruct Doc {\n  std::string_view name;\n  const char* text;\n};\n\n"
            f"inline constexpr std::array<Doc, {len(names)}> kDocs{{{{\n")
    for name in names:
        text += f'    {{"{name}",\n     {literal(as_docstring(comments[name]))}}},\n'
    text += "}};\n\n}  // namespace lefort::python\n"
    output.parent.mkdir(parents=True, exist_ok=True)
    output.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
