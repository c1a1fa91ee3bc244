import gc
import pickle

import numpy as np
import pytest

import lefort
from conftest import sphere

TETRAHEDRON = ([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])


def test_arrays_are_read_only_views_of_the_mesh():
    mesh = lefort.TriangleMesh(*TETRAHEDRON)
    assert mesh.vertices.shape == (4, 3) and mesh.vertices.dtype == np.float64
    assert mesh.triangles.shape == (4, 3) and mesh.triangles.dtype == np.int32
    assert np.shares_memory(mesh.vertices, mesh.vertices) and np.shares_memory(mesh.triangles, mesh.triangles)
    assert not mesh.vertices.flags.writeable and not mesh.triangles.flags.writeable
    view = mesh.vertices
    del mesh
    gc.collect()
    assert np.array_equal(view, TETRAHEDRON[0])


def test_properties_of_a_tetrahedron():
    mesh = lefort.TriangleMesh(*TETRAHEDRON)
    assert mesh.is_closed and mesh.signed_volume_mm3 == pytest.approx(1 / 6)
    assert mesh.area_mm2 == pytest.approx(1.5 + np.sqrt(3) / 2)
    inverted = lefort.TriangleMesh(TETRAHEDRON[0], np.array(TETRAHEDRON[1])[:, ::-1])
    assert inverted.signed_volume_mm3 == pytest.approx(-1 / 6)
    assert repr(mesh) == "<lefort.TriangleMesh: 4 vertices, 4 triangles>"


@pytest.mark.parametrize("vertices, triangles, message", [
    (np.zeros((4, 2)), TETRAHEDRON[1], r"\(4, 2\)"),
    (np.zeros((2, 2, 3)), TETRAHEDRON[1], r"\(n, 3\)"),
    (TETRAHEDRON[0], [[0, 1]], r"\(m, 3\)"),
    (TETRAHEDRON[0], [[0, 1, 4]], "vertex"),
    (TETRAHEDRON[0], [[0, 1, -1]], "vertex -1"),
    (TETRAHEDRON[0], [[0, 1, 2**40]], "vertex"),
    (TETRAHEDRON[0], [[0.0, 1.0, 2.0]], "integers wanted"),
    (TETRAHEDRON[0], np.zeros((0, 3), np.int32), "no triangle"),
    ([[np.nan, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], "finite"),
    ([[np.inf, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], "finite"),
    ("text", TETRAHEDRON[1], "numbers"), (TETRAHEDRON[0], object(), "integers"),
])
def test_invalid_arrays_are_a_value_error(vertices, triangles, message):
    with pytest.raises(ValueError, match=message):
        lefort.TriangleMesh(vertices, triangles)


@pytest.mark.parametrize("ending", ["vtp", "stl", "ply", "obj"])
def test_a_written_surface_is_read_again(tmp_path, ending):
    mesh = sphere()
    lefort.write_surface(tmp_path / f"a.{ending}", mesh)
    read = lefort.read_surface(tmp_path / f"a.{ending}")
    assert read.triangles.shape == mesh.triangles.shape and read.is_closed
    assert read.signed_volume_mm3 == pytest.approx(mesh.signed_volume_mm3, rel=1e-5)


def test_arrays_of_vertices_are_written(tmp_path):
    mesh = sphere()
    lefort.write_surface(tmp_path / "a.vtp", mesh, {"height_mm": mesh.vertices[:, 2], "normal": mesh.vertices})
    assert b"height_mm" in (tmp_path / "a.vtp").read_bytes()
    with pytest.raises(ValueError):
        lefort.write_surface(tmp_path / "a.vtp", mesh, {"height_mm": [1.0, 2.0]})
    with pytest.raises(lefort.FileUnsupported):
        lefort.write_surface(tmp_path / "a.doc", mesh)


def test_bad_surface_files(tmp_path):
    with pytest.raises(lefort.FileNotFound):
        lefort.read_surface(tmp_path / "none.stl")
    (tmp_path / "bad.stl").write_bytes(b"\x00" * 90)
    with pytest.raises((lefort.FileCorrupt, lefort.MeshInvalid)):
        lefort.read_surface(tmp_path / "bad.stl")


def test_surfaces_are_pickled():
    mesh = sphere()
    copy = pickle.loads(pickle.dumps(mesh))
    assert np.array_equal(copy.vertices, mesh.vertices) and np.array_equal(copy.triangles, mesh.triangles)


def test_exact_distance_is_negative_inside():
    tree = lefort.Bvh(lefort.TriangleMesh(*TETRAHEDRON))
    assert tree.signed_distance([0.1, 0.1, 0.05]) == pytest.approx(-0.05)
    assert np.allclose(tree.signed_distance([[0, 0, -2.0], [-3.0, 0, 0]]), [2, 3])
    assert tree.signed_distance(np.zeros((0, 3))).shape == (0,)
    with pytest.raises(ValueError, match="finite"):
        tree.signed_distance([np.nan, 0, 0])


def test_volume_mesh_views(source):
    mesh = lefort.read_volume_mesh(source / "examples" / "solve" / "block.vtu")
    nodes, (block, *_) = mesh.nodes_L, mesh.blocks
    assert nodes.shape[1] == 3 and block.nodes.max() < len(nodes) and block.region.shape == (len(block.nodes),)
    assert np.shares_memory(nodes, mesh.nodes_L) and not block.nodes.flags.writeable
    assert "z0" in mesh.node_sets and mesh.node_sets["z0"].dtype == np.int32
    assert np.ptp(nodes[mesh.node_sets["z0"], 2]) == 0
    kept = block.nodes
    expected = kept.copy()
    del mesh, block
    gc.collect()
    assert np.array_equal(kept, expected)
    with pytest.raises(lefort.FileNotFound):
        lefort.read_volume_mesh("none.vtu")
