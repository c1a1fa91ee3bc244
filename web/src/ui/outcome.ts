import type { Schemas } from '../api';
import { roundUp } from '../model';
import { isNotFound, messageOf, type App } from './app';
import { stageOf } from './state';

/** The prediction, and what it was held against, as the server has them. */
export class Outcome {
  private stepData = new Map<number, Float32Array>();
  private readonly regions = new Map<string, Schemas['RegionShifts']>();
  private readonly kept = new Map<string, { etag: string | null; data: Float32Array | null }>();

  constructor(private readonly app: App) {}

  async load(): Promise<void> {
    const { app } = this;
    const stage = stageOf(app.model.s, 'prediction');
    if (stage.state === 'missing') {
      app.patch({ prediction: null, files: [], comparison: null, difference_mm: null, regionShifts: null });
      return;
    }
    const [prediction, files] = await Promise.all([
      app.client.prediction().catch((error: unknown) => {
        if (!isNotFound(error)) app.toast(messageOf(error), 'error');
        return null;
      }),
      app.client.files().catch(() => []),
    ]);
    const before = app.model.s.prediction;
    if (JSON.stringify(before?.document) !== JSON.stringify(prediction?.document)) this.stepData.clear();
    const last = prediction?.steps.length ?? 0;
    app.patch({
      prediction,
      files,
      compareStep:
        before && app.model.s.compareStep <= last && app.model.s.compareStep > 0 ? app.model.s.compareStep : last,
    });
    await this.loadComparison();
    if (prediction?.converged && stage.state === 'fresh')
      app.patch({ previewDistance: await app.client.previewDistance().catch(() => null) });
  }

  private async loadComparison(): Promise<void> {
    const { app } = this;
    const { state } = stageOf(app.model.s, 'comparison');
    if (state !== 'fresh' && state !== 'stale') {
      app.patch({
        comparison: null,
        difference_mm: null,
        against: 'before',
        ...(app.model.s.skinPaint === 'error' ? { skinPaint: 'none' } : {}),
      });
      return;
    }
    const comparison = await app.attempt(() => app.client.comparison());
    const difference_mm = await this.values('difference');
    const whole = comparison?.regions[0]?.face.p99_mm ?? null;
    app.patch({ comparison, difference_mm, errorTop_mm: roundUp(whole ?? 1) });
  }

  /** Displacement of the skin at a step of the kept prediction; 0 is before surgery. */
  async displacementAt(step: number): Promise<Float32Array | null> {
    if (step === 0) return null;
    const known = this.stepData.get(step);
    if (known) return known;
    const data = await this.app.client.predictionStep(step);
    this.stepData.set(step, data);
    return data;
  }

  /** How far the parts of the face have moved at a step. */
  async loadRegions(step: number): Promise<void> {
    const { app } = this;
    if (step === 0) {
      app.patch({ regionShifts: null });
      return;
    }
    const key = JSON.stringify([stageOf(app.model.s, 'prediction').etag, stageOf(app.model.s, 'landmarks').etag, step]);
    const found = this.regions.get(key) ?? (await app.attempt(() => app.client.stepRegions(step)));
    if (!found) return;
    this.regions.set(key, found);
    if (app.model.s.compareStep === step) app.patch({ regionShifts: found });
  }

  /** Numbers for the vertices of a surface; null where there are none. */
  async values(name: Schemas['ValuesName'], segment?: string): Promise<Float32Array | null> {
    const { etag } = stageOf(this.app.model.s, name === 'difference' ? 'comparison' : 'prediction');
    const key = `${name} ${segment ?? ''}`;
    const known = this.kept.get(key);
    if (known && known.etag === etag) return known.data;
    const data = await this.app.client.values(name, segment).catch((error: unknown) => {
      if (!isNotFound(error)) this.app.toast(messageOf(error), 'error');
      return null;
    });
    this.kept.set(key, { etag, data });
    return data;
  }

  /** Holds the prediction against a scan after surgery, or a surface of the face. */
  async compareWith(files: readonly File[]): Promise<void> {
    const upload = await this.app.upload(files);
    if (upload !== null) await this.app.run({ kind: 'compare', upload }, () => this.app.patch({ skinPaint: 'error' }));
  }
}
