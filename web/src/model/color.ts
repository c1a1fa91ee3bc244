import { mapVec3 } from './frames';

/** Colors as 0 to 1, sRGB. */
export type Rgb = readonly [number, number, number];

const hex = (text: string): Rgb => mapVec3([1, 3, 5], (at) => parseInt(text.slice(at, at + 2), 16) / 255);

/**
 * Color scales with stops from 0 to 1. Distance: magma reversed, light where nothing moved, as in the command
 * line's pictures; suited for red-green color blindness. Depth: bone color to red, for overlap. Gap: red where arches
 * touch, to the color of teeth.
 */
const SCALES = {
  distance: ['#fcfdbf', '#fec287', '#fb8761', '#e55064', '#b5367a', '#812581', '#4f127b'].map(hex),
  depth: ['#e8dcc4', '#f6c46a', '#ee7b30', '#d22c2c', '#8b0f2e'].map(hex),
  gap: ['#8b0f2e', '#d22c2c', '#ee7b30', '#f6c46a', '#ece7dc'].map(hex),
  signed: ['#2166ac', '#67a9cf', '#d1e5f0', '#f7f7f7', '#fddbc7', '#ef8a62', '#b2182b'].map(hex),
} as const;

export type ScaleName = keyof typeof SCALES;

export function colorAt(name: ScaleName, fraction: number): Rgb {
  const stops = SCALES[name];
  if (!(fraction > 0)) return stops[0];
  if (fraction >= 1) return stops[stops.length - 1];
  const at = fraction * (stops.length - 1);
  const n = Math.floor(at);
  const f = at - n;
  return mapVec3(stops[n], (value, c) => value * (1 - f) + stops[n + 1][c] * f);
}

export const cssOf = ([r, g, b]: Rgb): string =>
  `rgb(${Math.round(r * 255)} ${Math.round(g * 255)} ${Math.round(b * 255)})`;

/** A CSS gradient of a scale, for its legend. */
export const gradientOf = (name: ScaleName): string =>
  `linear-gradient(to right, ${SCALES[name].map(cssOf).join(', ')})`;

/** Colors of the segments in the order of the plan; distinct also for color-blind users (after Okabe and Ito). */
export const SEGMENT_COLORS: readonly Rgb[] = [
  '#4c8fd6',
  '#e69f00',
  '#27a27a',
  '#cc79a7',
  '#d55e00',
  '#8f7ee6',
  '#a3a02a',
  '#5ab4e0',
].map(hex);

export const segmentColor = (index: number): Rgb => SEGMENT_COLORS[index % SEGMENT_COLORS.length];

export const BONE: Rgb = hex('#e3d9c6');
export const SKIN: Rgb = hex('#d9a88c');
export const TEETH: Rgb = hex('#ece7dc');
export const LOWER_TEETH: Rgb = hex('#cfdbe6');
export const SPLINT: Rgb = hex('#4c9fd0');
export const GUIDE: Rgb = hex('#4c9fd0');
export const NERVE: Rgb = hex('#f2b21b');
export const AIRWAY: Rgb = hex('#5ab4e0');

const linear = (c: number): number => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);

/** sRGB to linear RGB, which shading needs. */
export const linearOf = (color: Rgb): Rgb => mapVec3(color, linear);

/** Maps values to linear RGB per vertex; NaN has the lowest color. `rest`: color of values up to `from`. */
export function paint(
  values: ArrayLike<number>,
  name: ScaleName,
  from: number,
  to: number,
  into: Float32Array,
  rest?: Rgb,
): void {
  const steps = 255;
  const table = Array.from({ length: steps + 1 }, (_, n) => linearOf(colorAt(name, n / steps)));
  if (rest) table[0] = linearOf(rest);
  const k = steps / (to - from);
  for (let n = 0; n < values.length; n++) {
    const at = Math.min(steps, Math.max(0, Math.round((values[n] - from) * k))) || 0;
    const color = table[at];
    into[3 * n] = color[0];
    into[3 * n + 1] = color[1];
    into[3 * n + 2] = color[2];
  }
}

/** A round upper end for a legend: 1, 2 or 5 times a power of ten, at least `value`. */
export function roundUp(value: number): number {
  if (!(value > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(value));
  return [1, 2, 5, 10].map((m) => m * power).find((v) => v >= value * (1 - 1e-9))!;
}

/** Labels of a legend from 0 to `top`, with enough digits to be distinct. */
export function ticksOf(top: number): string[] {
  const digits = Math.max(0, Math.min(6, 1 - Math.floor(Math.log10(top))));
  return [0, 0.25, 0.5, 0.75, 1].map((fraction) => (fraction * top).toFixed(digits));
}
