# %% [markdown]
# # One plan, several advancements
#
# A Le Fort I osteotomy moves the maxilla forward by 2, 4 and 6 mm. How far does the skin follow at the landmarks? The
# plan is a dataclass: `replace()` gives a changed copy, which is checked when it is made. By default a synthetic head
# with teeth is used; `$LEFORT_CT` and `$LEFORT_LANDMARKS` (.mrk.json) name those of another head. The figure goes to
# `$LEFORT_FIGURES` (default: `figures`). Research software, not for clinical use.

# %%
import os
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray

import lefort

figures = Path(os.environ.get("LEFORT_FIGURES", "figures"))
figures.mkdir(parents=True, exist_ok=True)
element_size_mm = float(os.environ.get("LEFORT_ELEMENT_SIZE_MM", "8"))
advancements_mm = (2.0, 4.0, 6.0)
work = tempfile.TemporaryDirectory()

# %% [markdown]
# ## Scan and landmarks

# %%
labels: str | None = None
if "LEFORT_CT" in os.environ:
    scan, landmarks_file = Path(os.environ["LEFORT_CT"]).absolute(), Path(os.environ["LEFORT_LANDMARKS"]).absolute()
else:
    phantom = lefort.make_phantom(work.name, head="teeth", voxel_mm=2.5)
    assert phantom.landmarks is not None
    scan, landmarks_file, labels = phantom.scan, phantom.landmarks, str(phantom.labels)
landmarks = lefort.read_landmarks(landmarks_file)

# %% [markdown]
# ## The plan
#
# Elements are large, so that the notebook takes seconds; 2.5 mm is the default of a plan.

# %%
template = lefort.Plan(
    title="Le Fort I",
    landmarks=str(landmarks_file),
    segmentation=lefort.Segmentation(labels=labels),
    segments=(lefort.Segment(
        name="maxilla", osteotomy=lefort.Osteotomy(template="le-fort-1"),
        path=lefort.RigidPath(steps=1, keyframes=(lefort.Keyframe(),))),),
    tissue=lefort.SoftTissue(element_size_mm=element_size_mm, far_element_size_mm=max(10, element_size_mm),
                             margin_mm=20),
    field=lefort.Field(resolution=64))


def advanced(plan: lefort.Plan, advancement_mm: float) -> lefort.Plan:
    """The same plan with another movement."""
    (segment,) = plan.segments
    keyframe = lefort.Keyframe(translation_mm=(0, -advancement_mm, 0))
    return plan.replace(segments=(segment.replace(path=segment.path.replace(keyframes=(keyframe,))),))


# %% [markdown]
# ## Predict
#
# All predictions have the same folder: what does not depend on the movement is computed once.

# %%
predictions = {}
for advancement_mm in advancements_mm:
    prediction = lefort.predict(advanced(template, advancement_mm), ct=scan, output=Path(work.name) / "out",
                                pictures=False, sensitivity=False)
    predictions[advancement_mm] = prediction
    moved_mm = np.linalg.norm(prediction.displacement_mm, axis=1)
    print(f"{advancement_mm:g} mm: skin moved up to {moved_mm.max():.2f} mm, "
          f"{prediction.steps[-1].newton_iterations} Newton iterations, warnings: {len(prediction.warnings)}")

# %% [markdown]
# ## Landmarks and profile


# %%
def profile(mesh: lefort.TriangleMesh, x_mm: float, low_mm: float, high_mm: float) -> NDArray[np.float64]:
    """The most anterior points (y, z) of a surface in a sagittal plane, from inferior to superior.

    NaN where they are more than 50 mm behind the nose: in the gap between the lips.
    """
    segments = mesh.vertices[mesh.triangles][:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2, 3)
    sides = segments[:, :, 0] - x_mm
    crossing = segments[sides[:, 0] * sides[:, 1] < 0]
    t = (x_mm - crossing[:, 0, 0]) / (crossing[:, 1, 0] - crossing[:, 0, 0])
    points = crossing[:, 0, 1:] + t[:, None] * (crossing[:, 1, 1:] - crossing[:, 0, 1:])
    heights = np.arange(low_mm, high_mm, 1.0)
    anterior = points[points[:, 0] < points[(points[:, 1] > low_mm) & (points[:, 1] < high_mm), 0].min() + 50]
    rows = [anterior[np.abs(anterior[:, 1] - z_mm) < 1.0, 0] for z_mm in heights]
    return np.array([(row.min() if len(row) else np.nan, z_mm) for row, z_mm in zip(rows, heights)])


names = {"Prn": "pronasale", "Sn": "subnasale", "Ls": "labrale superius", "Li": "labrale inferius", "Pg'": "soft pogonion"}
shown = {name: label for name, label in names.items() if name in landmarks}
forward_mm = {name: [0.0] + [-float(one.displacement_at({name: landmarks[name]})[name][1]) for one in predictions.values()]
              for name in shown}

figure, (left, right) = plt.subplots(1, 2, figsize=(10.5, 5.4), width_ratios=(1.15, 1), layout="constrained")
colors = plt.get_cmap("viridis")(np.linspace(0.0, 0.85, len(shown)))
for (name, values_mm), color, marker in zip(forward_mm.items(), colors, "osD^v"):
    left.plot((0, *advancements_mm), values_mm, marker=marker, color=color, label=f"{shown[name]} ({name})")
left.plot((0, 6), (0, 6), color="0.6", linestyle="--", linewidth=1, label="bone (1 : 1)")
left.set_xlabel("advancement of the maxilla [mm]")
left.set_ylabel("displacement of the skin to anterior [mm]")
left.set_title("Displacement at landmarks of the skin", fontsize=11)
left.grid(color="0.9")
left.legend(frameon=False, fontsize=9)

first = next(iter(predictions.values()))
middle_mm = float(np.mean([landmarks[name][0] for name in shown]))
heights = [landmarks[name][2] for name in shown]
curves = {"before": profile(first.skin_before, middle_mm, min(heights) - 25, max(heights) + 30)}
curves |= {f"{mm:g} mm": profile(one.skin, middle_mm, min(heights) - 25, max(heights) + 30) for mm, one in predictions.items()}
for (name, curve), color in zip(curves.items(), ("0.3", "#fdae61", "#f46d43", "#a50026")):
    right.plot(curve[:, 0], curve[:, 1], color=color, linewidth=1.6, label=name)
everything = np.concatenate(list(curves.values()))
for name in shown:
    z_mm = landmarks[name][2]
    near = everything[np.abs(everything[:, 1] - z_mm) < 4, 0]
    right.annotate(name, (np.nanmin(near), z_mm), xytext=(-6, 0), textcoords="offset points", ha="right", va="center",
                   fontsize=8)
right.set_aspect("equal")
right.set_xlim(left=np.nanmin(everything[:, 0]) - 16)
right.set_xlabel("y, to posterior [mm]")
right.set_ylabel("z, to superior [mm]")
right.set_title("Profile in the mid-sagittal plane", fontsize=11)
right.legend(frameon=False, fontsize=9, loc="upper left", bbox_to_anchor=(1.0, 1.0), title="advancement")
for axes in (left, right):
    for spine in ("top", "right"):
        axes.spines[spine].set_visible(False)
figure.text(0.995, 0.005, lefort.NOTICE, ha="right", va="bottom", fontsize=7, color="0.4")
figure.get_layout_engine().set(rect=(0, 0.03, 1, 0.97))
figure.savefig(figures / "vary_a_plan.png", dpi=150)
print(figures / "vary_a_plan.png")
work.cleanup()
