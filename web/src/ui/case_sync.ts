import { ApiError, type CaseEvents, type Client, type Schemas } from '../api';
import { gridCenter, interfaceSurface, toVec3, type Grid, type Surface } from '../model';
import { prepareSurfaceAside } from '../workers';
import type { BoundaryBrush } from './boundary_brush';
import { messageOf } from './errors';
import type { JobTracker } from './job_tracker';
import type { Measures } from './measures';
import type { Outcome } from './outcome';
import type { PlanStore } from './plan_store';
import type { Planner, SceneListeners } from './planner_context';
import type { SolveMonitor } from './solve_monitor';
import { isStepName, isVariantsShown, type LoadedSurface, type State, type StepName } from './state';
import type { Variants } from './variants';

/** Surfaces that a step shows; others are loaded when they are first needed. */
const SURFACES_OF_STEP: Record<StepName, RegExp> = {
  case: /^(skull|skin)$/,
  anatomy: /^(skull|skin)$/,
  landmarks: /^(skull|skin)$/,
  osteotomy: /^(skull|skin|remainder|segments\/.+)$/,
  movement: /^(skull|skin|remainder|segments\/.+)$/,
  tissue: /^(skull|skin|remainder|interface|segments\/.+)$/,
  predict: /^(skull|skin|remainder|segments\/.+)$/,
  compare: /^(skin_before|predicted|after_surgery|band|remainder|segments\/.+|variants\/.+)$/,
  measures:
    /^(skull|(upper|lower)_arch|lower_in_occlusion|splint_(final|intermediate)|nerve_(right|left)|airway|guides\/.+)$/,
};

const VARIANT = 'variants/';

/** Whether a step shows a surface; of the variants only those that are chosen. */
const isShown = (s: State, name: string): boolean =>
  SURFACES_OF_STEP[s.step].test(name) &&
  (!name.startsWith(VARIANT) || (isVariantsShown(s) && s.chosenVariants.includes(name.slice(VARIANT.length))));

export const STEP_KEY = 'lefort-step';

type Context = Pick<Planner, 'model' | 'patch' | 'toast' | 'attempt'> & {
  readonly client: Pick<
    Client,
    'case' | 'jobs' | 'listen' | 'volume' | 'volumeData' | 'surfaces' | 'surface' | 'boundary'
  >;
};

/** The parts of the planner that load their own data when the case changes. */
export interface SyncedParts {
  store: Pick<PlanStore, 'planEtag' | 'landmarksEtag' | 'whenIdle' | 'loadPlan' | 'loadLandmarks'>;
  jobs: Pick<JobTracker, 'onEvent'>;
  solve: Pick<SolveMonitor, 'load' | 'onIterates' | 'onStep'>;
  outcome: Pick<Outcome, 'load'>;
  measures: Pick<Measures, 'load'>;
  variants: Pick<Variants, 'load'>;
  boundary: Pick<BoundaryBrush, 'labels' | 'load' | 'forget' | 'measure'>;
  /** Measures the landmarks. */
  measure(): void;
}

/** Follows the case on the server: its stages, its scan and its surfaces. */
export class CaseSync {
  private volumeEtag: string | null = null;
  private surfaceQueue: Promise<void> = Promise.resolve();

  constructor(
    private readonly planner: Context,
    private readonly parts: SyncedParts,
    private readonly listeners: Pick<SceneListeners, 'onSurface'>,
  ) {}

  async start(signal: AbortSignal): Promise<void> {
    this.planner.model.state.subscribe((state, before) => {
      if (state.step !== before.step) this.onStep(state.step);
      else if (isVariantsShown(state) && (!isVariantsShown(before) || state.chosenVariants !== before.chosenVariants))
        this.loadSurfaces();
    });
    await this.refresh();
    void this.planner.client.listen(
      (kind, event) => this.onEvent(kind, event),
      (isConnected, error) => this.onConnection(isConnected, error),
      signal,
    );
  }

  /** Reads case and jobs, and loads what has changed. */
  async refresh(): Promise<void> {
    const { planner } = this;
    try {
      const [caseInfo, jobs] = await Promise.all([planner.client.case(), planner.client.jobs()]);
      planner.patch({ case: caseInfo, jobs, connection: 'on', fatal: null });
      this.restoreStep(caseInfo);
      await this.onStages(caseInfo.stages);
      await this.parts.solve.load();
    } catch (error) {
      if (error instanceof ApiError && error.status === 0) planner.patch({ connection: 'lost' });
      else planner.patch({ fatal: messageOf(error) });
    }
  }

  /** Reads the case, and loads what has changed. */
  async reload(): Promise<void> {
    const caseInfo = await this.planner.client.case();
    this.planner.patch({ case: caseInfo });
    await this.onStages(caseInfo.stages);
  }

  private onEvent<Kind extends keyof CaseEvents>(kind: Kind, event: CaseEvents[Kind]): void {
    const { jobs, solve } = this.parts;
    if (kind === 'job') jobs.onEvent(event as CaseEvents['job']);
    else if (kind === 'newton') solve.onIterates(event as CaseEvents['newton']);
    else if (kind === 'step') solve.onStep(event as CaseEvents['step']);
    else if (kind === 'case') void this.onStages((event as CaseEvents['case']).stages as Schemas['Case']['stages']);
    else void this.refresh();
  }

  private onConnection(isConnected: boolean, error: ApiError | null): void {
    if (error?.status === 401 || error?.status === 403) this.planner.patch({ fatal: error.message });
    const before = this.planner.model.s.connection;
    this.planner.patch({ connection: isConnected ? 'on' : 'lost' });
    if (isConnected && before === 'lost') void this.refresh();
  }

  private onStep(step: StepName): void {
    this.loadSurfaces();
    if (step === 'compare' || step === 'predict') void this.parts.outcome.load();
    if (step === 'compare') void this.parts.variants.load();
    if (step === 'measures') void this.parts.measures.load();
    if (step === 'landmarks') this.parts.measure();
    if (step === 'tissue') void this.parts.boundary.load();
  }

  private restoreStep(caseInfo: Schemas['Case']): void {
    const step = sessionStorage.getItem(STEP_KEY);
    if (isStepName(step) && caseInfo.scan) this.planner.patch({ step });
  }

  private async onStages(stages: Schemas['Case']['stages']): Promise<void> {
    const { planner } = this;
    const { store, outcome, measures, variants, boundary } = this.parts;
    if (!planner.model.s.case) return;
    planner.patch({ case: { ...planner.model.s.case, stages } });
    // The etag of a save that is still running would look like a change by another page.
    await store.whenIdle();
    if (planner.model.s.case?.stages !== stages) return; // Newer stages have arrived.
    const work: Promise<unknown>[] = [];
    if (stages.scan.etag !== this.volumeEtag) work.push(this.loadVolume(stages.scan.etag));
    if (stages.plan.etag !== null && stages.plan.etag !== store.planEtag) work.push(store.loadPlan());
    if (stages.landmarks.etag !== null && stages.landmarks.etag !== store.landmarksEtag)
      work.push(store.loadLandmarks());
    await Promise.all(work);
    this.loadSurfaces();
    const { step } = planner.model.s;
    if (step === 'compare' || step === 'predict') void outcome.load();
    if (step === 'compare') void variants.load();
    if (step === 'measures') void measures.load();
    if (step === 'tissue' || boundary.labels) void boundary.load();
  }

  private async loadVolume(etag: string | null): Promise<void> {
    const { planner } = this;
    const { client, model } = planner;
    this.volumeEtag = etag;
    model.labels = null;
    model.labelsEtag = null;
    this.parts.boundary.forget();
    planner.patch({ volume: null, volumeLoading: etag !== null, labelsReady: false });
    if (etag === null) return;
    try {
      const [volume, data, caseInfo] = await Promise.all([client.volume(), client.volumeData(), client.case()]);
      if (this.volumeEtag !== etag) return;
      const grid = gridOf(volume);
      planner.patch({
        case: caseInfo,
        volume: { grid, data, presets: volume.presets },
        volumeLoading: false,
        cursor_L: gridCenter(grid),
      });
    } catch (error) {
      planner.patch({ volumeLoading: false });
      if (!(error instanceof ApiError && error.code === 'not_ready')) planner.toast(messageOf(error), 'error');
    }
  }

  /** Loads the surfaces that the step shows and that have changed. */
  private loadSurfaces(): void {
    this.planner.patch({ surfacesLoading: Math.max(1, this.planner.model.s.surfacesLoading) });
    this.surfaceQueue = this.surfaceQueue.then(() => this.loadSurfacesNow());
  }

  private async loadSurfacesNow(): Promise<void> {
    const { planner, parts } = this;
    const { model } = planner;
    const list = await planner.attempt(() => planner.client.surfaces());
    if (!list) {
      planner.patch({ surfacesLoading: 0 });
      return;
    }
    for (const name of [...model.surfaces.keys()])
      if (!list.some((entry) => entry.name === name)) {
        model.surfaces.delete(name);
        this.listeners.onSurface(name, null);
      }
    const needed = list.filter(({ name, etag }) => isShown(model.s, name) && model.surfaces.get(name)?.etag !== etag);
    planner.patch({ surfacesLoading: needed.length });
    await Promise.all(needed.map(({ name, etag }) => this.loadSurface(name, etag)));
    planner.patch({ surfacesLoading: 0 });
    if (needed.length > 0 && parts.boundary.labels) parts.boundary.measure();
  }

  private async loadSurface(name: string, etag: string): Promise<void> {
    const { planner } = this;
    const { model } = planner;
    await planner.attempt(async () => {
      const { shown, ...more } = await this.receiveSurface(name);
      const surface = await prepareSurfaceAside(shown);
      model.surfaces.set(name, { etag, surface, ...more });
      this.listeners.onSurface(name, surface);
    });
    planner.patch({ surfacesLoading: Math.max(0, model.s.surfacesLoading - 1) });
  }

  private async receiveSurface(
    name: string,
  ): Promise<{ shown: Surface } & Pick<LoadedSurface, 'condition' | 'band' | 'gap_mm'>> {
    const { client, model } = this.planner;
    const { points, triangles, scalars } = await client.surface(name);
    if (name === 'band') {
      const values = (array: string): Float32Array =>
        scalars.get(array)?.slice() ?? new Float32Array(points.length / 3);
      const band = { width_mm: values('band_width_mm'), p5_mm: values('p5_mm'), p95_mm: values('p95_mm') };
      return { shown: { points, triangles }, band };
    }
    if (name === 'lower_in_occlusion') return { shown: { points, triangles }, gap_mm: scalars.get('gap_mm')?.slice() };
    if (name !== 'interface') return { shown: { points, triangles } };
    const { rules } = model.s.boundary ?? (await client.boundary());
    const skin = rules.find((rule) => rule.name === 'skin')?.value;
    const ruleOf = scalars.get('rule');
    const condition = Uint8Array.from(scalars.get('condition') ?? []);
    return { shown: interfaceSurface({ points, triangles }, (v) => ruleOf?.[v] === skin), condition };
  }
}

const gridOf = (volume: Schemas['Volume']): Grid => ({
  size: toVec3(volume.size),
  spacing_mm: toVec3(volume.spacing_mm),
  origin_mm: toVec3(volume.origin_mm),
  direction: volume.direction,
});
