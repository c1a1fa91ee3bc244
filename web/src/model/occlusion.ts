import type { Schemas } from '../api';
import { add, sub, type Mat4, type Vec3 } from './frames';
import { poseOf, rotated, rotationVector, transformPoint, type Move } from './moves';
import { templateKind, type Segment } from './plan';
import { isMaxilla } from './splint';
import { fixed } from './units';

/** What an occlusion may be requested to have, in the order of the page. */
export const REQUESTS = [
  { key: 'midline_mm', name: 'Midline', hint: 'lower one to the left of the upper one' },
  { key: 'overjet_mm', name: 'Overjet', hint: 'from edge to edge' },
  { key: 'overbite_mm', name: 'Overbite', hint: 'from edge to edge' },
] as const;

export type RequestKey = (typeof REQUESTS)[number]['key'];

/** Requested values [mm]; null: not requested. */
export type OcclusionRequests = Record<RequestKey, number | null>;

export const MAX_REQUEST_MM = 10;

export const noRequests = (): OcclusionRequests => ({ midline_mm: null, overjet_mm: null, overbite_mm: null });

/** Parameters of a job: those that are requested. */
export const requestParameters = (requests: OcclusionRequests): Partial<Record<RequestKey, number>> =>
  Object.fromEntries(REQUESTS.flatMap(({ key }) => (requests[key] === null ? [] : [[key, requests[key]]])));

/** Whether a segment can have the lower teeth. */
export const hasLowerTeeth = (segment: Segment): boolean => {
  const kind = templateKind(segment.osteotomy);
  return kind === 'sagittal-split' || (kind === null && !isMaxilla(segment));
};

/** The segment whose movement the upper teeth follow; -1 if they stay. */
export const upperJawOf = (segments: readonly Segment[]): number => segments.findIndex(isMaxilla);

/**
 * The move about the point of `now` that brings the lower arch to the occlusion with the upper jaw.
 * `lower`: its pose for the upper jaw as scanned. `upper`: the move of the upper jaw; null if it stays.
 */
export function moveToOcclusion(now: Move, lower: Mat4, upper: Move | null): Move {
  const about: Vec3 = now.about_mm;
  const here = transformPoint(lower, about);
  const rotation = [lower[0], lower[1], lower[2], lower[4], lower[5], lower[6], lower[8], lower[9], lower[10]];
  const alone: Move = { about_mm: about, translation_mm: sub(here, about), rotation_deg: rotationVector(rotation) };
  if (upper === null) return alone;
  return {
    ...rotated(alone, upper.rotation_deg),
    translation_mm: sub(transformPoint(poseOf(upper), add(about, alone.translation_mm)), about),
  };
}

type Occlusion = Schemas['Occlusion'];
type Row = readonly [name: string, value: string];

const side = (mm: number): string => {
  const text = fixed(Math.abs(mm), 1);
  return text === '0.0' ? 'in line' : `${text} mm to the ${mm < 0 ? 'right' : 'left'}`;
};

const signed = (mm: number): string => `${mm >= 0.05 ? '+' : ''}${fixed(mm, 1)}`;

/** Midline, canines and molars in words. */
export function relationRows({ relations }: Occlusion): Row[] {
  if (relations === undefined) return [];
  const pairs = [
    ['Canine, right', relations.right_canine],
    ['Canine, left', relations.left_canine],
    ['Molar, right', relations.right_molar],
    ['Molar, left', relations.left_molar],
  ] as const;
  return [
    ['Lower midline', relations.midline_mm === null ? 'unknown' : side(relations.midline_mm)],
    ...pairs.map(
      ([name, { mesial_mm, class: angle }]): Row => [
        name,
        mesial_mm === null || angle === null ? 'unknown' : `class ${angle}, ${signed(mesial_mm)} mm`,
      ],
    ),
  ];
}

/** A request with what was reached. */
export interface RequestRow {
  name: string;
  requested: number;
  reached: number | null;
  isMet: boolean;
}

export const requestRows = ({ requests }: Occlusion): RequestRow[] =>
  REQUESTS.flatMap(({ key, name }) => {
    const one = requests?.[key];
    return one ? [{ name, requested: one.requested, reached: one.reached, isMet: one.is_met }] : [];
  });
