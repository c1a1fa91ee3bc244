"""The C++ reference: one page per layer, from Doxygen's XML of the public headers."""
import xml.etree.ElementTree as ElementTree
from collections import defaultdict
from pathlib import Path

from markdown import escape

KINDS = {"note": "Note", "pre": "Precondition", "post": "Postcondition", "warning": "Warning", "see": "See"}


def text_of(node, known_keys: set[str]) -> str:
    """Markdown of a Doxygen description, with citations linked to the list of references."""
    out = [escape(node.text or "")]
    for child in node:
        out.append(block(child, known_keys))
        out.append(escape(child.tail or ""))
    joined = "".join(out)
    for key in known_keys:
        joined = joined.replace(escape(f"[cite:{key}]"), f"[\\[{key}\\]]({anchor(key)})")
    return joined


def anchor(key: str) -> str:
    return "ref-" + key.replace(":", "-")


def raw(node) -> str:
    return "".join(node.itertext())


def block(node, keys: set[str]) -> str:
    tag = node.tag
    if tag == "para":
        return "\n\n" + text_of(node, keys) + "\n\n"
    if tag in {"computeroutput", "verbatim"} and "\n" not in raw(node):
        return f"``{raw(node)}``" if raw(node).strip() else ""
    if tag in {"verbatim", "preformatted", "programlisting"}:
        return "\n\n```\n" + raw(node).strip("\n") + "\n```\n\n"
    if tag in {"itemizedlist", "orderedlist"}:
        items = [" ".join(text_of(item, keys).split()) for item in node]
        return "\n\n" + "\n".join(f"- {item}" for item in items) + "\n\n"
    if tag == "parameterlist":
        items = [parameter(item, keys) for item in node]
        return "\n\n" + "\n".join(items) + "\n\n"
    if tag == "simplesect":
        label = "Returns" if node.get("kind") == "return" else KINDS.get(node.get("kind"), node.get("kind").title())
        return f"\n\n**{label}:** " + text_of(node, keys).strip() + "\n\n"
    if tag in {"sp", "linebreak"}:
        return " "
    if tag in {"ndash", "mdash"}:
        return "–"
    if tag == "table":
        return "\n\n```\n" + "\n".join("  ".join(raw(c).strip() for c in row) for row in node) + "\n```\n\n"
    return text_of(node, keys)


def parameter(item, keys: set[str]) -> str:
    names = ", ".join(f"``{raw(name)}``" for name in item.iter("parametername"))
    description = item.find("parameterdescription")
    return f"- {names}: " + " ".join(text_of(description, keys).split())


def description(node, keys: set[str]) -> str:
    parts = [text_of(part, keys) for name in ("briefdescription", "detaileddescription")
             if (part := node.find(name)) is not None]
    lines = "\n\n".join(parts).split("\n")
    return "\n".join(line.rstrip() for line in lines).strip()


def signature(member) -> str:
    kind = member.get("kind")
    name = raw(member.find("name"))
    if kind == "enum":
        values = ", ".join(raw(value.find("name")) for value in member.iter("enumvalue"))
        return f"enum class {name} {{ {values} }}"
    declared = raw(member.find("type")).strip() if member.find("type") is not None else ""
    declared = declared.replace("LEFORT_NODISCARD ", "").replace("< ", "<").replace(" >", ">")
    if kind == "function":
        arguments = raw(member.find("argsstring")).replace("< ", "<").replace(" >", ">")
        return f"{declared} {name}{arguments}".strip()
    if kind == "typedef":
        return f"using {name} = {declared}"
    value = member.find("initializer")
    return f"{declared} {name}{' ' + raw(value).strip() if value is not None else ''}"


def members(node, keys: set[str]) -> list[str]:
    out = []
    for member in node.iter("memberdef"):
        if member.get("prot") == "private" or raw(member.find("name")).startswith("@"):
            continue
        words = description(member, keys)
        values = [f"- ``{raw(value.find('name'))}``: " + " ".join(description(value, keys).split())
                  for value in member.iter("enumvalue") if description(value, keys)]
        if member.get("kind") == "variable" and "\n" not in words:
            out.append(f"- ``{signature(member)}``" + (f": {words}" if words else ""))
            continue
        out.append("\n```cpp\n" + signature(member) + "\n```\n\n" + words + "\n\n" + "\n".join(values) + "\n")
    return out


def header_section(xml: Path, keys: set[str]) -> tuple[str, str, str] | None:
    """(layer, path, Markdown) of a header, or nothing if the file is no header of a layer."""
    root = ElementTree.parse(xml).getroot().find("compounddef")
    path = root.find("location").get("file")
    path = path[path.index("lefort/"):] if "lefort/" in path else path
    parts = path.split("/")
    if len(parts) < 3 or not path.endswith(".h"):
        return None
    out = [f"## {escape('/'.join(parts[2:]))}\n", description(root, keys), ""]
    for inner in root.findall("innerclass"):
        if inner.get("prot") == "private":
            continue
        class_root = ElementTree.parse(xml.parent / f"{inner.get('refid')}.xml").getroot().find("compounddef")
        name = raw(inner).removeprefix("lefort::")
        out += [f"### {escape(class_root.get('kind'))} {escape(name)}\n", description(class_root, keys), ""]
        out += members(class_root, keys)
    free = members(root, keys)
    if free and root.findall("innerclass"):
        out.append("### Functions and constants\n")
    return parts[1], path, "\n".join(out + free) + "\n"


def write_cpp_reference(xml: Path, layers: dict[str, str], keys: set[str], folder: Path) -> list[str]:
    """Writes one page per layer, in the order of `layers` (name and what it may include)."""
    sections: dict[str, list[tuple[str, str]]] = defaultdict(list)
    for file in sorted(xml.glob("*_8h.xml")):
        found = header_section(file, keys)
        if found:
            sections[found[0]].append((found[1], found[2]))
    folder.mkdir(parents=True, exist_ok=True)
    pages = []
    for layer, includes in layers.items():
        body = [f"# {layer}\n", f"May include: {includes or 'nothing else'}. Namespace ``lefort::{layer}``.\n"]
        body += [text for _, text in sorted(sections.get(layer, []))]
        (folder / f"{layer}.md").write_text("\n".join(body), encoding="utf-8")
        pages.append(f"cpp/{layer}")
    return pages
