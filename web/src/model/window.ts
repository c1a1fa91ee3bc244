/** Map of CT numbers to gray: level is the middle, window the width; both HU. */
export interface Window {
  level_hu: number;
  window_hu: number;
}

export const WINDOW_PRESETS: readonly (Window & { name: string })[] = [
  { name: 'Bone', level_hu: 500, window_hu: 2000 },
  { name: 'Soft tissue', level_hu: 50, window_hu: 400 },
  { name: 'Skin', level_hu: -150, window_hu: 1000 },
  { name: 'Airway', level_hu: -600, window_hu: 1500 },
  { name: 'Full', level_hu: 1000, window_hu: 4000 },
];

/** Gray 0 to 255. */
export function grayOf(hu: number, { level_hu, window_hu }: Window): number {
  const fraction = (hu - level_hu) / window_hu + 0.5;
  return Math.round(255 * Math.min(1, Math.max(0, fraction)));
}

/** Grays of all int16 values, by value + 32768. */
export function grayTable(window: Window): Uint8Array {
  const table = new Uint8Array(65536);
  for (let n = 0; n < table.length; n++) table[n] = grayOf(n - 32768, window);
  return table;
}

/** Window after a drag: sideways changes the width, downwards the level. */
export const draggedWindow = (window: Window, dx_px: number, dy_px: number): Window => ({
  window_hu: Math.max(1, Math.round(window.window_hu * Math.exp(dx_px / 250))),
  level_hu: Math.round(window.level_hu + (dy_px * window.window_hu) / 300),
});

export const presetOf = (window: Window): string | null =>
  WINDOW_PRESETS.find((p) => p.level_hu === window.level_hu && p.window_hu === window.window_hu)?.name ?? null;
