"""The command-line reference: what `lefort --help` and the help of each command print."""
import re
import subprocess
from pathlib import Path

MAX_DEPTH = 3


def help_of(program: str, words: list[str]) -> str:
    done = subprocess.run([program, *words, "--help"], capture_output=True, text=True, timeout=20, check=True)
    return done.stdout.rstrip()


def subcommands(text: str) -> list[str]:
    """Names listed under "Subcommands:" in a help text of CLI11."""
    _, _, listed = text.partition("Subcommands:")
    return re.findall(r"^  ([a-z][\w-]*)", listed, re.MULTILINE)


def write_cli_reference(program: str, folder: Path) -> list[str]:
    sections = []

    def visit(words: list[str]) -> None:
        text = help_of(program, words)
        sections.append(f"## {' '.join(['lefort', *words])}\n\n```\n{text}\n```\n")
        if len(words) < MAX_DEPTH:
            for name in subcommands(text):
                visit([*words, name])

    visit([])
    intro = ("# Command line\n\nPrinted by `lefort --help` and the help of each command. Exit code 0: done; 1: failed, one\n"
             "line on stderr says why; 2: wrong usage.\n\n")
    (folder / "cli.md").write_text(intro + "\n".join(sections), encoding="utf-8")
    return ["cli"]
