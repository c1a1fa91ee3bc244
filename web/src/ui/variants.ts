import type { Schemas } from '../api';
import { faultOfVariantName, MAX_SIDE_BY_SIDE, withVariant } from '../model';
import { messageOf } from './errors';
import type { PlanStore } from './plan_store';
import type { Planner } from './planner_context';
import { stageOf } from './state';

type Store = Pick<PlanStore, 'save' | 'exchange'>;

/** Variants: named copies of the plan on the server, with their checks and predictions. */
export class Variants {
  private tableEtag: string | null = null;

  constructor(
    private readonly planner: Planner,
    private readonly store: Store,
  ) {}

  /** Reads the list, and the table if it has changed. */
  async load(): Promise<void> {
    await Promise.all([
      this.planner.attempt(async () => this.show(await this.planner.client.variants())),
      this.loadTable(),
    ]);
  }

  private async loadTable(): Promise<void> {
    const { planner } = this;
    const { etag } = stageOf(planner.model.s, 'variants');
    if (etag === this.tableEtag) return;
    this.tableEtag = etag;
    const sideBySide = etag === null ? null : await planner.attempt(() => planner.client.sideBySide());
    if (this.tableEtag === etag) planner.patch({ sideBySide });
  }

  private show({ variants, max_variants }: Schemas['VariantList']): void {
    const { s } = this.planner.model;
    const isNew = s.variants.length === 0 && s.chosenVariants.length === 0;
    const names = variants.map(({ name }) => name);
    const chosenVariants = isNew
      ? names.slice(0, MAX_SIDE_BY_SIDE)
      : s.chosenVariants.filter((name) => names.includes(name));
    const isSame = JSON.stringify(chosenVariants) === JSON.stringify(s.chosenVariants);
    this.planner.patch({
      variants,
      maxVariants: max_variants,
      chosenVariants: isSame ? s.chosenVariants : chosenVariants,
    });
  }

  /** Chooses a variant, or one less. */
  choose(name: string): void {
    const { s } = this.planner.model;
    this.planner.patch({ chosenVariants: withVariant(s.chosenVariants, name, s.variants) });
  }

  /** Keeps the current plan under the name that was typed. */
  async keep(): Promise<void> {
    const { planner } = this;
    const { variantName, variants, maxVariants } = planner.model.s;
    const name = variantName.trim();
    const fault = faultOfVariantName(name, variants, maxVariants);
    planner.patch({ variantFault: fault });
    if (fault !== null) return;
    try {
      if (!(await this.store.save())) throw new Error('The plan could not be saved. It was not kept as a variant.');
      const list = await planner.client.keepVariant(name);
      planner.patch({ variantName: '' });
      this.show(list);
      const { chosenVariants } = planner.model.s;
      if (!chosenVariants.includes(name) && chosenVariants.length < MAX_SIDE_BY_SIDE) this.choose(name);
      planner.toast(`The plan is kept as the variant ${name}.`);
    } catch (error) {
      planner.patch({ variantFault: messageOf(error) });
    }
  }

  /** Opens the dialog that confirms the replacement of the current plan. */
  askToLoad(variant: Schemas['Variant']): void {
    const { s } = this.planner.model;
    const isKept = s.variants.some((one) => one.is_current);
    const results = variant.has_prediction ? 'check and prediction' : 'check';
    this.ask(
      `Load the variant ${variant.name}?`,
      `It replaces the plan, its landmarks and painted boundary, and its ${results}. ` +
        (isKept
          ? 'The current plan is a variant itself and can be loaded again.'
          : 'The current plan is not kept as a variant: undo restores plan and landmarks, not its results and paint.'),
      'Load',
      () => void this.loadBack(variant.name),
    );
  }

  askToDelete({ name, is_current }: Schemas['Variant']): void {
    this.ask(
      `Delete the variant ${name}?`,
      `Its plan, check and prediction are removed. This cannot be undone. ${
        is_current ? 'The current plan, which is the same, stays.' : 'The current plan stays.'
      }`,
      'Delete',
      () => void this.remove(name),
    );
  }

  private ask(title: string, text: string, action: string, run: () => void): void {
    this.planner.patch({ confirm: { title, text, action, run } });
  }

  private async loadBack(name: string): Promise<void> {
    const { planner } = this;
    await planner.attempt(async () => {
      await this.store.exchange((etag) => planner.client.loadVariant(name, etag));
      await planner.reload();
      planner.toast(`The variant ${name} is the current plan.`);
    });
  }

  private async remove(name: string): Promise<void> {
    await this.planner.attempt(() => this.planner.client.deleteVariant(name));
    await this.planner.attempt(() => this.planner.reload());
  }

  /** Puts the chosen variants side by side in a table. */
  async compare(): Promise<void> {
    await this.planner.run({ kind: 'variants', names: [...this.planner.model.s.chosenVariants] });
  }
}
