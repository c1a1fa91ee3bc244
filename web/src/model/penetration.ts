interface Depths {
  p99_penetration_increase_mm: number | null;
  max_penetration_increase_mm: number | null;
}

/** The parts of prediction.json with the depth of tissue in bone. */
export interface PenetrationDocument {
  penetration_limits?: { p99_mm: number; max_mm: number; is_within: boolean | null };
  steps?: { contact?: Depths; stationary_bone_contact?: Depths }[];
}

export interface Penetration {
  p99_mm: number;
  max_mm: number;
  p99Limit_mm: number;
  maxLimit_mm: number;
}

/**
 * How much deeper tissue lies in bone at the end of the path than in the scan, if that exceeds the limits of the
 * prediction; else null.
 */
export function penetrationBeyondLimits({ penetration_limits, steps }: PenetrationDocument): Penetration | null {
  const last = steps?.at(-1);
  if (!last || penetration_limits?.is_within !== false) return null;
  const ofBones = [last.contact, last.stationary_bone_contact];
  return {
    p99_mm: Math.max(0, ...ofBones.map((x) => x?.p99_penetration_increase_mm ?? 0)),
    max_mm: Math.max(0, ...ofBones.map((x) => x?.max_penetration_increase_mm ?? 0)),
    p99Limit_mm: penetration_limits.p99_mm,
    maxLimit_mm: penetration_limits.max_mm,
  };
}
