import { AIRWAY, GUIDE, IDENTITY, LOWER_TEETH, NERVE, SPLINT, TEETH, type Mat4, type Rgb } from '../model';
import type { Body, View3d } from '../scene';
import type { App } from './app';
import type { State } from './state';

/** Colors of the surfaces of teeth and measures. */
const MEASURE_COLORS: Readonly<Record<string, Rgb>> = {
  upper_arch: TEETH,
  lower_arch: LOWER_TEETH,
  lower_in_occlusion: LOWER_TEETH,
  splint_final: SPLINT,
  splint_intermediate: SPLINT,
  nerve_right: NERVE,
  nerve_left: NERVE,
  airway: AIRWAY,
};

/** The color of a surface of teeth and measures; undefined for others. */
export const measureColor = (name: string): Rgb | undefined =>
  name.startsWith('guides/') ? GUIDE : MEASURE_COLORS[name];

/** Gap at the end of the color map [mm]. */
export const GAP_TOP_MM = 2;

const HEAD = ['skull'] as const;
const ARCHES = ['upper_arch', 'lower_arch'] as const;
const CANALS = ['nerve_right', 'nerve_left'] as const;

const toMat4 = (pose: readonly number[] | undefined): Mat4 => (pose as Mat4 | undefined) ?? IDENTITY;

/** Draws arches, splints, canals and the airway in the 3D view. */
export class MeasuresView {
  private painted: Body | undefined;
  private paintedGap: boolean | null = null;
  /** The bodies that were brought into view; null outside of this step. */
  private framed: readonly string[] | null = null;

  constructor(
    private readonly view: View3d,
    private readonly app: App,
  ) {}

  /** Bodies that are shown. */
  bodies(s: State): string[] {
    const { splint } = s.splintSettings;
    switch (s.measure) {
      case 'teeth':
      case 'cephalogram':
        return ['skull'];
      case 'arches':
        return ['skull', 'upper_arch', this.lower(s.showOcclusion)];
      case 'splint':
        return ['upper_arch', this.lower(splint === 'final'), `splint_${splint}`];
      case 'nerve':
        return ['skull', 'nerve_right', 'nerve_left'];
      case 'guides':
        return ['skull', ...(s.guides?.guides ?? []).map(({ name }) => `guides/${name}`)];
      case 'airway':
        return ['skull', 'airway'];
    }
  }

  /** The lower arch in occlusion if it is wanted and known, else as scanned. */
  private lower(isInOcclusion: boolean): string {
    return isInOcclusion && this.view.body('lower_in_occlusion') ? 'lower_in_occlusion' : 'lower_arch';
  }

  present(s: State): void {
    this.frame(s);
    if (s.step !== 'measures') return;
    const { view } = this;
    view.setLayout({ mode: 'single' });
    view.setOpacity('skull', ['teeth', 'cephalogram', 'guides'].includes(s.measure) ? 1 : 0.25);
    for (const splint of ['splint_final', 'splint_intermediate']) view.setOpacity(splint, 0.55);
    const splint = s.measure === 'splint' ? s.splints[s.splintSettings.splint] : null;
    view.setPose('upper_arch', toMat4(splint?.upper_pose));
    for (const lower of ['lower_arch', 'lower_in_occlusion'])
      if (view.body(lower)) view.setPose(lower, toMat4(splint?.lower_pose));
    this.paintGap(s.measure === 'arches');
  }

  /** Brings into view what was selected: small bodies alone, else the head. */
  private frame(s: State): void {
    const { view } = this;
    if (s.step !== 'measures') {
      if (this.framed) view.bringIntoView(['skull', 'skin']);
      this.framed = null;
      return;
    }
    const small = { arches: ARCHES, splint: ARCHES, nerve: CANALS } as Partial<Record<string, readonly string[]>>;
    const wanted = (small[s.measure] ?? HEAD).some((name) => view.body(name)) ? (small[s.measure] ?? HEAD) : HEAD;
    if (this.framed === wanted || !wanted.some((name) => view.body(name))) return;
    this.framed = wanted;
    view.bringIntoView(wanted);
  }

  /** Colors the lower arch by its gap to the upper one, or plain. */
  private paintGap(isShown: boolean): void {
    const body = this.view.body('lower_in_occlusion');
    if (!body || (this.painted === body && this.paintedGap === isShown)) return;
    this.painted = body;
    this.paintedGap = isShown;
    const gap_mm = this.app.model.surfaces.get('lower_in_occlusion')?.gap_mm;
    if (isShown && gap_mm?.length === body.surface.points.length / 3)
      body.setValues(
        gap_mm.map((gap) => (Number.isNaN(gap) ? Infinity : gap)),
        'gap',
        0,
        GAP_TOP_MM,
      );
    else body.setColor(LOWER_TEETH);
    this.view.render();
  }
}
