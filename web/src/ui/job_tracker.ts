import type { Client, Schemas } from '../api';
import type { Planner } from './planner_context';

export const JOB_NAMES: Record<Schemas['JobKind'], string> = {
  import: 'Reading the scan',
  segment: 'Segmenting tissues',
  landmarks: 'Finding landmarks',
  cut: 'Cutting the bone',
  check: 'Checking the plan',
  'preview-factor': 'Preparing the preview',
  predict: 'Predicting the face',
  compare: 'Comparing',
  uncertainty: 'Computing the band',
  teeth: 'Numbering the teeth',
  arches: 'Registering intraoral scans',
  occlusion: 'Finding the occlusion',
  splint: 'Making a splint',
  nerve: 'Tracing the canals',
  guides: 'Making cutting guides',
  airway: 'Measuring the airway',
  cephalogram: 'Computing the cephalogram',
  variants: 'Putting variants side by side',
};

/** Jobs that do not read the plan. */
const WITHOUT_PLAN: ReadonlySet<Schemas['JobKind']> = new Set(['import', 'segment', 'landmarks'] as const);

/** Lines of output that are kept of each job. */
const MAX_LINES = 200;

type Context = Pick<Planner, 'model' | 'patch' | 'toast' | 'attempt' | 'reload'> & {
  readonly client: Pick<Client, 'job' | 'startJob' | 'stopJob'>;
};

/** Starts jobs on the server and keeps their state up to date. */
export class JobTracker {
  private readonly callbacks = new Map<number, () => void>();

  constructor(
    private readonly planner: Context,
    /** Saves the plan before a job; returns whether everything is saved. */
    private readonly save: () => Promise<boolean>,
    /** A prediction has begun. */
    private readonly onSolveBegin: (job: number) => void,
  ) {}

  async run(request: Schemas['JobRequest'], then?: () => void): Promise<void> {
    const { planner } = this;
    await planner.attempt(async () => {
      const isSaved = await this.save();
      const needsPlan = !WITHOUT_PLAN.has(request.kind);
      if (!isSaved && needsPlan && planner.model.doc.plan.segments.length > 0)
        throw new Error(planner.model.s.saveError ?? 'The plan could not be saved. The job was not started.');
      const job = await planner.client.startJob(request);
      if (then) this.callbacks.set(job.id, then);
      this.put(job);
    });
  }

  async stop(id: number): Promise<void> {
    await this.planner.attempt(() => this.planner.client.stopJob(id));
  }

  onEvent(event: Schemas['JobEvent']): void {
    const old = this.planner.model.s.jobs.find((job) => job.id === event.id);
    if (old) {
      const { state, stage, fraction, message, line } = event;
      const lines = line === null ? old.lines : [...old.lines, line].slice(-MAX_LINES);
      this.put({ ...old, state, stage, fraction, message, lines });
    }
    if (event.state === 'running' && old?.state !== 'running' && event.kind === 'predict') this.onSolveBegin(event.id);
    const hasEnded = event.state !== 'queued' && event.state !== 'running';
    if (!old || hasEnded) void this.planner.attempt(() => this.fetch(event, hasEnded));
  }

  private async fetch(event: Schemas['JobEvent'], hasEnded: boolean): Promise<void> {
    const { planner } = this;
    this.put(await planner.client.job(event.id));
    if (!hasEnded) return;
    if (event.state === 'failed') planner.toast(`${JOB_NAMES[event.kind]} failed: ${event.message}`, 'error');
    const then = this.callbacks.get(event.id);
    this.callbacks.delete(event.id);
    await planner.reload();
    if (event.state === 'done') then?.();
  }

  private put(job: Schemas['Job']): void {
    const others = this.planner.model.s.jobs.filter((old) => old.id !== job.id);
    this.planner.patch({ jobs: [...others, job].sort((a, b) => a.id - b.id) });
  }
}
