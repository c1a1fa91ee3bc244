import type { Schemas } from '../api';
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
