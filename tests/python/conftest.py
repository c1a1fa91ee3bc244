"""Common data: a synthetic head that is solved in seconds, as in tests/support/small_head.h."""
from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

import lefort


def sphere(radius_mm: float = 20.0, bands: int = 24) -> lefort.TriangleMesh:
    """A closed surface, asymmetric about its center."""
    azimuth = np.linspace(0, 2 * np.pi, 2 * bands, endpoint=False)
    polar = np.linspace(0, np.pi, bands + 1)[1:-1]
    ring = np.stack([np.outer(np.sin(polar), np.cos(azimuth)), np.outer(np.sin(polar), np.sin(azimuth)),
                     np.outer(np.cos(polar), np.ones_like(azimuth))], axis=-1).reshape(-1, 3)
    vertices = radius_mm * np.vstack([ring, [0, 0, 1], [0, 0, -1]]) + [1.0, 2.0, 3.0]
    columns, north, south = 2 * bands, len(ring), len(ring) + 1
    triangles = []
    for i in range(columns):
        j = (i + 1) % columns
        triangles += [(north, i, j), (south, north - columns + j, north - columns + i)]
        for row in range(len(polar) - 1):
            a, b = row * columns + i, row * columns + j
            triangles += [(a, a + columns, b), (b, a + columns, b + columns)]
    return lefort.TriangleMesh(vertices, triangles)


def small_head() -> lefort.CtVolume:
    """A ball of skin around a shell of bone."""
    size, spacing_mm = 36, 3.0
    origin = -0.5 * spacing_mm * (size - 1)
    ct = lefort.CtVolume.empty((size, size, size), spacing_mm=(spacing_mm,) * 3, origin_L=(origin,) * 3)
    axis = origin + spacing_mm * np.arange(size)
    z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
    r_mm = np.sqrt(x * x + y * y + z * z)
    ct.hu[:] = np.where(r_mm > 47.0, -1000, np.where((r_mm > 24.0) & (r_mm < 32.0), 1200, 40))
    return ct


def small_plan(forward_mm: float = 3.0, steps: int = 2) -> lefort.Plan:
    """The front of the shell moves forward."""
    return lefort.Plan(
        segments=(lefort.Segment(
            name="front",
            osteotomy=lefort.Osteotomy(planes=(lefort.CutPlane(point_mm=(0, -16, 0), towards_segment=(0, -1, 0)),)),
            path=lefort.RigidPath(steps=steps, keyframes=(lefort.Keyframe(translation_mm=(0, -forward_mm, 0)),))),),
        tissue=lefort.SoftTissue(element_size_mm=5, margin_mm=10),
        field=lefort.Field(resolution=64, band_mm=4))


@pytest.fixture(scope="session")
def source() -> Path:
    """The source tree."""
    return Path(os.environ["LEFORT_SOURCE"])


@pytest.fixture(scope="session")
def program() -> str:
    """The command-line program."""
    return os.environ["LEFORT_PROGRAM"]


@pytest.fixture(scope="session")
def head() -> lefort.CtVolume:
    return small_head()


@pytest.fixture(scope="session")
def labels(head: lefort.CtVolume) -> lefort.LabelMap:
    return lefort.segment(head)


@pytest.fixture(scope="session")
def solved(head: lefort.CtVolume, tmp_path_factory: pytest.TempPathFactory) -> lefort.Prediction:
    """A prediction with its folder, which holds the scan and the plan, too."""
    folder = tmp_path_factory.mktemp("solved")
    lefort.write_volume(folder / "ct.nrrd", head)
    plan = small_plan().replace(ct="ct.nrrd", folder=str(folder))
    plan.write(folder / "plan.json")
    return lefort.predict(folder / "plan.json", output=folder / "out", pictures=False, sensitivity=False)
