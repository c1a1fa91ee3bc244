"""The examples of docs/guide/python.md run, one after the other."""
import re

import lefort
from conftest import small_head


def test_the_examples_of_the_guide_run(source, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    lefort.write_volume("ct.nrrd", small_head())
    text = (source / "docs" / "guide" / "python.md").read_text(encoding="utf-8")
    examples = re.findall(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    assert len(examples) >= 6
    names: dict[str, object] = {}
    for example in examples:
        exec(compile(example, "docs/guide/python.md", "exec"), names)  # noqa: S102
    assert isinstance(names["prediction"], lefort.Prediction)
