import { vertexNormals } from './prepare';
import type { Surface } from './section';

/** Distance from the bone at which the interface map is drawn, so that the bone does not hide it [mm]. */
const OFFSET_MM = 1;

/**
 * The tissue boundary as seen on the bone: without its skin, facing the tissue, and moved into it. Vertices keep their
 * numbers.
 *
 * @param boundary  triangles counter-clockwise from outside the tissue.
 * @param isSkin    of each vertex.
 */
export function interfaceSurface({ points, triangles }: Surface, isSkin: (vertex: number) => boolean): Surface {
  const kept: number[] = [];
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = triangles.subarray(t, t + 3);
    if (!isSkin(a) || !isSkin(b) || !isSkin(c)) kept.push(a, c, b);
  }
  const turned = Uint32Array.from(kept);
  const normals = vertexNormals({ points, triangles: turned });
  return { points: points.map((x, n) => x + OFFSET_MM * normals[n]), triangles: turned };
}
