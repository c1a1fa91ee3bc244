/** Received iterations of a solve. */
export interface Stream<T> {
  /** Id of the job. */
  readonly job: number;
  /** Number of iterations before the first received one. */
  readonly from: number;
  readonly points: readonly T[];
}

/** Appends received iterations; null if some are missing in between, or at the start of another solve. */
export function mergeStream<T>(known: Stream<T> | null, more: Stream<T>): Stream<T> | null {
  if (known === null || known.job !== more.job) return more.from === 0 ? more : null;
  const at = more.from - known.from;
  if (at < 0 || at > known.points.length) return null;
  if (at + more.points.length <= known.points.length) return known; // Received before.
  return { ...known, points: [...known.points.slice(0, at), ...more.points] };
}
