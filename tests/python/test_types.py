"""Stubs, docstrings and types."""
import inspect
import os
import subprocess
import sys

import pytest

import lefort
from lefort import _lefort


def public_objects():
    for name in lefort.__all__:
        if name in ("NOTICE", "__version__"):
            continue
        thing = getattr(lefort, name)
        yield name, thing
        if isinstance(thing, type):
            for member, value in vars(thing).items():
                is_data = not callable(value) and not isinstance(value, (property, staticmethod, classmethod))
                if not member.startswith("_") and not is_data:
                    yield f"{name}.{member}", getattr(thing, member)


@pytest.mark.parametrize("name, thing", public_objects())
def test_each_public_object_has_a_docstring(name, thing):
    text = inspect.getdoc(thing)
    assert text and len(text) > 8, name
    assert not text.startswith(f"{name}(") and "\\param" not in text and "\\returns" not in text


def test_all_names_are_exported_and_everything_is_listed():
    assert sorted(lefort.__all__) == sorted(set(lefort.__all__))
    private = {"check_plan", "check_plan_form", "rename_plan_keys", "PLAN_SCHEMA", "predict_case", "solve_deck",
               "compare_faces", "validate_cohort", "find_landmarks", "measure", "make_phantom", "make_phantom_cohort"}
    compiled = {name for name in vars(_lefort) if not name.startswith("_")}
    assert compiled - private <= set(lefort.__all__)


def test_each_error_has_its_code_and_base():
    errors = [one for one in vars(lefort).values() if isinstance(one, type) and issubclass(one, lefort.Error)]
    assert len(errors) == 18 and len({one.code for one in errors}) == 18
    assert issubclass(lefort.MeshInvalid, ValueError) and issubclass(lefort.OutOfMemory, MemoryError)


def test_docstrings_are_those_of_the_headers(source):
    header = (source / "src/lefort/geometry/mesh_properties.h").read_text()
    comment = header.split("[[nodiscard]] double signed_volume_mm3")[0].rsplit("\n\n", 1)[1]
    assert lefort.TriangleMesh.signed_volume_mm3.__doc__ == comment.replace("/// ", "").strip()
    assert "NotConverged" in lefort.predict.__doc__ and "kNotConverged" not in lefort.predict.__doc__


def run_mypy(arguments, folder):
    environment = {**os.environ, "MYPYPATH": os.environ["PYTHONPATH"]}
    return subprocess.run([sys.executable, "-m", *arguments], capture_output=True, text=True, cwd=folder,
                          env=environment, check=False)


def test_package_and_notebooks_are_typed(source, tmp_path):
    notebooks = sorted(str(file) for file in (source / "examples" / "python").glob("*.py"))
    assert len(notebooks) == 3
    options = ["--config-file", str(source / "python" / "mypy.ini"), "--cache-dir", str(tmp_path)]
    done = run_mypy(["mypy", *options, "-p", "lefort"], tmp_path)
    assert done.returncode == 0, done.stdout
    for notebook in notebooks:
        done = run_mypy(["mypy", *options, notebook], tmp_path)
        assert done.returncode == 0, done.stdout


def test_stubs_agree_with_the_module(source, tmp_path):
    (tmp_path / "allowed.txt").write_text(
        "lefort._lefort._Volume\n"          # Common to three classes in the stub alone.
        "lefort._lefort.*.__init__\n"       # pybind11 has no signatures that Python can inspect.
        "lefort._lefort.[A-Z][A-Za-z]*\n"   # pybind11 has a metaclass of its own; members are still compared.
    )
    done = run_mypy(["mypy.stubtest", "lefort._lefort", "--allowlist", str(tmp_path / "allowed.txt"),
                     "--ignore-unused-allowlist"], tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_missing_comment_stops_the_build(source, tmp_path):
    script = source / "cmake" / "extract_docs.py"
    (tmp_path / "headers").mkdir()
    (tmp_path / "headers" / "a.h").write_text("namespace lefort {\nint bare();\n/// Has one.\nint good();\n}\n")

    def extract(name):
        (tmp_path / "b.cpp").write_text(f'doc("{name}")')
        return subprocess.run([sys.executable, script, tmp_path / "out.h", tmp_path / "headers", tmp_path / "b.cpp"],
                              capture_output=True, text=True, check=False)

    assert extract("good").returncode == 0 and '"Has one."' in (tmp_path / "out.h").read_text()
    assert extract("bare").returncode == 1 and "bare has no comment" in extract("bare").stderr
    assert "declared in no public header" in extract("none").stderr
