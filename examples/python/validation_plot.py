# %% [markdown]
# # Predicted and achieved faces of a cohort
#
# A cohort of synthetic heads is made, each with a plan and a face "after surgery" from a finer prediction with other
# material constants and noise; then each face is predicted and compared. `$LEFORT_COHORT` names a cohort of patients
# instead (docs/guide/validate.md). The figure goes to `$LEFORT_FIGURES` (default: `figures`). Research software, not
# for clinical use.

# %%
import os
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import lefort

figures = Path(os.environ.get("LEFORT_FIGURES", "figures"))
figures.mkdir(parents=True, exist_ok=True)
cases = int(os.environ.get("LEFORT_CASES", "3"))
work = tempfile.TemporaryDirectory()

# %% [markdown]
# ## Cohort and validation

# %%
if "LEFORT_COHORT" in os.environ:
    cohort = Path(os.environ["LEFORT_COHORT"])
else:
    cohort = Path(work.name) / "cohort"
    lefort.make_phantom_cohort(cohort, cases=cases, voxel_mm=3, element_size_mm=8)
validation = lefort.validate(cohort, output=Path(work.name) / "validation", pictures=False)
compared = [case for case in validation.cases if case.failure is None]
for case in validation.cases:
    print(case.name, "compared" if case.failure is None else f"failed: {case.failure}")

# %% [markdown]
# ## Agreement and error by region
#
# Left: the plot of Bland and Altman (1986) of the mean displacement of each region along y; the lines are bias and
# limits of agreement, 1.96 standard deviations from it. Right: the mean distance from the achieved face, of the
# prediction, of the face before surgery, and of the rule that skin moves by a fixed fraction of the bone.

# %%
regions = [name for name in ("nose", "upper lip", "lower lip", "chin", "right cheek", "left cheek")
           if any(name in case.regions for case in compared)]
figure, (left, right) = plt.subplots(1, 2, figsize=(11, 5), layout="constrained")
colors = plt.get_cmap("tab10")(np.arange(len(regions)))
everything = []
for name, color, marker in zip(regions, colors, "osD^v>"):
    rows = [case.regions[name] for case in compared if name in case.regions]
    pairs = np.array([(row.predicted_y_mm, row.achieved_y_mm) for row in rows
                      if row.predicted_y_mm is not None and row.achieved_y_mm is not None]).reshape(-1, 2)
    everything.append(pairs)
    left.scatter(pairs.mean(axis=1), pairs[:, 0] - pairs[:, 1], color=color, marker=marker, s=36, label=name, zorder=3)
differences_mm = np.concatenate(everything) @ (1, -1)
bias_mm, deviation_mm = differences_mm.mean(), differences_mm.std(ddof=1)
for value_mm, style, name in ((bias_mm, "-", "bias"), (bias_mm + 1.96 * deviation_mm, "--", "+1.96 SD"),
                              (bias_mm - 1.96 * deviation_mm, "--", "−1.96 SD")):
    left.axhline(value_mm, color="0.35", linestyle=style, linewidth=1)
    left.annotate(f"{name} {value_mm:+.2f} mm".replace("-", "−"), (1.0, value_mm), xycoords=("axes fraction", "data"), xytext=(-2, 3),
                  textcoords="offset points", ha="right", fontsize=8, color="0.35")
margin_mm = max(3.2 * deviation_mm, 0.2)
left.set_ylim(bias_mm - margin_mm, bias_mm + margin_mm)
left.set_xlabel("mean of predicted and achieved displacement along y [mm]")
left.set_ylabel("predicted minus achieved [mm]")
left.set_title(f"Agreement, {len(compared)} of {len(validation.cases)} cases", fontsize=11)
left.legend(frameon=False, fontsize=8, ncols=2, loc="upper left")

methods = {"prediction": "#2166ac", "no_change": "0.7", "ratio_rule": "#ef8a62"}
for number, (method, color) in enumerate(methods.items()):
    at = np.arange(len(regions)) + 0.27 * (number - 1)
    means_mm = [[getattr(case.regions[name], method).mean_mm for case in compared if name in case.regions] for name in regions]
    right.bar(at, [np.mean(values) for values in means_mm], width=0.25, color=color, label=method.replace("_", " "))
    for position, values in zip(at, means_mm):
        right.scatter([position] * len(values), values, s=8, color="black", zorder=3)
right.set_xticks(range(len(regions)), regions, rotation=20)
right.set_ylabel("mean distance from the achieved face [mm]")
right.set_title("Error by region; points are cases", fontsize=11)
right.legend(frameon=False, fontsize=9)
for axes in (left, right):
    axes.grid(axis="y", color="0.92")
    axes.set_axisbelow(True)
    for spine in ("top", "right"):
        axes.spines[spine].set_visible(False)
figure.text(0.995, 0.005, validation.notice, ha="right", va="bottom", fontsize=7, color="0.4")
figure.get_layout_engine().set(rect=(0, 0.03, 1, 0.97))
figure.savefig(figures / "validation_plot.png", dpi=150)
print(figures / "validation_plot.png")
work.cleanup()
