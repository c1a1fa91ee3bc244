/** Settings of cutting guides. */
export interface GuideSettings {
  /** Null: each segment that is cut. */
  segment: string | null;
  /** The side from which a guide is put on; null: that of the osteotomy. */
  from: GuideSide | null;
  thickness_mm: number;
  width_mm: number;
  hole_diameter_mm: number;
  hole_distance_mm: number;
}

export type GuideSide = 'anterior' | 'right' | 'left' | 'inferior';

/** Limits of the lengths, as in the contract. */
export const GUIDE_LIMITS = {
  thickness_mm: [2, 6],
  width_mm: [5, 20],
  hole_diameter_mm: [1, 4],
  hole_distance_mm: [3, 15],
} as const;

export const defaultGuides = (): GuideSettings => ({
  segment: null,
  from: null,
  thickness_mm: 3,
  width_mm: 9,
  hole_diameter_mm: 1.5,
  hole_distance_mm: 5,
});

/** The parameters of the job; what is null is left out. */
export function guideParameters({ segment, from, ...lengths }: GuideSettings): {
  segment?: string;
  from?: GuideSide;
} & Omit<GuideSettings, 'segment' | 'from'> {
  return { ...lengths, ...(segment === null ? {} : { segment }), ...(from === null ? {} : { from }) };
}

interface Hole {
  closest?: { name: string; distance_mm: number };
}

/** The root or nerve that is closest to a hole; null if none is near. */
export function closestToHoles(holes: readonly Hole[]): { name: string; distance_mm: number } | null {
  const near = holes.flatMap(({ closest }) => closest ?? []);
  return near.sort((a, b) => a.distance_mm - b.distance_mm)[0] ?? null;
}

/** Warnings in the text of a job. */
export const warningsOf = (text: string): string[] => [
  ...new Set(
    text
      .split('\n')
      .map((line) => line.trim())
      .filter((line) => line.startsWith('warning: '))
      .map((line) => line.slice('warning: '.length)),
  ),
];
