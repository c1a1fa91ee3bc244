import type { Schemas } from '../api';
import type { Vec3 } from './frames';
import { toDrawing, type ProfileFrame } from './profile';
import { sectionsOf, type Surface } from './section';
import { fixed } from './units';

/** A number with at most four digits and no trailing zeros. */
const short = (value: number | undefined): string =>
  value === undefined ? '–' : String(Number(value.toPrecision(4))).replace('-', '−');

const moments = (mean: number | undefined, deviation: number | undefined): string =>
  `mean ${short(mean)}, standard deviation ${short(deviation)}`;

/** A distribution in words, as in the report. */
export function distributionText({
  kind,
  mean,
  standard_deviation,
  low,
  high,
  mode,
  values,
}: Schemas['Distribution']): string {
  switch (kind) {
    case 'uniform':
      return `uniform, ${short(low)} to ${short(high)}`;
    case 'triangular':
      return `triangular, ${short(low)}, ${short(mode)}, ${short(high)}`;
    case 'truncated normal':
      return `normal, ${moments(mean, standard_deviation)}, ${short(low)} to ${short(high)}`;
    case 'discrete':
      return `discrete, ${values?.length ?? 0} values, ${short(values?.[0])} to ${short(values?.at(-1))}`;
    default:
      return `${kind}, ${moments(mean, standard_deviation)}`;
  }
}

interface Index {
  name: string;
  first: number;
  total: number;
}

export interface IndexedRegion {
  region: string;
  sobol: readonly Index[];
}

/** A part of a bar: a fraction of the variance. */
export interface BarPart {
  name: string;
  fraction: number;
}

export interface SobolBar {
  region: string;
  parts: BarPart[];
}

export const OTHER_INPUTS = 'other inputs';
export const INTERACTIONS = 'interactions';

/** The inputs with the largest total index in the first region, the moved skin. */
export const mainInputs = (regions: readonly IndexedRegion[], most: number): string[] =>
  [...(regions[0]?.sobol ?? [])]
    .sort((a, b) => b.total - a.total)
    .slice(0, most)
    .map(({ name }) => name);

/** The variance of each region by input alone; what is left are the interactions of inputs. */
export const sobolBars = (regions: readonly IndexedRegion[], shown: readonly string[]): SobolBar[] =>
  regions.map(({ region, sobol }) => {
    const first = new Map(sobol.map((index) => [index.name, index.first]));
    const sum = sobol.reduce((total, index) => total + index.first, 0);
    const parts = shown.map((name) => ({ name, fraction: first.get(name) ?? 0 }));
    const rest = sum - parts.reduce((total, part) => total + part.fraction, 0);
    const hasVariance = sobol.some((index) => index.total > 0);
    return {
      region,
      parts: [
        ...parts,
        { name: OTHER_INPUTS, fraction: Math.max(0, rest) },
        { name: INTERACTIONS, fraction: hasVariance ? Math.max(0, 1 - sum) : 0 },
      ],
    };
  });

/** The band at the vertices of the median face [mm]: offsets of P5 and P95 along the normal, and their distance. */
export interface Band {
  width_mm: Float32Array;
  p5_mm: Float32Array;
  p95_mm: Float32Array;
}

/** Sections of the median face and of P5 and P95, pairs of points in L; the same index is the same skin. */
export interface BandSection {
  low: Float32Array;
  middle: Float32Array;
  high: Float32Array;
}

/** The section of a band by a plane; `normals`: of the median face, unit. */
export function bandSection(
  median: Surface & { normals: Float32Array },
  band: Band,
  point: Vec3,
  normal: Vec3,
): BandSection {
  const moved = (offset_mm: Float32Array): Float32Array =>
    median.points.map((value, n) => value + offset_mm[Math.floor(n / 3)] * median.normals[n]);
  const [low, middle, high] = sectionsOf(median, [moved(band.p5_mm), median.points, moved(band.p95_mm)], point, normal);
  return { low, middle, high };
}

/** Width of the band at a piece of its section [mm]. */
const widthAt = ({ low, high }: BandSection, n: number): number =>
  Math.max(
    Math.hypot(high[n + 1] - low[n + 1], high[n + 2] - low[n + 2]),
    Math.hypot(high[n + 4] - low[n + 4], high[n + 5] - low[n + 5]),
  );

/** Depth of the front of the face, and the margin of the drawing [mm]. */
const FRONT_MM = 60;
const MARGIN_MM = 8;

/** Where the band is wider than this fraction of its largest width, the face is drawn. */
const DRAWN_FRACTION = 0.2;

/** The part of the front of the face with the band; null without a band. */
export function bandFrame(section: BandSection): ProfileFrame | null {
  const { middle } = section;
  let front = Infinity;
  for (let n = 0; n < middle.length; n += 3) front = Math.min(front, middle[n + 1]);
  const isFront = (n: number): boolean => middle[n + 1] < front + FRONT_MM;
  let widest = 0;
  for (let n = 0; n < middle.length; n += 6) if (isFront(n)) widest = Math.max(widest, widthAt(section, n));
  if (!(widest > 0)) return null;
  let [lowZ, highZ, highY] = [Infinity, -Infinity, -Infinity];
  for (let n = 0; n < middle.length; n += 6) {
    if (!isFront(n) || widthAt(section, n) < DRAWN_FRACTION * widest) continue;
    lowZ = Math.min(lowZ, middle[n + 2], middle[n + 5]);
    highZ = Math.max(highZ, middle[n + 2], middle[n + 5]);
    highY = Math.max(highY, middle[n + 1], middle[n + 4]);
  }
  return {
    lowY: front - widest,
    highZ: highZ + MARGIN_MM,
    depth: highY - front + widest + MARGIN_MM,
    height: highZ - lowZ + 2 * MARGIN_MM,
  };
}

/** SVG path of the area between P5 and P95. */
export function bandPath(section: BandSection, frame: ProfileFrame): string {
  const { low, middle, high } = section;
  const end = frame.lowY + frame.depth;
  let d = '';
  for (let n = 0; n < low.length; n += 6) {
    // As in profilePath.
    if (!(widthAt(section, n) > 0) || (middle[n + 1] > end && middle[n + 4] > end)) continue;
    const corners = [
      toDrawing(frame, low[n + 1], low[n + 2]),
      toDrawing(frame, low[n + 4], low[n + 5]),
      toDrawing(frame, high[n + 4], high[n + 5]),
      toDrawing(frame, high[n + 1], high[n + 2]),
    ];
    const area = corners.reduce((sum, [x, y], k) => {
      const [nextX, nextY] = corners[(k + 1) % 4];
      return sum + x * nextY - nextX * y;
    }, 0);
    // All with the same orientation: areas that overlap remain filled.
    if (area < 0) corners.reverse();
    d += `M${corners.map((corner) => corner.map((value) => value.toFixed(2)).join(' ')).join('L')}Z`;
  }
  return d;
}

/** Upper end of a legend or an axis: at least `value`, and its quarters have the digits of ticksOf(). */
export function roundQuarters(value: number): number {
  const step = value > 9.6 ? 4 : value > 0.96 ? 0.4 : 0.04;
  return Math.max(1, Math.ceil(value / step - 1e-6)) * step;
}

/** A fraction as a percentage. */
export const percent = (fraction: number): string => `${fixed(100 * fraction, 0)} %`;
