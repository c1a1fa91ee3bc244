#!/usr/bin/env python3
"""Fails when an #include breaks src/lefort/LAYERS, names a library its layer may not use or the world
outside, when a line is too long, or when \\cite and docs/references.bib do not match. Run from the
repository root; it is the ctest `sources`.
"""
import re
import sys
from pathlib import Path

ROOT = Path("src/lefort")
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]')
MAX_LINE = 100
# Only io, report, bench, pipeline, server and app may name these: all else is a pure function of its arguments.
OUTSIDE_WORLD = {"fstream", "iostream", "filesystem", "cstdio"}
MAY_TOUCH_OUTSIDE = {"io", "report", "bench", "pipeline", "server", "app"}
# Libraries stay behind one layer's .cpp files, so that each can be replaced; bench runs some as peers.
# Eigen is for all.
LIBRARIES = {
    "tbb/": {"core"}, "CGAL/": {"mesh", "plan", "bench"}, "itk": {"anatomy", "io"},
    "vtk": {"anatomy", "io", "bench"}, "metis.h": {"linear"},
    "nlohmann/": {"io", "bench", "pipeline", "server", "app"}, "valijson/": {"io"}, "CLI/": {"app"}, "httplib.h": {"server"}, "curl/": {"io"},
    "embree3/": {"report", "bench"}, "openvdb/": {"io", "bench"}, "cairo": {"report"}, "zlib.h": {"io"}, "expat.h": {"io"}, "openssl/": {"io"},
}
MAY_SHOW_LIBRARIES = {"core/parallel.h", "mesh/internal/cgal_surface.h",
                      "io/internal/validated_json.h", "io/internal/rename_keys.h", "io/predicted_poses.h",
                      "bench", "pipeline", "server", "app"}  # Headers (or layers) that may include one.


def read_layers(text: str) -> dict[str, set[str]]:
    """Returns {layer: layers it may include}; checks that every name appears above its use."""
    layers: dict[str, set[str]] = {}
    for line in text.splitlines():
        line = line.split("#", 1)[0].strip()
        if not line:
            continue
        name, _, deps = line.partition(":")
        wanted = set(deps.split())
        unknown = wanted - layers.keys()
        if unknown:
            sys.exit(f"LAYERS: {name.strip()} names {sorted(unknown)}, not declared above it")
        layers[name.strip()] = wanted
    return layers


def violations(root: Path, layers: dict[str, set[str]]) -> list[str]:
    found = []
    for path in sorted(root.rglob("*")):
        if path.suffix not in {".h", ".cpp"}:
            continue
        layer = path.relative_to(root).parts[0]
        if layer not in layers:
            found.append(f"{path}: folder '{layer}' is not in LAYERS")
            continue
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            if len(line) > MAX_LINE:
                found.append(f"{path}:{number}: longer than {MAX_LINE} characters")
            match = INCLUDE.match(line)
            if not match:
                continue
            target = match.group(1)
            if target.startswith("lefort/"):
                other = target.split("/")[1]
                if other != layer and other not in layers[layer]:
                    found.append(f"{path}:{number}: {layer} may not include {other}")
                if "/internal/" in target and other != layer:
                    found.append(f"{path}:{number}: {target} is internal to {other}")
            elif target in OUTSIDE_WORLD and layer not in MAY_TOUCH_OUTSIDE:
                found.append(f"{path}:{number}: <{target}> is for {sorted(MAY_TOUCH_OUTSIDE)} only")
            for prefix, users in LIBRARIES.items():
                if not target.startswith(prefix):
                    continue
                shown = {layer, str(path.relative_to(root))} & MAY_SHOW_LIBRARIES
                if layer not in users:
                    found.append(f"{path}:{number}: <{target}> is for {sorted(users)} only")
                elif path.suffix == ".h" and not shown:
                    found.append(f"{path}:{number}: <{target}> belongs in a .cpp")
    return found


def citation_mismatches(root: Path, references: Path) -> list[str]:
    """Sources that are cited and not listed, and those listed that nobody cites."""
    listed = set(re.findall(r"^@\w+\{([^,\s]+),", references.read_text(encoding="utf-8"), re.MULTILINE))
    cited: dict[str, Path] = {}
    for path in sorted(root.rglob("*")):
        if path.suffix in {".h", ".cpp"}:
            for key in re.findall(r"\\cite\s+(?:///\s*)?([\w:-]+)", path.read_text(encoding="utf-8")):
                cited.setdefault(key, path)
    missing = [f"{cited[key]}: \\cite {key} is not in {references}" for key in sorted(cited.keys() - listed)]
    unused = [f"{references}: {key} is cited nowhere" for key in sorted(listed - cited.keys())]
    return missing + unused


if __name__ == "__main__":
    problems = violations(ROOT, read_layers((ROOT / "LAYERS").read_text(encoding="utf-8")))
    problems += citation_mismatches(ROOT, Path("docs/references.bib"))
    print("\n".join(problems) or "layers and citations: ok")
    sys.exit(bool(problems))
