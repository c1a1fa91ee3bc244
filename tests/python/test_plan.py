import copy
import dataclasses
import json
import pickle

import numpy as np
import pytest

import lefort
from conftest import small_plan
from lefort import plan as plan_module

PARTS = [one for one in vars(plan_module).values()
         if isinstance(one, type) and issubclass(one, plan_module.Part) and one is not plan_module.Part]
# The reader derives these from other values if they are omitted.
DERIVED = {("SoftTissue", "far_element_size_mm"), ("RigidPath", "steps")}


@pytest.mark.parametrize("part", PARTS)
def test_fields_are_the_keys_of_the_schema_with_their_defaults(part):
    properties = plan_module._find(part.SCHEMA_PATH)["properties"]
    fields = {one.name.rstrip("_"): one for one in dataclasses.fields(part) if "doc" not in one.metadata}
    assert fields.keys() == properties.keys()
    for key, schema in properties.items():
        if "default" in schema and (part.__name__, key) not in DERIVED:
            default = fields[key].default
            if isinstance(default, plan_module.Part):
                default = default.to_json()
            assert json.loads(json.dumps(default)) == schema["default"], key
        assert schema["description"] in part.__doc__


@pytest.mark.parametrize("name", [
    "le_fort_1", "le_fort_1_skin", "le_fort_1_two_piece", "le_fort_3", "midface_forward", "midface_forward_clinical",
    "midface_impaction", "two_jaw"])
def test_examples_are_read_and_written_without_loss(source, tmp_path, name):
    plan = lefort.Plan.read(source / "examples" / f"{name}.json")
    assert lefort.Plan.from_json(plan.to_json(), plan.folder) == plan
    (tmp_path / "sub").mkdir()
    plan.write(tmp_path / "sub" / "copy.json")
    copy = lefort.Plan.read(tmp_path / "sub" / "copy.json")
    assert copy.moved_to(plan.folder) == plan
    assert pickle.loads(pickle.dumps(plan)) == plan
    assert plan.replace(title="other").title == "other"


def test_values_are_written_only_if_they_differ_from_their_default():
    written = small_plan().to_json()
    assert written["tissue"] == {"element_size_mm": 5, "margin_mm": 10} and "boundary" not in written
    assert lefort.Skin().to_json() == {}
    tissue = lefort.SoftTissue(skin=lefort.Skin(), material=lefort.Material(young_kpa=20, poisson=0.4))
    assert tissue.to_json() == {
        "skin": {}, "material": {"law": "neo-hookean", "young_kpa": 20, "poisson": 0.4}}
    assert lefort.SoftTissue.from_json(tissue.to_json()) == tissue


def test_arrays_become_tuples_and_plans_do_not_change():
    keyframe = lefort.Keyframe(translation_mm=np.array([0, -6.0, 0]), rotation_deg=[1, 2, np.float32(3)])
    assert keyframe.translation_mm == (0.0, -6.0, 0.0) and keyframe.rotation_deg == (1, 2, 3)
    with pytest.raises(dataclasses.FrozenInstanceError):
        keyframe.translation_mm = (0, 0, 0)


@pytest.mark.parametrize("make, message", [
    (lambda: lefort.SoftTissue(element_size_mm=-1), r"tissue\.element_size_mm"),
    (lambda: lefort.SoftTissue(element_order=3), r"tissue\.element_order"),
    (lambda: lefort.SoftTissue(element_size_mm=float("nan")), "element_size_mm: nan is not finite"),
    (lambda: lefort.Skin(layers=0), r"tissue\.skin\.layers"),
    (lambda: lefort.Mucosa(thickness_mm=1, material="steel"), r"tissue\.mucosa\.material"),
    (lambda: lefort.Material(young_kpa=15, poisson=0.5), "poisson"),
    (lambda: lefort.Boundary(lips="open"), r"boundary\.lips"),
    (lambda: lefort.Contact(detection="magic"), r"contact\.detection"),
    (lambda: lefort.Field(resolution=100), r"field\.resolution"),
    (lambda: lefort.Solver(max_iterations=0), r"solver\.max_iterations"),
    (lambda: lefort.Segmentation(bone_hu=5000), r"segmentation\.bone_hu"),
    (lambda: lefort.Keyframe(translation_mm=(0, 0)), r"translation_mm"),
    (lambda: lefort.Keyframe(path_fraction=0), r"path_fraction"),
    (lambda: lefort.Keyframe(translation_mm=(0, float("inf"), 0)), "not finite"),
    (lambda: lefort.Distraction(towards=(0, -1, 0), mm_per_day=0, days=3), r"mm_per_day"),
    (lambda: lefort.Template(kind="le-fort-4"), "template"),
    (lambda: lefort.CutCurve(along=(0, 1, 0), points_mm=((0, 0, 0),)), "points_mm"),
    (lambda: lefort.Osteotomy(kerf_mm=9), "kerf_mm"),
    (lambda: lefort.Osteotomy(kerf_mm=object()), "kerf_mm: object is no value"),
    (lambda: small_plan().replace(segments=()), "segments"),
    (lambda: small_plan().replace(title="x" * 201), "title"),
    (lambda: small_plan().replace(landmarks="none.csv"), "none.csv"),
    (lambda: small_plan().replace(tissue=lefort.SoftTissue(element_size_mm=6, far_element_size_mm=5)),
     "far_element_size_mm: 5 is less than element_size_mm, 6"),
    (lambda: small_plan().replace(segments=small_plan().segments * 2), "front"),
    (lambda: lefort.Plan.from_json({"lefort_plan": 1, "hue": 1, "segments": []}), "hue"),
    (lambda: lefort.Keyframe.from_json({"hue": 1}), "unknown key 'hue'"),
])
def test_a_wrong_value_raises_the_message_of_the_reader(make, message):
    with pytest.raises(lefort.Error, match=message) as raised:
        make()
    assert "\n" not in str(raised.value)


def test_landmarks_place_a_template():
    landmarks = {"ANS": (0, -40, 0), "PNS": (0, 0, 0)}
    segment = lefort.Segment("maxilla", lefort.Osteotomy(template="le-fort-1"),
                             lefort.RigidPath(keyframes=(lefort.Keyframe(about="ANS"),)))
    with pytest.raises(lefort.PlanInvalid, match="ANS"):
        lefort.Plan(segments=(segment,))
    plan = lefort.Plan(segments=(segment,), landmarks=landmarks)
    assert plan.to_json()["landmarks"]["ANS"] == [0, -40, 0]
    lefort.Plan(segments=(segment,), landmarks="auto")  # Needs the scan: only its form is checked.

    with pytest.raises(TypeError):
        plan.landmarks["ANS"] = (0, 0, 0)
    landmarks["ANS"] = (0, 0, 0)  # That of the caller is another one.
    for copied in (plan, copy.deepcopy(plan), pickle.loads(pickle.dumps(plan))):
        assert copied == plan
        assert copied.landmarks["ANS"] == (0, -40, 0)


def test_files_that_are_no_plans(tmp_path):
    with pytest.raises(lefort.FileNotFound, match="none.json does not exist"):
        lefort.Plan.read(tmp_path / "none.json")
    for text in ("", "{", "[]", '{"lefort_plan": 1, "lefort_plan": 1, "segments": []}', "\x00"):
        (tmp_path / "bad.json").write_text(text)
        with pytest.raises(lefort.PlanInvalid, match="bad.json"):
            lefort.Plan.read(tmp_path / "bad.json")
    (tmp_path / "bad.json").write_bytes(b"\xff\xfe")
    with pytest.raises(lefort.FileCorrupt):
        lefort.Plan.read(tmp_path / "bad.json")
    with pytest.raises(lefort.FileUnwritable):
        small_plan().write(tmp_path / "no folder" / "plan.json")


def test_landmarks_are_measured_and_written(tmp_path):
    points = {"S": (0, 0, 0), "N": (0, -70, 0), "A": (0, -70, -50), "B": (0, -60, -90)}
    rows = {row.name: row for row in lefort.measure(points)}
    # Angles at N, seen from the side: A lies straight below.
    assert rows["SNA"].unit == "deg" and rows["SNA"].value == pytest.approx(90)
    assert rows["SNB"].value == pytest.approx(np.degrees(np.arctan2(90, 10)))
    lefort.write_landmarks(tmp_path / "a.mrk.json", points)
    read = lefort.read_landmarks(tmp_path / "a.mrk.json")
    assert {name: tuple(point) for name, point in read.items()} == points
    with pytest.raises(ValueError):
        lefort.measure({"S": (0, 0)})
    with pytest.raises(lefort.Error):
        lefort.measure({"S": (0, 0, float("nan"))})
