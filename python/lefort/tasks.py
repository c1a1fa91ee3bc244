"""The tasks of the command line: predict, solve, compare, validate, phantoms."""
from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any, Literal

from . import _lefort
from ._lefort import CancelToken, CtVolume, Progress, TriangleMesh
from .plan import Plan
from .results import Comparison, Phantom, Prediction, SolveResult, Validation

PathLike = str | os.PathLike[str]
ProgressCallback = Callable[[Progress], object]
Face = PathLike | Prediction | TriangleMesh

_LONG = """

All long functions have these parameters:
    progress: is called with a Progress when a stage begins, with each percent of it and each note. An
        exception in it stops the function and is raised.
    cancel: a CancelToken, which stops the function from another thread. Ctrl-C stops it, too.
    threads: 0 is all of the machine; the result is the same for any number.
The GIL is released.
"""


class _Folder:
    """Folders and files for one task; temporary ones are removed at its end."""

    def __init__(self) -> None:
        self._temporary = ExitStack()

    def __enter__(self) -> _Folder:
        return self

    def __exit__(self, *error: object) -> None:
        self._temporary.close()

    def temporary(self) -> Path:
        return Path(self._temporary.enter_context(tempfile.TemporaryDirectory(prefix="lefort-")))

    def output(self, given: PathLike | None) -> tuple[Path, Path | None]:
        """The folder of the results, and the same if it is kept."""
        if given is None:
            return self.temporary(), None
        return Path(given), Path(given)

    def scan(self, ct: PathLike | CtVolume | None) -> Path | None:
        if not isinstance(ct, CtVolume):
            return None if ct is None else Path(ct)
        file = self.temporary() / "ct.nrrd"
        _lefort.write_volume(file, ct)
        return file

    def plan(self, plan: PathLike | Plan) -> Path:
        if not isinstance(plan, Plan):
            return Path(plan)
        file = self.temporary() / "plan.json"
        plan.write(file)
        return file

    def deck(self, deck: PathLike | Mapping[str, Any], folder: PathLike) -> Path:
        if not isinstance(deck, Mapping):
            return Path(deck)
        start = Path(folder).absolute()
        moved = dict(deck)
        if isinstance(moved.get("mesh"), str):
            moved["mesh"] = str(start / moved["mesh"])
        if isinstance(moved.get("obstacles"), (list, tuple)):
            moved["obstacles"] = [
                {**one, "file": str(start / one["file"])} if isinstance(one, Mapping) and
                isinstance(one.get("file"), str) else one for one in moved["obstacles"]]
        file = self.temporary() / "deck.json"
        try:
            file.write_text(json.dumps(moved, allow_nan=False), encoding="utf-8")
        except (TypeError, ValueError) as error:
            raise _lefort.PlanInvalid(f"the deck is no JSON: {error}") from None
        return file

    def face(self, face: Face) -> Path:
        if isinstance(face, Prediction) and face.folder is not None:
            return face.folder
        if not isinstance(face, (Prediction, TriangleMesh)):
            return Path(face)
        file = self.temporary() / "face.vtp"
        _lefort.write_surface(file, face.skin if isinstance(face, Prediction) else face)
        return file


def predict(plan: PathLike | Plan, *, ct: PathLike | CtVolume | None = None, output: PathLike | None = None,
            pictures: bool = True, sensitivity: bool = True, progress: ProgressCallback | None = None,
            cancel: CancelToken | None = None, threads: int = 0) -> Prediction:
    if isinstance(plan, Plan) and plan.ct is None and ct is None:
        raise _lefort.PlanInvalid("the plan names no scan, and ct was not given")
    with _Folder() as files:
        folder, kept = files.output(output)
        text, warnings = _lefort.predict_case(
            files.plan(plan), files.scan(ct), folder, pictures=pictures and kept is not None, sensitivity=sensitivity,
            progress=progress, cancel=cancel, threads=threads)
        return Prediction._load(folder, json.loads(text), tuple(warnings), kept)


predict.__doc__ = f"""{_lefort.predict_case.__doc__}

Parameters:
    plan: a Plan, or its file.
    ct: the scan, instead of that of the plan.
    output: a folder for the results of `lefort predict`, which are the same files. Finished stages are
        stored there, too, and used again. None: nothing is kept.
    pictures: also draw; only with `output`.
    sensitivity: also solve with the interfaces bonded and contact on a coarse mesh.
Returns the predicted face; raises the errors above.{_LONG}"""


def solve(deck: PathLike | Mapping[str, Any], *, output: PathLike | None = None, folder: PathLike = ".",
          progress: ProgressCallback | None = None, cancel: CancelToken | None = None,
          threads: int = 0) -> SolveResult:
    with _Folder() as files:
        out, kept = files.output(output)
        text, _ = _lefort.solve_deck(files.deck(deck, folder), out, check_only=False, progress=progress, cancel=cancel,
                                     threads=threads)
        return SolveResult._load(out, json.loads(text), kept)


solve.__doc__ = f"""{_lefort.solve_deck.__doc__}

Parameters:
    deck: a file, or the same as a dict.
    output: a folder for the results of `lefort solve`. None: nothing is kept.
    folder: where relative paths of a dict start.
Returns the result; raises the errors above.{_LONG}"""


def compare(face: Face, other: Face | None = None, *, after_ct: PathLike | CtVolume | None = None,
            before: Face | None = None, landmarks: PathLike | None = None, output: PathLike | None = None,
            pictures: bool = True, progress: ProgressCallback | None = None, cancel: CancelToken | None = None,
            threads: int = 0) -> Comparison:
    with _Folder() as files:
        folder, kept = files.output(output)
        text, _ = _lefort.compare_faces(
            files.face(face), None if other is None else files.face(other), files.scan(after_ct),
            None if before is None else files.face(before), None if landmarks is None else Path(landmarks), folder,
            pictures=pictures and kept is not None, progress=progress, cancel=cancel, threads=threads)
        return Comparison._of(json.loads(text), kept)


compare.__doc__ = f"""{_lefort.compare_faces.__doc__}

Parameters:
    face: a surface, its file, a Prediction, or its folder.
    other: the other face.
    after_ct: a scan after surgery, instead of `other`.
    before: the skin before surgery; None: that of the prediction `face`.
    landmarks: file of landmarks before surgery; None: those of the prediction `face`.
    output: a folder for the results of `lefort compare`. None: nothing is kept.
    pictures: also draw; only with `output`.
Returns the result; raises the errors above.{_LONG}"""


def validate(cohort: PathLike, *, output: PathLike, achieved_movements: bool = False,
             element_size_mm: float | None = None, voxel_mm: float = 1.0, pictures: bool = True,
             progress: ProgressCallback | None = None, cancel: CancelToken | None = None,
             threads: int = 0) -> Validation:
    text, _ = _lefort.validate_cohort(
        Path(cohort), Path(output), achieved_movements=achieved_movements, element_size_mm=element_size_mm,
        voxel_mm=voxel_mm, pictures=pictures, progress=progress, cancel=cancel, threads=threads)
    del text  # A summary; the result is in the file.
    return Validation._of(json.loads((Path(output) / "validation.json").read_text(encoding="utf-8")), Path(output))


validate.__doc__ = f"""{_lefort.validate_cohort.__doc__}

Parameters:
    cohort: a folder of case folders (docs/guide/validate.md).
    output: a folder for the results of `lefort validate`.
    achieved_movements: predict the movements found in the bone after surgery, not those of the plans.
    element_size_mm: instead of that of the plans.
    voxel_mm: voxel edge of scans that are computed for cases with surfaces only.
    pictures: also draw.
Returns the result; raises the errors above.{_LONG}"""


def make_phantom(output: PathLike, *, head: Literal["simple", "teeth"] = "simple", voxel_mm: float = 1.4,
                 noise_hu: float = 12.0, progress: ProgressCallback | None = None, cancel: CancelToken | None = None,
                 threads: int = 0) -> Phantom:
    _lefort.make_phantom(Path(output), head=head, voxel_mm=voxel_mm, noise_hu=noise_hu, progress=progress,
                         cancel=cancel, threads=threads)
    folder = Path(output)
    landmarks = folder / "landmarks.mrk.json"
    return Phantom(folder / "dicom", folder / "labels.seg.nrrd", landmarks if landmarks.is_file() else None)


make_phantom.__doc__ = f"""{_lefort.make_phantom.__doc__}

Parameters:
    output: a folder; made if missing.
    head: "simple" shapes, or the head with "teeth".
    voxel_mm: edge of a voxel.
    noise_hu: standard deviation of the noise of the scan.
Returns the files; raises the errors above.{_LONG}"""


def make_phantom_cohort(output: PathLike, *, cases: int = 10, voxel_mm: float = 2.0, element_size_mm: float = 5.0,
                        seed: int = 1, progress: ProgressCallback | None = None, cancel: CancelToken | None = None,
                        threads: int = 0) -> list[Path]:
    text, _ = _lefort.make_phantom_cohort(Path(output), cases=cases, voxel_mm=voxel_mm,
                                          element_size_mm=element_size_mm, seed=seed, progress=progress,
                                          cancel=cancel, threads=threads)
    return [Path(output) / case["case"] for case in json.loads(text)["cases"]]


make_phantom_cohort.__doc__ = f"""{_lefort.make_phantom_cohort.__doc__}

Parameters:
    output: a folder; made if missing; must be empty.
    cases: number of cases.
    voxel_mm: voxel edge of the scans.
    element_size_mm: of the plans.
    seed: of the random numbers.
Returns the folders of the cases; raises the errors above.{_LONG}"""
