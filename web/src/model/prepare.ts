import type { Surface } from './section';

/** A surface prepared for drawing: normals, and a coarse version for drags. */
export interface DrawnSurface extends Surface {
  /** Unit normals per vertex, out of the body. */
  normals: Float32Array;
  coarse: {
    /** Vertex of the full surface of each coarse vertex. */
    vertex: Uint32Array;
    triangles: Uint32Array;
  };
}

/** Area-weighted vertex normals. */
export function vertexNormals({ points, triangles }: Surface): Float32Array {
  const normals = new Float32Array(points.length);
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * triangles[t];
    const b = 3 * triangles[t + 1];
    const c = 3 * triangles[t + 2];
    const ux = points[b] - points[a];
    const uy = points[b + 1] - points[a + 1];
    const uz = points[b + 2] - points[a + 2];
    const vx = points[c] - points[a];
    const vy = points[c + 1] - points[a + 1];
    const vz = points[c + 2] - points[a + 2];
    const nx = uy * vz - uz * vy;
    const ny = uz * vx - ux * vz;
    const nz = ux * vy - uy * vx;
    for (const v of [a, b, c]) {
      normals[v] += nx;
      normals[v + 1] += ny;
      normals[v + 2] += nz;
    }
  }
  for (let n = 0; n < normals.length; n += 3) {
    const size = Math.hypot(normals[n], normals[n + 1], normals[n + 2]) || 1;
    normals[n] /= size;
    normals[n + 1] /= size;
    normals[n + 2] /= size;
  }
  return normals;
}

/** Merges the vertices of each cube of `cell_mm`; collapsed triangles are removed. For drawing only. */
export function coarsen({ points, triangles }: Surface, cell_mm: number): DrawnSurface['coarse'] {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let n = 0; n < points.length; n++) {
    low[n % 3] = Math.min(low[n % 3], points[n]);
    high[n % 3] = Math.max(high[n % 3], points[n]);
  }
  const nx = Math.floor((high[0] - low[0]) / cell_mm) + 1;
  const ny = Math.floor((high[1] - low[1]) / cell_mm) + 1;
  const cells = new Map<number, number>();
  const vertex: number[] = [];
  const of = new Uint32Array(points.length / 3);
  for (let v = 0; v < of.length; v++) {
    const i = Math.floor((points[3 * v] - low[0]) / cell_mm);
    const j = Math.floor((points[3 * v + 1] - low[1]) / cell_mm);
    const k = Math.floor((points[3 * v + 2] - low[2]) / cell_mm);
    const key = i + nx * (j + ny * k);
    let coarse = cells.get(key);
    if (coarse === undefined) {
      coarse = vertex.length;
      cells.set(key, coarse);
      vertex.push(v);
    }
    of[v] = coarse;
  }
  const kept: number[] = [];
  for (let t = 0; t < triangles.length; t += 3) {
    const a = of[triangles[t]];
    const b = of[triangles[t + 1]];
    const c = of[triangles[t + 2]];
    if (a !== b && b !== c && c !== a) kept.push(a, b, c);
  }
  return { vertex: Uint32Array.from(vertex), triangles: Uint32Array.from(kept) };
}

/** Edge of the cubes [mm]: a head has about 35,000 triangles, which software renders fast enough. */
export const COARSE_CELL_MM = 5;

export const prepareSurface = (surface: Surface): DrawnSurface => ({
  ...surface,
  normals: vertexNormals(surface),
  coarse: coarsen(surface, COARSE_CELL_MM),
});
