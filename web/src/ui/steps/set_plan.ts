import type { Plan } from '../../model';

/** Changes a part of the plan; changes of one gesture are one undo step. */
export type SetPlan = (part: Partial<Plan>, gesture?: string | null) => void;
