import { sub, type Mat4, type Vec3 } from './frames';
import type { Landmark } from './landmarks';
import { transformPoint, type Move } from './moves';

/** Drawn part of a profile: the front of the face, from the right, so that anterior is on the right. Units: mm. */
export interface ProfileFrame {
  lowY: number;
  highZ: number;
  depth: number;
  height: number;
}

/** Depth of the front of the face, and the margin of the drawing [mm]. */
const FRONT_MM = 60;
const PAD_MM = 6;

/** The frame of outlines (pairs of points in L); null if there are none. */
export function profileFrame(outlines: readonly Float32Array[]): ProfileFrame | null {
  let [lowY, highZ, lowZ, highY] = [Infinity, -Infinity, Infinity, -Infinity];
  for (const lines of outlines)
    for (let n = 0; n < lines.length; n += 3) {
      lowY = Math.min(lowY, lines[n + 1]);
      highY = Math.max(highY, lines[n + 1]);
      lowZ = Math.min(lowZ, lines[n + 2]);
      highZ = Math.max(highZ, lines[n + 2]);
    }
  if (lowY > highY) return null;
  return { lowY, highZ, depth: Math.min(FRONT_MM, highY - lowY), height: highZ - lowZ };
}

export const viewBoxOf = (frame: ProfileFrame): string =>
  `0 0 ${frame.depth + 2 * PAD_MM} ${frame.height + 2 * PAD_MM}`;

/** Position in the drawing of a point of the profile at y and z. */
export const toDrawing = (frame: ProfileFrame, y: number, z: number): [number, number] => [
  frame.lowY + frame.depth - y + PAD_MM,
  frame.highZ - z + PAD_MM,
];

/** y and z of a position in the drawing; the inverse of toDrawing. */
export const fromDrawing = (frame: ProfileFrame, u: number, v: number): [number, number] => [
  frame.lowY + frame.depth + PAD_MM - u,
  frame.highZ + PAD_MM - v,
];

/** SVG path of the outline within the frame. */
export function profilePath(lines: Float32Array, frame: ProfileFrame): string {
  let d = '';
  for (let n = 0; n < lines.length; n += 6) {
    if (lines[n + 1] > frame.lowY + frame.depth && lines[n + 4] > frame.lowY + frame.depth) continue;
    const at = (k: number): string =>
      toDrawing(frame, lines[n + k + 1], lines[n + k + 2])
        .map((value) => value.toFixed(2))
        .join(' ');
    d += `M${at(0)}L${at(3)}`;
  }
  return d;
}

/** The vertex closest to a point, at most `reach_mm` away; null if there is none. */
export function vertexNear(points: Float32Array, at: Vec3, reach_mm: number): number | null {
  let closest: number | null = null;
  let least = reach_mm * reach_mm;
  for (let n = 0; n < points.length; n += 3) {
    const [dx, dy, dz] = [points[n] - at[0], points[n + 1] - at[1], points[n + 2] - at[2]];
    const squared = dx * dx + dy * dy + dz * dz;
    if (squared > least) continue;
    least = squared;
    closest = n / 3;
  }
  return closest;
}

export const vertexAt = (points: Float32Array, vertex: number): Vec3 => [
  points[3 * vertex],
  points[3 * vertex + 1],
  points[3 * vertex + 2],
];

/** The move with another translation, so that its pivot goes where the pose brings it. */
export const translatedTo = (move: Move, pose: Mat4): Move => ({
  ...move,
  translation_mm: sub(transformPoint(pose, move.about_mm), move.about_mm),
});

/** Position (x) of the mid-sagittal plane [mm]: from midline landmarks, else the middle of the skin. */
export function midsagittalX(landmarks: readonly Landmark[], skin: Float32Array): number {
  const middle = landmarks.filter((l) => ['N', 'ANS', 'A', 'S', 'PNS'].includes(l.name));
  if (middle.length > 0) return middle.reduce((sum, l) => sum + l.position_mm[0], 0) / middle.length;
  let [low, high] = [Infinity, -Infinity];
  for (let n = 0; n < skin.length; n += 3) {
    low = Math.min(low, skin[n]);
    high = Math.max(high, skin[n]);
  }
  return (low + high) / 2;
}
