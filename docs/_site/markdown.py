"""Small helpers to write Markdown."""
import re


def escape(text: str) -> str:
    """Escapes what MyST would read as markup in plain text."""
    return re.sub(r"([\\`*_<>\[\]$#|{}])", r"\\\1", text)


def code(text: str) -> str:
    """Inline code; a table cell needs its bars escaped."""
    fence = "``" if "`" in text else "`"
    pad = " " if "`" in text else ""
    return f"{fence}{pad}{text}{pad}{fence}".replace("|", r"\|")


def prose(text: str) -> str:
    """Plain text in which `code` stays code."""
    return "".join(part if part.startswith("`") else escape(part) for part in re.split(r"(`[^`]+`)", text))


def key(name: str) -> str:
    """A key of nested objects, which may break after a dot."""
    return '<code class="literal">' + name.replace(".", ".<wbr>") + "</code>"


def table(head: list[str], rows: list[list[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(cell.replace("\n", " ") for cell in row) + " |" for row in lines) + "\n"
