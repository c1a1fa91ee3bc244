"""The plan as dataclasses: what to cut, how to move it, and how to predict the face.

The fields are the keys of contract/plan.schema.json, and so are their descriptions. Objects check themselves when
they are made, with the rules and messages of the reader of `lefort predict`; a wrong one raises PlanInvalid. They do
not change: `replace()` returns a changed copy.
"""
from __future__ import annotations

import dataclasses
import json
import math
import os
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Literal, TypeVar

from . import _lefort
from ._lefort import PlanInvalid

Vector = tuple[float, float, float]
Json = dict[str, Any]
OuterBoundary = Literal["roller", "free", "fixed", "foundation"]
TemplateName = Literal["le-fort-1", "le-fort-2", "le-fort-3", "genioplasty", "sagittal-split"]

_SCHEMA: Json = json.loads(_lefort.PLAN_SCHEMA)
_Self = TypeVar("_Self", bound="Part")
_Class = TypeVar("_Class", bound="type[Part]")


class _FrozenMapping(Mapping[str, Any]):
    """A mapping that cannot be changed; it can be copied and pickled, which types.MappingProxyType cannot."""

    def __init__(self, items: Mapping[str, Any]) -> None:
        self._items = dict(items)

    def __getitem__(self, name: str) -> Any:
        return self._items[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._items)

    def __len__(self) -> int:
        return len(self._items)

    def __repr__(self) -> str:
        return repr(self._items)


def _frozen(value: Any) -> Any:
    """The value without lists, arrays and paths, so that nobody can change it."""
    if isinstance(value, (str, Part, bool)) or value is None:
        return value
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, Mapping):
        return _FrozenMapping({name: _frozen(one) for name, one in value.items()})
    if hasattr(value, "tolist"):  # An array or number of NumPy.
        return _frozen(value.tolist())
    if isinstance(value, (list, tuple)):
        return tuple(_frozen(one) for one in value)
    return value


def _as_json(value: Any, where: str) -> Any:
    if isinstance(value, Part):
        return value.to_json()
    if isinstance(value, tuple):
        return [_as_json(one, f"{where}[{number}]") for number, one in enumerate(value)]
    if isinstance(value, Mapping):
        return {str(name): _as_json(one, f"{where}.{name}") for name, one in value.items()}
    if isinstance(value, float) and not math.isfinite(value):
        raise PlanInvalid(f"{where}: {value} is not finite")
    if value is None or isinstance(value, (str, bool, int, float)):
        return value
    raise PlanInvalid(f"{where}: {type(value).__name__} is no value of a plan")


def _key(name: str) -> str:
    return name.rstrip("_")  # `as` is a word of Python: the field is as_.


def _resolve(schema: Json) -> Json:
    while "$ref" in schema:
        schema = _SCHEMA["definitions"][schema["$ref"].rsplit("/", 1)[1]]
    return schema


def _find(path: str) -> Json:
    """The schema at a path of keys; `*` is the item of a list, `?` the alternative that is an object."""
    schema = _SCHEMA
    for key in path.split("/") if path else []:
        if key == "*":
            schema = schema["items"]
        elif key == "?":
            schema = next(one for one in map(_resolve, schema["oneOf"]) if one.get("type") == "object")
        else:
            schema = schema["properties"][key]
        schema = _resolve(schema)
    return schema


def _described(path: str) -> Callable[[_Class], _Class]:
    """Gives a class the descriptions of the schema as its docstring."""
    def describe(made: _Class) -> _Class:
        schema = _find(path)
        made.SCHEMA_PATH = path
        about = schema.get("description") or _find(path.rsplit("/", 1)[0])["description"]
        lines = [about, "", "Fields:"]
        for one in dataclasses.fields(made):
            description = schema["properties"].get(_key(one.name), {}).get("description", one.metadata.get("doc"))
            lines.append(f"    {one.name}: {description}")
        made.__doc__ = "\n".join(lines)
        return made
    return describe


class Part:
    """A part of a plan."""

    SCHEMA_PATH: ClassVar[str] = ""
    _PARTS: ClassVar[Mapping[str, type[Part]]] = {}

    def __post_init__(self) -> None:
        for one in dataclasses.fields(self):
            object.__setattr__(self, one.name, _frozen(getattr(self, one.name)))
        self._check()

    def _check(self) -> None:
        _lefort.check_plan_form(json.dumps(_example_with(self.SCHEMA_PATH, self.to_json())))

    def to_json(self) -> Json:
        """The part as it is in a plan file; without keys that have their default."""
        written: Json = {}
        for one in dataclasses.fields(self):
            value = getattr(self, one.name)
            is_default = one.default is not dataclasses.MISSING and value == one.default
            if not is_default and "doc" not in one.metadata:
                written[_key(one.name)] = _as_json(value, _key(one.name))
        return written

    @classmethod
    def from_json(cls: type[_Self], value: Mapping[str, Any]) -> _Self:
        """The part from its form in a plan file."""
        known = {_key(one.name): one.name for one in dataclasses.fields(cls)}
        for key in value:
            if key not in known:
                raise PlanInvalid(f"unknown key '{key}'")
        return cls(**{known[key]: cls._part(key, one) for key, one in value.items()})

    @classmethod
    def _part(cls, key: str, value: Any) -> Any:
        part = cls._PARTS.get(key)
        if part is not None and isinstance(value, Mapping):
            return part.from_json(value)
        if part is not None and isinstance(value, (list, tuple)):
            return tuple(part.from_json(one) for one in value)
        return value

    def replace(self: _Self, **changes: Any) -> _Self:
        """A copy with other values of some fields, which is checked."""
        return dataclasses.replace(self, **changes)


_PLANE: Json = {"point_mm": [0, 0, 0], "towards_segment": [0, 0, -1]}


def _example_with(path: str, value: Json) -> Json:
    """A valid plan with `value` at a path, for the check of the part alone."""
    plan: Json = {"lefort_plan": 1, "segments": [
        {"name": "segment", "osteotomy": {"planes": [_PLANE]}, "path": {"keyframes": [{}]}}]}
    at: Any = plan
    keys = [key for key in path.split("/") if key != "?"]
    for key, following in zip(keys, keys[1:]):
        if key == "*":
            if not at:
                at.append({})
            at = at[0]
        else:
            at = at.setdefault(key, [] if following == "*" else {})
    if keys[-1] == "*":
        at[:] = [value]
    else:
        at[keys[-1]] = value
    if path.startswith("tissue/mucosa/"):
        plan["tissue"]["mucosa"]["thickness_mm"] = 1
    return plan


@_described("segmentation")
@dataclass(frozen=True)
class Segmentation(Part):
    labels: str | None = None
    teeth: str = "none"
    bone_hu: float = 226
    skin_hu: float = -300


@_described("segments/*/osteotomy/planes/*")
@dataclass(frozen=True)
class CutPlane(Part):
    point_mm: Vector | None = None
    towards_segment: Vector | None = None
    size_mm: tuple[float, float] | None = None
    across: Vector | None = None
    file: str | None = None
    name: str | None = None
    flip: bool = False
    bounded: bool = False


@_described("segments/*/osteotomy/curves/*")
@dataclass(frozen=True)
class CutCurve(Part):
    along: Vector
    points_mm: tuple[Vector, ...] | None = None
    depth_mm: float | None = None
    file: str | None = None
    name: str | None = None


@_described("segments/*/osteotomy/additional_regions/*")
@dataclass(frozen=True)
class CutRegion(Part):
    planes: tuple[CutPlane, ...] = ()
    curves: tuple[CutCurve, ...] = ()

    _PARTS: ClassVar[Mapping[str, type[Part]]] = {"planes": CutPlane, "curves": CutCurve}


@_described("segments/*/osteotomy/template/?")
@dataclass(frozen=True)
class Template(Part):
    kind: TemplateName
    above_palate_mm: float = 5
    behind_palate_mm: float = 0
    behind_rim_mm: float = 12
    above_pogonion_mm: float = 6
    split_depth_mm: float = 5
    behind_molar_mm: float = 12
    nerve: str | None = None
    nerve_clearance_mm: float = 2


@_described("segments/*/osteotomy")
@dataclass(frozen=True)
class Osteotomy(Part):
    template: TemplateName | Template | None = None
    planes: tuple[CutPlane, ...] = ()
    curves: tuple[CutCurve, ...] = ()
    additional_regions: tuple[CutRegion, ...] = ()
    bone: Literal["mandible"] | None = None
    piece_at: str | Vector | None = None
    kerf_mm: float = 0
    anchor_points: tuple[str | Vector, ...] = ()
    min_piece_ml: float = 0.5
    min_piece_fraction: float = 0.05

    _PARTS: ClassVar[Mapping[str, type[Part]]] = {
        "template": Template, "planes": CutPlane, "curves": CutCurve, "additional_regions": CutRegion}


@_described("segments/*/path/distraction/*")
@dataclass(frozen=True)
class Distraction(Part):
    towards: Vector
    mm_per_day: float
    days: int


@_described("segments/*/path/keyframes/*/autorotate")
@dataclass(frozen=True)
class Autorotation(Part):
    closing_deg: float | None = None
    gap_mm: float | None = None
    to: str | None = None
    as_: str | None = None


@_described("segments/*/path/keyframes/*")
@dataclass(frozen=True)
class Keyframe(Part):
    translation_mm: Vector = (0, 0, 0)
    rotation_deg: Vector = (0, 0, 0)
    about: str | None = None
    about_mm: Vector = (0, 0, 0)
    path_fraction: float = 1
    autorotate: Autorotation | None = None
    targets: str | Mapping[str, Vector] | None = None
    tolerance_mm: float = 1
    transform: str | None = None

    _PARTS: ClassVar[Mapping[str, type[Part]]] = {"autorotate": Autorotation}


@_described("segments/*/path")
@dataclass(frozen=True)
class RigidPath(Part):
    keyframes: tuple[Keyframe, ...] = ()
    distraction: tuple[Distraction, ...] = ()
    steps: int | None = None
    interpolation: Literal["straight", "screw"] = "straight"

    _PARTS: ClassVar[Mapping[str, type[Part]]] = {"keyframes": Keyframe, "distraction": Distraction}


@_described("segments/*")
@dataclass(frozen=True)
class Segment(Part):
    name: str
    osteotomy: Osteotomy
    path: RigidPath
    cut_from: str = ""

    _PARTS: ClassVar[Mapping[str, type[Part]]] = {"osteotomy": Osteotomy, "path": RigidPath}


@_described("tissue/material/?")
@dataclass(frozen=True)
class Material(Part):
    young_kpa: float
    poisson: float
    law: Literal["neo-hookean"] = "neo-hookean"

    def to_json(self) -> Json:
        """The part as it is in a plan file."""
        return {"law": self.law, **super().to_json()}


SoftTissueMaterial = Literal["face-nazari-2010", "face-compressible"] | Material
AnyMaterial = Literal["skin-barbarino-2011", "face-nazari-2010", "face-compressible"] | Material


@_described("tissue/skin")
@dataclass(frozen=True)
class Skin(Part):
    thickness_mm: float = 1.5
    layers: int = 2
    material: AnyMaterial = "skin-barbarino-2011"

    _PARTS: ClassVar[Mapping[str, type[Part]]] = {"material": Material}


@_described("tissue/mucosa")
@dataclass(frozen=True)
class Mucosa(Part):
    thickness_mm: float
    material: AnyMaterial

    _PARTS: ClassVar[Mapping[str, type[Part]]] = {"material": Material}


@_described("tissue/muscle")
@dataclass(frozen=True)
class Muscle(Part):
    material: AnyMaterial

    _PARTS: ClassVar[Mapping[str, type[Part]]] = {"material": Material}


@_described("tissue")
@dataclass(frozen=True)
class SoftTissue(Part):
    material: SoftTissueMaterial = "face-compressible"
    skin: Skin | None = None
    mucosa: Mucosa | None = None
    muscle: Muscle | None = None
    lips_and_nose_element_size_mm: float | None = None
    element_size_mm: float = 2.5
    far_element_size_mm: float | None = None
    element_order: Literal[1, 2] = 1
    margin_mm: float = 30

    _PARTS: ClassVar[Mapping[str, type[Part]]] = {
        "material": Material, "skin": Skin, "mucosa": Mucosa, "muscle": Muscle}


@_described("boundary")
@dataclass(frozen=True)
class Boundary(Part):
    interface: Literal["clinical", "bonded", "contact"] = "clinical"
    scan_boundary: OuterBoundary = "roller"
    cut_boundary: OuterBoundary = "roller"
    lips: Literal["separate", "joined"] = "separate"
    lip_tone_kpa: float = 0.6
    foundation_mm: float = 20
    elevation_margin_mm: float | None = None
    joint_margin_mm: float = 8
    vestibule_mm: float = 10
    interface_layer_mm: float = 1
    contact_snap_mm: float = 0.8
    labels: str | None = None


@_described("contact")
@dataclass(frozen=True)
class Contact(Part):
    stiffness_factor: float | None = None
    obstacle: Literal["regularized", "bone"] = "regularized"
    detection: Literal["smooth", "trilinear", "bvh"] = "smooth"
    integration: Literal["quadrature", "weighted"] = "quadrature"
    penetration_tolerance_mm: float | None = 0.05


@_described("field")
@dataclass(frozen=True)
class Field(Part):
    resolution: int = 256
    band_mm: float | None = None
    tolerance_mm: float = 0.005


@_described("solver")
@dataclass(frozen=True)
class Solver(Part):
    relative_tolerance: float = 1e-6
    max_iterations: int = 120
    min_increment_ratio: float = 1 / 64


@_described("")
@dataclass(frozen=True)
class Plan(Part):
    segments: tuple[Segment, ...]
    title: str = ""
    ct: str | None = None
    segmentation: Segmentation = Segmentation()
    landmarks: str | Mapping[str, Vector] | None = None
    tissue: SoftTissue = SoftTissue()
    boundary: Boundary = Boundary()
    contact: Contact = Contact()
    field: Field = Field()
    solver: Solver = Solver()
    folder: str = dataclasses.field(default="", compare=False, metadata={
        "doc": "Folder that relative paths of files start from; empty: the current one."})
    lefort_plan: Literal[1] = 1

    _PARTS: ClassVar[Mapping[str, type[Part]]] = {
        "segments": Segment, "segmentation": Segmentation, "tissue": SoftTissue, "boundary": Boundary,
        "contact": Contact, "field": Field, "solver": Solver}

    def _check(self) -> None:
        _lefort.check_plan(json.dumps(self.to_json()), self.folder or os.curdir)

    def to_json(self) -> Json:
        """The plan as in a file; without keys that have their default."""
        return {"lefort_plan": self.lefort_plan, **super().to_json()}

    @classmethod
    def from_json(cls, value: Mapping[str, Any], folder: str | os.PathLike[str] = "") -> Plan:
        """A plan from its form in a file; relative paths start from `folder`."""
        _lefort.check_plan(json.dumps(value), folder or os.curdir)  # Messages with the whole path of a key.
        return cls(folder=os.fspath(folder), **{key: cls._part(key, one) for key, one in value.items()})

    @classmethod
    def read(cls, file: str | os.PathLike[str]) -> Plan:
        """Reads a plan.

        Raises FileNotFound, FileCorrupt if the file is no text, or PlanInvalid with the key and the error. A
        deprecated key gives a DeprecationWarning.
        """
        try:
            text = Path(file).read_text(encoding="utf-8")
        except FileNotFoundError:
            raise _lefort.FileNotFound(f"plan {os.fspath(file)} does not exist") from None
        except (OSError, UnicodeDecodeError) as error:
            raise _lefort.FileCorrupt(f"plan {os.fspath(file)} cannot be read: {error}") from None
        folder = Path(file).parent
        try:
            for warning in _lefort.check_plan(text, folder):
                warnings.warn(warning, DeprecationWarning, stacklevel=2)
        except PlanInvalid as error:
            raise PlanInvalid(f"plan {os.fspath(file)}: {error}") from None
        return cls.from_json(json.loads(_lefort.rename_plan_keys(text)), folder)

    def write(self, file: str | os.PathLike[str]) -> None:
        """Writes the plan, with paths relative to the folder of the file; an existing file is replaced.

        Raises FileUnwritable.
        """
        target = Path(file)
        text = json.dumps(self.moved_to(target.parent).to_json(), indent=2) + "\n"
        partial = target.with_name(f"{target.name}.{os.getpid()}.partial")
        try:
            partial.write_text(text, encoding="utf-8")
            partial.replace(target)
        except OSError as error:
            partial.unlink(missing_ok=True)
            raise _lefort.FileUnwritable(f"plan {target} cannot be written: {error.strerror}") from None

    def moved_to(self, folder: str | os.PathLike[str]) -> Plan:
        """The same plan with paths that start from another folder."""
        start = Path(self.folder).absolute()
        to = Path(folder).absolute()

        def moved(value: Any, key: str) -> Any:
            if isinstance(value, dict):
                return {name: moved(one, name) for name, one in value.items()}
            if isinstance(value, list):
                return [moved(one, key) for one in value]
            is_file = key in ("ct", "labels", "file", "transform") or (
                key in ("landmarks", "targets") and value != "auto") or (
                key == "teeth" and value not in ("auto", "none"))
            if not is_file or not isinstance(value, str) or os.path.isabs(value):
                return value
            return os.path.relpath(start / value, to)

        return Plan.from_json(moved(self.to_json(), ""), folder)
