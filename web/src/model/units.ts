/** A number as the page shows it: with a minus sign, not a hyphen, and never minus zero. */
export function fixed(value: number | null | undefined, digits: number): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  const text = value.toFixed(digits);
  return Number(text) === 0 ? text.replace('-', '') : text.replace('-', '−');
}

export const mm = (value: number | null | undefined, digits = 1): string => `${fixed(value, digits)} mm`;
export const ml = (value: number | null | undefined, digits = 1): string => `${fixed(value, digits)} ml`;

export function seconds(value: number): string {
  if (value < 10) return `${value.toFixed(1)} s`;
  if (value < 90) return `${Math.round(value)} s`;
  return `${Math.floor(value / 60)} min ${Math.round(value % 60)} s`;
}

/** Parses input such as 1.5, −1.5 or 1,5. Null if it is not a number. */
export function parseNumber(text: string): number | null {
  const clean = text.trim().replace('−', '-').replace(',', '.');
  if (!/^[+-]?(\d+\.?\d*|\.\d+)$/.test(clean)) return null;
  return Number(clean);
}

export function bytes(count: number): string {
  return count < 1e6 ? `${Math.max(1, Math.round(count / 1e3))} kB` : `${(count / 1e6).toFixed(1)} MB`;
}
