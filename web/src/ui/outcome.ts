import type { Schemas } from '../api';
import { roundUp } from '../model';
import { isNotFound, messageOf } from './errors';
import type { Planner } from './planner_context';
import { stageOf, type State } from './state';

/** The prediction, its comparison and its band, read from the server. */
export class Outcome {
  private stepData = new Map<number, Float32Array>();
  private readonly regions = new Map<string, Schemas['RegionShifts']>();
  private uncertaintyEtag: string | null = null;
  private readonly kept = new Map<string, { etag: string | null; data: Float32Array | null }>();

  constructor(private readonly planner: Planner) {}

  async load(): Promise<void> {
    await Promise.all([this.loadPrediction(), this.loadUncertainty()]);
  }

  /** Reads the results of `lefort uncertainty`, which the job or the command line has written. */
  private async loadUncertainty(): Promise<void> {
    const { planner } = this;
    const { etag } = stageOf(planner.model.s, 'uncertainty');
    if (etag === this.uncertaintyEtag) return;
    this.uncertaintyEtag = etag;
    const uncertainty = etag === null ? null : await planner.attempt(() => planner.client.uncertainty());
    if (this.uncertaintyEtag === etag) planner.patch({ uncertainty, bandRegion: 0 });
  }

  private async loadPrediction(): Promise<void> {
    const { planner } = this;
    const stage = stageOf(planner.model.s, 'prediction');
    if (stage.state === 'missing') {
      planner.patch({ prediction: null, files: [], comparison: null, difference_mm: null, regionShifts: null });
      return;
    }
    const [prediction, files] = await Promise.all([
      planner.client.prediction().catch((error: unknown) => {
        if (!isNotFound(error)) planner.toast(messageOf(error), 'error');
        return null;
      }),
      planner.client.files().catch(() => []),
    ]);
    const before = planner.model.s.prediction;
    if (JSON.stringify(before?.document) !== JSON.stringify(prediction?.document)) this.stepData.clear();
    const last = prediction?.steps.length ?? 0;
    planner.patch({
      prediction,
      files,
      compareStep:
        before && planner.model.s.compareStep <= last && planner.model.s.compareStep > 0
          ? planner.model.s.compareStep
          : last,
    });
    await this.loadComparison();
    if (prediction?.converged && stage.state === 'fresh')
      planner.patch({ previewDistance: await planner.client.previewDistance().catch(() => null) });
  }

  private async loadComparison(): Promise<void> {
    const { planner } = this;
    const { state } = stageOf(planner.model.s, 'comparison');
    if (state !== 'fresh' && state !== 'stale') {
      planner.patch({
        comparison: null,
        difference_mm: null,
        against: 'before',
        ...(planner.model.s.skinPaint === 'error' ? { skinPaint: 'none' } : {}),
      });
      return;
    }
    const comparison = await planner.attempt(() => planner.client.comparison());
    const difference_mm = await this.values('difference');
    const whole = comparison?.regions[0]?.face.p99_mm ?? null;
    planner.patch({ comparison, difference_mm, errorTop_mm: roundUp(whole ?? 1) });
  }

  /** Displacement of the skin at a step of the prediction; step 0 is before surgery. */
  async displacementAt(step: number): Promise<Float32Array | null> {
    if (step === 0) return null;
    const known = this.stepData.get(step);
    if (known) return known;
    const data = await this.planner.client.predictionStep(step);
    this.stepData.set(step, data);
    return data;
  }

  /** Loads the displacement of the regions of the face at a step. */
  async loadRegions(step: number): Promise<void> {
    const { planner } = this;
    if (step === 0) {
      planner.patch({ regionShifts: null });
      return;
    }
    const key = JSON.stringify([
      stageOf(planner.model.s, 'prediction').etag,
      stageOf(planner.model.s, 'landmarks').etag,
      step,
    ]);
    const found = this.regions.get(key) ?? (await planner.attempt(() => planner.client.stepRegions(step)));
    if (!found) return;
    this.regions.set(key, found);
    if (planner.model.s.compareStep === step) planner.patch({ regionShifts: found });
  }

  /** Values at the vertices of a surface; null if there are none. */
  async values(name: Schemas['ValuesName'], segment?: string): Promise<Float32Array | null> {
    const { etag } = stageOf(this.planner.model.s, name === 'difference' ? 'comparison' : 'prediction');
    const key = `${name} ${segment ?? ''}`;
    const known = this.kept.get(key);
    if (known && known.etag === etag) return known.data;
    const data = await this.planner.client.values(name, segment).catch((error: unknown) => {
      if (!isNotFound(error)) this.planner.toast(messageOf(error), 'error');
      return null;
    });
    this.kept.set(key, { etag, data });
    return data;
  }

  /** Selects what the comparison shows. The command line may have written a band since the case was read. */
  async show(compareView: State['compareView']): Promise<void> {
    this.planner.patch({ compareView });
    if (compareView !== 'faces') await this.planner.attempt(() => this.planner.reload());
  }

  /** Compares the prediction with a scan after surgery, or with a surface of the face. */
  async compareWith(files: readonly File[]): Promise<void> {
    const upload = await this.planner.upload(files);
    if (upload !== null)
      await this.planner.run({ kind: 'compare', upload }, () => this.planner.patch({ skinPaint: 'error' }));
  }
}
