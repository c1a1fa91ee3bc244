const LATEST_MS = 40;

/**
 * Runs work with the next picture, or after 40 ms if that is late: on slow graphics a picture takes longer than what a
 * person does, and neither numbers nor questions to the server shall wait for it.
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

/** For numbers that nobody reads digit by digit as they run. */
const READABLE_MS = 120;

export function idle(work: () => void): void {
  setTimeout(work, READABLE_MS);
}
