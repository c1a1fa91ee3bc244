/** Variants that can be put side by side, as in the contract. */
export const MAX_SIDE_BY_SIDE = 4;

const NAME = /^[A-Za-z0-9_-]{1,40}$/;

/** Why the plan cannot be kept under a name; null if it can. */
export function faultOfVariantName(name: string, others: readonly { name: string }[], max: number): string | null {
  if (others.length >= max) return `A case has at most ${max} variants. Delete one first.`;
  if (name === '') return 'Give it a name.';
  if (name.length > 40) return 'The name has more than 40 characters.';
  if (!NAME.test(name)) return 'The name can have letters without accents, digits, - and _, and no others.';
  if (others.some((one) => one.name === name)) return `There is a variant ${name}. Choose another name.`;
  return null;
}

/** The chosen variants with one more or one less, in the order of the list. */
export function withVariant(
  chosen: readonly string[],
  name: string,
  variants: readonly { name: string }[],
): readonly string[] {
  const wanted = chosen.includes(name) ? chosen.filter((one) => one !== name) : [...chosen, name];
  return variants.map((one) => one.name).filter((one) => wanted.includes(one));
}

/** Why the chosen variants cannot be put side by side; null if they can. */
export function faultOfChoice(chosen: readonly string[]): string | null {
  if (chosen.length < 2) return 'Choose two to four variants in the list.';
  if (chosen.length > MAX_SIDE_BY_SIDE) return `Choose at most ${MAX_SIDE_BY_SIDE} variants.`;
  return null;
}

/** Whether a table is of these variants, in any order. */
export const isOfVariants = (names: readonly string[], chosen: readonly string[]): boolean =>
  names.length === chosen.length && names.every((name) => chosen.includes(name));
