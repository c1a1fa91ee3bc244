import { describe, expect, it } from 'vitest';
import { BrushPath } from '../src/scene/brush_path';

/** All points of a path, taken in steps. */
function pointsOf(path: BrushPath, step: number, isLast: boolean): [number, number][] {
  const points: [number, number][] = [];
  for (let at = path.next(step, isLast); at; at = path.next(step, isLast)) points.push(at);
  return points;
}

describe('the path of the brush', () => {
  it('has points at most a step apart', () => {
    const path = new BrushPath();
    path.begin([0, 0]);
    path.extend([10, 0]);
    expect(pointsOf(path, 4, false)).toEqual([
      [4, 0],
      [8, 0],
    ]);
    expect(pointsOf(path, 4, true)).toEqual([[10, 0]]);
  });

  it('merges small movements of the pointer', () => {
    const path = new BrushPath();
    path.begin([0, 0]);
    for (let x = 1; x <= 9; x++) path.extend([x, 0]);
    const points = pointsOf(path, 4, false);
    expect(points.length).toBe(2);
    expect(points.at(-1)![0]).toBeCloseTo(8, 9);
  });

  it('is empty while the pointer rests', () => {
    const path = new BrushPath();
    path.begin([3, 3]);
    expect(path.next(4, true)).toBeNull();
  });
});
