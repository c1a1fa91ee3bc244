import type { Schemas } from '../api';
import { length, roundVec3, sub, toVec3, type Vec3 } from './frames';

export type NervePoints = Readonly<Record<string, readonly number[]>>;

/** A point on a canal: found, or corrected by the user. */
export interface NervePoint {
  name: string;
  position_mm: Vec3;
  isCorrected: boolean;
}

/** Points that were found and lie closer than this to a corrected one are not shown. */
const SAME_MM = 4;

const SIDES = { R: 'right', L: 'left' } as const;

/** The side of a point, R or L; null for another name. */
export const sideOfPoint = (name: string): 'R' | 'L' | null =>
  (/^(?:(?:MdF|MeF)-([RL])|IAN-([RL])-\d+)$/.exec(name)?.slice(1).find(Boolean) as 'R' | 'L' | undefined) ?? null;

const isOnCanal = (name: string): boolean => name.startsWith('IAN-');

/** The name of a point in words. */
export function describeNervePoint(name: string): string {
  const side = sideOfPoint(name);
  if (!side) return name;
  if (name.startsWith('MdF')) return `mandibular foramen, ${SIDES[side]}`;
  if (name.startsWith('MeF')) return `mental foramen, ${SIDES[side]}`;
  return `canal, ${SIDES[side]}, point ${name.split('-')[2]}`;
}

/** The corrected points, and those found that are not close to them. */
export function shownNervePoints(found: NervePoints, corrected: NervePoints): NervePoint[] {
  const fixed = Object.entries(corrected).map(([name, at]) => ({
    name,
    position_mm: toVec3(at),
    isCorrected: true,
  }));
  const others = Object.entries(found)
    .map(([name, at]) => ({ name: `found ${name}`, position_mm: toVec3(at), isCorrected: false }))
    .filter(({ name, position_mm }) => {
      const original = name.slice('found '.length);
      if (!isOnCanal(original)) return !(original in corrected);
      return !fixed.some((one) => length(sub(one.position_mm, position_mm)) < SAME_MM);
    });
  return [...fixed, ...others];
}

/** The number of the point of a line that is nearest to `p`. */
function nearestOnLine(line: readonly (readonly number[])[], p: Vec3): number {
  let best = 0;
  let least = Infinity;
  line.forEach((at, n) => {
    const distance = length(sub(toVec3(at), p));
    if (distance < least) [best, least] = [n, distance];
  });
  return best;
}

/**
 * Corrects a point. `name`: of a corrected point, or `found NAME` of one that was found. Points of a canal are numbered
 * in the order along its line, since they must be given from posterior to anterior.
 */
export function withNervePoint(
  corrected: NervePoints,
  name: string,
  position: Vec3,
  nerve: Schemas['Nerve'],
): Record<string, number[]> {
  const original = name.replace(/^found /, '');
  const side = sideOfPoint(original);
  const at = [...roundVec3(position, 2)];
  if (!side) return copyOf(corrected);
  if (!isOnCanal(original)) return { ...copyOf(corrected), [original]: at };
  if (!name.startsWith('found ')) return { ...copyOf(corrected), [name]: at };
  const line = nerve[SIDES[side]]?.points ?? [];
  const place = nearestOnLine(line, toVec3(nerve.points[original] ?? at));
  const points = Object.entries(corrected)
    .filter(([key]) => isOnCanal(key) && sideOfPoint(key) === side)
    .map(([key, point]) => ({ order: nearestOnLine(line, toVec3(point)), number: numberOf(key), point: [...point] }));
  points.push({ order: place, number: Infinity, point: at });
  points.sort((a, b) => a.order - b.order || a.number - b.number);
  const others = Object.entries(corrected).filter(([key]) => !(isOnCanal(key) && sideOfPoint(key) === side));
  return copyOf(
    Object.fromEntries([...others, ...points.map(({ point }, n) => [`IAN-${side}-${n + 1}`, point] as const)]),
  );
}

const numberOf = (name: string): number => Number(name.split('-')[2]);

const copyOf = (points: NervePoints): Record<string, number[]> =>
  Object.fromEntries(Object.entries(points).map(([name, point]) => [name, [...point]]));

export const withoutNervePoint = (corrected: NervePoints, name: string): Record<string, number[]> =>
  copyOf(Object.fromEntries(Object.entries(corrected).filter(([key]) => key !== name)));

/** Distance of a cut from a canal. */
export interface NerveDistance {
  segment: string;
  nerve: string;
  distance_mm: number;
}

/** The distances in the result of a check; null if it did not include the canals. */
export function nerveDistances(result: unknown): NerveDistance[] | null {
  const { nerve } = (result ?? {}) as { nerve?: NerveDistance[] };
  return nerve ? [...nerve].sort((a, b) => a.distance_mm - b.distance_mm) : null;
}
