import { describe, expect, it } from 'vitest';
import { penetrationBeyondLimits } from '../src/model';

const depths = (p99: number | null, max: number | null) => ({
  p99_penetration_increase_mm: p99,
  max_penetration_increase_mm: max,
});
const limits = (is_within: boolean | null) => ({ p99_mm: 0.1, max_mm: 0.3, is_within });

describe('the depth of tissue in bone', () => {
  it('is the deepest of all bones at the end of the path', () => {
    const steps = [
      { contact: depths(5, 9), stationary_bone_contact: depths(5, 9) },
      { contact: depths(0.62, 1.2), stationary_bone_contact: depths(0.04, 1.56) },
    ];
    expect(penetrationBeyondLimits({ penetration_limits: limits(false), steps })).toEqual({
      p99_mm: 0.62,
      max_mm: 1.56,
      p99Limit_mm: 0.1,
      maxLimit_mm: 0.3,
    });
  });

  it('has no warning within the limits, without contact, and for documents of earlier versions', () => {
    const steps = [{ contact: depths(0.05, 0.2) }];
    expect(penetrationBeyondLimits({ penetration_limits: limits(true), steps })).toBeNull();
    expect(penetrationBeyondLimits({ penetration_limits: limits(null), steps: [] })).toBeNull();
    expect(penetrationBeyondLimits({ steps })).toBeNull();
    expect(penetrationBeyondLimits({ penetration_limits: limits(false), steps: [] })).toBeNull();
    const bonded = [{ contact: depths(null, null) }];
    expect(penetrationBeyondLimits({ penetration_limits: limits(false), steps: bonded })?.max_mm).toBe(0);
  });
});
