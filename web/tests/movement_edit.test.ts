import { describe, expect, it } from 'vitest';
import {
  centroidOf,
  draggedMove,
  IDENTITY,
  moveAt,
  poseOf,
  posesOf,
  transformPoint,
  withMove,
  withPivot,
  type Keyframe,
  type Landmark,
  type Plan,
  type Vec3,
} from '../src/model';

const landmarks: Landmark[] = [{ name: 'ANS', position_mm: [1, -60, 5] }];
const pivot: Vec3 = [0, -40, 0];
const first = { segment: 0, keyframe: 0 };

const planWith = (...keyframes: Keyframe[]): Plan => ({
  lefort_plan: 1,
  segments: [{ name: 'front', osteotomy: {}, path: { keyframes } }],
});
const keyframeOf = (plan: Plan): Keyframe => plan.segments[0].path.keyframes![0];

describe('the move at a keyframe', () => {
  it('is about the pivot, a point or a landmark', () => {
    const aboutOf = (keyframe: Keyframe) => moveAt(planWith(keyframe), landmarks, first, pivot)?.about_mm;
    expect(aboutOf({})).toEqual(pivot);
    expect(aboutOf({ about_mm: [1, 2, 3] })).toEqual([1, 2, 3]);
    expect(aboutOf({ about: 'ANS' })).toEqual([1, -60, 5]);
    expect(aboutOf({ about: 'none such' })).toEqual(pivot);
  });

  it('is that of the last keyframe beyond the end', () => {
    const plan = planWith({ translation_mm: [1, 0, 0] }, { translation_mm: [2, 0, 0] });
    expect(moveAt(plan, [], { segment: 0, keyframe: Infinity }, pivot)?.translation_mm).toEqual([2, 0, 0]);
  });

  it('does not exist for targets, files and missing segments', () => {
    expect(moveAt(planWith({ targets: 'a.mrk.json' }), [], first, pivot)).toBeNull();
    expect(moveAt(planWith({ transform: 'a.tfm' }), [], first, pivot)).toBeNull();
    expect(moveAt(planWith({}), [], { segment: 1, keyframe: 0 }, pivot)).toBeNull();
  });
});

describe('a move that is written to the plan', () => {
  const move = (rotation_deg: Vec3) => ({ translation_mm: [0.12345, 0, -0] as Vec3, rotation_deg, about_mm: pivot });

  it('is rounded, and has no rotation that is not there', () => {
    const next = keyframeOf(withMove(planWith({ at: 1, rotation_deg: [1, 0, 0] }), first, move([0, 0, 1e-4]), null));
    expect(next).toEqual({ at: 1, translation_mm: [0.123, 0, 0] });
  });

  it('names its pivot when it rotates', () => {
    const next = keyframeOf(withMove(planWith({}), first, move([0, 2, 0]), null));
    expect(next).toMatchObject({ rotation_deg: [0, 2, 0], about_mm: pivot });
  });

  it('stays about a landmark while its pivot is unchanged', () => {
    const plan = planWith({ about: 'ANS' });
    const before = moveAt(plan, landmarks, first, pivot)!;
    const kept = keyframeOf(withMove(plan, first, { ...before, rotation_deg: [0, 0, 3] }, before));
    expect(kept.about).toBe('ANS');
    expect(kept.about_mm).toBeUndefined();
    const other = keyframeOf(
      withMove(plan, first, { ...before, rotation_deg: [0, 0, 3], about_mm: [9, 9, 9] }, before),
    );
    expect(other.about).toBeUndefined();
    expect(other.about_mm).toEqual([9, 9, 9]);
  });
});

describe('another pivot', () => {
  it('does not change the motion', () => {
    const plan = planWith({ translation_mm: [0, -5, 1], rotation_deg: [3, 2, 1] });
    const before = moveAt(plan, landmarks, first, pivot)!;
    for (const about of ['ANS', [20, 30, 40] as Vec3]) {
      const changed = withPivot(plan, landmarks, first, before, about)!;
      const after = moveAt(changed, landmarks, first, pivot)!;
      const where = transformPoint(poseOf(after), [7, 8, 9]);
      transformPoint(poseOf(before), [7, 8, 9]).forEach((v, n) => expect(where[n]).toBeCloseTo(v, 9));
    }
    expect(keyframeOf(withPivot(plan, landmarks, first, before, 'ANS')!).about).toBe('ANS');
  });

  it('must exist', () => {
    const plan = planWith({});
    expect(withPivot(plan, [], first, moveAt(plan, [], first, pivot)!, 'ANS')).toBeNull();
  });
});

describe('dragging', () => {
  it('moves in steps of a tenth', () => {
    const from = { translation_mm: [1, 0, 0] as Vec3, rotation_deg: [0, 0, 0] as Vec3, about_mm: pivot };
    expect(draggedMove(from, 'translate', [0, -1, 0], 2.34).translation_mm).toEqual([1, -2.3, 0]);
    expect(draggedMove(from, 'rotate', [0, 0, 1], 2.36).rotation_deg[2]).toBeCloseTo(2.4, 9);
  });
});

describe('poses', () => {
  const shift = (x: number) => IDENTITY.map((v, n) => (n === 3 ? x : v));
  const path = { count: 2, segments: { front: [shift(0), shift(1), shift(2)] } };

  it('are those of the path while it is scrubbed', () => {
    expect(posesOf(planWith({}), path, 0.5, () => null).front).toEqual(shift(1));
  });

  it('are those of the move, else the last of the path', () => {
    const move = { translation_mm: [5, 0, 0] as Vec3, rotation_deg: [0, 0, 0] as Vec3, about_mm: pivot };
    expect(posesOf(planWith({}), path, null, () => move).front[3]).toBe(5);
    expect(posesOf(planWith({}), path, null, () => null).front).toEqual(shift(2));
    expect(posesOf(planWith({}), null, null, () => null)).toEqual({});
  });
});

describe('the centroid of a surface', () => {
  it('is rounded to a tenth, and needs points', () => {
    expect(centroidOf(Float32Array.of(0, 0, 0, 1, 2, 3.32))).toEqual([0.5, 1, 1.7]);
    expect(centroidOf(new Float32Array(0))).toBeNull();
    expect(centroidOf(undefined)).toBeNull();
  });
});
