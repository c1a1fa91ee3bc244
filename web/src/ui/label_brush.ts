import { AppliedStrokes, joinEdits, paintBall, type LabelEdit, type Vec3 } from '../model';
import type { Planner, SceneListeners } from './planner_context';
import { stageOf, type Doc } from './state';

/** Labels of the voxels, and brush strokes on them with undo. */
export class LabelBrush {
  private stroke: LabelEdit | null = null;
  private readonly strokes = new AppliedStrokes();
  /** ETag of the anatomy of the labels. */
  private labelsOf: string | null = null;

  constructor(
    private readonly planner: Planner,
    private readonly listeners: SceneListeners,
  ) {}

  async load(): Promise<void> {
    const { model } = this.planner;
    const etag = stageOf(model.s, 'anatomy').etag;
    if (model.labels && this.labelsOf === etag) return;
    this.labelsOf = etag;
    await this.planner.attempt(async () => {
      const [about, data] = await Promise.all([this.planner.client.labels(), this.planner.client.labelsData()]);
      model.labels = data.value;
      model.labelsEtag = data.etag;
      this.strokes.setApplied([]);
      const bare = (doc: Doc): Doc => ({ ...doc, strokes: [] });
      const { past, present, future } = model.history.value;
      model.history.set({ past: past.map(bare), present: bare(present), future: future.map(bare), gesture: null });
      this.planner.patch({ labelNames: about.names, labelsReady: true });
      this.listeners.onLabels();
    });
  }

  brush(p_L: Vec3, phase: 'start' | 'move' | 'end'): void {
    const { model } = this.planner;
    const { volume, brush_mm, brushLabel } = model.s;
    if (!volume || !model.labels) return;
    if (phase !== 'end') {
      const edit = paintBall(model.labels, volume.grid, p_L, brush_mm, brushLabel);
      this.stroke = this.stroke ? joinEdits(this.stroke, edit) : edit;
      this.listeners.onLabels();
      return;
    }
    if (this.stroke && this.stroke.at.length > 0) {
      const strokes = [...model.doc.strokes, this.stroke];
      this.strokes.setApplied(strokes);
      this.planner.edit({ strokes });
    }
    this.stroke = null;
  }

  apply(strokes: readonly LabelEdit[]): void {
    const { labels } = this.planner.model;
    if (labels && this.strokes.apply(labels, strokes)) this.listeners.onLabels();
  }

  /** Saves the painted labels and rebuilds the surfaces; the plan then names the labels. */
  async use(): Promise<void> {
    const { model } = this.planner;
    if (!model.labels || !model.labelsEtag) return;
    const { plan } = model.doc;
    this.planner.edit({ plan: { ...plan, segmentation: { ...plan.segmentation, labels: 'anatomy/labels.seg.nrrd' } } });
    await this.planner.attempt(async () => {
      model.labelsEtag = await this.planner.client.putLabels(model.labels!, model.labelsEtag!);
      await this.planner.run({ kind: 'segment', from_labels: true });
    });
  }
}
