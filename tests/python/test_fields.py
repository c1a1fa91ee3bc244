import pickle

import numpy as np
import pytest

import lefort
from conftest import sphere


@pytest.fixture(scope="module")
def field():
    return lefort.DistanceField.build(sphere(), resolution=64, band_mm=4, smooth=True)


def directions(count=500):
    """Unit vectors in a spiral."""
    height = np.linspace(-0.99, 0.99, count)
    angle = 2.4 * np.arange(count)
    radius = np.sqrt(1 - height**2)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), height], axis=-1)


@pytest.mark.parametrize("smooth", [False, True])
def test_distance_and_gradient_near_the_surface(field, smooth):
    tree = lefort.Bvh(sphere())
    for offset_mm in (-2.0, 0.3, 2.0):
        points = (20 + offset_mm) * directions() + (1, 2, 3)
        error = field.distance(points, smooth=smooth) - tree.signed_distance(points)
        assert np.abs(error).max() < 0.1 * field.cell_mm
        gradient = field.gradient(points, smooth=smooth)
        assert gradient.shape == points.shape
        assert ((gradient * directions()).sum(axis=1) > 0.9).all()  # Out of the body.
        assert (field.zone(points, smooth=smooth) == lefort.Zone.BAND).all()


def test_beyond_the_band_and_for_points_that_are_not_finite(field):
    points = [[1, 2, 3], [1000, 0, 0], [np.nan, 0, 0]]
    assert list(field.zone(points)) == [lefort.Zone.INSIDE, lefort.Zone.OUTSIDE, lefort.Zone.UNKNOWN]
    distance = field.distance(points)
    assert distance[0] == -np.inf and distance[1] == np.inf and np.isnan(distance[2])


def test_shapes_of_queries(field):
    assert field.distance([21, 2, 3]).shape == ()
    assert field.distance(np.zeros((0, 3))).shape == (0,)
    grid = np.zeros((4, 5, 3), np.float32)[:, ::-1]
    assert field.distance(grid).shape == (4, 5) and field.gradient(grid).shape == (4, 5, 3)
    for bad in (np.zeros((3, 4)), 1.0, "text", np.zeros(3, complex)):
        with pytest.raises(ValueError):
            field.distance(bad)


def test_many_points_give_the_bits_of_few(field):
    points = np.random.default_rng(1).uniform(-20, 24, (20_000, 3))
    whole = field.distance(points)
    parts = np.concatenate([field.distance(part) for part in np.array_split(points, 7)])
    assert np.array_equal(whole, parts)


def test_options_are_checked():
    for change in ({"resolution": 100}, {"band_mm": -1}, {"band_mm": float("nan")}, {"tolerance_mm": -1},
                   {"threads": -1}):
        with pytest.raises(ValueError):
            lefort.DistanceField.build(sphere(), **{"resolution": 64, **change})
    with pytest.raises(ValueError, match="method"):
        lefort.DistanceField.build(sphere(), resolution=32, method="magic")
    rough = lefort.DistanceField.build(sphere(), resolution=32)
    with pytest.raises(ValueError, match="smooth=True"):
        rough.distance([0, 0, 0], smooth=True)


def test_threads_and_methods_give_the_same_distances():
    points = 21 * directions() + (1, 2, 3)
    one = lefort.DistanceField.build(sphere(), resolution=64, threads=1)
    two = lefort.DistanceField.build(sphere(), resolution=64, threads=2)
    assert pickle.dumps(one) == pickle.dumps(two)
    for method in ("hybrid", "adaptive", "uniform"):
        other = lefort.DistanceField.build(sphere(), resolution=64, method=method, threads=2)
        assert np.allclose(other.distance(points), one.distance(points), atol=0.02)


def test_files_and_pickles(field, tmp_path):
    lefort.write_field(tmp_path / "a.field", field)
    points = 21 * directions() + (1, 2, 3)
    for copy in (lefort.read_field(tmp_path / "a.field"), pickle.loads(pickle.dumps(field))):
        assert np.array_equal(copy.distance(points), field.distance(points))
        assert (copy.resolution, copy.band_mm, copy.is_closed, copy.is_smooth) == (64, 4, True, True)
    (tmp_path / "b.field").write_bytes((tmp_path / "a.field").read_bytes()[:-100])
    with pytest.raises(lefort.FileCorrupt):
        lefort.read_field(tmp_path / "b.field")
    with pytest.raises(ValueError):
        lefort.write_field(tmp_path / "a.txt", field)
    low, high = field.box_B
    assert (low < -19).all() and (high > 21).all() and field.guaranteed_mm < field.band_mm and field.sample_bytes > 0
    assert repr(field).startswith("<lefort.DistanceField: 64^3 cells")
