import { add, cross, dot, length, scale, sub, type Mat4, type Vec3 } from './frames';
import type { Keyframe } from './plan';

/** Motion of a segment as the plan states it: a rotation about a point, then a translation. */
export interface Move {
  translation_mm: Vec3;
  /** Rotation vector: axis times angle, in L. */
  rotation_deg: Vec3;
  about_mm: Vec3;
}

type Mat3 = readonly number[];

const DEG = Math.PI / 180;

/** Rodrigues' formula; row-major 3x3. */
export function rotationMatrix(rotation_deg: Vec3): Mat3 {
  const angle = length(rotation_deg) * DEG;
  if (angle === 0) return [1, 0, 0, 0, 1, 0, 0, 0, 1];
  const [x, y, z] = scale(rotation_deg, DEG / angle);
  const c = Math.cos(angle);
  const s = Math.sin(angle);
  const t = 1 - c;
  return [
    t * x * x + c,
    t * x * y - s * z,
    t * x * z + s * y,
    t * x * y + s * z,
    t * y * y + c,
    t * y * z - s * x,
    t * x * z - s * y,
    t * y * z + s * x,
    t * z * z + c,
  ];
}

/** The inverse of rotationMatrix, for angles below 180 degrees. */
export function rotationVector(R: Mat3): Vec3 {
  const axis: Vec3 = [R[7] - R[5], R[2] - R[6], R[3] - R[1]];
  const sine = length(axis) / 2;
  const cosine = (R[0] + R[4] + R[8] - 1) / 2;
  const angle = Math.atan2(sine, cosine);
  if (sine < 1e-12) return [0, 0, 0];
  return scale(axis, angle / (2 * sine) / DEG);
}

const apply3 = (R: Mat3, p: Vec3): Vec3 => [
  R[0] * p[0] + R[1] * p[1] + R[2] * p[2],
  R[3] * p[0] + R[4] * p[1] + R[5] * p[2],
  R[6] * p[0] + R[7] * p[1] + R[8] * p[2],
];

const multiply3 = (A: Mat3, B: Mat3): Mat3 =>
  Array.from({ length: 9 }, (_, n) => {
    const row = Math.floor(n / 3) * 3;
    const col = n % 3;
    return A[row] * B[col] + A[row + 1] * B[col + 3] + A[row + 2] * B[col + 6];
  });

/** X_LB of a move: from the bone as scanned to its new position. */
export function poseOf(move: Move): Mat4 {
  const R = rotationMatrix(move.rotation_deg);
  const t = add(sub(move.about_mm, apply3(R, move.about_mm)), move.translation_mm);
  return [R[0], R[1], R[2], t[0], R[3], R[4], R[5], t[1], R[6], R[7], R[8], t[2], 0, 0, 0, 1];
}

export const IDENTITY: Mat4 = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

export const transformPoint = (X: Mat4, p: Vec3): Vec3 => [
  X[0] * p[0] + X[1] * p[1] + X[2] * p[2] + X[3],
  X[4] * p[0] + X[5] * p[1] + X[6] * p[2] + X[7],
  X[8] * p[0] + X[9] * p[1] + X[10] * p[2] + X[11],
];

/** The same motion, described about another point. */
export function changePivot(move: Move, about_mm: Vec3): Move {
  return { ...move, about_mm, translation_mm: sub(transformPoint(poseOf(move), about_mm), about_mm) };
}

/** The move with a further translation by a vector of L. */
export const translated = (move: Move, by_mm: Vec3): Move => ({
  ...move,
  translation_mm: add(move.translation_mm, by_mm),
});

/** The move with a further rotation about the new position of its pivot. */
export function rotated(move: Move, by_deg: Vec3): Move {
  const R = multiply3(rotationMatrix(by_deg), rotationMatrix(move.rotation_deg));
  return { ...move, rotation_deg: rotationVector(R) };
}

export const moveOf = (keyframe: Keyframe, pivot: Vec3): Move => ({
  translation_mm: keyframe.translation_mm ?? [0, 0, 0],
  rotation_deg: keyframe.rotation_deg ?? [0, 0, 0],
  about_mm: keyframe.about_mm ?? pivot,
});

/** Fraction of the path at keyframe k. */
export const pathFractionOf = (keyframes: readonly Keyframe[], k: number): number =>
  keyframes[k].at ?? (k + 1) / keyframes.length;

/** Components of a move in clinical terms: along and about the axes of L. */
export const COMPONENTS = [
  { key: 'anterior', kind: 'translate', plus: 'anterior', minus: 'posterior', axis: [0, -1, 0], unit: 'mm' },
  { key: 'superior', kind: 'translate', plus: 'superior', minus: 'inferior', axis: [0, 0, 1], unit: 'mm' },
  { key: 'left', kind: 'translate', plus: 'to the left', minus: 'to the right', axis: [1, 0, 0], unit: 'mm' },
  { key: 'pitch', kind: 'rotate', plus: 'front up', minus: 'front down', axis: [-1, 0, 0], unit: '°' },
  { key: 'roll', kind: 'rotate', plus: 'left side up', minus: 'right side up', axis: [0, -1, 0], unit: '°' },
  { key: 'yaw', kind: 'rotate', plus: 'front to the left', minus: 'front to the right', axis: [0, 0, 1], unit: '°' },
] as const satisfies readonly { key: string; kind: string; plus: string; minus: string; axis: Vec3; unit: string }[];

export type ComponentKey = (typeof COMPONENTS)[number]['key'];

export function componentOf(move: Move, key: ComponentKey): number {
  const part = COMPONENTS.find((p) => p.key === key)!;
  const value = dot(part.kind === 'translate' ? move.translation_mm : move.rotation_deg, part.axis);
  return value === 0 ? 0 : value; // Never minus zero.
}

export function withComponent(move: Move, key: ComponentKey, value: number): Move {
  const part = COMPONENTS.find((p) => p.key === key)!;
  const field = part.kind === 'translate' ? 'translation_mm' : 'rotation_deg';
  return { ...move, [field]: add(move[field], scale(part.axis, value - componentOf(move, key))) };
}

/** Two unit vectors perpendicular to `normal`; with it they form a right-handed frame. */
export function acrossNormal(normal: Vec3): [Vec3, Vec3] {
  const helper: Vec3 = Math.abs(normal[0]) < 0.9 * length(normal) ? [1, 0, 0] : [0, 1, 0];
  const first = cross(normal, helper);
  const a = scale(first, 1 / length(first));
  const second = cross(normal, a);
  return [a, scale(second, 1 / length(second))];
}
