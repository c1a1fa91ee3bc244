import type { Vec3 } from './frames';
import type { Surface } from './section';

export interface Hit {
  distance: number;
  point: Vec3;
  /** Unit normal of the triangle, out of the body. */
  normal: Vec3;
  /** The triangle's corner nearest to the point. */
  vertex: number;
}

/**
 * First triangle that a ray enters from outside (Moeller and Trumbore 1997), or null. A loop over all triangles takes
 * 5 ms for a skull.
 */
export function rayHit({ points: p, triangles }: Surface, origin: Vec3, direction: Vec3): Hit | null {
  const [ox, oy, oz] = origin;
  const [dx, dy, dz] = direction;
  let best = Infinity;
  let at = -1;
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * triangles[t];
    const b = 3 * triangles[t + 1];
    const c = 3 * triangles[t + 2];
    const e1x = p[b] - p[a];
    const e1y = p[b + 1] - p[a + 1];
    const e1z = p[b + 2] - p[a + 2];
    const e2x = p[c] - p[a];
    const e2y = p[c + 1] - p[a + 1];
    const e2z = p[c + 2] - p[a + 2];
    const px = dy * e2z - dz * e2y;
    const py = dz * e2x - dx * e2z;
    const pz = dx * e2y - dy * e2x;
    const det = e1x * px + e1y * py + e1z * pz;
    if (!(det > 1e-12)) continue; // Back face, or parallel to the ray.
    const sx = ox - p[a];
    const sy = oy - p[a + 1];
    const sz = oz - p[a + 2];
    const u = sx * px + sy * py + sz * pz;
    if (u < 0 || u > det) continue;
    const qx = sy * e1z - sz * e1y;
    const qy = sz * e1x - sx * e1z;
    const qz = sx * e1y - sy * e1x;
    const v = dx * qx + dy * qy + dz * qz;
    if (v < 0 || u + v > det) continue;
    const distance = (e2x * qx + e2y * qy + e2z * qz) / det;
    if (distance > 0 && distance < best) {
      best = distance;
      at = t;
    }
  }
  if (at < 0) return null;
  const point: Vec3 = [ox + best * dx, oy + best * dy, oz + best * dz];
  const corner = (n: number): Vec3 => {
    const v = 3 * triangles[at + n];
    return [p[v], p[v + 1], p[v + 2]];
  };
  const [a, b, c] = [corner(0), corner(1), corner(2)];
  const n: Vec3 = [
    (b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1]),
    (b[2] - a[2]) * (c[0] - a[0]) - (b[0] - a[0]) * (c[2] - a[2]),
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]),
  ];
  const size = Math.hypot(...n);
  const far = [a, b, c].map((q) => Math.hypot(q[0] - point[0], q[1] - point[1], q[2] - point[2]));
  return {
    distance: best,
    point,
    normal: [n[0] / size, n[1] / size, n[2] / size],
    vertex: triangles[at + far.indexOf(Math.min(...far))],
  };
}
