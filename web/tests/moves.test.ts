import { describe, expect, it } from 'vitest';
import {
  changePivot,
  componentOf,
  COMPONENTS,
  poseOf,
  rotationMatrix,
  rotationVector,
  toVec3,
  translated,
  transformPoint,
  rotated,
  withComponent,
  type Move,
  type Vec3,
} from '../src/model';

const rest: Move = { translation_mm: [0, 0, 0], rotation_deg: [0, 0, 0], about_mm: [120, 50, 30] };
const close = (a: readonly number[], b: readonly number[]) => a.forEach((v, n) => expect(v).toBeCloseTo(b[n], 9));
const goes = (move: Move, p: Vec3) => transformPoint(poseOf(move), p);

describe('a move', () => {
  it('12 mm forward and 5 mm down is −y and −z', () => {
    const move = withComponent(withComponent(rest, 'anterior', 12), 'superior', -5);
    close(move.translation_mm, [0, -12, -5]);
    close(goes(move, [1, 2, 3]), [1, -10, -2]);
  });

  it('rotates about its pivot, then translates', () => {
    const move: Move = { ...rest, rotation_deg: [0, 0, 90], translation_mm: [0, 0, 7] };
    close(goes(move, rest.about_mm), [120, 50, 37]);
    close(goes(move, [121, 50, 30]), [120, 51, 37]);
  });

  it('pitch lifts the front, yaw moves it to the left, roll lifts the left side', () => {
    const front: Vec3 = [120, 40, 30];
    const left: Vec3 = [130, 50, 30];
    expect(goes(withComponent(rest, 'pitch', 10), front)[2]).toBeGreaterThan(30);
    expect(goes(withComponent(rest, 'yaw', 10), front)[0]).toBeGreaterThan(120);
    expect(goes(withComponent(rest, 'roll', 10), left)[2]).toBeGreaterThan(30);
  });

  it('has components that are independent', () => {
    let move = rest;
    COMPONENTS.forEach((part, n) => (move = withComponent(move, part.key, n + 1.5)));
    COMPONENTS.forEach((part, n) => expect(componentOf(move, part.key)).toBeCloseTo(n + 1.5, 12));
  });

  it('is the same motion about another pivot', () => {
    const move: Move = { ...rest, rotation_deg: [3, -8, 20], translation_mm: [1, -12, -5] };
    const other = changePivot(move, [90, 10, 70]);
    close(poseOf(other), poseOf(move));
  });

  it('keeps the new position of its pivot when rotated further', () => {
    const move = rotated(translated(rest, [0, -12, -5]), [0, 0, 15]);
    close(goes(move, rest.about_mm), [120, 38, 25]);
    close(rotated(rotated(rest, [0, 0, 10]), [0, 0, 5]).rotation_deg, [0, 0, 15]);
  });
});

describe('rotation vectors', () => {
  it.each([
    [0, 0, 0],
    [10, 0, 0],
    [-20, 35, 70],
    [0, 179, 0],
  ] as Vec3[])('%s, %s, %s survive the matrix', (...v) => {
    close(rotationVector(rotationMatrix(toVec3(v))), toVec3(v));
  });

  it('are right-handed: 90 degrees about z take x to y', () => {
    const R = rotationMatrix([0, 0, 90]);
    close([R[0], R[3], R[6]], [0, 1, 0]);
  });

  it('equal the pose of the command line for 12 mm forward and 5 mm down', () => {
    // The last pose of examples/midface_forward_down.json, contract/plan.schema.json: rows, L, mm.
    close(poseOf({ ...rest, translation_mm: [0, -12, -5] }), [1, 0, 0, 0, 0, 1, 0, -12, 0, 0, 1, -5, 0, 0, 0, 1]);
  });
});
