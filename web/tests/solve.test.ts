import { describe, expect, it } from 'vitest';
import { joinTold, type Told } from '../src/model';

const told = (from: number, to: number, job = 1): Told<number> => ({
  job,
  from,
  points: Array.from({ length: to - from }, (_, n) => from + n),
});

describe('what a solve tells', () => {
  it('is joined in its order, whatever is told twice', () => {
    let known: Told<number> | null = null;
    for (const more of [told(0, 3), told(3, 5), told(1, 4), told(4, 9), told(9, 9)]) known = joinTold(known, more);
    expect(known).toEqual(told(0, 9));
    expect(joinTold(told(2, 6), told(4, 8))).toEqual(told(2, 8));
  });

  it('is asked for anew where something is missing, or it is of another solve', () => {
    expect(joinTold(null, told(4, 6))).toBeNull();
    expect(joinTold(told(0, 3), told(4, 6))).toBeNull();
    expect(joinTold(told(2, 6), told(1, 8))).toBeNull();
    expect(joinTold(told(0, 3), told(3, 6, 2))).toBeNull();
    expect(joinTold(told(0, 3), told(0, 2, 2))).toEqual(told(0, 2, 2));
  });
});
