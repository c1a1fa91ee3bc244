/** Numbers of a distance map, as this field reports them (median and percentiles beside the mean). */
export interface Summary {
  count: number;
  mean: number;
  median: number;
  p90: number;
  p95: number;
  max: number;
}

/** Nearest-rank percentile of sorted numbers; p from 0 to 100. */
export const percentile = (sorted: ArrayLike<number>, p: number): number =>
  sorted[Math.min(sorted.length - 1, Math.max(0, Math.ceil((p / 100) * sorted.length) - 1))];

/** Null if there are no values. */
export function summarise(values: Float32Array): Summary | null {
  if (values.length === 0) return null;
  const sorted = Float32Array.from(values).sort();
  let sum = 0;
  for (const value of sorted) sum += value;
  return {
    count: sorted.length,
    mean: sum / sorted.length,
    median: percentile(sorted, 50),
    p90: percentile(sorted, 90),
    p95: percentile(sorted, 95),
    max: sorted[sorted.length - 1],
  };
}

/** Length of each vector of a flat xyz array. */
export function lengths(xyz: Float32Array): Float32Array {
  const out = new Float32Array(xyz.length / 3);
  for (let n = 0; n < out.length; n++) out[n] = Math.hypot(xyz[3 * n], xyz[3 * n + 1], xyz[3 * n + 2]);
  return out;
}
