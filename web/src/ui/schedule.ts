const LATEST_MS = 40;

/**
 * Runs work with the next frame, or after 40 ms at the latest, so that numbers and requests do not wait for slow
 * graphics.
 */
export function nextFrame(work: () => void): void {
  let done = false;
  const once = (): void => {
    if (done) return;
    done = true;
    cancelAnimationFrame(frame);
    clearTimeout(timer);
    work();
  };
  const frame = requestAnimationFrame(once);
  const timer = setTimeout(once, LATEST_MS);
}

/** Interval of numbers that change continuously. */
const READABLE_MS = 120;

/** Runs work when a drag leaves time for it. */
export function idle(work: () => void): void {
  setTimeout(work, READABLE_MS);
}
