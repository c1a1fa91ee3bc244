import { describe, expect, it } from 'vitest';
import { placeLabels, type Tag } from '../src/scene/overlay';

const tag = (x: number, y: number): Tag => ({ x, y, text: 'A', strong: false });
const RADIUS = 6;

describe('labels of points', () => {
  it('are to the right if there is space', () => {
    expect(placeLabels([tag(100, 50)], [30], [[100, 50]], RADIUS)).toEqual([[107, 50]]);
  });

  it('cover no dot and no other label; without space they are left out', () => {
    for (let seed = 1; seed <= 40; seed++) {
      const tags = Array.from({ length: 30 }, (_, n) =>
        tag(100 + 90 * Math.sin(seed * (n + 1) * 1.3), 100 + 60 * Math.sin(seed * (n + 1) * 2.1)),
      );
      const widths = tags.map((_, n) => 20 + (n % 5) * 8);
      const dots = tags.map(({ x, y }) => [x, y] as const);
      const places = placeLabels(tags, widths, dots, RADIUS);
      const rects = places.flatMap((at, n) => (at ? [[at[0], at[1] - 8.5, at[0] + widths[n], at[1] + 8.5]] : []));
      expect(rects.length).toBeGreaterThan(3);
      rects.forEach((a, n) => {
        for (const b of rects.slice(n + 1))
          expect(a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3]).toBe(false);
        for (const [x, y] of dots) {
          const d = Math.hypot(x - Math.min(a[2], Math.max(a[0], x)), y - Math.min(a[3], Math.max(a[1], y)));
          expect(d).toBeGreaterThanOrEqual(RADIUS);
        }
      });
    }
  });

  it('move to another side of their point if one is occupied', () => {
    const [first, second] = placeLabels(
      [tag(100, 50), tag(112, 50)],
      [30, 30],
      [
        [100, 50],
        [112, 50],
      ],
      RADIUS,
    );
    expect(first![0] + 30).toBeLessThanOrEqual(100);
    expect(second![0]).toBeGreaterThanOrEqual(112);
  });
});
