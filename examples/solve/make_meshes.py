#!/usr/bin/env python3
"""Writes the meshes of the examples beside this file: block.vtu, layers.msh and ball.obj. Text, some KB each."""
from math import cos, pi, sin
from pathlib import Path

HERE = Path(__file__).parent


def data(name: str, kind: str, components: int, values) -> str:
    return (f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{components}" format="ascii">\n'
            + " ".join(f"{v:g}" for v in values) + "\n</DataArray>\n")


def block(file: Path, cells=(4, 4, 4), size_mm=(20.0, 20.0, 10.0)) -> None:
    """Hexahedra with a node set for each side: x0, x1, y0, y1, z0, z1."""
    nx, ny, nz = cells
    nodes = [(i * size_mm[0] / nx, j * size_mm[1] / ny, k * size_mm[2] / nz)
             for k in range(nz + 1) for j in range(ny + 1) for i in range(nx + 1)]

    def number(i, j, k):
        return i + (nx + 1) * (j + (ny + 1) * k)

    hexahedra = [[number(i + di, j + dj, k + dk) for dk in (0, 1) for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1))]
                 for k in range(nz) for j in range(ny) for i in range(nx)]
    sets = "".join(data(f"set:{'xyz'[axis]}{side}", "UInt8", 1,
                        [int(p[axis] == side * size_mm[axis]) for p in nodes])
                   for axis in range(3) for side in (0, 1))
    file.write_text(
        '<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian">\n'
        f'<UnstructuredGrid>\n<Piece NumberOfPoints="{len(nodes)}" NumberOfCells="{len(hexahedra)}">\n'
        f"<PointData>\n{sets}</PointData>\n"
        "<CellData>\n" + data("region", "Int32", 1, [1] * len(hexahedra)) + "</CellData>\n"
        "<Points>\n" + data("points", "Float64", 3, [x for p in nodes for x in p]) + "</Points>\n"
        "<Cells>\n" + data("connectivity", "Int32", 1, [n for h in hexahedra for n in h])
        + data("offsets", "Int64", 1, [8 * (e + 1) for e in range(len(hexahedra))])
        + data("types", "UInt8", 1, [12] * len(hexahedra)) + "</Cells>\n"
        "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n")


def layers(file: Path, cells=(4, 4, 4), size_mm=(20.0, 20.0, 10.0)) -> None:
    """A slab of fat under a layer of skin for Gmsh 4.1: hexahedra in the half of low x, wedges in the other.

    Physical volumes fat and skin, physical surfaces held (x = 0), tip (x = 20 mm) and under (z = 0).
    """
    nx, ny, nz = cells

    def number(i, j, k):
        return 1 + i + (nx + 1) * (j + (ny + 1) * k)

    nodes = [(i * size_mm[0] / nx, j * size_mm[1] / ny, k * size_mm[2] / nz)
             for k in range(nz + 1) for j in range(ny + 1) for i in range(nx + 1)]
    hexahedron, wedge, quad, triangle = 5, 6, 3, 2
    blocks: dict = {}  # (dimension, entity, type): elements.
    for k in range(nz):
        region = 2 if k == nz - 1 else 1
        for j in range(ny):
            for i in range(nx):
                low = [number(i + di, j + dj, k) for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1))]
                step = (nx + 1) * (ny + 1)
                bases = [low] if i < nx // 2 else [[low[0], low[1], low[2]], [low[0], low[2], low[3]]]
                for base in bases:
                    kind = hexahedron if len(base) == 4 else wedge
                    blocks.setdefault((3, region, kind), []).append(base + [n + step for n in base])
                    if k == 0:
                        kind = quad if len(base) == 4 else triangle
                        blocks.setdefault((2, 3, kind), []).append(base[::-1])
    for entity, i in ((1, 0), (2, nx)):
        blocks[2, entity, quad] = [[number(i, j + dj, k + dk) for dj, dk in ((0, 0), (1, 0), (1, 1), (0, 1))]
                                   for k in range(nz) for j in range(ny)]

    box = "0 0 0 " + " ".join(f"{x:g}" for x in size_mm)
    total = sum(map(len, blocks.values()))
    lines = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$PhysicalNames", "5", '2 1 "held"', '2 2 "tip"', '2 3 "under"',
             '3 1 "fat"', '3 2 "skin"', "$EndPhysicalNames", "$Entities", "0 0 3 2"]
    lines += [f"{tag} {box} 1 {tag} 0" for tag in (1, 2, 3)] + [f"{tag} {box} 1 {tag} 0" for tag in (1, 2)]
    lines += ["$EndEntities", "$Nodes", f"1 {len(nodes)} 1 {len(nodes)}", f"3 1 0 {len(nodes)}"]
    lines += [str(1 + n) for n in range(len(nodes))] + [" ".join(f"{x:g}" for x in p) for p in nodes]
    lines += ["$EndNodes", "$Elements", f"{len(blocks)} {total} 1 {total}"]
    tag = 0
    for (dimension, entity, kind), elements in sorted(blocks.items()):
        lines.append(f"{dimension} {entity} {kind} {len(elements)}")
        for element in elements:
            tag += 1
            lines.append(" ".join(map(str, [tag] + element)))
    file.write_text("\n".join(lines + ["$EndElements"]) + "\n")


def ball(file: Path, radius_mm=6.0, center=(10.0, 10.0, 16.0), rings=10, around=20) -> None:
    """A sphere that touches the middle of the block's upper side."""
    points = [(0.0, 0.0, 1.0)]
    for ring in range(1, rings):
        angle = pi * ring / rings
        points += [(sin(angle) * cos(2 * pi * n / around), sin(angle) * sin(2 * pi * n / around), cos(angle))
                   for n in range(around)]
    points.append((0.0, 0.0, -1.0))

    def at(ring, n):
        return 2 + (ring - 1) * around + n % around

    faces = [(1, at(1, n), at(1, n + 1)) for n in range(around)]
    for ring in range(1, rings - 1):
        for n in range(around):
            faces += [(at(ring, n), at(ring + 1, n), at(ring + 1, n + 1)),
                      (at(ring, n), at(ring + 1, n + 1), at(ring, n + 1))]
    faces += [(at(rings - 1, n + 1), at(rings - 1, n), len(points)) for n in range(around)]
    lines = ["v " + " ".join(f"{c + radius_mm * x:.6g}" for c, x in zip(center, p)) for p in points]
    lines += ["f " + " ".join(map(str, face)) for face in faces]
    file.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    block(HERE / "block.vtu")
    layers(HERE / "layers.msh")
    ball(HERE / "ball.obj")
