import { ApiError, type Client, type Depths, type Schemas } from '../api';
import {
  change,
  fromRecord,
  toRecord,
  moveOf,
  poseOf,
  redo,
  settle,
  startHistory,
  undo,
  gridCenter,
  transformPoint,
  IDENTITY,
  translated,
  rotated,
  changePivot,
  editKeyframe,
  keyframesOf,
  withPaintedBoundary,
  isEditablePath,
  templateKind,
  type DrawnSurface,
  type Grid,
  type History,
  type Landmark,
  type Mat4,
  type Move,
  type Plan,
  type Vec3,
} from '../model';
import { prepareSurfaceAside } from '../workers';
import { BOUNDARY_FILE, BoundaryBrush } from './boundary_brush';
import { LabelBrush } from './label_brush';
import { LiveQueries } from './live_queries';
import { Outcome } from './outcome';
import { SolveMonitor } from './solve_monitor';
import { Model, stageOf, type Doc, type StepName } from './state';

/** How deep bones may overlap before a plan is marked: the limit of `lefort plan check` [mm]. */
export const OVERLAP_LIMIT_MM = 0.5;

const SAVE_AFTER_MS = 300;

/** Surfaces a step shows; others are fetched when they are first needed. */
const WANTED: Record<StepName, RegExp> = {
  case: /^(skull|skin)$/,
  anatomy: /^(skull|skin)$/,
  landmarks: /^(skull|skin)$/,
  osteotomy: /^(skull|skin|remainder|segments\/.+)$/,
  movement: /^(skull|skin|remainder|segments\/.+)$/,
  tissue: /^(skull|skin|remainder|segments\/.+)$/,
  predict: /^(skull|skin|remainder|segments\/.+)$/,
  compare: /^(skin_before|predicted|after_surgery|remainder|segments\/.+)$/,
};

export interface SceneListeners {
  /** A surface came or went. */
  onSurface(name: string, surface: DrawnSurface | null): void;
  onDepths(depths: Depths | null): void;
  /** Displacement of the skin; null takes it back. */
  onPreview(xyz: Float32Array | null): void;
  onLabels(): void;
  /** What is painted on the tissue's boundary has changed. */
  onPaint(): void;
}

/** What a person can do, and what the server says. The only place that calls the server. */
export class App {
  readonly model = new Model();
  readonly outcome = new Outcome(this);
  private readonly solve = new SolveMonitor(this);
  readonly live: LiveQueries;
  readonly labelBrush: LabelBrush;
  readonly boundaryBrush: BoundaryBrush;
  private readonly aborter = new AbortController();
  private etags: { plan: string; landmarks: string } = { plan: '*', landmarks: '*' };
  private stored: { plan: Plan | null; landmarks: readonly Landmark[] | null } = { plan: null, landmarks: null };
  private saveTimer = 0;
  private saveRunning: Promise<void> | null = null;
  private volumeEtag: string | null = null;
  /** What another page painted was seen, and is to be replaced. */
  private overwrites = false;
  private toastId = 0;
  private readonly whenDone = new Map<number, () => void>();
  private surfaceQueue: Promise<void> = Promise.resolve();

  constructor(
    readonly client: Client,
    private readonly listeners: SceneListeners,
  ) {
    this.live = new LiveQueries(this, listeners);
    this.labelBrush = new LabelBrush(this, listeners);
    this.boundaryBrush = new BoundaryBrush(this, listeners);
    // Before whoever draws it: what is selected must be there.
    this.model.history.subscribe((history, before) => this.onDocChanged(history, before));
  }

  // The life of the page

  async start(): Promise<void> {
    const { model } = this;
    model.state.subscribe((state, before) => {
      if (state.step !== before.step) {
        this.loadSurfaces();
        if (state.step === 'compare' || state.step === 'predict') void this.outcome.load();
        if (state.step === 'landmarks') void this.measure();
        if (state.step === 'tissue') void this.boundaryBrush.load();
      }
    });
    await this.refresh();
    void this.client.listen(
      (kind, event) => {
        if (kind === 'job') this.onJob(event as Schemas['JobEvent']);
        else if (kind === 'newton') this.solve.onIterates(event as Schemas['NewtonEvent']);
        else if (kind === 'step') this.solve.onStep(event as Schemas['StepEvent']);
        else if (kind === 'case') this.onStages((event as Schemas['CaseEvent']).stages as Schemas['Case']['stages']);
        else void this.refresh();
      },
      (connected, error) => {
        if (error?.status === 401 || error?.status === 403) this.patch({ fatal: error.message });
        const was = model.s.connection;
        this.patch({ connection: connected ? 'on' : 'lost' });
        if (connected && was === 'lost') void this.refresh();
      },
      this.aborter.signal,
    );
  }

  stop(): void {
    this.aborter.abort();
  }

  patch(part: Parameters<Model['state']['patch']>[0]): void {
    this.model.state.patch(part);
  }

  toast(text: string, kind: 'info' | 'error' = 'info'): void {
    const id = ++this.toastId;
    this.patch({ toasts: [...this.model.s.toasts, { id, kind, text }].slice(-4) });
    setTimeout(() => this.dismiss(id), kind === 'error' ? 12000 : 4500);
  }

  dismiss(id: number): void {
    this.patch({ toasts: this.model.s.toasts.filter((toast) => toast.id !== id) });
  }

  /** Runs something that may be refused; the refusal is shown. */
  async attempt<T>(work: () => Promise<T>): Promise<T | null> {
    try {
      return await work();
    } catch (error) {
      this.toast(messageOf(error), 'error');
      return null;
    }
  }

  private async refresh(): Promise<void> {
    try {
      const [caseInfo, jobs] = await Promise.all([this.client.case(), this.client.jobs()]);
      this.patch({ case: caseInfo, jobs, connection: 'on', fatal: null });
      this.restoreStep(caseInfo);
      await this.onStages(caseInfo.stages);
      await this.solve.load();
    } catch (error) {
      if (error instanceof ApiError && error.status === 0) this.patch({ connection: 'lost' });
      else this.patch({ fatal: messageOf(error) });
    }
  }

  private restoreStep(caseInfo: Schemas['Case']): void {
    const kept = sessionStorage.getItem('lefort-step') as StepName | null;
    if (kept && caseInfo.scan) this.patch({ step: kept });
  }

  setStep(step: StepName): void {
    sessionStorage.setItem('lefort-step', step);
    this.patch({
      step,
      tool: 'none',
      curveDraft: null,
      scrub: null,
      thresholdOn: step === 'anatomy' ? this.model.s.thresholdOn : false,
    });
  }

  private async onStages(stages: Schemas['Case']['stages']): Promise<void> {
    const { s } = this.model;
    if (!s.case) return;
    this.patch({ case: { ...s.case, stages } });
    // What this page is just keeping would look as if another one had changed it.
    while (this.saveRunning) await this.saveRunning;
    if (this.model.s.case?.stages !== stages) return; // Newer ones came meanwhile.
    const work: Promise<unknown>[] = [];
    if (stages.scan.etag !== this.volumeEtag) work.push(this.loadVolume(stages.scan.etag));
    if (stages.plan.etag !== null && stages.plan.etag !== this.etags.plan) work.push(this.loadPlan());
    if (stages.landmarks.etag !== null && stages.landmarks.etag !== this.etags.landmarks)
      work.push(this.loadLandmarks());
    await Promise.all(work);
    this.loadSurfaces();
    if (this.model.s.step === 'compare' || this.model.s.step === 'predict') void this.outcome.load();
    if (this.model.s.step === 'tissue' || this.boundaryBrush.labels) void this.boundaryBrush.load();
  }

  /** Looks at everything anew, after something was changed past the page's own ways. */
  async reload(): Promise<void> {
    const caseInfo = await this.client.case();
    this.patch({ case: caseInfo });
    await this.onStages(caseInfo.stages);
  }

  // What the server has

  private async loadVolume(etag: string | null): Promise<void> {
    this.volumeEtag = etag;
    this.model.labels = null;
    this.model.labelsEtag = null;
    this.boundaryBrush.forget();
    this.patch({ volume: null, volumeLoading: etag !== null, labelsReady: false });
    if (etag === null) return;
    try {
      const [volume, data, caseInfo] = await Promise.all([
        this.client.volume(),
        this.client.volumeData(),
        this.client.case(),
      ]);
      if (this.volumeEtag !== etag) return;
      const grid: Grid = {
        size: volume.size as unknown as Vec3,
        spacing_mm: volume.spacing_mm as unknown as Vec3,
        origin_mm: volume.origin_mm as unknown as Vec3,
        direction: volume.direction,
      };
      this.patch({
        case: caseInfo,
        volume: { grid, data, presets: volume.presets },
        volumeLoading: false,
        cursor_L: gridCenter(grid),
      });
    } catch (error) {
      this.patch({ volumeLoading: false });
      if (!(error instanceof ApiError && error.code === 'not_ready')) this.toast(messageOf(error), 'error');
    }
  }

  /** Fetches those of the server's surfaces that the step shows and that have changed. */
  private loadSurfaces(): void {
    this.patch({ surfacesLoading: Math.max(1, this.model.s.surfacesLoading) });
    this.surfaceQueue = this.surfaceQueue.then(() => this.loadSurfacesNow());
  }

  private async loadSurfacesNow(): Promise<void> {
    const { model } = this;
    const list = await this.attempt(() => this.client.surfaces());
    if (!list) {
      this.patch({ surfacesLoading: 0 });
      return;
    }
    for (const name of [...model.surfaces.keys()])
      if (!list.some((entry) => entry.name === name)) {
        model.surfaces.delete(name);
        this.listeners.onSurface(name, null);
      }
    const wanted = list.filter(
      (entry) => WANTED[model.s.step].test(entry.name) && model.surfaces.get(entry.name)?.etag !== entry.etag,
    );
    this.patch({ surfacesLoading: wanted.length });
    await Promise.all(
      wanted.map(async ({ name, etag }) => {
        await this.attempt(async () => {
          const { points, triangles } = await this.client.surface(name);
          const surface = await prepareSurfaceAside({ points, triangles });
          model.surfaces.set(name, { etag, surface });
          this.listeners.onSurface(name, surface);
        });
        this.patch({ surfacesLoading: Math.max(0, model.s.surfacesLoading - 1) });
      }),
    );
    this.patch({ surfacesLoading: 0 });
    if (wanted.length > 0 && this.boundaryBrush.labels) this.boundaryBrush.measure();
  }

  /** Where the tissue's boundary is painted: bones as cut, else the skull, and the skin. */
  boundarySurfaces(): [string, { surface: DrawnSurface }][] {
    const { surfaces } = this.model;
    const isCut = surfaces.has('remainder');
    return [...surfaces].filter(
      ([name]) => name === 'skin' || (isCut ? name === 'remainder' || name.startsWith('segments/') : name === 'skull'),
    );
  }

  private async loadPlan(replacesMine = false): Promise<void> {
    // Changes of both pages: keeping this one's finds the conflict, and the person decides.
    if (!replacesMine && this.isUnsaved()) return;
    try {
      const { value, etag } = await this.client.plan();
      this.etags.plan = etag;
      const plan = value as unknown as Plan;
      const { plan: mine } = this.model.doc;
      this.stored.plan = plan;
      if (mine.segments.length === 0 && this.model.history.value.past.length === 0) {
        this.model.history.set(startHistory({ ...this.model.doc, plan }));
      } else if (JSON.stringify(this.planToSave()) !== JSON.stringify(plan)) {
        this.model.history.set(change(this.model.history.value, { ...this.model.doc, plan }));
        this.toast('The plan was changed elsewhere; this page now shows that.');
      }
      this.stored.plan = this.model.doc.plan;
      clearTimeout(this.saveTimer);
      this.patch({ saving: 'saved', saveError: null });
      await this.afterPlanSaved();
    } catch (error) {
      if (!isNotFound(error)) this.toast(messageOf(error), 'error');
    }
  }

  private async loadLandmarks(replacesMine = false): Promise<void> {
    if (!replacesMine && this.isUnsaved()) return;
    try {
      const { value, etag } = await this.client.landmarks();
      this.etags.landmarks = etag;
      const landmarks = fromRecord(value.landmarks as unknown as Record<string, Vec3>);
      const history = this.model.history.value;
      if (JSON.stringify(toRecord(history.present.landmarks)) === JSON.stringify(toRecord(landmarks))) {
        this.stored.landmarks = history.present.landmarks;
        return;
      }
      this.stored.landmarks = landmarks;
      const next = { ...history.present, landmarks };
      this.model.history.set(history.past.length === 0 ? startHistory(next) : change(history, next));
      void this.measure();
    } catch (error) {
      if (!isNotFound(error)) this.toast(messageOf(error), 'error');
    }
  }

  // Undo and redo

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

  private onDocChanged({ present }: History<Doc>, { present: before }: History<Doc>): void {
    if (present.strokes !== before.strokes) this.labelBrush.apply(present.strokes);
    if (present.paint !== before.paint) this.boundaryBrush.apply(present.paint);
    if (present.plan !== before.plan || present.landmarks !== before.landmarks || present.paint !== before.paint) {
      this.patch({ scrub: null });
      clearTimeout(this.saveTimer);
      if (this.isUnsaved()) {
        if (this.model.s.saving === 'saved') this.patch({ saving: 'unsaved' });
        this.saveTimer = window.setTimeout(() => void this.save(), SAVE_AFTER_MS);
      } else if (this.model.s.saving === 'unsaved') this.patch({ saving: 'saved' }); // Undone before it was kept.
    }
    if (present.landmarks !== before.landmarks) void this.measure();
    const count = present.plan.segments.length;
    if (this.model.s.segment >= count) this.patch({ segment: Math.max(0, count - 1), plane: null, keyframe: 0 });
    const segment = present.plan.segments[this.model.s.segment];
    const keyframes = segment ? keyframesOf(segment).length : 0;
    if (this.model.s.keyframe >= Math.max(1, keyframes)) this.patch({ keyframe: Math.max(0, keyframes - 1) });
    if (this.model.s.plane !== null && this.model.s.plane >= (segment?.osteotomy.planes?.length ?? 0))
      this.patch({ plane: null });
  }

  // Keeping

  private isUnsaved(): boolean {
    const { plan, landmarks } = this.model.doc;
    return (
      this.boundaryBrush.isUnsaved() ||
      (plan !== this.stored.plan && plan.segments.length > 0) ||
      (landmarks !== this.stored.landmarks && (landmarks.length > 0 || this.stored.landmarks !== null))
    );
  }

  /** The plan as it is kept: the files of landmarks and of what is painted are named as soon as there are any. */
  private planToSave(): Plan {
    const { plan: bare, landmarks } = this.model.doc;
    const plan = this.boundaryBrush.labels
      ? withPaintedBoundary(bare, this.boundaryBrush.isPainted ? BOUNDARY_FILE : null)
      : bare;
    return landmarks.length > 0 && plan.landmarks === undefined ? { ...plan, landmarks: 'landmarks.mrk.json' } : plan;
  }

  /** Sends what has changed; a second call waits for the first. */
  async save(): Promise<boolean> {
    clearTimeout(this.saveTimer);
    while (this.saveRunning) await this.saveRunning;
    if (!this.isUnsaved() || this.model.s.conflict) return !this.isUnsaved();
    this.saveRunning = this.saveNow();
    await this.saveRunning;
    this.saveRunning = null;
    return this.model.s.saving === 'saved';
  }

  private async saveNow(): Promise<void> {
    this.patch({ saving: 'saving' });
    let what: 'plan' | 'landmarks' | 'boundary' = 'landmarks';
    try {
      const { landmarks, plan } = this.model.doc;
      if (landmarks !== this.stored.landmarks && !(landmarks.length === 0 && this.stored.landmarks === null)) {
        this.etags.landmarks = await this.client.putLandmarks(
          { landmarks: toRecord(landmarks) as never },
          this.etags.landmarks,
        );
      }
      this.stored.landmarks = landmarks;
      what = 'boundary';
      const isPaintNew = this.boundaryBrush.isUnsaved();
      if (isPaintNew) await this.boundaryBrush.save(this.overwrites);
      what = 'plan';
      if ((plan !== this.stored.plan || isPaintNew) && plan.segments.length > 0) {
        const answer = await this.client.putPlan(this.planToSave(), this.etags.plan);
        this.etags.plan = answer.etag;
        this.stored.plan = plan;
        await this.afterPlanSaved();
      }
      what = 'boundary';
      if (this.boundaryBrush.isUnsaved() && !this.boundaryBrush.isPainted) await this.boundaryBrush.removeIfEmpty();
      this.overwrites = false;
      this.patch({ saving: 'saved', saveError: null });
    } catch (error) {
      if (error instanceof ApiError && error.status === 412) this.patch({ saving: 'unsaved', conflict: what });
      else this.patch({ saving: 'error', saveError: messageOf(error) });
    }
  }

  /** Two pages changed the same: the person says whose stays. */
  async resolveConflict(keep: 'mine' | 'theirs'): Promise<void> {
    const what = this.model.s.conflict;
    if (!what) return;
    this.patch({ conflict: null });
    if (keep === 'theirs') {
      if (what === 'plan') await this.loadPlan(true);
      else if (what === 'boundary') await this.boundaryBrush.load(true);
      else await this.loadLandmarks(true);
      return;
    }
    if (what === 'boundary') this.overwrites = true;
    else this.etags[what] = '*';
    await this.save();
  }

  private async afterPlanSaved(): Promise<void> {
    if (this.model.s.step === 'tissue') void this.boundaryBrush.loadRules();
    const { segments } = this.model.doc.plan;
    const steps = segments.length > 0 ? 60 : 0;
    if (steps) this.patch({ planPoses: await this.client.planPoses(steps).catch(() => null) });
  }

  // Jobs

  async run(request: Schemas['JobRequest'], then?: () => void): Promise<void> {
    await this.attempt(async () => {
      if (
        !(await this.save()) &&
        this.model.doc.plan.segments.length > 0 &&
        request.kind !== 'import' &&
        request.kind !== 'segment'
      ) {
        throw new Error(this.model.s.saveError ?? 'The plan could not be kept, so nothing was started.');
      }
      const job = await this.client.startJob(request);
      if (then) this.whenDone.set(job.id, then);
      this.putJob(job);
    });
  }

  async stopJob(id: number): Promise<void> {
    await this.attempt(() => this.client.stopJob(id));
  }

  private putJob(job: Schemas['Job']): void {
    const others = this.model.s.jobs.filter((old) => old.id !== job.id);
    this.patch({ jobs: [...others, job].sort((a, b) => a.id - b.id) });
  }

  private onJob(event: Schemas['JobEvent']): void {
    const old = this.model.s.jobs.find((job) => job.id === event.id);
    if (old)
      this.putJob({
        ...old,
        state: event.state,
        stage: event.stage,
        fraction: event.fraction,
        message: event.message,
        lines: event.line === null ? old.lines : [...old.lines, event.line].slice(-200),
      });
    if (event.state === 'running' && old?.state !== 'running' && event.kind === 'predict') this.solve.begin(event.id);
    const ended = event.state !== 'queued' && event.state !== 'running';
    if (!old || ended) {
      void this.attempt(async () => {
        this.putJob(await this.client.job(event.id));
        if (!ended) return;
        if (event.state === 'failed') this.toast(`${JOB_NAMES[event.kind]} failed: ${event.message}`, 'error');
        const then = this.whenDone.get(event.id);
        this.whenDone.delete(event.id);
        const caseInfo = await this.client.case();
        this.patch({ case: caseInfo });
        await this.onStages(caseInfo.stages);
        if (event.state === 'done') then?.();
      });
    }
  }

  /** Hands files over to the server; null if that was refused, which has been shown. */
  async upload(files: readonly File[]): Promise<string | null> {
    const limits = this.model.s.case?.limits;
    if (files.length === 0) return null;
    const tooLarge = files.find((file) => limits && file.size > limits.upload_file_bytes);
    if (limits && files.length > limits.upload_files) {
      this.toast(`These are ${files.length} files; a scan may have ${limits.upload_files}.`, 'error');
      return null;
    }
    if (tooLarge) {
      this.toast('One of the files is larger than the server takes.', 'error');
      return null;
    }
    const total = files.reduce((sum, file) => sum + file.size, 0) || 1;
    const name = files.length === 1 ? 'one file' : `${files.length} files`;
    this.patch({ upload: { name, share: 0 } });
    const id = await this.attempt(() =>
      this.client.upload(files, (sent) => this.patch({ upload: { name, share: sent / total } })),
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

  /** A scan is of use when its tissues are told apart, so that is begun at once. */
  private afterImport(): void {
    if (stageOf(this.model.s, 'anatomy').state !== 'fresh') void this.run({ kind: 'segment' });
    this.setStep('anatomy');
  }

  // Landmarks

  private measureTimer = 0;

  private async measure(): Promise<void> {
    clearTimeout(this.measureTimer);
    this.measureTimer = window.setTimeout(async () => {
      const { landmarks } = this.model.doc;
      if (landmarks.length === 0) {
        this.patch({ measurements: null, measurementError: null });
        return;
      }
      try {
        this.patch({ measurements: await this.client.measure(toRecord(landmarks) as never), measurementError: null });
      } catch (error) {
        this.patch({ measurements: null, measurementError: messageOf(error) });
      }
    }, 250);
  }

  // Tissues

  /** Tells tissues apart anew. The plan remembers the threshold, so that a prediction sees the same bone. */
  async segment(bone_hu: number): Promise<void> {
    const { plan } = this.model.doc;
    const kept = { ...plan.segmentation, bone_hu };
    delete kept.labels;
    if (plan.segmentation?.bone_hu !== bone_hu || plan.segmentation.labels !== undefined)
      this.edit({ plan: { ...plan, segmentation: kept } });
    await this.run({ kind: 'segment', bone_hu });
  }

  // Osteotomies

  async placeTemplates(): Promise<void> {
    const { plan, landmarks } = this.model.doc;
    const points = toRecord(landmarks);
    for (const segment of plan.segments) {
      const { template } = segment.osteotomy;
      if (template === undefined || templateKind(segment.osteotomy) === null) continue;
      const key = templateKey(segment.osteotomy.template, landmarks);
      if (this.model.s.templatePlanes.has(key)) continue;
      const answer = await this.client
        .placeTemplate({ template: template as never, landmarks: points as never })
        .catch((error: unknown) => messageOf(error));
      this.patch({ templatePlanes: new Map(this.model.s.templatePlanes).set(key, answer) });
    }
  }

  // Movement

  /** Where a segment turns unless told otherwise: the middle of its bone. */
  pivotOf(name: string): Vec3 {
    const known = this.model.surfaces.get(`segments/${name}`)?.surface.points;
    if (!known || known.length === 0) return this.model.s.volume ? gridCenter(this.model.s.volume.grid) : [0, 0, 0];
    const sum = [0, 0, 0];
    for (let n = 0; n < known.length; n++) sum[n % 3] += known[n];
    return sum.map((c) => Math.round((10 * c * 3) / known.length) / 10) as unknown as Vec3;
  }

  /** Slices beside the bones, through the one in hand. */
  showSlices(on: boolean): void {
    const segment = this.model.doc.plan.segments[this.model.s.segment];
    this.patch({
      showSlices: on,
      ...(on && segment
        ? { cursor_L: transformPoint(this.poses()[segment.name] ?? IDENTITY, this.pivotOf(segment.name)) }
        : {}),
    });
  }

  /** The move of a segment at the keyframe in hand; null if numbers cannot say it. */
  move(index = this.model.s.segment): Move | null {
    const segment = this.model.doc.plan.segments[index];
    if (!segment || !isEditablePath(segment.path)) return null;
    const keyframes = keyframesOf(segment);
    const k = index === this.model.s.segment ? this.model.s.keyframe : keyframes.length - 1;
    const keyframe = keyframes[Math.min(k, keyframes.length - 1)];
    if (!keyframe) return null;
    const named = keyframe.about
      ? this.model.doc.landmarks.find((l) => l.name === keyframe.about)?.position_mm
      : undefined;
    return moveOf(named ? { ...keyframe, about_mm: named } : keyframe, this.pivotOf(segment.name));
  }

  setMove(move: Move, gesture: string | null): void {
    const { plan } = this.model.doc;
    const { segment, keyframe } = this.model.s;
    const old = keyframesOf(plan.segments[segment])[keyframe];
    const round = (v: Vec3): Vec3 => v.map((c) => Math.round(c * 1000) / 1000 + 0) as unknown as Vec3;
    const next = { ...old, translation_mm: round(move.translation_mm) };
    const turns = move.rotation_deg.some((c) => Math.abs(c) > 5e-4);
    if (turns) Object.assign(next, { rotation_deg: round(move.rotation_deg) });
    else delete next.rotation_deg;
    if (old.about !== undefined && move.about_mm === this.move()?.about_mm) delete next.about_mm;
    else if (turns || old.about_mm !== undefined) {
      delete next.about;
      next.about_mm = round(move.about_mm);
    }
    this.edit({ plan: editKeyframe(plan, segment, keyframe, next) }, gesture);
  }

  /** Tells the same motion about another point. */
  setPivot(about: Vec3 | string): void {
    const move = this.move();
    if (!move) return;
    const { plan, landmarks } = this.model.doc;
    const { segment, keyframe } = this.model.s;
    const point = typeof about === 'string' ? landmarks.find((l) => l.name === about)?.position_mm : about;
    if (!point) return;
    const next = changePivot(move, point);
    const old = { ...keyframesOf(plan.segments[segment])[keyframe], translation_mm: next.translation_mm };
    delete old.about;
    delete old.about_mm;
    this.edit({
      plan: editKeyframe(plan, segment, keyframe, {
        ...old,
        ...(typeof about === 'string' ? { about } : { about_mm: point }),
      }),
    });
  }

  gizmoMove(from: Move, kind: 'translate' | 'rotate', axis: Vec3, amount: number): Move {
    const rounded = Math.round(amount * 10) / 10;
    const by = axis.map((c) => c * rounded) as unknown as Vec3;
    return kind === 'translate' ? translated(from, by) : rotated(from, by);
  }

  /** Poses of all segments as they stand on the screen. */
  poses(): Record<string, Mat4> {
    const { scrub, planPoses } = this.model.s;
    const out: Record<string, Mat4> = {};
    this.model.doc.plan.segments.forEach((segment, index) => {
      const kept = planPoses?.segments[segment.name];
      if (scrub !== null && kept && planPoses) out[segment.name] = kept[Math.round(scrub * planPoses.count)];
      else {
        const move = this.move(index);
        if (move) out[segment.name] = poseOf(move);
        else if (kept) out[segment.name] = kept[kept.length - 1];
      }
    });
    return out;
  }

  /** Only those whose bone is cut: the server knows no others. */
  cutPoses(): Record<string, Mat4> {
    return Object.fromEntries(
      Object.entries(this.poses()).filter(([name]) => this.model.surfaces.has(`segments/${name}`)),
    );
  }

  async download(name: string): Promise<void> {
    await this.attempt(async () => saveBlob(await this.client.file(name), name));
  }
}

export const JOB_NAMES: Record<Schemas['JobKind'], string> = {
  import: 'Reading the scan',
  segment: 'Telling tissues apart',
  cut: 'Cutting the bone',
  check: 'Checking the plan',
  'preview-factor': 'Preparing the preview',
  predict: 'Predicting the face',
  compare: 'Comparing',
};

export const templateKey = (template: unknown, landmarks: readonly Landmark[]): string =>
  JSON.stringify([template, toRecord(landmarks)]);

export const messageOf = (error: unknown): string => (error instanceof Error ? error.message : String(error));

export const isNotFound = (error: unknown): boolean =>
  error instanceof ApiError && (error.code === 'not_found' || error.code === 'not_ready');

export function saveBlob(blob: Blob, name: string): void {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
