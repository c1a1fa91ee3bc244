"""Sphinx configuration; script/docs runs it on the pages that make_pages.py collects in build/docs/source."""
import shutil
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

project = "lefort"
copyright = "the lefort contributors, GPL-3.0-or-later. Research software, not for clinical use"
extensions = ["myst_parser", "sphinx.ext.mathjax"]
source_suffix = {".md": "markdown"}
smartquotes = False
highlight_language = "none"
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4
# JSON examples hold "..." and comments.
suppress_warnings = ["misc.highlighting_failure"]

html_theme = "furo"
html_title = "lefort"
html_static_path = [str(ROOT / "build/docs/static")]
html_css_files = ["katex/katex.min.css", "page.css"]
# Formulas are drawn by KaTeX from Debian's package, so that the site needs no network.
mathjax_path = "katex/katex.min.js"
html_js_files = [("katex/contrib/auto-render.js", {"defer": "defer"}), ("draw_formulas.js", {"defer": "defer"})]


def _make_static() -> None:
    static = ROOT / "build/docs/static"
    shutil.rmtree(static, ignore_errors=True)
    library = static / "katex"
    (library / "contrib").mkdir(parents=True)
    debian = Path("/usr/share/javascript/katex")
    shutil.copy(debian / "katex.min.js", library)
    shutil.copy(debian / "katex.min.css", library)
    shutil.copy(debian / "contrib/auto-render.js", library / "contrib")
    (library / "fonts").mkdir()
    for font in Path("/usr/share/fonts/truetype/katex").glob("*.woff2"):
        shutil.copy(font, library / "fonts")
    # Wide enough for tables of keys.
    (static / "page.css").write_text(
        ".content { width: 54em; }\n", encoding="utf-8")
    (static / "draw_formulas.js").write_text(
        'document.querySelectorAll(".math").forEach((element) => renderMathInElement(element));\n', encoding="utf-8")


_make_static()
