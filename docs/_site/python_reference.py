"""The Python reference: the docstrings of the package of the build tree, and the signatures of its stubs."""
import ast
import inspect
import subprocess
import sys
from pathlib import Path
from types import ModuleType

PYTHON = "/usr/bin/python3"  # For which the module is built.
GROUPS = [
    ("Volumes and segmentation", ["CtVolume", "LabelMap", "ScalarVolume", "Tissue", "import_scan", "write_volume",
                                  "reduce_metal_streaks", "find_thresholds", "segment", "tissue_volumes_ml",
                                  "read_segmentation", "write_segmentation", "bone_surface", "skin_surface"]),
    ("Meshes", ["TriangleMesh", "Bvh", "read_surface", "write_surface", "VolumeMesh", "ElementBlock",
                "read_volume_mesh", "read_vtu_vectors"]),
    ("Distance fields", ["DistanceField", "Zone", "read_field", "write_field"]),
    ("Landmarks", ["find_landmarks", "LandmarkSearch", "measure", "Measurement", "read_landmarks", "write_landmarks"]),
    ("Plans", ["Plan", "Segment", "Osteotomy", "Template", "CutPlane", "CutCurve", "CutRegion", "RigidPath", "Keyframe",
               "Autorotation", "Distraction", "Segmentation", "SoftTissue", "Skin", "Mucosa", "Muscle", "Material",
               "Boundary", "Contact", "Field", "Solver"]),
    ("Tasks", ["predict", "Prediction", "Step", "compare", "Comparison", "RegionDistance", "DistanceStatistics", "solve",
               "SolveResult", "Increment", "validate", "Validation", "ValidationCase", "CaseRegion", "make_phantom",
               "Phantom", "make_phantom_cohort", "Progress", "CancelToken"]),
]


def stub_signatures(stub: Path) -> dict[str, str]:
    """Signatures by "name" or "Class.name"."""
    found: dict[str, str] = {}

    def visit(body: list[ast.stmt], prefix: str) -> None:
        for node in body:
            if isinstance(node, ast.ClassDef):
                visit(node.body, f"{node.name}.")
            elif isinstance(node, ast.FunctionDef):
                result = f" -> {ast.unparse(node.returns)}" if node.returns else ""
                found[prefix + node.name] = f"({ast.unparse(node.args)}){result}"

    visit(ast.parse(stub.read_text(encoding="utf-8")).body, "")
    return found


def section(name: str, thing: object, signatures: dict[str, str]) -> list[str]:
    signature = signatures.get(f"{name}.__init__", signatures.get(name, ""))
    if not signature and callable(thing):
        try:
            signature = str(inspect.signature(thing))
        except ValueError:  # A compiled class that Python code does not construct.
            signature = ""
    if "<factory>" in signature:
        signature = ""
    is_plan = isinstance(thing, type) and thing.__module__ == "lefort.plan"
    kind = "class " if isinstance(thing, type) else ""
    head = f"{kind}{name}" if is_plan or not signature else f"{kind}{name}{signature}".replace("(self, ", "(")
    lines = [f"### {name}", "", "```python", head, "```", "", "```", inspect.getdoc(thing) or "", "```", ""]
    if not isinstance(thing, type):
        return lines
    for member, value in vars(thing).items():
        if member.startswith("_") or not (callable(value) or isinstance(value, (property, staticmethod, classmethod))):
            continue
        text = inspect.getdoc(getattr(thing, member)) or ""
        form = signatures.get(f"{name}.{member}", "") if not isinstance(value, property) else ""
        form = form.replace("(self, ", "(").replace("(self)", "()")
        lines += [f"**`{member}{form}`**", "", "```", text, "```", ""]
    return lines


def pages(module: ModuleType) -> str:
    signatures = stub_signatures(Path(str(module.__file__)).parent / "_lefort.pyi")
    lines = ["# Python", "", f"Docstrings and types of `import lefort`; [guide](../guide/python.md). {module.NOTICE}", ""]
    errors = sorted(name for name in module.__all__
                    if isinstance(getattr(module, name), type) and issubclass(getattr(module, name), module.Error))
    listed = {name for _, names in GROUPS for name in names}
    missing = set(module.__all__) - listed - set(errors) - {"NOTICE", "__version__"}
    if missing:
        sys.exit(f"docs/_site/python_reference.py: GROUPS lacks {sorted(missing)}")
    for title, names in GROUPS:
        lines += [f"## {title}", ""]
        for name in names:
            lines += section(name, getattr(module, name), signatures)
    lines += ["## Errors", "", "| class | code | also a | meaning |", "|---|---|---|---|"]
    for name in errors:
        error = getattr(module, name)
        also = ", ".join(f"`{base.__name__}`" for base in error.__bases__ if base not in (module.Error, Exception))
        meaning = " ".join((inspect.getdoc(error) or "").split())
        lines.append(f"| `{name}` | `{error.code}` | {also} | {meaning} |")
    return "\n".join(lines) + "\n"


def write_python_reference(package: Path, folder: Path) -> None:
    """Runs this file with the interpreter of the module, which may be another one."""
    done = subprocess.run([PYTHON, __file__, package], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(done.stderr)
    (folder / "python.md").write_text(done.stdout, encoding="utf-8")


if __name__ == "__main__":
    sys.path.insert(0, sys.argv[1])
    import lefort

    print(pages(lefort), end="")
