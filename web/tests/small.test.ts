import { describe, expect, it } from 'vitest';
import {
  colorAt,
  fixed,
  grayOf,
  grayTable,
  joinEdits,
  nextToPlace,
  paint,
  paintBall,
  parseNumber,
  repeat,
  revert,
  roundUp,
  seconds,
  withLandmark,
  withoutLandmark,
  CATALOGUE,
  type Grid,
} from '../src/model';

const grid: Grid = {
  size: [20, 20, 20],
  spacing_mm: [1, 1, 2],
  origin_mm: [0, 0, 0],
  direction: [1, 0, 0, 0, 1, 0, 0, 0, 1],
};

describe('the brush', () => {
  it('is a ball in mm, not in voxels', () => {
    const labels = new Uint8Array(8000);
    const edit = paintBall(labels, grid, [10, 10, 20], 3, 2);
    expect(labels[13 + 20 * (10 + 20 * 10)]).toBe(2);
    expect(labels[14 + 20 * (10 + 20 * 10)]).toBe(0);
    expect(labels[10 + 20 * (10 + 20 * 11)]).toBe(2);
    expect(labels[10 + 20 * (10 + 20 * 12)]).toBe(0);
    expect(edit.at.length).toBe(labels.filter((l) => l === 2).length);
  });

  it('can be undone and redone, also if stamps overlap', () => {
    const labels = Uint8Array.from({ length: 8000 }, (_, n) => n % 3);
    const before = labels.slice();
    const stroke = joinEdits(paintBall(labels, grid, [10, 10, 20], 3, 2), paintBall(labels, grid, [11, 10, 20], 3, 2));
    const after = labels.slice();
    revert(labels, stroke);
    expect(labels).toEqual(before);
    repeat(labels, stroke);
    expect(labels).toEqual(after);
  });

  it('stays in the scan', () => {
    expect(() => paintBall(new Uint8Array(8000), grid, [-1, -1, -1], 5, 1)).not.toThrow();
  });
});

describe('grays', () => {
  it('run from black to white over the window', () => {
    const window = { level_hu: 50, window_hu: 400 };
    expect([-151, 50, 251].map((hu) => grayOf(hu, window))).toEqual([0, 128, 255]);
    expect(grayTable(window)[32768 + 50]).toBe(128);
  });
});

describe('colors', () => {
  it('clamp; NaN has the lowest color', () => {
    expect(colorAt('distance', -1)).toEqual(colorAt('distance', 0));
    expect(colorAt('distance', NaN)).toEqual(colorAt('distance', 0));
    expect(colorAt('distance', 2)).toEqual(colorAt('distance', 1));
  });

  it('color each vertex, and the rest with its own color', () => {
    const rgb = new Float32Array(9);
    paint([0, 1, 2], 'depth', 0, 2, rgb, [0, 0, 1]);
    expect([...rgb.slice(0, 3)]).toEqual([0, 0, 1]);
    expect(rgb[6]).not.toBe(rgb[3]);
  });

  it('have legends that end with round numbers', () => {
    expect([0.3, 6.04, 12.3, 0].map(roundUp)).toEqual([0.5, 10, 20, 1]);
  });
});

describe('numbers', () => {
  it('are shown with a minus sign, never as minus zero', () => {
    expect(fixed(-1.25, 1)).toBe('−1.3');
    expect(fixed(-0.01, 1)).toBe('0.0');
    expect(fixed(null, 1)).toBe('–');
    expect(fixed(Infinity, 1)).toBe('–');
    expect(seconds(125)).toBe('2 min 5 s');
  });

  it('are parsed as users type them', () => {
    expect(['1.5', '−1,5', ' +.5 ', '12'].map(parseNumber)).toEqual([1.5, -1.5, 0.5, 12]);
    expect(['', 'a', '1e9', '1.2.3', '-'].map(parseNumber)).toEqual([null, null, null, null, null]);
  });
});

describe('landmarks', () => {
  it('are placed once, moved in place, removed', () => {
    const two = withLandmark(withLandmark([], { name: 'N', position_mm: [1, 2, 3] }), {
      name: 'S',
      position_mm: [4, 5, 6],
    });
    const moved = withLandmark(two, { name: 'N', position_mm: [7, 8, 9] });
    expect(moved.map((l) => l.name)).toEqual(['N', 'S']);
    expect(moved[0].position_mm).toEqual([7, 8, 9]);
    expect(withoutLandmark(moved, 'N').map((l) => l.name)).toEqual(['S']);
  });

  it('follow each other in the catalog, with both sides', () => {
    expect(nextToPlace([], null)).toBe('N');
    expect(nextToPlace([{ name: 'S', position_mm: [0, 0, 0] }], 'N')).toBe('Or-R');
    const names = CATALOGUE.map((k) => k.name);
    expect(new Set(names).size).toBe(names.length);
    for (const name of names.filter((n) => n.endsWith('-R'))) expect(names).toContain(name.replace(/-R$/, '-L'));
  });
});
