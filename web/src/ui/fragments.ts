import type { Vec3 } from '../model';
import { lastJob, stageOf, type State } from './state';

/** A piece of bone that the osteotomy of a segment makes beside it. */
export interface Fragment {
  segment: string;
  volume_ml: number;
  center_mm: Vec3;
  owner: 'remainder' | 'segment' | 'none';
}

const OWNERS = { remainder: 'stays', segment: 'moves with the segment', none: 'left out' };

/** The fragments in the result of a check, the largest first. */
export function fragmentsIn(result: unknown): Fragment[] {
  const { segments = [] } = (result ?? {}) as {
    segments?: { name: string; fragments?: Omit<Fragment, 'segment'>[] }[];
  };
  return segments
    .flatMap(({ name, fragments = [] }) => fragments.map((one) => ({ ...one, segment: name })))
    .sort((a, b) => b.volume_ml - a.volume_ml);
}

/** Those of the last check, while it belongs to the plan. */
export function checkedFragments(s: State): Fragment[] {
  return stageOf(s, 'check').state === 'fresh' ? fragmentsIn(lastJob(s, 'check')?.result) : [];
}

/** Volume, owner and position, for a list. */
export function describeFragment({ segment, volume_ml, center_mm, owner }: Fragment): string {
  const at = center_mm.map((x) => x.toFixed(0)).join(', ');
  return `${segment}: ${volume_ml.toPrecision(2)} ml, ${OWNERS[owner]}, at (${at}) mm`;
}
