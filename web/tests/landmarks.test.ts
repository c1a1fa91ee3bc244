import { describe, expect, it } from 'vitest';
import { landmarkSearch, uncertaintyOf, withFound, type Landmark } from '../src/model';

const result = {
  found: {
    N: { point_mm: [1, 2, 3], uncertainty_mm: 1.2 },
    Me: { point_mm: [4, 5, 6], uncertainty_mm: 0.8 },
  },
  missing: { 'Po-L': 'the scan ends there' },
};

describe('landmarks that are found', () => {
  const search = landmarkSearch(result)!;

  it('are read from the result of the job', () => {
    expect(search.found.map(({ name }) => name)).toEqual(['N', 'Me']);
    expect(search.missing).toEqual({ 'Po-L': 'the scan ends there' });
    for (const none of [undefined, null, {}, { text: '' }]) expect(landmarkSearch(none)).toBeNull();
  });

  it('do not move those that are placed', () => {
    const mine: Landmark[] = [
      { name: 'Me', position_mm: [7, 7, 7] },
      { name: 'mine', position_mm: [0, 0, 0] },
    ];
    expect(withFound(mine, search)).toEqual([...mine, { name: 'N', position_mm: [1, 2, 3] }]);
  });

  it('have an uncertainty until they are moved', () => {
    const [n] = withFound([], search);
    expect(uncertaintyOf(n, search)).toBe(1.2);
    expect(uncertaintyOf({ ...n, position_mm: [1, 2, 3.1] }, search)).toBeNull();
    expect(uncertaintyOf({ ...n, name: 'S' }, search)).toBeNull();
    expect(uncertaintyOf(n, null)).toBeNull();
  });
});
