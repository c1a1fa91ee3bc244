import { describe, expect, it } from 'vitest';
import {
  fromDrawing,
  midsagittalX,
  poseOf,
  profileFrame,
  profilePath,
  toDrawing,
  transformPoint,
  translatedTo,
  vertexAt,
  vertexNear,
  type Move,
} from '../src/model';

const outline = new Float32Array([0, 10, 0, 0, 12, 20, 0, 12, 20, 0, 90, 40]);

describe('the profile', () => {
  it('is drawn from the right: anterior is on the right, superior on top', () => {
    const frame = profileFrame([outline])!;
    const [anteriorX, lowY] = toDrawing(frame, 10, 0);
    const [posteriorX, highY] = toDrawing(frame, 30, 40);
    expect(anteriorX).toBeGreaterThan(posteriorX);
    expect(highY).toBeLessThan(lowY);
    expect(fromDrawing(frame, ...toDrawing(frame, 17, 33))).toEqual([17, 33]);
    expect(profileFrame([new Float32Array()])).toBeNull();
  });

  it('leaves out what lies behind the front 60 mm', () => {
    const back = new Float32Array([0, 10, 0, 0, 12, 20, 0, 88, 0, 0, 95, 10]);
    const frame = profileFrame([back])!;
    expect(profilePath(back, frame).match(/M/g)).toHaveLength(1);
  });

  it('picks the closest vertex within reach', () => {
    const points = new Float32Array([0, 0, 0, 5, 0, 0, 9, 9, 9]);
    expect(vertexNear(points, [4, 1, 0], 3)).toBe(1);
    expect(vertexNear(points, [30, 0, 0], 3)).toBeNull();
    expect(vertexAt(points, 2)).toEqual([9, 9, 9]);
  });

  it('lies in the plane of the midline landmarks, else in the middle of the skin', () => {
    const skin = new Float32Array([-10, 0, 0, 30, 0, 0]);
    expect(midsagittalX([], skin)).toBe(10);
    expect(midsagittalX([{ name: 'ANS', position_mm: [4, 1, 1] }], skin)).toBe(4);
  });
});

describe('a move that follows a fitted pose', () => {
  it('keeps its rotation and brings its pivot where the pose does', () => {
    const move: Move = { translation_mm: [0, -3, 1], rotation_deg: [4, -2, 7], about_mm: [120, 50, 30] };
    const moved: Move = { ...move, translation_mm: [0, -5, 2.5] };
    const fitted = translatedTo(move, poseOf(moved));
    expect(fitted.rotation_deg).toEqual(move.rotation_deg);
    fitted.translation_mm.forEach((v, n) => expect(v).toBeCloseTo(moved.translation_mm[n], 9));
    expect(transformPoint(poseOf(fitted), [1, 2, 3])[1]).toBeCloseTo(transformPoint(poseOf(moved), [1, 2, 3])[1], 9);
  });
});
