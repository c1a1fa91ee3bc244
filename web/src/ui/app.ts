import type { Client, Schemas } from '../api';
import {
  centroidOf,
  change,
  draggedMove,
  gridCenter,
  IDENTITY,
  keyframesOf,
  moveAt,
  posesOf,
  redo,
  settle,
  templateKey,
  moveToOcclusion,
  templateRequest,
  upperJawOf,
  toRecord,
  transformPoint,
  undo,
  withMove,
  withPivot,
  type DrawnSurface,
  type Mat4,
  type Move,
  type Vec3,
} from '../model';
import { BoundaryBrush } from './boundary_brush';
import { CaseSync, STEP_KEY } from './case_sync';
import { saveBlob } from './download';
import { messageOf } from './errors';
import { JobTracker } from './job_tracker';
import { LabelBrush } from './label_brush';
import { LiveQueries } from './live_queries';
import { Measures } from './measures';
import { Outcome } from './outcome';
import { PlanStore } from './plan_store';
import type { Planner, SceneListeners } from './planner_context';
import { SolveMonitor } from './solve_monitor';
import { Variants } from './variants';
import { Model, stageOf, type Doc, type State, type StepName } from './state';

const MEASURE_DELAY_MS = 250;
const MAX_TOASTS = 4;
const TOAST_MS = { info: 4500, error: 12000 };

/** The actions of the user and the data of the server. Only this class and its parts call the server. */
export class App implements Planner {
  readonly model = new Model();
  readonly outcome = new Outcome(this);
  readonly measures = new Measures(this);
  readonly live: LiveQueries;
  readonly labelBrush: LabelBrush;
  readonly boundaryBrush: BoundaryBrush;
  readonly variants: Variants;
  private readonly solve = new SolveMonitor(this);
  private readonly store: PlanStore;
  private readonly jobs: JobTracker;
  private readonly sync: CaseSync;
  private readonly aborter = new AbortController();
  private toastId = 0;
  private measureTimer: ReturnType<typeof setTimeout> | undefined;

  constructor(
    readonly client: Client,
    listeners: SceneListeners,
  ) {
    this.live = new LiveQueries(this, listeners);
    this.labelBrush = new LabelBrush(this, listeners);
    this.boundaryBrush = new BoundaryBrush(this, listeners);
    this.store = new PlanStore(this, this.boundaryBrush);
    this.variants = new Variants(this, this.store);
    this.jobs = new JobTracker(
      this,
      () => this.store.save(),
      (job) => this.solve.begin(job),
    );
    const { store, jobs, solve, outcome, measures, variants } = this;
    const parts = {
      store,
      jobs,
      solve,
      outcome,
      measures,
      variants,
      boundary: this.boundaryBrush,
      measure: () => this.measure(),
    };
    this.sync = new CaseSync(this, parts, listeners);
    // Before the views subscribe: they draw the selection, which must be valid.
    this.model.history.subscribe(({ present }, { present: before }) => this.onDocChanged(present, before));
  }

  start(): Promise<void> {
    return this.sync.start(this.aborter.signal);
  }

  stop(): void {
    this.aborter.abort();
  }

  patch(part: Partial<State>): void {
    this.model.state.patch(part);
  }

  toast(text: string, kind: 'info' | 'error' = 'info'): void {
    const id = ++this.toastId;
    this.patch({ toasts: [...this.model.s.toasts, { id, kind, text }].slice(-MAX_TOASTS) });
    setTimeout(() => this.dismiss(id), TOAST_MS[kind]);
  }

  dismiss(id: number): void {
    this.patch({ toasts: this.model.s.toasts.filter((toast) => toast.id !== id) });
  }

  async attempt<T>(work: () => Promise<T>): Promise<T | null> {
    try {
      return await work();
    } catch (error) {
      this.toast(messageOf(error), 'error');
      return null;
    }
  }

  setStep(step: StepName): void {
    sessionStorage.setItem(STEP_KEY, step);
    const thresholdOn = step === 'anatomy' ? this.model.s.thresholdOn : false;
    this.patch({ step, tool: 'none', curveDraft: null, scrub: null, thresholdOn });
  }

  reload(): Promise<void> {
    return this.sync.reload();
  }

  /** Surfaces on which the boundary can be painted: the skin, and the cut bones, or the skull if there are none. */
  boundarySurfaces(): [string, { surface: DrawnSurface }][] {
    const { surfaces } = this.model;
    const isBone = surfaces.has('remainder')
      ? (name: string) => name === 'remainder' || name.startsWith('segments/')
      : (name: string) => name === 'skull';
    return [...surfaces].filter(([name]) => name === 'skin' || isBone(name));
  }

  // Document

  edit(next: Partial<Doc>, gesture: string | null = null): void {
    this.model.history.set(change(this.model.history.value, { ...this.model.doc, ...next }, gesture));
  }

  settle(): void {
    this.model.history.set(settle(this.model.history.value));
  }

  undo(): void {
    this.model.history.set(undo(this.model.history.value));
  }

  redo(): void {
    this.model.history.set(redo(this.model.history.value));
  }

  resolveConflict(keep: 'mine' | 'theirs'): Promise<void> {
    return this.store.resolveConflict(keep);
  }

  private onDocChanged(doc: Doc, before: Doc): void {
    if (doc.strokes !== before.strokes) this.labelBrush.apply(doc.strokes);
    if (doc.paint !== before.paint) this.boundaryBrush.apply(doc.paint);
    this.store.onDocChanged(doc, before);
    if (doc.landmarks !== before.landmarks) this.measure();
    this.clampSelection(doc);
  }

  /** Selects a segment, a keyframe and a plane that the document has. */
  private clampSelection({ plan }: Doc): void {
    const count = plan.segments.length;
    if (this.model.s.segment >= count) this.patch({ segment: Math.max(0, count - 1), plane: null, keyframe: 0 });
    const segment = plan.segments[this.model.s.segment];
    const keyframes = segment ? keyframesOf(segment).length : 0;
    if (this.model.s.keyframe >= Math.max(1, keyframes)) this.patch({ keyframe: Math.max(0, keyframes - 1) });
    const planes = segment?.osteotomy.planes?.length ?? 0;
    if (this.model.s.plane !== null && this.model.s.plane >= planes) this.patch({ plane: null });
  }

  // Jobs

  run(request: Schemas['JobRequest'], then?: () => void): Promise<void> {
    return this.jobs.run(request, then);
  }

  stopJob(id: number): Promise<void> {
    return this.jobs.stop(id);
  }

  async upload(files: readonly File[]): Promise<string | null> {
    if (files.length === 0) return null;
    const limits = this.model.s.case?.limits;
    if (limits && files.length > limits.upload_files) {
      this.toast(`${files.length} files were selected. A scan can have at most ${limits.upload_files}.`, 'error');
      return null;
    }
    if (limits && files.some((file) => file.size > limits.upload_file_bytes)) {
      this.toast('One of the files exceeds the size limit of the server.', 'error');
      return null;
    }
    const total = files.reduce((sum, file) => sum + file.size, 0) || 1;
    const name = files.length === 1 ? 'one file' : `${files.length} files`;
    this.patch({ upload: { name, fraction: 0 } });
    const id = await this.attempt(() =>
      this.client.upload(files, (sent) => this.patch({ upload: { name, fraction: sent / total } })),
    );
    this.patch({ upload: null });
    return id;
  }

  async importFiles(files: readonly File[]): Promise<void> {
    const upload = await this.upload(files);
    if (upload !== null) await this.run({ kind: 'import', upload }, () => this.afterImport());
  }

  openExample(): Promise<void> {
    return this.run({ kind: 'import', example: true }, () => this.afterImport());
  }

  /** Every later step needs the tissues, so their segmentation starts at once. */
  private afterImport(): void {
    if (stageOf(this.model.s, 'anatomy').state !== 'fresh') void this.run({ kind: 'segment' });
    this.setStep('anatomy');
  }

  /** Segments the tissues. The plan stores the threshold, so that a prediction uses the same bone. */
  async segment(bone_hu: number): Promise<void> {
    const { plan } = this.model.doc;
    const segmentation = { ...plan.segmentation, bone_hu };
    delete segmentation.labels;
    if (plan.segmentation?.bone_hu !== bone_hu || plan.segmentation.labels !== undefined)
      this.edit({ plan: { ...plan, segmentation } });
    await this.run({ kind: 'segment', bone_hu });
  }

  async download(name: string): Promise<void> {
    await this.attempt(async () => saveBlob(await this.client.file(name), name));
  }

  // Landmarks and templates

  private measure(): void {
    clearTimeout(this.measureTimer);
    this.measureTimer = setTimeout(() => void this.measureNow(), MEASURE_DELAY_MS);
  }

  private async measureNow(): Promise<void> {
    const { landmarks } = this.model.doc;
    if (landmarks.length === 0) {
      this.patch({ measurements: null, measurementError: null });
      return;
    }
    try {
      this.patch({ measurements: await this.client.measure(toRecord(landmarks)), measurementError: null });
    } catch (error) {
      this.patch({ measurements: null, measurementError: messageOf(error) });
    }
  }

  /** Fetches the planes of the plan's templates. */
  async placeTemplates(): Promise<void> {
    const { plan, landmarks } = this.model.doc;
    for (const { osteotomy } of plan.segments) {
      const request = templateRequest(osteotomy, landmarks);
      if (request === null) continue;
      const key = templateKey(osteotomy, landmarks, stageOf(this.model.s, 'nerve'));
      if (this.model.s.templatePlanes.has(key)) continue;
      const answer = await this.client.placeTemplate(request).catch((error: unknown) => messageOf(error));
      this.patch({ templatePlanes: new Map(this.model.s.templatePlanes).set(key, answer) });
    }
  }

  // Movement

  /** Default pivot of a segment: the centroid of its bone. */
  pivotOf(name: string): Vec3 {
    const { surfaces, s } = this.model;
    const centroid = centroidOf(surfaces.get(`segments/${name}`)?.surface.points);
    return centroid ?? (s.volume ? gridCenter(s.volume.grid) : [0, 0, 0]);
  }

  /** Shows slices beside the bones, through the selected segment. */
  showSlices(on: boolean): void {
    const segment = this.model.doc.plan.segments[this.model.s.segment];
    if (!on || !segment) this.patch({ showSlices: on });
    else {
      const cursor_L = transformPoint(this.poses()[segment.name] ?? IDENTITY, this.pivotOf(segment.name));
      this.patch({ showSlices: on, cursor_L });
    }
  }

  /** The move of a segment at the selected keyframe, else at its last; null if the path is not made of numbers. */
  move(index = this.model.s.segment): Move | null {
    const { doc, s } = this.model;
    const segment = doc.plan.segments[index];
    if (!segment) return null;
    const keyframe = index === s.segment ? s.keyframe : Infinity;
    return moveAt(doc.plan, doc.landmarks, { segment: index, keyframe }, this.pivotOf(segment.name));
  }

  setMove(move: Move, gesture: string | null): void {
    const { doc, s } = this.model;
    this.edit({ plan: withMove(doc.plan, s, move, this.move()) }, gesture);
  }

  /** Moves the segment of the lower teeth to the occlusion of step 9, with the upper jaw where it is planned. */
  async moveToOcclusion(): Promise<void> {
    const pose = (await this.attempt(() => this.client.occlusion()))?.pose;
    const now = this.move();
    if (!pose || !now) return;
    const { segments } = this.model.doc.plan;
    const index = upperJawOf(segments);
    const upper = index < 0 ? null : this.move(index);
    if (index >= 0 && upper === null)
      this.toast(`The path of ${segments[index].name} has no numbers: the occlusion cannot follow it.`, 'error');
    else this.setMove(moveToOcclusion(now, pose, upper), null);
  }

  /** Describes the same motion about another point or landmark. */
  setPivot(about: Vec3 | string): void {
    const { doc, s } = this.model;
    const move = this.move();
    const plan = move && withPivot(doc.plan, doc.landmarks, s, move, about);
    if (plan) this.edit({ plan });
  }

  gizmoMove(from: Move, kind: 'translate' | 'rotate', axis: Vec3, amount: number): Move {
    return draggedMove(from, kind, axis, amount);
  }

  /** Poses of all segments as the views show them. */
  poses(): Record<string, Mat4> {
    const { doc, s } = this.model;
    return posesOf(doc.plan, s.planPoses, s.scrub, (index) => this.move(index));
  }

  /** Poses of the segments that are cut; the server has no others. */
  cutPoses(): Record<string, Mat4> {
    const isCut = ([name]: [string, Mat4]): boolean => this.model.surfaces.has(`segments/${name}`);
    return Object.fromEntries(Object.entries(this.poses()).filter(isCut));
  }
}
