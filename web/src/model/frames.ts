/**
 * Frame L: the patient, LPS, mm. x grows to the patient's left, y to posterior, z to superior.
 * The 3D view uses L as it is (x, y, z are right-handed), with z up.
 */
export type Vec3 = readonly [number, number, number];

/** Row-major 4x4, as in files and in the server's API. */
export type Mat4 = readonly number[];

export const add = (a: Vec3, b: Vec3): Vec3 => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const sub = (a: Vec3, b: Vec3): Vec3 => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scale = (a: Vec3, s: number): Vec3 => [a[0] * s, a[1] * s, a[2] * s];
export const dot = (a: Vec3, b: Vec3): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a: Vec3, b: Vec3): Vec3 => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
export const length = (a: Vec3): number => Math.hypot(a[0], a[1], a[2]);
export const distance = (a: Vec3, b: Vec3): number => length(sub(a, b));

/** Applies `f` to each component. */
export const mapVec3 = (a: Vec3, f: (value: number, axis: number) => number): Vec3 => [
  f(a[0], 0),
  f(a[1], 1),
  f(a[2], 2),
];

/** Rounds each component to a number of decimals; never minus zero. */
export const roundVec3 = (a: Vec3, decimals: number): Vec3 =>
  mapVec3(a, (c) => Math.round(c * 10 ** decimals) / 10 ** decimals + 0);

/** An array from outside as a vector; throws if it has another length than 3. */
export function toVec3(values: readonly number[]): Vec3 {
  if (values.length !== 3) throw new RangeError(`a vector has 3 components, not ${values.length}`);
  return [values[0], values[1], values[2]];
}

/** Unit vector along a; throws if a is zero. */
export function unit(a: Vec3): Vec3 {
  const size = length(a);
  if (!(size > 0)) throw new RangeError('a direction must not be zero');
  return scale(a, 1 / size);
}

export type Side = 'R' | 'L' | 'A' | 'P' | 'I' | 'S';

/** The two letters of each axis of L: negative direction, positive direction. */
const LETTERS: readonly (readonly Side[])[] = [
  ['R', 'L'],
  ['A', 'P'],
  ['I', 'S'],
];

/** The direction of L a letter stands for. */
export function directionOf(side: Side): Vec3 {
  for (let axis = 0; axis < 3; axis++) {
    const sign = LETTERS[axis].indexOf(side);
    if (sign >= 0) {
      const direction: [number, number, number] = [0, 0, 0];
      direction[axis] = sign === 0 ? -1 : 1;
      return direction;
    }
  }
  throw new RangeError(`${side} is not a side`);
}

/** The main side of a direction: 'A', or 'RA' if a second component exceeds 0.35. */
export function sideName(direction: Vec3): string {
  const d = unit(direction);
  return [0, 1, 2]
    .filter((axis) => Math.abs(d[axis]) > 0.35)
    .sort((a, b) => Math.abs(d[b]) - Math.abs(d[a]))
    .slice(0, 2)
    .map((axis) => LETTERS[axis][d[axis] < 0 ? 0 : 1])
    .join('');
}

/** A voxel grid in L. `direction` has the axes of i, j, k as its columns, row-major. */
export interface Grid {
  size: Vec3;
  spacing_mm: Vec3;
  origin_mm: Vec3;
  direction: readonly number[];
}

const column = (grid: Grid, axis: number): Vec3 => [
  grid.direction[axis],
  grid.direction[3 + axis],
  grid.direction[6 + axis],
];

/** Voxel index (may be fractional) to L. */
export function indexToL(grid: Grid, index: Vec3): Vec3 {
  let p = grid.origin_mm;
  for (let axis = 0; axis < 3; axis++) p = add(p, scale(column(grid, axis), index[axis] * grid.spacing_mm[axis]));
  return p;
}

/** L to fractional voxel index; the direction is a rotation, so its inverse is its transpose. */
export function lToIndex(grid: Grid, p_L: Vec3): Vec3 {
  const d = sub(p_L, grid.origin_mm);
  return mapVec3(grid.spacing_mm, (spacing, axis) => dot(d, column(grid, axis)) / spacing);
}

export type Orientation = 'axial' | 'coronal' | 'sagittal';

/** Orientation of a slice on the screen: the voxel axes to the right, down and in depth. */
export interface SliceFrame {
  orientation: Orientation;
  right: number;
  down: number;
  depth: number;
  /** True if the index decreases along the screen's direction. */
  flipRight: boolean;
  flipDown: boolean;
  /** Sides at the screen's edges. */
  labels: { left: string; right: string; top: string; bottom: string };
}

// Radiological: axial from below, coronal from the front, sagittal from the patient's left.
const SCREEN: Record<Orientation, { right: Side; down: Side }> = {
  axial: { right: 'L', down: 'P' },
  coronal: { right: 'L', down: 'I' },
  sagittal: { right: 'P', down: 'I' },
};

/** The voxel axis closest to a direction of L. */
function axisAlong(grid: Grid, direction: Vec3, taken: number[]): number {
  const free = [0, 1, 2].filter((axis) => !taken.includes(axis));
  return free.reduce((best, axis) =>
    Math.abs(dot(column(grid, axis), direction)) > Math.abs(dot(column(grid, best), direction)) ? axis : best,
  );
}

export function sliceFrame(grid: Grid, orientation: Orientation): SliceFrame {
  const towardsRight = directionOf(SCREEN[orientation].right);
  const towardsDown = directionOf(SCREEN[orientation].down);
  const right = axisAlong(grid, towardsRight, []);
  const down = axisAlong(grid, towardsDown, [right]);
  const depth = 3 - right - down;
  const flipRight = dot(column(grid, right), towardsRight) < 0;
  const flipDown = dot(column(grid, down), towardsDown) < 0;
  const sideAlong = (axis: number, flip: boolean) => sideName(scale(column(grid, axis), flip ? -1 : 1));
  return {
    orientation,
    right,
    down,
    depth,
    flipRight,
    flipDown,
    labels: {
      right: sideAlong(right, flipRight),
      left: sideAlong(right, !flipRight),
      bottom: sideAlong(down, flipDown),
      top: sideAlong(down, !flipDown),
    },
  };
}

/** A point of a slice's picture, in pixels from its top left voxel's center, as a voxel index. */
export function pixelToIndex(grid: Grid, frame: SliceFrame, column_px: number, row_px: number, slice: number): Vec3 {
  const index: [number, number, number] = [0, 0, 0];
  index[frame.right] = frame.flipRight ? grid.size[frame.right] - 1 - column_px : column_px;
  index[frame.down] = frame.flipDown ? grid.size[frame.down] - 1 - row_px : row_px;
  index[frame.depth] = slice;
  return index;
}

export function indexToPixel(
  grid: Grid,
  frame: SliceFrame,
  index: Vec3,
): { column: number; row: number; slice: number } {
  return {
    column: frame.flipRight ? grid.size[frame.right] - 1 - index[frame.right] : index[frame.right],
    row: frame.flipDown ? grid.size[frame.down] - 1 - index[frame.down] : index[frame.down],
    slice: index[frame.depth],
  };
}

/** Middle of the grid in L. */
export const gridCenter = (grid: Grid): Vec3 =>
  indexToL(grid, [(grid.size[0] - 1) / 2, (grid.size[1] - 1) / 2, (grid.size[2] - 1) / 2]);

export type ViewName = 'front' | 'right' | 'left' | 'right three-quarter' | 'left three-quarter' | 'below' | 'above';

/** From the target to the camera, in L; z is always up. `right` is the patient's right side. */
export const VIEWS: Record<ViewName, Vec3> = {
  front: [0, -1, 0],
  right: [-1, 0, 0],
  left: [1, 0, 0],
  'right three-quarter': [-0.66, -0.74, 0.12],
  'left three-quarter': [0.66, -0.74, 0.12],
  below: [0, -0.02, -1],
  above: [0, -0.02, 1],
};

/** The sides at the edges of a picture whose camera looks along `forward` with `up` upwards. */
export function screenSides(forward: Vec3, up: Vec3): { left: string; right: string; top: string; bottom: string } {
  const right = cross(forward, up);
  const trueUp = cross(right, forward);
  return {
    right: sideName(right),
    left: sideName(scale(right, -1)),
    top: sideName(trueUp),
    bottom: sideName(scale(trueUp, -1)),
  };
}

/** Length of each vector of a flat xyz array. */
export function lengths(xyz: Float32Array): Float32Array {
  const out = new Float32Array(xyz.length / 3);
  for (let n = 0; n < out.length; n++) out[n] = Math.hypot(xyz[3 * n], xyz[3 * n + 1], xyz[3 * n + 2]);
  return out;
}
