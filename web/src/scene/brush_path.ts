type Point = [number, number];

/** The path of the brush on the screen: where the pointer was, and where the brush was put. */
export class BrushPath {
  /** The pointer, while it can paint. */
  pointer: Point | null = null;
  /** Where the brush was put since the bodies were drawn. */
  trace: Point[] = [];
  private ahead: Point[] = [];

  begin(at: Point): void {
    this.ahead = [at];
    this.trace = [at];
    this.pointer = at;
  }

  extend(to: Point): void {
    this.ahead.push(to);
    this.pointer = to;
  }

  /**
   * The next point at most `step` along the path, so that stamps overlap; null if there is none. A pointer that moves
   * less than `step` gives one stamp, not one per event; `isLast` takes the rest of the path.
   */
  next(step: number, isLast: boolean): Point | null {
    while (this.ahead.length > 1) {
      const [from, to] = this.ahead;
      const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
      if (length < step && (this.ahead.length > 2 || !isLast)) {
        if (this.ahead.length === 2) return null;
        this.ahead.splice(1, 1);
        continue;
      }
      const fraction = Math.min(1, step / (length || 1));
      const at: Point = [from[0] + fraction * (to[0] - from[0]), from[1] + fraction * (to[1] - from[1])];
      if (fraction < 1) this.ahead[0] = at;
      else this.ahead.shift();
      return at;
    }
    return null;
  }
}
