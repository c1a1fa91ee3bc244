import { Matrix4 } from 'three';
import { add, rayHit, sub, transformPoint, type Mat4, type Vec3 } from '../model';
import type { Body } from './body';
import type { BodyHit } from './view_events';

/** Bodies below this opacity cannot be picked. */
const MIN_OPACITY = 0.3;

const rowMajor = (m: Matrix4): Mat4 => m.clone().transpose().toArray();

/** First visible body along a ray of L. `coarse`: tests the coarse surfaces, which is faster. */
export function pickAlong(
  bodies: ReadonlyMap<string, Body>,
  origin: Vec3,
  direction: Vec3,
  isPickable: (name: string) => boolean,
  coarse: boolean,
): BodyHit | null {
  let nearest: BodyHit | null = null;
  for (const [name, body] of bodies) {
    if (!body.shown || body.opacity < MIN_OPACITY || !isPickable(name)) continue;
    const inverse = rowMajor(new Matrix4().copy(body.group.matrix).invert());
    const from = transformPoint(inverse, origin);
    const along = sub(transformPoint(inverse, add(origin, direction)), from);
    const surface = coarse ? body.coarseSurface : { points: body.points, triangles: body.surface.triangles };
    const hit = rayHit(surface, from, along);
    if (!hit || (nearest && hit.distance >= nearest.hit.distance)) continue;
    const pose = rowMajor(body.group.matrix);
    const point = transformPoint(pose, hit.point);
    const normal = sub(transformPoint(pose, add(hit.point, hit.normal)), point);
    nearest = { body: name, hit: { ...hit, point, normal } };
  }
  return nearest;
}
