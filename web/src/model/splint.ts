import type { Segment } from './plan';
import { templateKind } from './plan';

/** Settings of a splint. */
export interface SplintSettings {
  splint: 'final' | 'intermediate';
  /** The segment of the maxilla; null: the likely one. */
  segment: string | null;
  open_mm: number;
  clearance_mm: number;
  cover_mm: number;
  wall_mm: number;
  rim_mm: number;
  edge_mm: number;
  /** Engraved into the front; may be empty. */
  text: string;
}

/** Limits of the lengths, as in the contract. */
export const SPLINT_LIMITS = {
  open_mm: [0, 20],
  clearance_mm: [0, 0.5],
  cover_mm: [0.5, 6],
  wall_mm: [1, 6],
  rim_mm: [1, 6],
  edge_mm: [0, 3],
} as const;

/** Letters that can be engraved. */
export const MAX_LETTERS = 16;

/** Thinner splints break. */
export const MIN_THICKNESS_MM = 1;

export const defaultSplint = (): SplintSettings => ({
  splint: 'final',
  segment: null,
  open_mm: 2,
  clearance_mm: 0.1,
  cover_mm: 2.5,
  wall_mm: 2.5,
  rim_mm: 2,
  edge_mm: 0.8,
  text: '',
});

/** Why no splint can be made with these settings; null if one can. */
export function faultOfSplint({ wall_mm, rim_mm, edge_mm, text }: SplintSettings): string | null {
  if (rim_mm > wall_mm) return 'The rim must not be wider than the wall.';
  if (edge_mm > rim_mm / 2) return 'The radius of the edges must not exceed half of the rim.';
  const letters = [...text.trim()].length;
  return letters > MAX_LETTERS ? `The text has ${letters} letters, must be ${MAX_LETTERS} or fewer.` : null;
}

/** Parameters of a job for both kinds of splint. */
export function splintParameters(settings: SplintSettings) {
  const { open_mm, clearance_mm, cover_mm, wall_mm, rim_mm, edge_mm } = settings;
  const text = settings.text.trim();
  return { open_mm, clearance_mm, cover_mm, wall_mm, rim_mm, edge_mm, ...(text === '' ? {} : { text }) };
}

const isNamed = ({ name }: Segment): boolean => /maxilla|le_?-?fort_?-?1|lefort1/i.test(name);

/** Whether a segment moves the upper teeth, by its name or its template. */
export const isMaxilla = (segment: Segment): boolean =>
  isNamed(segment) || (templateKind(segment.osteotomy)?.startsWith('le-fort') ?? false);

/** The segment that is likely the maxilla: by its name, its template, or as the only one. */
export function maxillaOf(segments: readonly Segment[]): string | null {
  const byName = segments.find(isNamed);
  const byTemplate = segments.find(({ osteotomy }) => templateKind(osteotomy) === 'le-fort-1');
  return (byName ?? byTemplate ?? (segments.length === 1 ? segments[0] : undefined))?.name ?? null;
}
