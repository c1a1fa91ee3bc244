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
}

/** Limits of the lengths, as in the contract. */
export const SPLINT_LIMITS = {
  open_mm: [0, 20],
  clearance_mm: [0, 0.5],
  cover_mm: [0.5, 6],
  wall_mm: [1, 6],
} as const;

/** Thinner splints break. */
export const MIN_THICKNESS_MM = 1;

export const defaultSplint = (): SplintSettings => ({
  splint: 'final',
  segment: null,
  open_mm: 2,
  clearance_mm: 0.1,
  cover_mm: 2.5,
  wall_mm: 2.5,
});

/** The segment that is likely the maxilla: by its name, its template, or as the only one. */
export function maxillaOf(segments: readonly Segment[]): string | null {
  const byName = segments.find(({ name }) => /maxilla|le_?-?fort_?-?1|lefort1/i.test(name));
  const byTemplate = segments.find(({ osteotomy }) => templateKind(osteotomy) === 'le-fort-1');
  return (byName ?? byTemplate ?? (segments.length === 1 ? segments[0] : undefined))?.name ?? null;
}
