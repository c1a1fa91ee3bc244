"""Results of the tasks, as typed objects. `json` is the result file, with all values."""
from __future__ import annotations

import json as json_module
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _lefort
from ._lefort import FileNotFound, NotConverged, TriangleMesh

Json = dict[str, Any]


def _read_json(file: Path) -> Json:
    loaded = json_module.loads(file.read_text(encoding="utf-8"))
    if not isinstance(loaded, dict):
        raise _lefort.FileCorrupt(f"{file} is no result of lefort")
    return loaded


def _vector(value: Any) -> NDArray[np.float64]:
    return np.asarray(value, dtype=np.float64)


@dataclass(frozen=True, eq=False)
class Step:
    """A converged step of a prediction.

    Fields:
        path_fraction: fraction of the planned bone motion, 0 to 1.
        poses_L: 4 by 4 pose of each segment, by name; it maps bone as scanned to frame L [mm].
        max_displacement_mm: of a node.
        max_penetration_mm: of tissue into the obstacles of the segments.
        p99_penetration_increase_mm: 99th percentile over the contact area.
        contact_area_mm2: of tissue with the segments, at rest.
        relative_residual: of the last Newton iteration.
        newton_iterations: of all attempts of the step.
    """

    path_fraction: float
    poses_L: dict[str, NDArray[np.float64]] = field(repr=False)
    max_displacement_mm: float
    max_penetration_mm: float
    p99_penetration_increase_mm: float
    contact_area_mm2: float
    relative_residual: float
    newton_iterations: int

    @classmethod
    def _of(cls, step: Json) -> Step:
        contact = step["contact"]
        return cls(
            path_fraction=step["path_fraction"],
            poses_L={one["name"]: _vector(one["pose_4x4_row_major_mm_lps"]).reshape(4, 4)
                     for one in step["segments"]},
            max_displacement_mm=step["max_displacement_mm"],
            max_penetration_mm=contact["max_penetration_mm"],
            p99_penetration_increase_mm=contact["p99_penetration_increase_mm"],
            contact_area_mm2=contact["area_mm2"],
            relative_residual=step["relative_residual"],
            newton_iterations=sum(max(len(one["newton"]) - 1, 0) for one in step["attempts"]))


@dataclass(frozen=True, eq=False)
class Prediction:
    """A predicted face. Research software, not for clinical use.

    Fields:
        skin_before: the skin before surgery, frame L.
        skin: the predicted skin; the same triangles.
        displacement_mm: of each vertex of the skin, (n, 3).
        steps: converged steps of the path.
        converged: True: a path that does not converge raises NotConverged, and gives no face.
        warnings: of the import and the prediction.
        notice: shown with every result.
        folder: the result files; None if they were not kept.
        json: prediction.json.
    """

    skin_before: TriangleMesh
    skin: TriangleMesh
    displacement_mm: NDArray[np.float64] = field(repr=False)
    steps: tuple[Step, ...] = field(repr=False)
    converged: bool
    warnings: tuple[str, ...] = field(repr=False)
    notice: str
    folder: Path | None
    json: Json = field(repr=False)

    @classmethod
    def read(cls, folder: str | Path) -> Prediction:
        """Reads a finished prediction from its folder.

        Raises NotConverged if the path did not converge, FileNotFound if the folder has no prediction.
        """
        folder = Path(folder)
        if (folder / "failure.json").is_file():
            raise NotConverged(f"{folder}: {_read_json(folder / 'failure.json').get('failure')}")
        if not (folder / "prediction.json").is_file():
            raise FileNotFound(f"{folder} has no finished prediction (prediction.json)")
        return cls._load(folder, _read_json(folder / "prediction.json"), (), folder)

    @classmethod
    def _load(cls, folder: Path, json: Json, warnings: tuple[str, ...], kept: Path | None) -> Prediction:
        before = _lefort.read_surface(folder / "skin_before.vtp")
        after = _lefort.read_surface(folder / "predicted_skin.vtp")
        displacement = after.vertices - before.vertices
        displacement.flags.writeable = False
        imported = tuple(json["inputs"]["warnings"])
        return cls(before, after, displacement, tuple(Step._of(step) for step in json["steps"]),
                   bool(json["converged"]), imported + tuple(one for one in warnings if one not in imported),
                   json["notice"], kept, json)

    def displacement_at(self, points_L: Mapping[str, Any]) -> dict[str, NDArray[np.float64]]:
        """Displacement of the vertex of the skin that is closest to each point [mm], by name."""
        vertices = self.skin_before.vertices
        return {name: self.displacement_mm[np.argmin(((vertices - _vector(point)) ** 2).sum(axis=1))]
                for name, point in points_L.items()}


@dataclass(frozen=True)
class DistanceStatistics:
    """Distances between two surfaces, weighted by area; None where there is none.

    Fields:
        mean_mm, median_mm, p90_mm: of the absolute distance.
        mean_signed_mm: mean of the signed distance, positive outside the other surface.
        fraction_below_1mm, fraction_below_2mm: fractions of the area.
    """

    mean_mm: float | None
    median_mm: float | None
    p90_mm: float | None
    mean_signed_mm: float | None
    fraction_below_1mm: float | None
    fraction_below_2mm: float | None

    @classmethod
    def _of(cls, values: Json) -> DistanceStatistics:
        return cls(**{name: values[name] for name in cls.__dataclass_fields__})


@dataclass(frozen=True)
class RegionDistance:
    """Distance of two faces in a region.

    Fields:
        region: its name.
        face: of the compared face.
        baseline_no_change: of the face before surgery; None if it is not known.
    """

    region: str
    face: DistanceStatistics
    baseline_no_change: DistanceStatistics | None


@dataclass(frozen=True, eq=False)
class Comparison:
    """Result of compare().

    Fields:
        regions: distances by region; the first is the whole face.
        regions_missing: regions whose landmarks are missing.
        notice: shown with every result.
        folder: the result files; None if they were not kept.
        json: compare.json.
    """

    regions: tuple[RegionDistance, ...]
    regions_missing: tuple[str, ...]
    notice: str
    folder: Path | None
    json: Json = field(repr=False)

    @classmethod
    def _of(cls, json: Json, folder: Path | None) -> Comparison:
        regions = tuple(
            RegionDistance(one["region"], DistanceStatistics._of(one["face"]),
                           DistanceStatistics._of(one["baseline_no_change"]) if one.get("baseline_no_change") else None)
            for one in json["regions"])
        return cls(regions, tuple(json["regions_missing"]), json["notice"], folder, json)


@dataclass(frozen=True, eq=False)
class Increment:
    """A converged increment of a deck.

    Fields:
        time: 0 to 1.
        max_displacement_mm: of a node.
        energy_mj: potential energy.
        relative_residual: of the last Newton iteration.
        reactions_n: force of each displacement or motion condition on the body, by its name.
    """

    time: float
    max_displacement_mm: float
    energy_mj: float
    relative_residual: float
    reactions_n: dict[str, NDArray[np.float64]]


@dataclass(frozen=True, eq=False)
class SolveResult:
    """Result of solve().

    Fields:
        completed: the deck was solved to time 1.
        increments: converged increments.
        nodes_L: nodes at rest, (n, 3) [mm].
        displacement_mm: of the nodes after the last increment, (n, 3).
        warnings: of the deck.
        notice: shown with every result.
        folder: the result files; None if they were not kept.
        json: solve.json.
    """

    completed: bool
    increments: tuple[Increment, ...] = field(repr=False)
    nodes_L: NDArray[np.float64] = field(repr=False)
    displacement_mm: NDArray[np.float64] = field(repr=False)
    warnings: tuple[str, ...] = field(repr=False)
    notice: str
    folder: Path | None
    json: Json = field(repr=False)

    @classmethod
    def _load(cls, folder: Path, json: Json, kept: Path | None) -> SolveResult:
        increments = tuple(
            Increment(one["time"], one["max_displacement_mm"], one["energy_mj"], one["relative_residual"],
                      {name: _vector(force) for name, force in one["reactions_n"].items()})
            for one in json["increments"])
        last = max(folder.glob("step_*.vtu"))
        nodes = _lefort.read_volume_mesh(last).nodes_L
        displacement = _lefort.read_vtu_vectors(last, "displacement_mm")
        return cls(bool(json["completed"]), increments, nodes, displacement, tuple(json["warnings"]), json["notice"],
                   kept, json)


@dataclass(frozen=True)
class CaseRegion:
    """A case of a cohort in one region.

    Fields:
        region: its name.
        achieved_y_mm, predicted_y_mm: mean displacement to posterior.
        prediction, no_change, ratio_rule: distance of each method from the achieved skin.
    """

    region: str
    achieved_y_mm: float | None
    predicted_y_mm: float | None
    prediction: DistanceStatistics
    no_change: DistanceStatistics
    ratio_rule: DistanceStatistics


@dataclass(frozen=True)
class ValidationCase:
    """A case of a cohort.

    Fields:
        name: of its folder.
        failure: why there is no result; None if there is one.
        regions: comparison in each region, by name.
    """

    name: str
    failure: str | None
    regions: dict[str, CaseRegion] = field(repr=False)

    @classmethod
    def _of(cls, case: Json) -> ValidationCase:
        regions = {
            one["region"]: CaseRegion(
                one["region"], one["achieved_y_mm"], one["predicted_y_mm"],
                DistanceStatistics._of(one["prediction"]), DistanceStatistics._of(one["no_change"]),
                DistanceStatistics._of(one["ratio_rule"]))
            for one in case.get("regions", ())}
        return cls(case["case"], case["failure"], regions)


@dataclass(frozen=True, eq=False)
class Validation:
    """Result of validate().

    Fields:
        cases: all cases of the cohort, also those that failed.
        notice: shown with every result.
        folder: the result files.
        json: validation.json, with the statistics of the cohort.
    """

    cases: tuple[ValidationCase, ...]
    notice: str
    folder: Path
    json: Json = field(repr=False)

    @classmethod
    def _of(cls, json: Json, folder: Path) -> Validation:
        return cls(tuple(ValidationCase._of(case) for case in json["cases"]), json["notice"], folder, json)


@dataclass(frozen=True)
class Phantom:
    """Files of a synthetic head.

    Fields:
        scan: folder of DICOM files.
        labels: true labels, .seg.nrrd.
        landmarks: true landmarks, .mrk.json; None for the simple head.
    """

    scan: Path
    labels: Path
    landmarks: Path | None
