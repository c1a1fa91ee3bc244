import gc
import pickle

import numpy as np
import pytest

import lefort

AFFINE = {"spacing_mm": (1.0, 2.0, 3.0), "origin_L": (-4.0, 5.0, 6.5),
          "direction": [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]}


def numbers(shape=(4, 3, 2), dtype=np.int16):
    return np.arange(np.prod(shape), dtype=dtype).reshape(shape)


def test_axes_are_z_y_x_and_the_grid_is_kept():
    ct = lefort.CtVolume(numbers(), **AFFINE)
    assert ct.shape == ct.hu.shape == (4, 3, 2)
    assert np.array_equal(ct.hu, numbers())
    assert np.array_equal(ct.spacing_mm, (1, 2, 3)) and np.array_equal(ct.origin_L, (-4, 5, 6.5))
    # One voxel along x (i) moves by 1 mm along y of the patient, one along y by 2 mm to the right.
    assert np.allclose(ct.affine_LV @ (1, 0, 0, 1), (-4, 6, 6.5, 1))
    assert np.allclose(ct.affine_LV @ (0, 1, 0, 1), (-6, 5, 6.5, 1))


def test_views_share_memory_and_keep_the_volume_alive():
    ct = lefort.CtVolume(numbers(), **AFFINE)
    first, second = ct.hu, ct.hu
    assert np.shares_memory(first, second) and first.base is not None
    assert np.shares_memory(first, np.asarray(ct))
    expected = first.copy()
    del ct, second
    gc.collect()
    ballast = [np.full(24, 7, np.int16) for _ in range(1000)]
    assert np.array_equal(first, expected) and len(ballast) == 1000


def test_values_are_read_only_except_of_an_empty_volume():
    with pytest.raises(ValueError, match="read-only"):
        lefort.CtVolume(numbers()).hu[0, 0, 0] = 1
    empty = lefort.CtVolume.empty((4, 3, 2))
    empty.hu[:] = numbers()
    assert np.array_equal(empty.hu, numbers()) and np.shares_memory(empty.hu, empty.hu)


def test_any_strides_are_accepted_and_other_types_are_not():
    assert np.array_equal(lefort.CtVolume(numbers()[::-1, :, ::-1]).hu, numbers()[::-1, :, ::-1])
    assert np.array_equal(lefort.CtVolume(np.asfortranarray(numbers())).hu, numbers())
    with pytest.raises(lefort.InvalidArgument, match="float64; int16 wanted"):
        lefort.CtVolume(numbers(dtype=np.float64))
    with pytest.raises(ValueError, match="2 dimensions"):
        lefort.CtVolume(numbers()[0])


@pytest.mark.parametrize("change", [
    {"spacing_mm": (0, 1, 1)}, {"spacing_mm": (np.nan, 1, 1)}, {"origin_L": (np.inf, 0, 0)}, {"origin_L": (0, 0)},
    {"direction": np.ones((3, 3))}, {"direction": "no matrix"}, {"spacing_mm": (1j, 1, 1)}])
def test_an_invalid_grid_is_a_value_error(change):
    with pytest.raises(ValueError):
        lefort.CtVolume(numbers(), **{**AFFINE, **change})


@pytest.mark.parametrize("shape", [(0, 3, 2), (1 << 20, 1 << 20, 1 << 20), (-1, 2, 2)])
def test_empty_and_huge_volumes_are_a_value_error(shape):
    with pytest.raises(ValueError, match="voxels"):
        lefort.CtVolume.empty(shape)


def test_labels_beyond_the_last_tissue_are_a_value_error():
    lefort.LabelMap(np.full((2, 2, 2), lefort.Tissue.MUSCLE, np.uint8))
    with pytest.raises(ValueError, match="a label is 8"):
        lefort.LabelMap(np.full((2, 2, 2), 8, np.uint8))


@pytest.mark.parametrize("ending", ["nrrd", "nii.gz", "mha"])
def test_a_written_volume_is_read_again(tmp_path, ending):
    ct = lefort.CtVolume(numbers((6, 5, 4)), **AFFINE)
    lefort.write_volume(tmp_path / f"ct.{ending}", ct)
    read = lefort.import_scan(tmp_path / f"ct.{ending}")
    assert np.array_equal(read.hu, ct.hu) and np.allclose(read.affine_LV, ct.affine_LV, atol=1e-5)
    assert read.source_kind and isinstance(read.warnings, list)


def test_bad_files_raise_their_error(tmp_path):
    with pytest.raises(lefort.FileNotFound) as raised:
        lefort.import_scan(tmp_path / "none.nrrd")
    assert isinstance(raised.value, FileNotFoundError) and raised.value.code == "file_not_found"
    (tmp_path / "bad.nrrd").write_bytes(b"NRRD0004\n\x00\xff truncated")
    with pytest.raises(lefort.FileCorrupt):
        lefort.import_scan(tmp_path / "bad.nrrd")
    with pytest.raises(lefort.InvalidArgument):
        lefort.write_volume(tmp_path / "ct.png", lefort.CtVolume(numbers()))
    with pytest.raises(OSError):
        lefort.write_volume(tmp_path / "no folder" / "ct.nrrd", lefort.CtVolume(numbers()))


@pytest.mark.parametrize("volume", [
    lefort.CtVolume(numbers(), **AFFINE), lefort.ScalarVolume(numbers(dtype=np.float32), **AFFINE),
    lefort.LabelMap(numbers(dtype=np.uint8) % 8, **AFFINE)])
def test_volumes_are_pickled(volume):
    copy = pickle.loads(pickle.dumps(volume))
    assert np.array_equal(np.asarray(copy), np.asarray(volume)) and np.array_equal(copy.affine_LV, volume.affine_LV)
    assert type(volume).__name__ in repr(volume) and "4 x 3 x 2" in repr(volume)


def test_a_scan_is_segmented_and_its_surfaces_extracted(head, labels, tmp_path):
    assert set(np.unique(labels.labels)) >= {lefort.Tissue.BACKGROUND, lefort.Tissue.BONE, lefort.Tissue.SOFT_TISSUE}
    assert labels.labels[18, 18, 9] == lefort.Tissue.BONE
    bone = lefort.bone_surface(head, labels)
    skin = lefort.skin_surface(head, labels)
    assert bone.is_closed and skin.is_closed
    # Shell between 24 and 32 mm, ball of 47 mm; voxels of 3 mm.
    assert bone.signed_volume_mm3 == pytest.approx(4 / 3 * np.pi * (32**3 - 24**3), rel=0.1)
    assert skin.signed_volume_mm3 == pytest.approx(4 / 3 * np.pi * 47**3, rel=0.05)
    lefort.write_segmentation(tmp_path / "l.seg.nrrd", labels)
    assert np.array_equal(lefort.read_segmentation(tmp_path / "l.seg.nrrd", ct=head).labels, labels.labels)
    volumes = lefort.tissue_volumes_ml(labels)
    assert volumes["bone"] == pytest.approx(4 / 3 * np.pi * (3.2**3 - 2.4**3), rel=0.1)


def test_segmentation_options_are_checked(head, labels):
    with pytest.raises(ValueError):
        lefort.segment(head, bone_hu=-500)
    with pytest.raises(ValueError):
        lefort.segment(head, bone_hu=float("nan"))
    with pytest.raises(lefort.AnatomyMissing):
        lefort.segment(lefort.CtVolume.empty((8, 8, 8)))
    with pytest.raises(ValueError, match="bones is"):
        lefort.bone_surface(head, labels, bones="leg")
    with pytest.raises(ValueError, match="same grid"):
        lefort.bone_surface(head, lefort.LabelMap.empty((8, 8, 8)))
    assert lefort.find_thresholds(head)["bone_hu"] > lefort.find_thresholds(head)["skin_hu"]
    assert np.array_equal(lefort.reduce_metal_streaks(head).hu, head.hu)
