import type { Mat4, Vec3 } from './frames';

/** Triangles as the server sends them: xyz and ijk, flat. */
export interface Surface {
  points: Float32Array;
  triangles: Uint32Array;
}

/**
 * Intersection of a plane and a surface as line segments, 6 numbers each, mm in L. For drawing, not for measuring.
 */
export const sectionOf = (surface: Surface, point: Vec3, normal: Vec3): Float32Array =>
  sectionsOf(surface, [surface.points], point, normal)[0];

/**
 * The section of a surface, and where the same points of its material lie if the vertices have other positions: one
 * list of line segments for each of `positions`.
 */
export function sectionsOf(
  surface: Surface,
  positions: readonly Float32Array[],
  point: Vec3,
  normal: Vec3,
): Float32Array[] {
  const { points, triangles } = surface;
  const offset = point[0] * normal[0] + point[1] * normal[1] + point[2] * normal[2];
  const height = new Float32Array(points.length / 3);
  for (let n = 0; n < height.length; n++)
    height[n] = points[3 * n] * normal[0] + points[3 * n + 1] * normal[1] + points[3 * n + 2] * normal[2] - offset;
  const lines = positions.map((): number[] => []);
  const cross = (a: number, b: number): void => {
    const t = height[a] / (height[a] - height[b]);
    positions.forEach((at, k) => {
      for (let c = 0; c < 3; c++) lines[k].push(at[3 * a + c] + t * (at[3 * b + c] - at[3 * a + c]));
    });
  };
  for (let t = 0; t < triangles.length; t += 3) {
    const a = triangles[t];
    const b = triangles[t + 1];
    const c = triangles[t + 2];
    const above = (height[a] >= 0 ? 1 : 0) + (height[b] >= 0 ? 2 : 0) + (height[c] >= 0 ? 4 : 0);
    if (above === 0 || above === 7) continue;
    // One corner is alone on its side of the plane.
    if (above === 1 || above === 6) {
      cross(a, b);
      cross(a, c);
    } else if (above === 2 || above === 5) {
      cross(b, a);
      cross(b, c);
    } else {
      cross(c, a);
      cross(c, b);
    }
  }
  return lines.map((list) => Float32Array.from(list));
}

/** Intersection of a plane of L and a surface at pose X_LB; lines in L. */
export function posedSectionOf(surface: Surface, X_LB: Mat4, point: Vec3, normal: Vec3): Float32Array {
  const [r00, r01, r02, tx, r10, r11, r12, ty, r20, r21, r22, tz] = X_LB;
  const [dx, dy, dz] = [point[0] - tx, point[1] - ty, point[2] - tz];
  const back = (x: number, y: number, z: number): Vec3 => [
    r00 * x + r10 * y + r20 * z,
    r01 * x + r11 * y + r21 * z,
    r02 * x + r12 * y + r22 * z,
  ];
  const lines = sectionOf(surface, back(dx, dy, dz), back(...normal));
  for (let n = 0; n < lines.length; n += 3) {
    const [x, y, z] = [lines[n], lines[n + 1], lines[n + 2]];
    lines[n] = r00 * x + r01 * y + r02 * z + tx;
    lines[n + 1] = r10 * x + r11 * y + r12 * z + ty;
    lines[n + 2] = r20 * x + r21 * y + r22 * z + tz;
  }
  return lines;
}
