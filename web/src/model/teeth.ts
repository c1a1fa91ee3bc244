import type { Schemas } from '../api';

export type Tooth = Schemas['Teeth']['teeth'][number];
export type ToothCorrection = Schemas['ToothCorrections']['corrections'][number];

/** A tooth that was found, or a number that was removed as not a tooth. */
export interface ToothRow {
  /** The number that was found: the key of a correction. */
  found: number;
  /** Its number after the correction; 0: not a tooth. */
  fdi: number;
  /** Null if it is not in the result any more. */
  tooth: Tooth | null;
}

/** Whether a number is an FDI number of a permanent tooth (ISO 3950). */
export function isToothNumber(fdi: number): boolean {
  const [quadrant, place] = [Math.floor(fdi / 10), fdi % 10];
  return Number.isInteger(fdi) && quadrant >= 1 && quadrant <= 4 && place >= 1 && place <= 8;
}

/** Order along the arches: 18 to 28, then 48 to 38; what is not a tooth comes last. */
export function archOrder(fdi: number): number {
  const [quadrant, place] = [Math.floor(fdi / 10), fdi % 10];
  if (!isToothNumber(fdi)) return 100;
  return (quadrant < 3 ? 0 : 20) + (quadrant === 1 || quadrant === 4 ? 8 - place : 7 + place);
}

/** The teeth with their corrected numbers, in the order of the arches. */
export function toothRows(teeth: readonly Tooth[], corrections: readonly ToothCorrection[]): ToothRow[] {
  const corrected = new Map(corrections.map(({ found, fdi }) => [found, fdi]));
  const rows: ToothRow[] = teeth.map((tooth) => {
    const found = tooth.found ?? tooth.fdi;
    return { found, fdi: corrected.get(found) ?? found, tooth };
  });
  for (const { found, fdi } of corrections)
    if (!rows.some((row) => row.found === found)) rows.push({ found, fdi, tooth: null });
  return rows.sort((a, b) => archOrder(a.fdi) - archOrder(b.fdi) || a.found - b.found);
}

/** Sets the number of a tooth. A correction to the number that was found is none. */
export function withToothNumber(
  corrections: readonly ToothCorrection[],
  found: number,
  fdi: number,
): ToothCorrection[] {
  const others = corrections.filter((one) => one.found !== found);
  return fdi === found ? others : [...others, { found, fdi }].sort((a, b) => a.found - b.found);
}

/** What is wrong with a new number of a tooth; null if nothing is. */
export function faultOfNumber(rows: readonly ToothRow[], found: number, fdi: number): string | null {
  if (fdi !== 0 && !isToothNumber(fdi))
    return `${fdi} is no FDI number: 11 to 18, 21 to 28, 31 to 38, 41 to 48, or 0 for what is not a tooth.`;
  if (fdi !== 0 && fdi < 30 !== found < 30) return `Tooth ${found} cannot be ${fdi}, which is in the other jaw.`;
  if (fdi !== 0 && rows.some((row) => row.found !== found && row.fdi === fdi))
    return `Another tooth has the number ${fdi}. Correct that one first.`;
  return null;
}
