import { describe, expect, it } from 'vitest';
import {
  archOrder,
  closestToHoles,
  defaultGuides,
  faultOfNumber,
  GUIDE_LIMITS,
  guideParameters,
  isToothNumber,
  maxillaOf,
  nerveDistances,
  shownNervePoints,
  sideOfPoint,
  toothRows,
  warningsOf,
  withNervePoint,
  withoutNervePoint,
  withToothNumber,
  type Segment,
  type Tooth,
} from '../src/model';

const tooth = (fdi: number, found?: number): Tooth => ({
  fdi,
  ...(found === undefined ? {} : { found }),
  crown: [0, 0, 0],
  apex: [0, 0, 10],
  length_mm: 20,
  width_mm: 8,
  volume_mm3: 500,
});

describe('numbers of teeth', () => {
  it('are those of ISO 3950', () => {
    const numbers = Array.from({ length: 100 }, (_, n) => n).filter(isToothNumber);
    expect(numbers).toHaveLength(32);
    expect([11, 18, 21, 28, 31, 38, 41, 48].every(isToothNumber)).toBe(true);
    expect([0, 10, 19, 20, 29, 39, 49, 51, 16.5, NaN].some(isToothNumber)).toBe(false);
  });

  it('are sorted along the arches, from the right to the left', () => {
    const sorted = [31, 48, 21, 11, 18, 28, 41, 38].sort((a, b) => archOrder(a) - archOrder(b));
    expect(sorted).toEqual([18, 11, 21, 28, 48, 41, 31, 38]);
  });

  it('are corrected by the number that was found, also after the correction was computed', () => {
    const corrections = withToothNumber(withToothNumber([], 16, 17), 18, 0);
    expect(corrections).toEqual([
      { found: 16, fdi: 17 },
      { found: 18, fdi: 0 },
    ]);
    const before = toothRows([tooth(16), tooth(18), tooth(11)], corrections);
    expect(before.map(({ found, fdi }) => [found, fdi])).toEqual([
      [16, 17],
      [11, 11],
      [18, 0],
    ]);
    // The result has the corrected number, and what is not a tooth is not in it.
    const after = toothRows([tooth(17, 16), tooth(11)], corrections);
    expect(after.map(({ found, fdi }) => [found, fdi])).toEqual([
      [16, 17],
      [11, 11],
      [18, 0],
    ]);
    expect(after[2].tooth).toBeNull();
    expect(withToothNumber(corrections, 16, 16)).toEqual([{ found: 18, fdi: 0 }]);
  });

  it('are refused if another tooth has them', () => {
    const rows = toothRows([tooth(16), tooth(17), tooth(18)], [{ found: 18, fdi: 0 }]);
    expect(faultOfNumber(rows, 16, 17)).toContain('Another tooth has the number 17');
    expect(faultOfNumber(rows, 16, 18)).toBeNull();
    expect(faultOfNumber(rows, 16, 19)).toContain('no FDI number');
    expect(faultOfNumber(rows, 16, 0)).toBeNull();
    expect(faultOfNumber(rows, 16, 46)).toContain('in the other jaw');
    expect(faultOfNumber(rows, 16, 16)).toBeNull();
  });
});

/** A canal along y from posterior to anterior, with a point every 10 mm. */
const line = Array.from({ length: 61 }, (_, n) => [-40, -n, -60]);
const nerve = {
  notice: '',
  right: { length_mm: 60, visible_fraction: 1, points: line },
  points: {
    'MdF-R': [-40, 0, -60],
    'IAN-R-1': [-40, -10, -60],
    'IAN-R-2': [-40, -20, -60],
    'IAN-R-3': [-40, -30, -60],
    'MeF-R': [-40, -60, -60],
  },
};

describe('corrected points on a canal', () => {
  it('have a side', () => {
    expect(sideOfPoint('MdF-L')).toBe('L');
    expect(sideOfPoint('IAN-R-12')).toBe('R');
    expect(sideOfPoint('Me')).toBeNull();
  });

  it('are numbered from posterior to anterior in any order of correction', () => {
    const first = withNervePoint({}, 'found IAN-R-3', [-42, -30, -58], nerve);
    expect(first).toEqual({ 'IAN-R-1': [-42, -30, -58] });
    const second = withNervePoint(first, 'found IAN-R-1', [-39, -11, -62], nerve);
    expect(second).toEqual({ 'IAN-R-1': [-39, -11, -62], 'IAN-R-2': [-42, -30, -58] });
    const third = withNervePoint(second, 'found MeF-R', [-40, -58, -60], nerve);
    expect(Object.keys(third).sort()).toEqual(['IAN-R-1', 'IAN-R-2', 'MeF-R']);
    // A corrected point that is moved again keeps its number.
    expect(withNervePoint(third, 'IAN-R-2', [-41, -31, -59], nerve)['IAN-R-2']).toEqual([-41, -31, -59]);
    expect(withNervePoint({}, 'Me', [0, 0, 0], nerve)).toEqual({});
  });

  it('replace those that were found near them', () => {
    const corrected = { 'IAN-R-1': [-40, -12, -60], 'MeF-R': [-40, -40, -60] };
    const shown = shownNervePoints(nerve.points, corrected).map(({ name }) => name);
    expect(shown).toEqual(['IAN-R-1', 'MeF-R', 'found MdF-R', 'found IAN-R-2', 'found IAN-R-3']);
    expect(withoutNervePoint(corrected, 'IAN-R-1')).toEqual({ 'MeF-R': [-40, -40, -60] });
  });

  it('leave the distances of cuts to the check', () => {
    const one = { segment: 'maxilla', nerve: 'left', distance_mm: 4 };
    expect(nerveDistances({ nerve: [one, { ...one, distance_mm: 2 }] })?.map((x) => x.distance_mm)).toEqual([2, 4]);
    expect(nerveDistances({})).toBeNull();
    expect(nerveDistances(null)).toBeNull();
  });
});

describe('the segment of the maxilla', () => {
  const segment = (name: string, template?: 'le-fort-1' | 'genioplasty'): Segment =>
    ({ name, osteotomy: template ? { template } : {}, path: { steps: 1, keyframes: [] } }) as unknown as Segment;

  it('is found by its name, its template, or as the only one', () => {
    expect(maxillaOf([segment('chin', 'genioplasty'), segment('upper', 'le-fort-1')])).toBe('upper');
    expect(maxillaOf([segment('chin'), segment('maxilla')])).toBe('maxilla');
    expect(maxillaOf([segment('front')])).toBe('front');
    expect(maxillaOf([segment('a'), segment('b')])).toBeNull();
    expect(maxillaOf([])).toBeNull();
  });
});

describe('cutting guides', () => {
  it('leave out parameters that are not chosen', () => {
    const settings = defaultGuides();
    expect(Object.keys(guideParameters(settings)).sort()).toEqual(Object.keys(GUIDE_LIMITS).sort());
    expect(guideParameters({ ...settings, segment: 'chin', from: 'inferior' })).toMatchObject({
      segment: 'chin',
      from: 'inferior',
      thickness_mm: 3,
    });
  });

  it('have defaults within the limits', () => {
    const settings = defaultGuides();
    for (const key of Object.keys(GUIDE_LIMITS) as (keyof typeof GUIDE_LIMITS)[]) {
      expect(settings[key]).toBeGreaterThanOrEqual(GUIDE_LIMITS[key][0]);
      expect(settings[key]).toBeLessThanOrEqual(GUIDE_LIMITS[key][1]);
    }
  });

  it('name the closest root or nerve of all holes', () => {
    const root = { name: 'root of 43', distance_mm: 3.5 };
    const nerve = { name: 'right nerve', distance_mm: 2.5 };
    expect(closestToHoles([{ closest: root }, {}, { closest: nerve }])).toEqual(nerve);
    expect(closestToHoles([{}])).toBeNull();
  });

  it('show each warning of the summary once', () => {
    const text = 'guide_a_left.stl: slot\n  warning: meets bone\n4 holes\n  warning: meets bone\n';
    expect(warningsOf(text)).toEqual(['meets bone']);
    expect(warningsOf('')).toEqual([]);
  });
});
