/** Iterations of a solve as they are told, from the first that is known. */
export interface Stream<T> {
  /** The solve: a job's number. */
  readonly job: number;
  /** How many came before those that are known. */
  readonly from: number;
  readonly points: readonly T[];
}

/** Puts what a page is told behind what it knows; null if something between is missing, or it is of another solve. */
export function mergeStream<T>(known: Stream<T> | null, more: Stream<T>): Stream<T> | null {
  if (known === null || known.job !== more.job) return more.from === 0 ? more : null;
  const at = more.from - known.from;
  if (at < 0 || at > known.points.length) return null;
  if (at + more.points.length <= known.points.length) return known; // Told twice.
  return { ...known, points: [...known.points.slice(0, at), ...more.points] };
}
