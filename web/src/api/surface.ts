/** Triangles with values per vertex, decoded from LFSURF1. mm, L. */
export interface WireSurface {
  points: Float32Array;
  triangles: Uint32Array;
  scalars: Map<string, Float32Array>;
}

const MAGIC = 'LFSURF1\0';

/** Reads LFSURF1 (contract/openapi.json, info). Throws if the size or an index is wrong. */
export function decodeSurface(bytes: ArrayBuffer, names: readonly string[] = []): WireSurface {
  if (bytes.byteLength < 20) throw new Error('the surface is truncated');
  const head = new Uint8Array(bytes, 0, 8);
  if (String.fromCharCode(...head) !== MAGIC) throw new Error('the format of the surface is unknown');
  const view = new DataView(bytes);
  const [points, triangles, arrays] = [8, 12, 16].map((at) => view.getUint32(at, true));
  const expected = 20 + 12 * points + 12 * triangles + 4 * points * arrays;
  if (bytes.byteLength !== expected)
    throw new Error(`the surface has ${bytes.byteLength} bytes instead of ${expected}`);
  const surface: WireSurface = {
    points: new Float32Array(bytes, 20, 3 * points),
    triangles: new Uint32Array(bytes, 20 + 12 * points, 3 * triangles),
    scalars: new Map(),
  };
  for (const index of surface.triangles)
    if (index >= points) throw new Error(`a triangle refers to vertex ${index} of ${points}`);
  for (let n = 0; n < arrays; n++)
    surface.scalars.set(
      names[n] ?? `scalar ${n}`,
      new Float32Array(bytes, 20 + 12 * points + 12 * triangles + 4 * points * n, points),
    );
  return surface;
}
