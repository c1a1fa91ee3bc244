import type { Schemas } from '../api';

/** A question before something is replaced or removed. */
export interface Confirm {
  title: string;
  text: string;
  action: string;
  run: () => void;
}

/** State of the variants of the plan. */
export interface VariantState {
  variants: readonly Schemas['Variant'][];
  maxVariants: number;
  /** The name under which the plan is kept next. */
  variantName: string;
  /** Why the last name was refused. */
  variantFault: string | null;
  /** The variants that are shown side by side. */
  chosenVariants: readonly string[];
  sideBySide: Schemas['SideBySide'] | null;
  confirm: Confirm | null;
}

export const initialVariants = (): VariantState => ({
  variants: [],
  maxVariants: 1,
  variantName: '',
  variantFault: null,
  chosenVariants: [],
  sideBySide: null,
  confirm: null,
});
