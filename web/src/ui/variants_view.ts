import type { View3d } from '../scene';
import { isVariantsShown, type State } from './state';

const bodyOf = (name: string): string => `variants/${name}`;

/** Draws the predicted faces of variants side by side, from the same view. */
export class VariantsView {
  private isFramed = false;

  constructor(private readonly view: View3d) {}

  /** Bodies that are shown. */
  bodies = (s: State): string[] => s.chosenVariants.map(bodyOf);

  present(s: State): void {
    const { view } = this;
    if (!isVariantsShown(s)) {
      this.isFramed = false;
      return;
    }
    const shown = this.bodies(s).filter((name) => view.body(name));
    for (const name of shown) view.setOpacity(name, 1);
    if (shown.length === 0) {
      view.setLayout({ mode: 'single' });
      view.show([]);
      return;
    }
    const panes = s.chosenVariants.map((name) => ({
      bodies: [bodyOf(name)],
      name: view.body(bodyOf(name)) ? name : `${name}: no face`,
    }));
    view.setLayout({ mode: 'beside', panes });
    if (this.isFramed) return;
    this.isFramed = true;
    view.bringIntoView(shown);
  }
}
