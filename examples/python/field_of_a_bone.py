# %% [markdown]
# # The distance field of a bone
#
# From a scan to the surface of the skull, to its signed distance field, and how far the field is from the exact
# distance. Jupyter opens this file as a notebook (with jupytext); `python3 field_of_a_bone.py` runs it and writes the
# figure into `$LEFORT_FIGURES` (default: `figures`). `$LEFORT_CT` names another scan; by default a synthetic head is
# made. Research software, not for clinical use.

# %%
import os
import tempfile
import time
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import lefort

figures = Path(os.environ.get("LEFORT_FIGURES", "figures"))
figures.mkdir(parents=True, exist_ok=True)
resolution = int(os.environ.get("LEFORT_RESOLUTION", "256"))

# %% [markdown]
# ## Scan, labels, surface

# %%
with tempfile.TemporaryDirectory() as folder:
    scan = os.environ.get("LEFORT_CT") or lefort.make_phantom(folder, head="teeth", voxel_mm=2.5).scan
    ct = lefort.import_scan(scan)
print(ct)
labels = lefort.segment(ct)
skull = lefort.bone_surface(ct, labels, bones="skull")
print(skull, "closed" if skull.is_closed else "open")

# %% [markdown]
# ## Build the field
#
# Distances are stored in a band around the surface; beyond it only the sign is known.

# %%
begun = time.perf_counter()
field = lefort.DistanceField.build(skull, resolution=resolution, band_mm=6, smooth=True)
built_s = time.perf_counter() - begun
print(field, f"built in {built_s:.2f} s")

# %% [markdown]
# ## Error against the exact distance
#
# At random points near the surface: triangles by area, at most 4 mm along their normals. Trilinear interpolation is
# continuous; the smooth one has continuous derivatives, which contact needs.

# %%
random = np.random.default_rng(seed=1)
corners = skull.vertices[skull.triangles]
normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
areas = np.linalg.norm(normals, axis=1)
chosen = random.choice(len(areas), size=100_000, p=areas / areas.sum())
normals = normals[chosen] / areas[chosen, None]
weights = random.dirichlet((1, 1, 1), size=len(chosen))
points_B = (weights[:, :, None] * corners[chosen]).sum(axis=1) + random.uniform(-4, 4, (len(chosen), 1)) * normals

begun = time.perf_counter()
exact_mm = lefort.Bvh(skull).signed_distance(points_B)
exact_s = time.perf_counter() - begun
errors_mm = {}
for name, smooth in (("trilinear", False), ("smooth", True)):
    begun = time.perf_counter()
    distance_mm = field.distance(points_B, smooth=smooth)
    query_s = time.perf_counter() - begun
    error_mm = np.abs(distance_mm - exact_mm)
    errors_mm[name] = error_mm[np.isfinite(error_mm)]
    print(f"{name}: {len(points_B) / query_s / 1e6:.1f} million points/s (exact: {len(points_B) / exact_s / 1e6:.2f}), "
          f"median error {np.median(errors_mm[name]) * 1e3:.1f} µm, "
          f"P99 {np.percentile(errors_mm[name], 99) * 1e3:.0f} µm, known at {len(errors_mm[name]) / len(points_B):.1%}")

# %% [markdown]
# ## A slice, and the distribution of the error

# %%
low, high = skull.vertices.min(axis=0), skull.vertices.max(axis=0)
x = np.arange(low[0] - 6, high[0] + 6, 0.4)
y = np.arange(low[1] - 6, high[1] + 6, 0.4)
z_mm = low[2] + 0.45 * (high[2] - low[2])
grid = np.stack(np.broadcast_arrays(x[None, :], y[:, None], z_mm), axis=-1)
slice_mm = field.distance(grid)

figure, (left, right) = plt.subplots(1, 2, figsize=(10.5, 5.2), width_ratios=(0.95, 1), layout="constrained")
shown = left.imshow(np.clip(slice_mm, -field.band_mm, field.band_mm), extent=(x[0], x[-1], y[-1], y[0]),
                    cmap="RdBu", vmin=-field.band_mm, vmax=field.band_mm, interpolation="nearest")
left.contour(x, y, np.clip(slice_mm, -field.band_mm, field.band_mm), levels=[0], colors="black", linewidths=0.8)
left.set_xlabel("x, to the patient's left [mm]")
left.set_ylabel("y, to posterior [mm]")
left.set_title(f"Signed distance to the skull at z = {z_mm:.0f} mm", fontsize=11)
figure.colorbar(shown, ax=left, label="signed distance [mm], negative in bone, clipped at the band")

bins = np.geomspace(1e-2, 1e3, 61)
for (name, error_mm), color in zip(errors_mm.items(), ("#b2182b", "#2166ac")):
    right.hist(error_mm * 1e3, bins=bins, weights=np.full(len(error_mm), 100 / len(error_mm)), histtype="stepfilled",
               alpha=0.35, color=color)
    median_um = float(np.median(error_mm) * 1e3)
    right.axvline(median_um, color=color, linewidth=1.5, label=f"{name}: median {median_um:.1f} µm")
right.set_xscale("log")
right.set_ylim(top=1.2 * right.get_ylim()[1])
right.set_xlabel("error against the exact distance [µm]")
right.set_ylabel("points [%]")
right.set_title(f"{len(points_B):,} points within 4 mm, cells of {field.cell_mm:.2f} mm", fontsize=11)
right.legend(frameon=False)
for spine in ("top", "right"):
    right.spines[spine].set_visible(False)
figure.text(0.995, 0.005, lefort.NOTICE, ha="right", va="bottom", fontsize=7, color="0.4")
figure.get_layout_engine().set(rect=(0, 0.03, 1, 0.97))
figure.savefig(figures / "field_of_a_bone.png", dpi=150)
print(figures / "field_of_a_bone.png")
