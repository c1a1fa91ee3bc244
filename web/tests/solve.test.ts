import { describe, expect, it } from 'vitest';
import { mergeStream, type Stream } from '../src/model';

const part = (from: number, to: number, job = 1): Stream<number> => ({
  job,
  from,
  points: Array.from({ length: to - from }, (_, n) => from + n),
});

describe('the stream of iterations', () => {
  it('is merged in order, with repeated parts', () => {
    let known: Stream<number> | null = null;
    for (const more of [part(0, 3), part(3, 5), part(1, 4), part(4, 9), part(9, 9)]) known = mergeStream(known, more);
    expect(known).toEqual(part(0, 9));
    expect(mergeStream(part(2, 6), part(4, 8))).toEqual(part(2, 8));
  });

  it('is read again if a part is missing, or for another solve', () => {
    expect(mergeStream(null, part(4, 6))).toBeNull();
    expect(mergeStream(part(0, 3), part(4, 6))).toBeNull();
    expect(mergeStream(part(2, 6), part(1, 8))).toBeNull();
    expect(mergeStream(part(0, 3), part(3, 6, 2))).toBeNull();
    expect(mergeStream(part(0, 3), part(0, 2, 2))).toEqual(part(0, 2, 2));
  });
});
