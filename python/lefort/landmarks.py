"""Landmarks: found in a segmented scan, and measured."""
from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _lefort
from ._lefort import CancelToken, CtVolume, LabelMap, Progress


@dataclass(frozen=True, eq=False)
class LandmarkSearch:
    """Landmarks found in a scan.

    Fields:
        points_L: position of each landmark, by name [mm].
        uncertainty_mm: its standard uncertainty, by name [mm].
        missing: why a landmark was not found, by name.
        mid_sagittal_point_L: a point of the symmetry plane of the skull [mm].
        mid_sagittal_normal_L: its normal, to the patient's left.
    """

    points_L: dict[str, NDArray[np.float64]] = field(repr=False)
    uncertainty_mm: dict[str, float] = field(repr=False)
    missing: dict[str, str]
    mid_sagittal_point_L: NDArray[np.float64]
    mid_sagittal_normal_L: NDArray[np.float64]


@dataclass(frozen=True)
class Measurement:
    """One row of the cephalometric table.

    Fields:
        name: "SNA", "ANS-Me".
        meaning: one line for readers.
        unit: "deg" or "mm".
        value: in that unit; None if a landmark is missing or the value is undefined.
    """

    name: str
    meaning: str
    unit: str
    value: float | None


def find_landmarks(ct: CtVolume, labels: LabelMap, *, bone_hu: float = 226.0, skin_hu: float = -300.0,
                   progress: Callable[[Progress], object] | None = None, cancel: CancelToken | None = None,
                   threads: int = 0) -> LandmarkSearch:
    return LandmarkSearch(*_lefort.find_landmarks(ct, labels, bone_hu=bone_hu, skin_hu=skin_hu, progress=progress,
                                                  cancel=cancel, threads=threads))


def measure(landmarks: Mapping[str, ArrayLike], frame: Mapping[str, ArrayLike] | None = None) -> list[Measurement]:
    return [Measurement(*row) for row in _lefort.measure(dict(landmarks), None if frame is None else dict(frame))]


find_landmarks.__doc__ = _lefort.find_landmarks.__doc__
measure.__doc__ = _lefort.measure.__doc__
