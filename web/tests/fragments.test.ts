import { describe, expect, it } from 'vitest';
import { describeFragment, fragmentsIn } from '../src/ui/fragments';

describe('fragments of a check', () => {
  const fragment = (volume_ml: number, owner: string) => ({
    volume_ml,
    center_mm: [1.2, -3.4, 56.7],
    owner,
    is_within_cut: true,
  });

  it('are listed with their segments, the largest first', () => {
    const found = fragmentsIn({
      segments: [
        { name: 'maxilla', fragments: [fragment(0.01, 'remainder'), fragment(0.2, 'segment')] },
        { name: 'chin', fragments: [fragment(0.05, 'none')] },
      ],
    });
    expect(found.map(({ segment, owner }) => `${segment} ${owner}`)).toEqual([
      'maxilla segment',
      'chin none',
      'maxilla remainder',
    ]);
    expect(describeFragment(found[0]!)).toBe('maxilla: 0.20 ml, moves with the segment, at (1, -3, 57) mm');
  });

  it('are none without a result, or in one of an earlier version', () => {
    expect(fragmentsIn(null)).toEqual([]);
    expect(fragmentsIn({ segments: [{ name: 'maxilla', fragments_left: 3 }] })).toEqual([]);
  });
});
