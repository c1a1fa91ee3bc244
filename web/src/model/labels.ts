import { indexToL, lToIndex, type Grid, type Vec3 } from './frames';

/** Changed voxels with their labels before, so that a stroke can be undone. */
export interface LabelEdit {
  at: Uint32Array;
  before: Uint8Array;
  after: number;
}

/** Paints a ball into labels (x fastest) and returns the changes. A voxel is painted if its center is in the ball. */
export function paintBall(labels: Uint8Array, grid: Grid, center_L: Vec3, radius_mm: number, label: number): LabelEdit {
  const center = lToIndex(grid, center_L);
  const [nx, ny, nz] = grid.size;
  const range = [0, 1, 2].map((axis) => {
    const reach = radius_mm / grid.spacing_mm[axis];
    return [
      Math.max(0, Math.ceil(center[axis] - reach)),
      Math.min(grid.size[axis] - 1, Math.floor(center[axis] + reach)),
    ];
  });
  const at: number[] = [];
  const before: number[] = [];
  for (let k = range[2][0]; k <= range[2][1] && k < nz; k++)
    for (let j = range[1][0]; j <= range[1][1] && j < ny; j++)
      for (let i = range[0][0]; i <= range[0][1] && i < nx; i++) {
        const dx = (i - center[0]) * grid.spacing_mm[0];
        const dy = (j - center[1]) * grid.spacing_mm[1];
        const dz = (k - center[2]) * grid.spacing_mm[2];
        if (dx * dx + dy * dy + dz * dz > radius_mm * radius_mm) continue;
        const n = i + nx * (j + ny * k);
        if (labels[n] === label) continue;
        at.push(n);
        before.push(labels[n]);
        labels[n] = label;
      }
  return { at: Uint32Array.from(at), before: Uint8Array.from(before), after: label };
}

export function revert(labels: Uint8Array, edit: LabelEdit): void {
  // In reverse: a voxel that was painted twice must get its first value.
  for (let n = edit.at.length - 1; n >= 0; n--) labels[edit.at[n]] = edit.before[n];
}

export function repeat(labels: Uint8Array, edit: LabelEdit): void {
  for (const n of edit.at) labels[n] = edit.after;
}

export const joinEdits = (first: LabelEdit, second: LabelEdit): LabelEdit => ({
  at: Uint32Array.from([...first.at, ...second.at]),
  before: Uint8Array.from([...first.before, ...second.before]),
  after: second.after,
});

/** Tracks which strokes of the history are applied to the labels, also after undo and redo. */
export class AppliedStrokes {
  private applied: readonly LabelEdit[] = [];

  /** Sets the strokes that the labels contain already. */
  setApplied(strokes: readonly LabelEdit[]): void {
    this.applied = strokes;
  }

  /** Reverts the strokes that are not in `strokes` and applies the others. Returns whether anything changed. */
  apply(labels: Uint8Array, strokes: readonly LabelEdit[]): boolean {
    if (strokes === this.applied) return false;
    let common = 0;
    while (common < strokes.length && strokes[common] === this.applied[common]) common++;
    for (const stroke of this.applied.slice(common).reverse()) revert(labels, stroke);
    for (const stroke of strokes.slice(common)) repeat(labels, stroke);
    this.applied = strokes;
    return true;
  }
}

/** Center of a voxel in L, by its number. */
export function voxelCenter(grid: Grid, n: number): Vec3 {
  const [nx, ny] = grid.size;
  return indexToL(grid, [n % nx, Math.floor(n / nx) % ny, Math.floor(n / (nx * ny))]);
}
