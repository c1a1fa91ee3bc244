"""The list of references, from docs/references.bib."""
import re
from pathlib import Path

ENTRY = re.compile(r"^@(\w+)\{([^,\s]+),(.*)\}\s*$", re.MULTILINE)
ACCENTS = {r"{\ae}": "æ", r"{\ss}": "ß", r"{\v{e}}": "ě", r"{\v s}": "š", r'{\"a}': "ä", r'{\"o}': "ö", r"{\'e}": "é",
           r"{\o}": "ø", "--": "–"}


def fields(body: str) -> dict[str, str]:
    """Fields `name={...}` of an entry that stands on one line; braces nest."""
    found: dict[str, str] = {}
    for match in re.finditer(r"(\w+)=\{", body):
        depth, end = 1, match.end()
        while depth:
            depth += {"{": 1, "}": -1}.get(body[end], 0)
            end += 1
        found.setdefault(match.group(1), body[match.end():end - 1])
    return found


def plain(text: str) -> str:
    for latex, character in ACCENTS.items():
        text = text.replace(latex, character)
    return re.sub(r"[{}]", "", text).replace("*", r"\*").replace("_", r"\_")


def read_bibliography(file: Path) -> dict[str, dict[str, str]]:
    return {key: fields(body) for _, key, body in ENTRY.findall(file.read_text(encoding="utf-8"))}


def line_of(entry: dict[str, str]) -> str:
    where = entry.get("journal") or entry.get("booktitle") or entry.get("publisher") or entry.get("organization", "")
    numbers = entry.get("volume", "") + (f"({entry['number']})" if "number" in entry else "")
    authors = plain(entry.get("author", "")).replace(" and others", " et al.").replace(" and ", ", ")
    parts = [authors, f"*{plain(entry['title'])}*", plain(where),
             numbers + (f":{plain(entry['pages'])}" if "pages" in entry else ""), entry.get("year", "")]
    text = ". ".join(part.removesuffix(".") for part in parts if part) + "."
    if "url" in entry:
        text += f" <{entry['url']}>"
    if "doi" in entry:
        text += f" [doi:{entry['doi'].replace('<', '&lt;').replace('>', '&gt;')}](<https://doi.org/" + \
            entry["doi"].replace("<", "%3C").replace(">", "%3E") + ">)"
    if "note" in entry:
        text += f" {plain(entry['note'])}."
    return text


def write_bibliography(entries: dict[str, dict[str, str]], page: Path) -> None:
    lines = ["# References\n", "From ``docs/references.bib``. Source files cite these keys with ``\\cite``.\n"]
    for key, entry in sorted(entries.items(), key=lambda item: item[0]):
        lines.append(f"(ref-{key.replace(':', '-')})=\n- **{key}** {line_of(entry)}\n")
    page.write_text("\n".join(lines), encoding="utf-8")
