import type { Client } from '../api';
import {
  change,
  fromRecord,
  settle,
  startHistory,
  toPlan,
  toRecord,
  withPaintedBoundary,
  type Landmark,
  type Plan,
} from '../model';
import { isConflict, isNotFound, messageOf } from './errors';
import type { Planner } from './planner_context';
import type { Doc, State } from './state';

const SAVE_DELAY_MS = 300;

/** Poses along the path that are fetched with a plan. */
const PATH_POSES = 60;

/** Name of the file of the painted boundary in the plan. */
export const BOUNDARY_FILE = 'boundary.seg.nrrd';

/** The last version of a file that this page read or wrote; etag `*` matches any version. */
interface Persisted<T> {
  value: T;
  etag: string;
}

/** The painted boundary as the store sees it. */
export interface BoundaryFile {
  /** Null while it is not known what the server has. */
  readonly labels: Uint8Array | null;
  readonly isPainted: boolean;
  isUnsaved(): boolean;
  /** Sends the paint; `overwrite`: also if another page changed it. */
  save(overwrite: boolean): Promise<void>;
  removeIfEmpty(): Promise<void>;
  load(discardMine?: boolean): Promise<void>;
  loadRules(): Promise<void>;
}

type StoreClient = Pick<Client, 'plan' | 'landmarks' | 'putPlan' | 'putLandmarks' | 'planPoses'>;
type Context = Pick<Planner, 'model' | 'patch' | 'toast'> & { readonly client: StoreClient };

/** Keeps plan, landmarks and painted boundary equal on the page and on the server. Only one save runs at a time. */
export class PlanStore {
  private plan: Persisted<Plan | null> = { value: null, etag: '*' };
  private landmarks: Persisted<readonly Landmark[] | null> = { value: null, etag: '*' };
  private timer: ReturnType<typeof setTimeout> | undefined;
  private running: Promise<boolean> | null = null;
  /** Whether the user chose to overwrite the paint that another page has saved. */
  private overwritesPaint = false;

  constructor(
    private readonly planner: Context,
    private readonly boundary: BoundaryFile,
  ) {}

  get planEtag(): string {
    return this.plan.etag;
  }

  get landmarksEtag(): string {
    return this.landmarks.etag;
  }

  isUnsaved(): boolean {
    const { plan } = this.planner.model.doc;
    return (
      this.boundary.isUnsaved() || (plan !== this.plan.value && plan.segments.length > 0) || this.areLandmarksUnsaved()
    );
  }

  /** Resolves when no save is running. */
  async whenIdle(): Promise<void> {
    while (this.running) await this.running;
  }

  /** Schedules a save after a change of the document. */
  onDocChanged(doc: Doc, before: Doc): void {
    if (doc.plan === before.plan && doc.landmarks === before.landmarks && doc.paint === before.paint) return;
    const { planner } = this;
    planner.patch({ scrub: null });
    clearTimeout(this.timer);
    if (this.isUnsaved()) {
      if (planner.model.s.saving === 'saved') planner.patch({ saving: 'unsaved' });
      this.timer = setTimeout(() => void this.save(), SAVE_DELAY_MS);
    } else if (planner.model.s.saving === 'unsaved') planner.patch({ saving: 'saved' }); // Undone before the save.
  }

  /** Sends all changes, also those made while it is sending. Returns whether everything is saved. */
  async save(): Promise<boolean> {
    clearTimeout(this.timer);
    await this.whenIdle();
    while (this.isUnsaved() && !this.planner.model.s.conflict) {
      this.running = this.saveNow();
      const isSaved = await this.running;
      this.running = null;
      if (!isSaved) return false;
    }
    return !this.isUnsaved();
  }

  /** Continues after a conflict with the version that the user chose. */
  async resolveConflict(keep: 'mine' | 'theirs'): Promise<void> {
    const { conflict } = this.planner.model.s;
    if (!conflict) return;
    this.planner.patch({ conflict: null });
    if (keep === 'theirs') {
      if (conflict === 'plan') await this.loadPlan(true);
      else if (conflict === 'boundary') await this.boundary.load(true);
      else await this.loadLandmarks(true);
      return;
    }
    if (conflict === 'boundary') this.overwritesPaint = true;
    else this[conflict].etag = '*';
    await this.save();
  }

  /**
   * Saves, then lets the server replace plan and landmarks, and shows them; one undo step restores the earlier ones.
   * `replace` gets the ETag of the plan. Throws if it fails.
   */
  async exchange(replace: (etag: string) => Promise<unknown>): Promise<void> {
    if (!(await this.save())) throw new Error('The plan could not be saved. It was not replaced.');
    let failure: unknown = null;
    // Like a save: new ETags are not taken for changes by another page meanwhile.
    this.running = (async () => {
      try {
        await replace(this.plan.etag);
        const gesture = `exchange ${this.plan.etag}`;
        this.planner.model.history.set(settle(this.planner.model.history.value));
        await this.loadLandmarks(true, gesture);
        await this.loadPlan(true, gesture);
        this.planner.model.history.set(settle(this.planner.model.history.value));
      } catch (error) {
        failure = error;
      }
      return failure === null;
    })();
    await this.running;
    this.running = null;
    if (failure !== null) throw failure;
  }

  /** Reads the plan from the server. Unsaved changes are kept, unless `discardMine`: saving them finds the conflict. */
  async loadPlan(discardMine = false, gesture: string | null = null): Promise<void> {
    if (!discardMine && this.isUnsaved()) return;
    const { planner } = this;
    const { model } = planner;
    try {
      const { value, etag } = await planner.client.plan();
      const plan = toPlan(value);
      this.plan = { value: plan, etag };
      if (model.doc.plan.segments.length === 0 && model.history.value.past.length === 0) {
        model.history.set(startHistory({ ...model.doc, plan }));
      } else if (JSON.stringify(this.planToSave()) !== JSON.stringify(plan)) {
        model.history.set(change(model.history.value, { ...model.doc, plan }, gesture));
        if (gesture === null) planner.toast('The plan was changed on another page. This page now shows the new plan.');
      }
      this.plan.value = model.doc.plan;
      clearTimeout(this.timer);
      planner.patch({ saving: 'saved', saveError: null });
      await this.onPlanStored();
    } catch (error) {
      if (!isNotFound(error)) planner.toast(messageOf(error), 'error');
    }
  }

  /** Reads the landmarks from the server, as `loadPlan` reads the plan. */
  async loadLandmarks(discardMine = false, gesture: string | null = null): Promise<void> {
    if (!discardMine && this.isUnsaved()) return;
    const { planner } = this;
    try {
      const { value, etag } = await planner.client.landmarks();
      const landmarks = fromRecord(value.landmarks);
      const history = planner.model.history.value;
      if (JSON.stringify(toRecord(history.present.landmarks)) === JSON.stringify(toRecord(landmarks))) {
        this.landmarks = { value: history.present.landmarks, etag };
        return;
      }
      this.landmarks = { value: landmarks, etag };
      const next = { ...history.present, landmarks };
      planner.model.history.set(history.past.length === 0 ? startHistory(next) : change(history, next, gesture));
    } catch (error) {
      if (!isNotFound(error)) planner.toast(messageOf(error), 'error');
    }
  }

  private areLandmarksUnsaved(): boolean {
    const { landmarks } = this.planner.model.doc;
    return landmarks !== this.landmarks.value && (landmarks.length > 0 || this.landmarks.value !== null);
  }

  /** The plan with the names of the files of landmarks and paint, as soon as there are any. */
  private planToSave(): Plan {
    const { plan: bare, landmarks } = this.planner.model.doc;
    const plan = this.boundary.labels
      ? withPaintedBoundary(bare, this.boundary.isPainted ? BOUNDARY_FILE : null)
      : bare;
    return landmarks.length > 0 && plan.landmarks === undefined ? { ...plan, landmarks: 'landmarks.mrk.json' } : plan;
  }

  private async saveNow(): Promise<boolean> {
    this.planner.patch({ saving: 'saving' });
    const current: { file: NonNullable<State['conflict']> } = { file: 'landmarks' };
    try {
      await this.sendFiles(current);
      this.planner.patch({ saving: this.isUnsaved() ? 'unsaved' : 'saved', saveError: null });
      return true;
    } catch (error) {
      if (isConflict(error)) this.planner.patch({ saving: 'unsaved', conflict: current.file });
      else this.planner.patch({ saving: 'error', saveError: messageOf(error) });
      return false;
    }
  }

  /** Sends the changed files in the order of their references; `current` is the file that is being sent. */
  private async sendFiles(current: { file: NonNullable<State['conflict']> }): Promise<void> {
    const { boundary } = this;
    const { client, model } = this.planner;
    const { landmarks } = model.doc;
    if (this.areLandmarksUnsaved())
      this.landmarks.etag = await client.putLandmarks({ landmarks: toRecord(landmarks) }, this.landmarks.etag);
    this.landmarks.value = landmarks;
    current.file = 'boundary';
    const isPaintNew = boundary.isUnsaved();
    if (isPaintNew) await boundary.save(this.overwritesPaint);
    current.file = 'plan';
    const { plan } = model.doc;
    if ((plan !== this.plan.value || isPaintNew) && plan.segments.length > 0) {
      // An edit during the request replaces model.doc.plan; the next save sends it.
      this.plan.etag = (await client.putPlan(this.planToSave(), this.plan.etag)).etag;
      this.plan.value = plan;
      await this.onPlanStored();
    }
    current.file = 'boundary';
    if (boundary.isUnsaved() && !boundary.isPainted) await boundary.removeIfEmpty();
    this.overwritesPaint = false;
  }

  private async onPlanStored(): Promise<void> {
    const { model, client } = this.planner;
    if (model.s.step === 'tissue') void this.boundary.loadRules();
    if (model.doc.plan.segments.length === 0) return;
    this.planner.patch({ planPoses: await client.planPoses(PATH_POSES).catch(() => null) });
  }
}
