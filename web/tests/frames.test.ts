import { describe, expect, it } from 'vitest';
import {
  directionOf,
  indexToL,
  indexToPixel,
  lToIndex,
  mapVec3,
  pixelToIndex,
  screenSides,
  sideName,
  sliceFrame,
  unit,
  VIEWS,
  type Grid,
  type Vec3,
} from '../src/model';

const head: Grid = {
  size: [256, 256, 108],
  spacing_mm: [0.957, 0.957, 1.5],
  origin_mm: [10, -20, 30],
  direction: [1, 0, 0, 0, 1, 0, 0, 0, 1],
};
/** Stored from left to right, front to back turned round, top to bottom: all three axes reversed. */
const reversed: Grid = { ...head, direction: [-1, 0, 0, 0, -1, 0, 0, 0, -1] };
/** Sagittal slices: i runs to posterior, j to inferior, k to the left. */
const sagittal: Grid = { ...head, direction: [0, 0, 1, 1, 0, 0, 0, -1, 0] };

const close = (a: Vec3, b: Vec3) => a.forEach((v, n) => expect(v).toBeCloseTo(b[n], 9));

describe('sides', () => {
  it('are those of LPS', () => {
    expect(sideName([1, 0, 0])).toBe('L');
    expect(sideName([0, 1, 0])).toBe('P');
    expect(sideName([0, 0, 1])).toBe('S');
    expect(sideName([-1, -0.6, 0])).toBe('RA');
    expect(directionOf('R')).toEqual([-1, 0, 0]);
  });

  it('are at the edges of the screen: facing the patient, the patient’s left is on the right', () => {
    const sides = (name: keyof typeof VIEWS) => {
      const forward = mapVec3(unit(VIEWS[name]), (c) => -c);
      return screenSides(forward, [0, 0, 1]);
    };
    expect(sides('front')).toEqual({ left: 'R', right: 'L', top: 'S', bottom: 'I' });
    expect(sides('right')).toEqual({ left: 'P', right: 'A', top: 'S', bottom: 'I' });
    expect(sides('left')).toEqual({ left: 'A', right: 'P', top: 'S', bottom: 'I' });
  });
});

describe('voxels', () => {
  it.each([head, reversed, sagittal])('go to L and back', (grid) => {
    close(lToIndex(grid, indexToL(grid, [12, 200.5, 7])), [12, 200.5, 7]);
  });

  it('of a stored axis that runs to the left lie on the patient’s left', () => {
    expect(indexToL(head, [200, 0, 0])[0]).toBeGreaterThan(indexToL(head, [10, 0, 0])[0]);
    expect(indexToL(reversed, [200, 0, 0])[0]).toBeLessThan(indexToL(reversed, [10, 0, 0])[0]);
  });
});

describe('slices', () => {
  it.each([
    ['head', head],
    ['reversed', reversed],
    ['sagittal', sagittal],
  ] as const)('of %s are radiological', (_, grid) => {
    expect(sliceFrame(grid, 'axial').labels).toEqual({ left: 'R', right: 'L', top: 'A', bottom: 'P' });
    expect(sliceFrame(grid, 'coronal').labels).toEqual({ left: 'R', right: 'L', top: 'S', bottom: 'I' });
    expect(sliceFrame(grid, 'sagittal').labels).toEqual({ left: 'A', right: 'P', top: 'S', bottom: 'I' });
  });

  it.each([head, reversed, sagittal])(
    'show a point on the patient’s right at the left of the axial picture',
    (grid) => {
      const frame = sliceFrame(grid, 'axial');
      const middle = indexToL(grid, [grid.size[0] / 2, grid.size[1] / 2, grid.size[2] / 2]);
      const right: Vec3 = [middle[0] - 30, middle[1], middle[2]];
      const columnOf = (p: Vec3) => indexToPixel(grid, frame, lToIndex(grid, p)).column;
      expect(columnOf(right)).toBeLessThan(columnOf(middle));
    },
  );

  it.each(['axial', 'coronal', 'sagittal'] as const)('%s: pixel and voxel convert to each other', (orientation) => {
    const frame = sliceFrame(reversed, orientation);
    const { column, row, slice } = indexToPixel(reversed, frame, [3, 50, 9]);
    expect(pixelToIndex(reversed, frame, column, row, slice)).toEqual([3, 50, 9]);
  });
});
