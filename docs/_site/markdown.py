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


def table(head: list[str], rows: list[list[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(cell.replace("\n", " ") for cell in row) + " |" for row in lines) + "\n"
