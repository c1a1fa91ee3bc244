import { add, mapVec3, roundVec3, type Mat4, type Vec3 } from './frames';
import type { Landmark } from './landmarks';
import { changePivot, moveOf, poseOf, rotated, translated, type Move } from './moves';
import { editKeyframe, isEditablePath, keyframesOf, type Plan } from './plan';

// Edits of a segment's movement, as pure functions of the plan and the landmarks.

/** Rotations below this angle are not written to the plan [deg]. */
const MIN_ROTATION_DEG = 5e-4;

/** Mean of the points (flat xyz), rounded to 0.1 mm; null if there are none. */
export function centroidOf(points: Float32Array | undefined): Vec3 | null {
  if (!points || points.length === 0) return null;
  let sum: Vec3 = [0, 0, 0];
  for (let n = 0; n < points.length; n += 3) sum = add(sum, [points[n], points[n + 1], points[n + 2]]);
  return mapVec3(sum, (c) => Math.round((10 * c * 3) / points.length) / 10);
}

/** Keyframe k of a segment. */
export interface KeyframeRef {
  segment: number;
  keyframe: number;
}

/** The move at a keyframe, about `pivot` unless the keyframe names a point; null if the path is not made of numbers. */
export function moveAt(plan: Plan, landmarks: readonly Landmark[], at: KeyframeRef, pivot: Vec3): Move | null {
  const segment = plan.segments[at.segment];
  if (!segment || !isEditablePath(segment.path)) return null;
  const keyframes = keyframesOf(segment);
  const keyframe = keyframes[Math.min(at.keyframe, keyframes.length - 1)];
  if (!keyframe) return null;
  const landmark = keyframe.about ? landmarks.find((l) => l.name === keyframe.about) : undefined;
  return moveOf(landmark ? { ...keyframe, about_mm: landmark.position_mm } : keyframe, pivot);
}

/** Writes `move` to a keyframe. `before` is the move that the keyframe describes now. */
export function withMove(plan: Plan, at: KeyframeRef, move: Move, before: Move | null): Plan {
  const old = keyframesOf(plan.segments[at.segment])[at.keyframe];
  const next = { ...old, translation_mm: roundVec3(move.translation_mm, 3) };
  const rotates = move.rotation_deg.some((c) => Math.abs(c) > MIN_ROTATION_DEG);
  if (rotates) next.rotation_deg = roundVec3(move.rotation_deg, 3);
  else delete next.rotation_deg;
  if (old.about !== undefined && move.about_mm === before?.about_mm) delete next.about_mm;
  else if (rotates || old.about_mm !== undefined) {
    delete next.about;
    next.about_mm = roundVec3(move.about_mm, 3);
  }
  return editKeyframe(plan, at.segment, at.keyframe, next);
}

/** Describes the same motion about another point or landmark; null if the landmark does not exist. */
export function withPivot(
  plan: Plan,
  landmarks: readonly Landmark[],
  at: KeyframeRef,
  move: Move,
  about: Vec3 | string,
): Plan | null {
  const point = typeof about === 'string' ? landmarks.find((l) => l.name === about)?.position_mm : about;
  if (!point) return null;
  const { translation_mm } = changePivot(move, point);
  const next = { ...keyframesOf(plan.segments[at.segment])[at.keyframe], translation_mm };
  delete next.about;
  delete next.about_mm;
  Object.assign(next, typeof about === 'string' ? { about } : { about_mm: point });
  return editKeyframe(plan, at.segment, at.keyframe, next);
}

/** A move after its gizmo was dragged along or about an axis, in steps of 0.1 mm or 0.1 degrees. */
export function draggedMove(from: Move, kind: 'translate' | 'rotate', axis: Vec3, amount: number): Move {
  const rounded = Math.round(amount * 10) / 10;
  const by = mapVec3(axis, (c) => c * rounded);
  return kind === 'translate' ? translated(from, by) : rotated(from, by);
}

/** Poses along the path, as the server computed them: count + 1 for each segment. */
export interface PathPoses {
  count: number;
  segments: Record<string, readonly Mat4[]>;
}

/**
 * Poses of all segments: at `scrub` (fraction of the path) if it is given, else of the edited moves. A segment whose
 * path is not made of numbers has the last pose of `path`.
 */
export function posesOf(
  plan: Plan,
  path: PathPoses | null,
  scrub: number | null,
  moveOfSegment: (index: number) => Move | null,
): Record<string, Mat4> {
  const poses: Record<string, Mat4> = {};
  plan.segments.forEach(({ name }, index) => {
    const known = path?.segments[name];
    if (scrub !== null && known && path) poses[name] = known[Math.round(scrub * path.count)];
    else {
      const move = moveOfSegment(index);
      if (move) poses[name] = poseOf(move);
      else if (known) poses[name] = known[known.length - 1];
    }
  });
  return poses;
}
