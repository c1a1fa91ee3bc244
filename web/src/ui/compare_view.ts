import {
  IDENTITY,
  lengths,
  midsagittalX,
  roundUp,
  sectionOf,
  segmentColor,
  SKIN,
  type Mat4,
  type Vec3,
} from '../model';
import type { View3d } from '../scene';
import type { App } from './app';
import { saveBlob } from './download';
import { stageOf, type State } from './state';

/** Draws the comparison: the face before or after surgery, the predicted face at any step, and the contact on bone. */
export class CompareView {
  private shifts: Float32Array | null = null;
  private shown: { step: number; document: unknown } | null = null;
  private profile_: { before: Float32Array; after: Float32Array } | null = null;
  private paintedSkin: unknown[] = [];
  private paintedBone: unknown[] = [];

  constructor(
    private readonly view: View3d,
    private readonly app: App,
  ) {}

  surfaceChanged(name: string): void {
    this.profile_ = null;
    this.paintedBone = [];
    if (name === 'skin_before') this.shown = null;
  }

  /** Bodies that are shown. */
  bodies(s: State): string[] {
    return ['skin_before', 'predicted', 'after_surgery', ...this.bones(s)];
  }

  poseOf(s: State, index: number): Mat4 {
    const name = this.app.model.doc.plan.segments[index]?.name ?? '';
    return s.prediction?.steps[s.compareStep - 1]?.poses[name] ?? IDENTITY;
  }

  present(s: State): void {
    const { view } = this;
    if (s.step === 'compare' && s.compareView !== 'faces') return;
    if (s.step !== 'compare' || !view.body('skin_before') || !view.body('predicted') || !s.prediction?.converged) {
      view.setLayout({ mode: 'single' });
      if (s.step === 'compare') view.show([]);
      return;
    }
    const clear = this.showsContact(s) ? 0.2 : 0.4;
    for (const skin of ['skin_before', 'predicted', 'after_surgery']) view.setOpacity(skin, s.showBones ? clear : 1);
    if (this.shown?.step !== s.compareStep || this.shown.document !== s.prediction.document) {
      const step = s.compareStep;
      this.shown = { step, document: s.prediction.document };
      void this.app.attempt(async () => {
        const xyz = await this.app.outcome.displacementAt(step);
        if (this.app.model.s.compareStep !== step) return;
        this.showStep(xyz);
      });
      void this.app.outcome.loadRegions(step);
    }
    const afterSurgery = s.against === 'after_surgery' && view.body('after_surgery') !== undefined;
    const right = ['predicted', ...this.bones(s)];
    const left = [afterSurgery ? 'after_surgery' : 'skin_before', ...this.bones(s)];
    const names: [string, string] = [
      afterSurgery ? 'After surgery' : 'Before',
      this.isAtEnd(s) ? 'Predicted' : `Step ${s.compareStep}`,
    ];
    if (s.compareMode === 'slider') view.setLayout({ mode: 'wipe', fraction: s.wipe, left, right, names });
    else if (s.compareMode === 'beside') {
      const panes = [left, right].map((bodies, n) => ({ bodies, name: names[n] }));
      view.setLayout({ mode: 'beside', panes });
    } else {
      view.show(right);
      view.setLayout({ mode: 'single' });
    }
    this.paintSkin();
    void this.paintBone();
  }

  private bones(s: State): string[] {
    return s.showBones ? ['remainder', ...this.app.model.doc.plan.segments.map((x) => `segments/${x.name}`)] : [];
  }

  /** If contact is shown, the skin has a plain color: two overlaid color maps cannot be read. */
  private showsContact = (s: State): boolean => s.showBones && s.bonePaint !== 'none' && this.isAtEnd(s);

  private isAtEnd = (s: State): boolean => s.compareStep === s.prediction?.steps.length;

  /** Moves the predicted skin to its position at a step: the scanned skin plus its displacement. */
  private showStep(xyz: Float32Array | null): void {
    const before = this.view.body('skin_before');
    const predicted = this.view.body('predicted');
    if (!before || !predicted) return;
    const base = before.surface.points;
    const wanted = base.slice();
    if (xyz && xyz.length === base.length) for (let n = 0; n < base.length; n++) wanted[n] += xyz[n];
    if (wanted.length === predicted.surface.points.length) {
      // The body has the vertices of the last step, so its displacement is relative to them.
      const from = predicted.surface.points;
      predicted.setDisplacement(wanted.map((v, n) => v - from[n]));
    }
    this.shifts = xyz ? lengths(xyz) : new Float32Array(base.length / 3);
    this.profile_ = null;
    this.paintSkin();
    this.app.patch({ distanceTop_mm: roundUp(this.app.model.s.prediction?.skin_max_shift_mm ?? 1) });
    this.view.render();
  }

  /** Colors the skin by displacement, by error, or plain. */
  private paintSkin(): void {
    const { s } = this.app.model;
    const predicted = this.view.body('predicted');
    if (!predicted) return;
    const error = s.skinPaint === 'error' && this.isAtEnd(s) ? s.difference_mm : null;
    const plain = this.showsContact(s);
    const now = [predicted, s.skinPaint, this.shifts, error, s.errorTop_mm, plain];
    if (now.every((value, n) => value === this.paintedSkin[n])) return;
    this.paintedSkin = now;
    const count = predicted.surface.points.length / 3;
    if (plain) predicted.setColor(SKIN);
    else if (error?.length === count) predicted.setValues(error.map(Math.abs), 'distance', 0, s.errorTop_mm);
    else if (s.skinPaint === 'moved' && this.shifts?.length === count)
      predicted.setValues(this.shifts, 'distance', 0, roundUp(s.prediction?.skin_max_shift_mm ?? 1));
    else predicted.setColor(SKIN);
    this.view.render();
  }

  /** Colors the mobilized segments by contact, on one scale; contact is stored for the last step only. */
  private async paintBone(): Promise<void> {
    const { s, doc } = this.app.model;
    const { segments } = doc.plan;
    const bodies = segments.flatMap(({ name }, index) => {
      const body = this.view.body(`segments/${name}`);
      return body ? [{ body, name, color: segmentColor(index) }] : [];
    });
    if (bodies.length === 0) return;
    const wanted = this.showsContact(s) ? s.bonePaint : 'none';
    const now = [wanted, stageOf(s, 'prediction').etag, segments.length, ...bodies.map(({ body }) => body)];
    if (now.length === this.paintedBone.length && now.every((value, n) => value === this.paintedBone[n])) return;
    this.paintedBone = now;
    const kind = wanted === 'pressure' ? 'contact-pressure' : 'contact-depth';
    const all = await Promise.all(
      bodies.map(({ name }) =>
        wanted === 'none' ? null : this.app.outcome.values(kind, segments.length > 1 ? name : undefined),
      ),
    );
    if (this.paintedBone !== now) return; // The selection has changed.
    const fits = all.map((values, n) => (values?.length === bodies[n].body.surface.points.length / 3 ? values : null));
    const finite = fits.filter((values) => values !== null);
    const top =
      finite.length > 0
        ? roundUp(Math.max(...finite.map((values) => values.reduce((a, b) => Math.max(a, b), 0))))
        : null;
    bodies.forEach(({ body, color }, n) => {
      const values = fits[n];
      if (values && top !== null) body.setValues(values, 'depth', 0, top, color);
      else body.setColor(color);
    });
    this.app.patch({ boneTop: top });
    this.view.render();
  }

  profile(): { before: Float32Array; after: Float32Array } | null {
    const before = this.view.body('skin_before');
    const after = this.view.body('predicted');
    if (!before || !after) return null;
    if (!this.profile_) {
      const point: Vec3 = [midsagittalX(this.app.model.doc.landmarks, before.surface.points), 0, 0];
      this.profile_ = {
        before: sectionOf(before.surface, point, [1, 0, 0]),
        after: sectionOf({ points: after.points, triangles: after.surface.triangles }, point, [1, 0, 0]),
      };
    }
    return this.profile_;
  }

  savePicture(): void {
    const { s } = this.app.model;
    const left = s.against === 'after_surgery' && this.view.body('after_surgery') ? 'After surgery' : 'Before';
    const what = { slider: `${left} and predicted`, beside: `${left}, predicted`, after: 'Predicted' }[s.compareMode];
    const ground = getComputedStyle(document.documentElement).getPropertyValue('--view-top').trim();
    const stale = stageOf(s, 'prediction').state === 'stale' ? ' OUT OF DATE.' : '';
    this.view
      .snapshot(
        `${what}, step ${s.compareStep} of ${s.prediction?.steps.length ?? 0}.${stale} Research ` +
          'software. A simulation, not for clinical use.',
        ground,
      )
      .toBlob((blob) => blob && saveBlob(blob, 'planner.png'), 'image/png');
  }
}
