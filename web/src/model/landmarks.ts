import { toVec3, type Vec3 } from './frames';

export interface Landmark {
  name: string;
  position_mm: Vec3;
}

export interface LandmarkKind {
  name: string;
  full: string;
  on: 'bone' | 'skin';
}

const paired = (name: string, full: string, on: LandmarkKind['on']): LandmarkKind[] => [
  { name: `${name}-R`, full: `right ${full}`, on },
  { name: `${name}-L`, full: `left ${full}`, on },
];

const bone = (name: string, full: string): LandmarkKind => ({ name, full, on: 'bone' });
const skin = (name: string, full: string): LandmarkKind => ({ name, full, on: 'skin' });

/** Landmarks used by templates and cephalometry (docs/guide/landmarks.md), in the order of placement. */
export const CATALOG: readonly LandmarkKind[] = [
  bone('N', 'nasion'),
  bone('S', 'sella'),
  ...paired('Or', 'orbitale', 'bone'),
  ...paired('Po', 'porion', 'bone'),
  bone('ANS', 'anterior nasal spine'),
  bone('PNS', 'posterior nasal spine'),
  bone('A', 'A point'),
  bone('B', 'B point'),
  bone('Pg', 'pogonion'),
  bone('Gn', 'gnathion'),
  bone('Me', 'menton'),
  ...paired('Go', 'gonion', 'bone'),
  ...paired('Co', 'condylion', 'bone'),
  ...paired('Cdl', 'lateral pole of the condyle', 'bone'),
  ...paired('Cdm', 'medial pole of the condyle', 'bone'),
  ...paired('Ar', 'articulare', 'bone'),
  bone('U1', 'upper incisor'),
  bone('L1', 'lower incisor'),
  ...paired('U6', 'upper first molar', 'bone'),
  ...paired('L6', 'lower first molar', 'bone'),
  ...paired('Zy', 'zygion', 'bone'),
  ...paired('FZ', 'frontozygomatic point', 'bone'),
  skin("N'", 'soft-tissue nasion'),
  skin('Prn', 'pronasale'),
  skin('Sn', 'subnasale'),
  skin("A'", 'soft-tissue A point'),
  skin('Ls', 'labrale superius'),
  skin('Stm', 'stomion'),
  skin('Li', 'labrale inferius'),
  skin("B'", 'soft-tissue B point'),
  skin("Pg'", 'soft-tissue pogonion'),
  skin("Me'", 'soft-tissue menton'),
  ...paired('Ex', 'exocanthion', 'skin'),
  ...paired('En', 'endocanthion', 'skin'),
  ...paired('Al', 'alare', 'skin'),
  ...paired('Ch', 'cheilion', 'skin'),
];

export const kindOf = (name: string): LandmarkKind | undefined => CATALOG.find((kind) => kind.name === name);

export const placed = (landmarks: readonly Landmark[], name: string): Landmark | undefined =>
  landmarks.find((landmark) => landmark.name === name);

/** Places a landmark, or moves the one that has this name. */
export const withLandmark = (landmarks: readonly Landmark[], landmark: Landmark): Landmark[] =>
  landmarks.some((old) => old.name === landmark.name)
    ? landmarks.map((old) => (old.name === landmark.name ? landmark : old))
    : [...landmarks, landmark];

export const withoutLandmark = (landmarks: readonly Landmark[], name: string): Landmark[] =>
  landmarks.filter((landmark) => landmark.name !== name);

/** A landmark that was found, with its standard uncertainty. */
export interface FoundLandmark extends Landmark {
  uncertainty_mm: number;
}

/** What the job that finds landmarks has found, and why others are missing, by name. */
export interface LandmarkSearch {
  found: readonly FoundLandmark[];
  missing: Readonly<Record<string, string>>;
}

/** From the result of the job; null without one. */
export function landmarkSearch(result: unknown): LandmarkSearch | null {
  const { found, missing } = (result ?? {}) as {
    found?: Record<string, { point_mm: number[]; uncertainty_mm: number }>;
    missing?: Record<string, string>;
  };
  if (!found) return null;
  return {
    found: Object.entries(found).map(([name, one]) => ({
      name,
      position_mm: toVec3(one.point_mm),
      uncertainty_mm: one.uncertainty_mm,
    })),
    missing: missing ?? {},
  };
}

/** Places what was found; landmarks that are placed already stay where they are. */
export const withFound = (landmarks: readonly Landmark[], search: LandmarkSearch): Landmark[] => [
  ...landmarks,
  ...search.found
    .filter(({ name }) => !placed(landmarks, name))
    .map(({ name, position_mm }) => ({ name, position_mm })),
];

/** The standard uncertainty of a landmark that is where it was found; null of another one. */
export function uncertaintyOf(landmark: Landmark, search: LandmarkSearch | null): number | null {
  const found = search?.found.find(({ name }) => name === landmark.name);
  const isThere = found?.position_mm.every((value, axis) => value === landmark.position_mm[axis]);
  return found && isThere ? found.uncertainty_mm : null;
}

/** The next landmark of the catalog to place after `name`, skipping those placed. */
export function nextToPlace(landmarks: readonly Landmark[], name: string | null): string | null {
  const start = name === null ? 0 : CATALOG.findIndex((kind) => kind.name === name) + 1;
  const order = [...CATALOG.slice(start), ...CATALOG.slice(0, start)];
  return order.find((kind) => !placed(landmarks, kind.name))?.name ?? null;
}

/** Positions by name, as the server reads them. */
export const toRecord = (landmarks: readonly Landmark[]): Record<string, number[]> =>
  Object.fromEntries(landmarks.map((landmark) => [landmark.name, [...landmark.position_mm]]));

export const fromRecord = (points: Record<string, readonly number[]>): Landmark[] =>
  Object.entries(points).map(([name, position_mm]) => ({ name, position_mm: toVec3(position_mm) }));
