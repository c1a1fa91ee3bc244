import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import { parse } from '../src/api';
import {
  bandFrame,
  bandPath,
  bandSection,
  distributionText,
  INTERACTIONS,
  mainInputs,
  OTHER_INPUTS,
  roundQuarters,
  sobolBars,
  ticksOf,
  toDrawing,
  vertexNormals,
  type Surface,
} from '../src/model';

const index = (name: string, first: number, total: number) => ({ name, first, total });

const regions = [
  { region: 'moved skin', sobol: [index('a', 0.1, 0.15), index('b', 0.5, 0.6), index('c', 0.2, 0.3)] },
  { region: 'nose', sobol: [index('a', 0.9, 0.9), index('b', 0.1, 0.1), index('c', 0, 0)] },
  { region: 'chin', sobol: [index('a', 0, 0), index('b', 0, 0), index('c', 0, 0)] },
];

describe('Sobol indices', () => {
  it('are sorted by the total index of the moved skin', () => {
    expect(mainInputs(regions, 2)).toEqual(['b', 'c']);
    expect(mainInputs([], 2)).toEqual([]);
  });

  it('and interactions are the whole variance of a region', () => {
    const [moved, nose, chin] = sobolBars(regions, ['b', 'c']);
    const of = (bar: typeof moved, name: string) => bar.parts.find((part) => part.name === name)!.fraction;
    expect(of(moved, 'b')).toBe(0.5);
    expect(of(moved, OTHER_INPUTS)).toBeCloseTo(0.1, 12);
    expect(of(moved, INTERACTIONS)).toBeCloseTo(0.2, 12);
    expect(of(nose, OTHER_INPUTS)).toBeCloseTo(0.9, 12);
    expect(of(nose, INTERACTIONS)).toBeCloseTo(0, 12);
    for (const bar of [moved, nose]) expect(bar.parts.reduce((sum, part) => sum + part.fraction, 0)).toBeCloseTo(1, 12);
    // Without variance there is nothing to divide.
    expect(chin.parts.every((part) => part.fraction === 0)).toBe(true);
  });
});

describe('distributions', () => {
  it('have the words of the report', () => {
    expect(distributionText({ kind: 'uniform', low: 0.4, high: 0.49 })).toBe('uniform, 0.4 to 0.49');
    expect(distributionText({ kind: 'truncated normal', mean: 0, standard_deviation: 50, low: -150, high: 150 })).toBe(
      'normal, mean 0, standard deviation 50, −150 to 150',
    );
    expect(distributionText({ kind: 'lognormal', mean: 1, standard_deviation: 0.5 })).toBe(
      'lognormal, mean 1, standard deviation 0.5',
    );
    expect(distributionText({ kind: 'discrete', values: [1, 2, 4] })).toBe('discrete, 3 values, 1 to 4');
    expect(distributionText({ kind: 'triangular', low: 0, mode: 1, high: 3 })).toBe('triangular, 0, 1, 3');
  });

  it('of the fixture are those of the contract', () => {
    const file = new URL('../../contract/fixtures/valid/Uncertainty.one.json', import.meta.url);
    const { inputs } = parse('Uncertainty', JSON.parse(readFileSync(file, 'utf8')));
    expect(inputs.map(({ distribution }) => distributionText(distribution))).toEqual([
      'uniform, 0.4 to 0.49',
      'normal, mean 0, standard deviation 50, −150 to 150',
    ]);
  });
});

describe('a legend of widths', () => {
  it('ends above the largest width, and its ticks are exact', () => {
    for (const width of [0, 0.03, 0.5, 1, 2.31, 4.01, 9.7, 31]) {
      const top = roundQuarters(width);
      expect(top).toBeGreaterThanOrEqual(width - 1e-5);
      ticksOf(top).forEach((tick, k) => expect(Number(tick)).toBeCloseTo((k * top) / 4, 9));
    }
  });
});

/** A ball of radius 50 mm about the origin. */
function ball(): Surface & { normals: Float32Array } {
  const points: number[] = [];
  const triangles: number[] = [];
  const [rows, columns] = [32, 64];
  for (let i = 0; i <= rows; i++)
    for (let k = 0; k < columns; k++) {
      const [polar, turn] = [(Math.PI * i) / rows, (2 * Math.PI * (k + 0.5)) / columns];
      points.push(50 * Math.sin(polar) * Math.cos(turn), 50 * Math.sin(polar) * Math.sin(turn), 50 * Math.cos(polar));
    }
  for (let i = 0; i < rows; i++)
    for (let k = 0; k < columns; k++) {
      const [a, b] = [i * columns + k, i * columns + ((k + 1) % columns)];
      const [c, d] = [a + columns, b + columns];
      triangles.push(a, c, b, b, c, d);
    }
  const surface = { points: Float32Array.from(points), triangles: Uint32Array.from(triangles) };
  return { ...surface, normals: vertexNormals(surface) };
}

describe('the section of a band', () => {
  const surface = ball();
  const count = surface.points.length / 3;
  const isFront = (v: number): boolean => surface.points[3 * v + 1] < -25;
  const filled = (value: number): Float32Array =>
    Float32Array.from({ length: count }, (_, v) => (isFront(v) ? value : 0));
  const band = { width_mm: filled(5), p5_mm: filled(-2), p95_mm: filled(3) };
  const section = bandSection(surface, band, [0, 0, 0], [1, 0, 0]);

  it('lies at the offsets from the median along the normal', () => {
    expect(section.low.length).toBe(section.middle.length);
    let wide = 0;
    for (let n = 0; n < section.middle.length; n += 3) {
      const radius = (lines: Float32Array): number => Math.hypot(lines[n + 1], lines[n + 2]);
      expect(radius(section.middle)).toBeCloseTo(50, 0);
      if (section.middle[n + 1] > -30) continue;
      wide++;
      expect(radius(section.low) - radius(section.middle)).toBeCloseTo(-2, 1);
      expect(radius(section.high) - radius(section.middle)).toBeCloseTo(3, 1);
    }
    expect(wide).toBeGreaterThan(10);
  });

  it('is drawn with its front only, all of it in the frame', () => {
    const frame = bandFrame(section)!;
    expect(frame.height).toBeGreaterThan(80);
    expect(frame.height).toBeLessThan(110);
    expect(frame.depth).toBeLessThan(60);
    const [x, y] = toDrawing(frame, -53, 0);
    expect(x).toBeLessThan(frame.depth + 12);
    expect(y).toBeCloseTo(frame.height / 2 + 6, 0);
  });

  it('is filled with pieces of one orientation', () => {
    const frame = bandFrame(section)!;
    const pieces = bandPath(section, frame).split('Z').filter(Boolean);
    expect(pieces.length).toBeGreaterThan(10);
    for (const piece of pieces) {
      const corners = piece
        .slice(1)
        .split('L')
        .map((corner) => corner.split(' ').map(Number));
      const area = corners.reduce(
        (sum, [x, y], k) => sum + x * corners[(k + 1) % 4][1] - corners[(k + 1) % 4][0] * y,
        0,
      );
      expect(area).toBeGreaterThanOrEqual(-0.05);
    }
  });

  it('is not drawn without a width', () => {
    const none = { width_mm: filled(0), p5_mm: filled(0), p95_mm: filled(0) };
    const flat = bandSection(surface, none, [0, 0, 0], [1, 0, 0]);
    expect(bandFrame(flat)).toBeNull();
    expect(bandFrame(bandSection(surface, band, [200, 0, 0], [1, 0, 0]))).toBeNull();
  });
});
