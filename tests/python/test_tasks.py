import json
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import lefort
from conftest import small_plan


def test_a_prediction_has_arrays_steps_and_a_notice(solved):
    assert solved.converged and "not for clinical use" in solved.notice and lefort.NOTICE == solved.notice
    assert solved.skin.triangles.shape == solved.skin_before.triangles.shape
    assert np.array_equal(solved.skin.vertices - solved.skin_before.vertices, solved.displacement_mm)
    assert [step.path_fraction for step in solved.steps] == [0.5, 1.0]
    assert np.allclose(solved.steps[-1].poses_L["front"][:3, 3], (0, -3, 0))
    length_mm = np.linalg.norm(solved.displacement_mm, axis=1)
    assert length_mm.max() == pytest.approx(solved.json["skin"]["max_shift_mm"], abs=1e-4) and length_mm.max() > 1
    moved = solved.displacement_at({"front": (22, -41, 4), "back": (0, 47, 0)})
    assert moved["front"][1] < -0.5 and np.linalg.norm(moved["back"]) < 0.2
    again = lefort.Prediction.read(solved.folder)
    assert np.array_equal(again.displacement_mm, solved.displacement_mm)
    assert repr(solved).startswith("Prediction(skin_before=<lefort.TriangleMesh")


def test_the_face_has_the_bytes_of_the_command_line(solved, program, tmp_path):
    subprocess.run([program, "predict", solved.folder.parent / "plan.json", "-o", tmp_path / "cli", "--no-pictures",
                    "--no-sensitivity", "--quiet", "--threads", "1"], check=True, capture_output=True)
    for name in ("predicted_skin.vtp", "predicted_skin.stl", "skin_before.vtp", "bone_segment_moved.vtp"):
        assert (tmp_path / "cli" / name).read_bytes() == (solved.folder / name).read_bytes(), name
    times = {"timing"}
    ours, theirs = (json.loads((folder / "prediction.json").read_text()) for folder in (solved.folder, tmp_path / "cli"))
    assert {k: v for k, v in ours.items() if k not in times} == {k: v for k, v in theirs.items() if k not in times}


def test_arrays_in_memory_and_threads_give_the_same_face(solved, head):
    one = lefort.predict(small_plan(), ct=head, sensitivity=False, threads=1)
    assert one.folder is None
    assert np.array_equal(one.skin.vertices, solved.skin.vertices)


def test_progress_reports_stages_fractions_and_notes(head):
    reports = []
    lefort.predict(small_plan(1.0, 1), ct=head, sensitivity=False, progress=reports.append)
    stages = list(dict.fromkeys(report.stage for report in reports))
    assert "segment" in stages and stages.index("solve") < stages.index("write")
    assert all(0 <= report.fraction <= 1 for report in reports)
    assert any("Newton iterations" in (report.note or "") for report in reports)
    assert repr(reports[0]).startswith("<lefort.Progress: ")


def test_an_exception_of_the_callback_stops_the_call(head, tmp_path):
    class Stop(Exception):
        pass

    def progress(report):
        if report.stage == "solve":
            raise Stop("enough")

    with pytest.raises(Stop, match="enough"):
        lefort.predict(small_plan(), ct=head, output=tmp_path / "out", progress=progress)
    assert not (tmp_path / "out" / "prediction.json").exists()
    with pytest.raises(TypeError):
        lefort.segment(head, progress="no function")


def test_a_token_cancels_from_the_callback_and_from_a_thread(head):
    token = lefort.CancelToken()
    with pytest.raises(lefort.Cancelled) as raised:
        lefort.predict(small_plan(), ct=head, cancel=token,
                       progress=lambda report: token.cancel() if report.stage == "solve" else None)
    assert raised.value.code == "cancelled" and token.cancelled
    with pytest.raises(lefort.Cancelled):
        lefort.segment(head, cancel=token)
    other = lefort.CancelToken()
    timer = threading.Timer(0.3, other.cancel)
    timer.start()
    with pytest.raises(lefort.Cancelled):
        lefort.predict(small_plan(steps=100), ct=head, cancel=other)
    timer.join()


def test_ctrl_c_stops_a_prediction(head):
    timer = threading.Timer(0.5, signal.raise_signal, [signal.SIGINT])
    timer.start()
    begun = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        lefort.predict(small_plan(steps=200), ct=head)
    assert time.monotonic() - begun < 60
    timer.join()


def test_other_threads_run_while_a_prediction_is_computed(head):
    stages: dict[str, int] = {}
    current, done, counted = ["-"], threading.Event(), [0]

    def count():
        while not done.wait(0.001):
            counted[0] += 1
            stages[current[0]] = stages.get(current[0], 0) + 1

    def progress(report):
        current[0] = report.stage

    thread = threading.Thread(target=count)
    thread.start()
    lefort.predict(small_plan(steps=4), ct=head, sensitivity=False, progress=progress)
    done.set()
    thread.join()
    assert stages["solve"] > 20 and counted[0] > 100


def test_two_predictions_run_at_once(head, solved):
    faces = {}

    def predict(name):
        faces[name] = lefort.predict(small_plan(), ct=head, sensitivity=False).skin.vertices

    threads = [threading.Thread(target=predict, args=(n,)) for n in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(np.array_equal(faces[n], solved.skin.vertices) for n in range(2))


def test_errors_have_their_class_and_leave_no_folder(head, tmp_path):
    with pytest.raises(lefort.FileNotFound):
        lefort.predict(tmp_path / "none.json", output=tmp_path / "a")
    with pytest.raises(lefort.PlanInvalid, match="scan"):
        lefort.predict(small_plan(), output=tmp_path / "b")
    missing = small_plan().replace(segments=(small_plan().segments[0].replace(osteotomy=lefort.Osteotomy(
        planes=(lefort.CutPlane(point_mm=(0, -90, 0), towards_segment=(0, -1, 0)),))),))
    with pytest.raises((lefort.CutMissesBone, lefort.MeshInvalid)):
        lefort.predict(missing, ct=head, output=tmp_path / "c")
    hard = small_plan(12.0, 4).replace(solver=lefort.Solver(max_iterations=1, min_increment_ratio=1))
    with pytest.raises(lefort.NotConverged):
        lefort.predict(hard, ct=head, output=tmp_path / "d", pictures=False)
    with pytest.raises(lefort.NotConverged):
        lefort.Prediction.read(tmp_path / "d")
    with pytest.raises(lefort.FileNotFound):
        lefort.Prediction.read(tmp_path)
    assert not (tmp_path / "a").exists() and not (tmp_path / "b").exists()
    with pytest.raises(ValueError, match="threads"):
        lefort.predict(small_plan(), ct=head, threads=-1)


def test_a_deck_is_solved_from_a_file_and_from_a_dict(source, tmp_path):
    folder = source / "examples" / "solve"
    from_file = lefort.solve(folder / "stretch.json", output=tmp_path / "out")
    assert from_file.completed and from_file.increments[-1].time == 1.0 and from_file.folder == tmp_path / "out"
    assert from_file.displacement_mm.shape == from_file.nodes_L.shape
    assert np.linalg.norm(from_file.displacement_mm, axis=1).max() == pytest.approx(
        from_file.increments[-1].max_displacement_mm, rel=1e-5)
    deck = json.loads((folder / "stretch.json").read_text())
    from_dict = lefort.solve(deck, folder=folder)
    assert np.array_equal(from_dict.displacement_mm, from_file.displacement_mm) and from_dict.folder is None
    with pytest.raises(lefort.PlanInvalid, match="hue"):
        lefort.solve({**deck, "hue": 1}, folder=folder)
    with pytest.raises(lefort.PlanInvalid, match="no JSON"):
        lefort.solve({**deck, "title": float("nan")}, folder=folder)
    with pytest.raises(lefort.FileNotFound):
        lefort.solve(deck, folder=tmp_path)


def test_faces_are_compared(solved):
    same = lefort.compare(solved, solved.skin)
    assert same.regions[0].face.mean_mm == pytest.approx(0, abs=1e-4)
    moved = lefort.TriangleMesh(solved.skin.vertices + (0, 0.5, 0), solved.skin.triangles)
    other = lefort.compare(solved.skin, moved, before=solved.skin_before)
    assert 0.1 < other.regions[0].face.mean_mm < 0.5 and other.folder is None
    with pytest.raises(lefort.InvalidArgument):
        lefort.compare(solved)


def test_phantoms(tmp_path):
    phantom = lefort.make_phantom(tmp_path / "simple", voxel_mm=5)
    ct = lefort.import_scan(phantom.scan)
    labels = lefort.read_segmentation(phantom.labels, ct=ct)
    assert labels.shape == ct.shape and phantom.landmarks is None
    assert ct.source_kind.startswith("DICOM")
    for change in ({"voxel_mm": 0}, {"voxel_mm": float("nan")}, {"noise_hu": -1}, {"head": "cat"}):
        with pytest.raises(ValueError):
            lefort.make_phantom(tmp_path / "bad", **change)
    with pytest.raises(lefort.FileUnwritable):
        lefort.make_phantom(tmp_path / "simple", voxel_mm=5)


def test_landmarks_are_found(tmp_path):
    phantom = lefort.make_phantom(tmp_path, head="teeth", voxel_mm=4)
    ct = lefort.import_scan(phantom.scan)
    search = lefort.find_landmarks(ct, lefort.read_segmentation(phantom.labels, ct=ct))
    truth = lefort.read_landmarks(phantom.landmarks)
    assert np.linalg.norm(search.points_L["Pg'"] - truth["Pg'"]) < 5
    assert search.uncertainty_mm.keys() == search.points_L.keys()
    assert abs(search.mid_sagittal_normal_L[0]) > 0.9


def test_an_import_of_lefort_alone_needs_no_other_libraries():
    code = "import sys, lefort; print(sorted(m for m in ('matplotlib', 'scipy', 'vtk', 'itk') if m in sys.modules))"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "[]\n"
