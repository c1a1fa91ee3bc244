"""The notebooks of examples/python run as scripts, and draw their figures."""
import os
import subprocess
import sys

import pytest


@pytest.mark.parametrize("name, options", [
    ("field_of_a_bone", {"LEFORT_RESOLUTION": "128"}), ("vary_a_plan", {}), ("validation_plot", {"LEFORT_CASES": "2"})])
def test_a_notebook_draws_its_figure(source, tmp_path, name, options):
    environment = {**os.environ, **options, "LEFORT_FIGURES": str(tmp_path / "figures"), "MPLBACKEND": "Agg"}
    done = subprocess.run([sys.executable, source / "examples" / "python" / f"{name}.py"], env=environment, cwd=tmp_path,
                          capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 0 and not done.stderr, done.stderr
    figure = (tmp_path / "figures" / f"{name}.png").read_bytes()
    assert figure.startswith(b"\x89PNG") and len(figure) > 20_000
    assert os.listdir(tmp_path) == ["figures"]  # Everything else was temporary.


@pytest.mark.parametrize("name", ["field_of_a_bone", "vary_a_plan", "validation_plot"])
def test_a_notebook_has_text_and_code_cells(source, name):
    text = (source / "examples" / "python" / f"{name}.py").read_text()
    assert text.startswith("# %% [markdown]\n# # ") and text.count("\n# %%\n") >= 3
    assert "not\n# for clinical use" in text or "not for clinical use" in text.replace("\n# ", " ")
