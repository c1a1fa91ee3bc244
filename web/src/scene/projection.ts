import { cross, dot, mapVec3, sub, type Vec3 } from '../model';

/** Orthographic projection of L. Pixels are CSS pixels from the top left corner of the view. */
export interface Projection {
  right: Vec3;
  up: Vec3;
  forward: Vec3;
  px_per_mm: number;
  toScreen(p: Vec3): [number, number];
  /** Pixels per mm along a direction, to the right and down. */
  directionOnScreen(d: Vec3): [number, number];
  /** Ray through a point of the screen; it starts in front of everything. */
  rayAt(x: number, y: number): { origin: Vec3; direction: Vec3 };
}

export function projectionOf(
  target: Vec3,
  forward: Vec3,
  up: Vec3,
  px_per_mm: number,
  center_px: [number, number],
): Projection {
  const right = cross(forward, up);
  const directionOnScreen = (d: Vec3): [number, number] => [dot(d, right) * px_per_mm, -dot(d, up) * px_per_mm];
  return {
    right,
    up,
    forward,
    px_per_mm,
    directionOnScreen,
    toScreen(p) {
      const [x, y] = directionOnScreen(sub(p, target));
      return [center_px[0] + x, center_px[1] + y];
    },
    rayAt(x, y) {
      const a = (x - center_px[0]) / px_per_mm;
      const b = -(y - center_px[1]) / px_per_mm;
      const back = 2000; // mm, beyond any head
      const origin = mapVec3(target, (value, c) => value + a * right[c] + b * up[c] - back * forward[c]);
      return { origin, direction: forward };
    },
  };
}
