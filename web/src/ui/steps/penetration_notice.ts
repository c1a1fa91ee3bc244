import { nothing } from 'lit-html';
import { mm, penetrationBeyondLimits } from '../../model';
import type { State } from '../state';
import { notice, type Html } from '../widgets';

/** A warning beside the predicted face if tissue lies too deep in bone. */
export function penetrationNotice({ prediction }: State): Html {
  const depth = prediction?.converged ? penetrationBeyondLimits(prediction.document) : null;
  if (!depth) return nothing;
  return notice(
    'warning',
    'Tissue penetrates bone beyond the limits',
    `At the end of the path the penetration increases by ${mm(depth.p99_mm, 2)} (P99) and ${mm(depth.max_mm, 2)} (max);
    the limits are ${mm(depth.p99Limit_mm)} and ${mm(depth.maxLimit_mm)}. The face over this bone is less certain.`,
  );
}
