#!/usr/bin/python3
"""Manual pages, completion in bash and modules for 3D Slicer of the built program.

    test_reference.py PROGRAM SOURCE_FOLDER
"""
import copy
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from lxml import etree

PROGRAM = Path(sys.argv[1])
SOURCE = Path(sys.argv[2])


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([str(PROGRAM), *arguments], capture_output=True, text=True, timeout=120)


def commands(words: tuple[str, ...] = ()) -> list[tuple[str, ...]]:
    """All commands that the help texts list."""
    _, _, listed = run(*words, "--help").stdout.partition("Subcommands:")
    found = []
    for name in re.findall(r"^  ([a-z][\w-]*)", listed, re.MULTILINE):
        found += [(*words, name), *commands((*words, name))]
    return found


class ManualPages(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = tempfile.TemporaryDirectory()
        cls.done = run("--write-reference", cls.folder.name)
        cls.pages = Path(cls.folder.name) / "man1"

    @classmethod
    def tearDownClass(cls) -> None:
        cls.folder.cleanup()

    def test_each_command_has_a_page_and_there_is_no_other(self) -> None:
        self.assertEqual(self.done.returncode, 0, self.done.stderr)
        wanted = {"lefort.1"} | {"-".join(("lefort", *words)) + ".1" for words in commands()}
        self.assertIn("lefort-plan-check.1", wanted)
        self.assertEqual({page.name for page in self.pages.iterdir()}, wanted)

    def test_man_formats_each_page_without_a_warning(self) -> None:
        for page in sorted(self.pages.iterdir()):
            done = subprocess.run(["man", "--warnings=all", "-E", "UTF-8", "-l", "-Tutf8", "-Z", str(page)],
                                  capture_output=True, text=True, timeout=60)
            self.assertEqual((done.returncode, done.stderr), (0, ""), page.name)

    def test_each_option_of_the_help_is_in_the_page(self) -> None:
        for words in [(), *commands()]:
            page = run(*words, "--man").stdout.replace("\\-", "-")
            for option in re.findall(r"^  (?:-\w,)?(--[a-z][\w-]*)", run(*words, "--help").stdout, re.MULTILINE):
                if option != "--help":
                    self.assertIn(f"\\fB{option}\\fR", page, words)

    def test_names_in_see_also_are_pages(self) -> None:
        names = {page.stem for page in self.pages.iterdir()}
        for page in self.pages.iterdir():
            _, _, listed = page.read_text().replace("\\-", "-").partition(".SH SEE ALSO")
            others = set(re.findall(r"^\.BR (\S+) \(1\)", listed, re.MULTILINE))
            self.assertTrue(others and others <= names - {page.stem}, page.name)

    def test_a_folder_that_cannot_be_written_is_one_line_and_exit_code_1(self) -> None:
        done = run("--write-reference", "/proc/none")
        self.assertEqual(done.returncode, 1)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)


class Completion(unittest.TestCase):
    def proposals(self, *words: str, files: tuple[str, ...] = ()) -> set[str]:
        """What bash proposes for the last word, in a folder with these files; a name ending in / is a folder."""
        with tempfile.TemporaryDirectory() as folder:
            for name in files:
                path = Path(folder) / name
                path.mkdir() if name.endswith("/") else path.write_text("")
            script = ('source <("$0" --bash-completion) && [[ $(complete -p lefort) == "complete -F _lefort lefort" ]] '
                      '|| exit 9; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _lefort; printf "%s\\n" "${COMPREPLY[@]}"')
            done = subprocess.run(["bash", "--norc", "-c", script, str(PROGRAM), "lefort", *words],
                                  capture_output=True, text=True, cwd=folder, timeout=60)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            return set(done.stdout.split("\n")) - {""}

    def test_commands_and_nested_commands(self) -> None:
        self.assertEqual(self.proposals("pre"), {"predict"})
        self.assertEqual(self.proposals(""), {words[0] for words in commands() if len(words) == 1})
        self.assertEqual(self.proposals("plan", ""), {words[1] for words in commands() if words[0] == "plan" and len(words) > 1})

    def test_options_of_the_command_and_of_all_commands(self) -> None:
        self.assertEqual(self.proposals("plan", "check", "--su"), {"--support", "--support-fraction"})
        self.assertIn("--threads", self.proposals("predict", "plan.json", "--"))
        self.assertNotIn("--bone-hu", self.proposals("predict", "--"))

    def test_choices_of_values(self) -> None:
        self.assertEqual(self.proposals("field", "build", "--method", ""), {"bricks", "hybrid", "adaptive", "uniform"})
        self.assertEqual(self.proposals("field", "build", "--resolution", "25"), {"256"})

    def test_files_by_extension_and_folders(self) -> None:
        files = ("plan.json", "ct.nrrd", "notes.txt", "out/")
        self.assertEqual(self.proposals("predict", "", files=files), {"plan.json", "out"})
        self.assertEqual(self.proposals("predict", "plan.json", "--ct", "", files=files), {"ct.nrrd", "out"})
        self.assertEqual(self.proposals("predict", "-o", "", files=files), {"out"})
        self.assertEqual(self.proposals("predict", "not", files=files), {"notes.txt"})  # None fits: any file.

    def test_a_value_that_is_a_number_has_no_proposals(self) -> None:
        self.assertEqual(self.proposals("segment", "--bone-hu", "", files=("a.nrrd",)), set())
        self.assertEqual(self.proposals("segment", "--threads", "", files=("a.nrrd",)), set())


class SlicerModules(unittest.TestCase):
    schema = etree.XMLSchema(etree.parse(str(SOURCE / "contract" / "slicer_module.xsd")))

    def description(self, *words: str) -> etree._Element:
        done = run(*words, "--xml")
        self.assertEqual(done.returncode, 0, done.stderr)
        return etree.fromstring(done.stdout.encode())

    def command_of_slicer(self, words: tuple[str, ...], values: dict[str, str]) -> list[str]:
        """The command line of 3D Slicer: all flags with a value, then the arguments in the order of the indices."""
        flags, arguments = [], {}
        for one in self.description(*words).iterfind("parameters/*[name]"):
            value = values.get(one.findtext("name"), one.findtext("default") or "")
            flag, index = one.findtext("longflag"), one.findtext("index")
            if one.tag == "boolean":
                flags += [f"--{flag}"] if value == "true" else []
            elif index is not None:
                arguments[int(index)] = value
            elif value or not one.tag.startswith(("file", "directory", "image", "string", "double-vector", "integer-vector")):
                flags += [f"--{flag}", value]
        return ["--slicer-progress", *words, *flags, *(arguments[index] for index in sorted(arguments))]

    def test_the_schema_rejects_what_3d_slicer_does_not_read(self) -> None:
        valid = self.description("segment")
        self.assertTrue(self.schema.validate(valid), self.schema.error_log)

        def changed(change) -> bool:
            tree = copy.deepcopy(valid)
            change(tree)
            return self.schema.validate(tree)

        flag = "parameters/integer/longflag"
        self.assertFalse(changed(lambda tree: tree.remove(tree.find("title"))))
        self.assertFalse(changed(lambda tree: setattr(tree.find(flag), "text", "--smooth")))
        self.assertFalse(changed(lambda tree: setattr(tree.find("parameters/integer/default"), "text", "many")))
        self.assertFalse(changed(lambda tree: setattr(tree.find("parameters/image/name"), "text", "the scan")))
        self.assertFalse(changed(lambda tree: setattr(tree.find("parameters/image/channel"), "text", "both")))
        self.assertFalse(changed(lambda tree: tree.find("parameters/integer").remove(tree.find(flag))))
        self.assertFalse(changed(lambda tree: setattr(tree.find("parameters/directory/name"), "text", "ct")))

    def test_a_command_that_is_no_module_is_wrong_usage(self) -> None:
        for words in ((), ("bench", "solve"), ("plan",)):
            done = run(*words, "--xml")
            self.assertEqual((done.returncode, done.stdout), (2, ""), words)
            self.assertIn("is not a module of 3D Slicer", done.stderr)

    def test_command_lines_of_3d_slicer_run(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            scan, labels = f"{folder}/ct.nrrd", f"{folder}/anatomy"
            self.assertEqual(run("phantom", "--voxel", "4", "-o", f"{folder}/head").returncode, 0)
            for words, values, result in (
                (("import",), {"source": f"{folder}/head/dicom", "output": scan}, scan),
                (("segment",), {"ct": scan, "output": labels}, f"{labels}/skull.vtp"),
                (("field", "build"), {"surface": f"{labels}/skull.vtp", "output": f"{folder}/a.field", "resolution": "32"},
                 f"{folder}/a.field"),
                (("solve",), {"deck": str(SOURCE / "examples/solve/stretch.json"), "output": f"{folder}/solve"},
                 f"{folder}/solve/solve.json"),
            ):
                done = run(*self.command_of_slicer(words, values))
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertTrue(Path(result).exists(), words)
                fractions = [float(text) for text in re.findall(r"<filter-progress>(.*)</filter-progress>", done.stdout)]
                self.assertTrue(fractions and all(0 <= one <= 1 for one in fractions), done.stdout)
                self.assertEqual(done.stdout.count("<filter-start>"), done.stdout.count("<filter-end>"))
                self.assertTrue(all(text not in done.stderr for text in ("[=", " s\n")), done.stderr)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
