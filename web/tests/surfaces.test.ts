import { describe, expect, it } from 'vitest';
import { decodeSurface, endingOnly, EventParser } from '../src/api';
import {
  coarsen,
  interfaceSurface,
  posedSectionOf,
  rayHit,
  sectionOf,
  poseOf,
  transformPoint,
  vertexNormals,
  type Surface,
} from '../src/model';

/** A box from 0 to 10 mm, triangles counter-clockwise from outside. */
const box: Surface = {
  points: Float32Array.from([0, 0, 0, 10, 0, 0, 10, 10, 0, 0, 10, 0, 0, 0, 10, 10, 0, 10, 10, 10, 10, 0, 10, 10]),
  triangles: Uint32Array.from([
    0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4, 1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7,
  ]),
};

function encode({ points, triangles }: Surface, scalars: Float32Array[] = []): ArrayBuffer {
  const head = new ArrayBuffer(20);
  new Uint8Array(head).set([...'LFSURF1\0'].map((c) => c.charCodeAt(0)));
  const view = new DataView(head);
  [points.length / 3, triangles.length / 3, scalars.length].forEach((n, k) => view.setUint32(8 + 4 * k, n, true));
  const parts = [head, points.buffer, triangles.buffer, ...scalars.map((s) => s.buffer)].map(
    (b) => new Uint8Array(b as ArrayBuffer),
  );
  const all = new Uint8Array(parts.reduce((n, p) => n + p.length, 0));
  let at = 0;
  for (const part of parts) {
    all.set(part, at);
    at += part.length;
  }
  return all.buffer;
}

describe('LFSURF1', () => {
  it('is read with its scalars', () => {
    const depth = Float32Array.from({ length: 8 }, (_, n) => n / 2);
    const surface = decodeSurface(encode(box, [depth]), ['depth_mm']);
    expect(surface.points).toEqual(box.points);
    expect(surface.triangles).toEqual(box.triangles);
    expect(surface.scalars.get('depth_mm')).toEqual(depth);
  });

  it('is refused if truncated, too long, of another format, or with an invalid index', () => {
    const good = encode(box);
    expect(() => decodeSurface(good.slice(0, 10))).toThrow(/truncated/);
    expect(() => decodeSurface(good.slice(0, good.byteLength - 4))).toThrow(/bytes/);
    expect(() => decodeSurface(encode(box, [new Float32Array(7)]))).toThrow(/bytes/);
    const other = good.slice(0);
    new Uint8Array(other)[6] = 50;
    expect(() => decodeSurface(other)).toThrow(/format/);
    expect(() => decodeSurface(encode({ ...box, triangles: Uint32Array.from([0, 1, 8]) }))).toThrow(/vertex 8/);
  });
});

describe('the surface of the interface map', () => {
  /** Vertices 4 to 7 of the box are its top. */
  const isSkin = (v: number): boolean => v > 3;

  it('has no skin, faces the tissue and lies in it, on the same vertices', () => {
    const { points, triangles } = interfaceSurface(box, isSkin);
    expect(triangles.length).toBe(box.triangles.length - 6);
    expect([...triangles.subarray(0, 3)]).toEqual([0, 1, 2]);
    expect(points.length).toBe(box.points.length);
    const [x, y, z] = points;
    expect(Math.min(x, y, z)).toBeGreaterThan(0);
    expect(Math.hypot(x, y, z)).toBeCloseTo(1, 5);
  });

  it('is empty if all is skin', () => {
    expect(interfaceSurface(box, () => true).triangles.length).toBe(0);
  });
});

describe('a ray', () => {
  it('hits the side it comes from, with its normal towards it', () => {
    const hit = rayHit(box, [5, -100, 5], [0, 1, 0])!;
    expect(hit.point).toEqual([5, 0, 5]);
    expect(hit.normal).toEqual([0, -1, 0]);
    expect(rayHit(box, [5, 5, 100], [0, 0, -1])!.point[2]).toBe(10);
  });

  it('misses surfaces beside and behind it, and back faces', () => {
    expect(rayHit(box, [11, -100, 5], [0, 1, 0])).toBeNull();
    expect(rayHit(box, [5, -100, 5], [0, -1, 0])).toBeNull();
    expect(rayHit(box, [5, 5, 5], [0, 1, 0])).toBeNull();
  });
});

describe('a section', () => {
  it('of a box is a square', () => {
    const lines = sectionOf(box, [4, 0, 0], [1, 0, 0]);
    let around = 0;
    for (let n = 0; n < lines.length; n += 6) {
      expect(lines[n]).toBeCloseTo(4, 5);
      around += Math.hypot(lines[n + 1] - lines[n + 4], lines[n + 2] - lines[n + 5]);
    }
    expect(around).toBeCloseTo(40, 4);
  });

  it('beside the box is empty', () => {
    expect(sectionOf(box, [11, 0, 0], [1, 0, 0])).toHaveLength(0);
  });
});

describe('a section of a mobilized segment', () => {
  const move = { translation_mm: [3, -2, 5], rotation_deg: [10, -20, 35], about_mm: [5, 5, 5] } as const;
  const pose = poseOf(move);

  it('equals the section of the moved points', () => {
    const moved = box.points.slice();
    for (let n = 0; n < moved.length; n += 3)
      moved.set(transformPoint(pose, [moved[n], moved[n + 1], moved[n + 2]]), n);
    for (const normal of [
      [1, 0, 0],
      [0, 1, 0],
      [0.6, 0, 0.8],
    ] as const) {
      const lines = posedSectionOf(box, pose, [8, 3, 10], normal);
      const expected = sectionOf({ points: moved, triangles: box.triangles }, [8, 3, 10], normal);
      expect(lines.length).toBeGreaterThan(0);
      expect(lines.length).toBe(expected.length);
      lines.forEach((v, n) => expect(v).toBeCloseTo(expected[n], 4));
      for (let n = 0; n < lines.length; n += 3) {
        const height = (lines[n] - 8) * normal[0] + (lines[n + 1] - 3) * normal[1] + (lines[n + 2] - 10) * normal[2];
        expect(height).toBeCloseTo(0, 4);
      }
    }
  });

  it('is empty outside the bone', () => {
    expect(sectionOf(box, [0, 0, 1], [0, 0, 1]).length).toBeGreaterThan(0);
    expect(posedSectionOf(box, poseOf({ ...move, translation_mm: [0, 0, 20] }), [0, 0, 1], [0, 0, 1])).toHaveLength(0);
  });
});

describe('drawing', () => {
  it('has normals out of the body', () => {
    const normals = vertexNormals(box);
    for (let n = 0; n < 24; n++) expect(Math.sign(normals[n])).toBe(box.points[n] === 0 ? -1 : 1);
  });

  it('keeps vertices of the surface when it is coarsened', () => {
    const fine = coarsen(box, 1);
    expect(fine.vertex).toHaveLength(8);
    expect(fine.triangles).toHaveLength(36);
    const one = coarsen(box, 100);
    expect(one.vertex).toHaveLength(1);
    expect(one.triangles).toHaveLength(0);
  });
});

describe('server-sent events', () => {
  it('are parsed however the stream is split', () => {
    const text = ': hello\n\nid: 7\nevent: job\ndata: {"a":\ndata: 1}\n\nid: 8\r\nevent: case\r\ndata: {}\r\n\r\n';
    for (let size = 1; size < text.length; size++) {
      const parser = new EventParser();
      const events = [];
      for (let at = 0; at < text.length; at += size) events.push(...parser.push(text.slice(at, at + size)));
      expect(events).toEqual([
        { id: '7', event: 'job', data: '{"a":\n1}' },
        { id: '8', event: 'case', data: '{}' },
      ]);
    }
  });
});

describe('names of uploaded files', () => {
  it('keep only their extension', () => {
    expect(endingOnly('Mustermann_Max_1960.NII.GZ', 0)).toBe('file0.nii.gz');
    expect(endingOnly('Doe^Jane.dcm', 3)).toBe('file3.dcm');
    expect(endingOnly('IM0001', 1)).toBe('file1');
    expect(endingOnly('1.2.840.113619.2', 2)).toBe('file2');
  });
});
