import type { Schemas } from '../api';
import { mergeStream, type Stream } from '../model';
import type { Planner } from './planner_context';
import { lastJob, type NewtonPoint } from './state';

/** Receives the iterations of a running solve; a page that is opened later reads the earlier ones. */
export class SolveMonitor {
  private stream: Stream<NewtonPoint> | null = null;
  private isLoading = false;

  constructor(private readonly planner: Planner) {}

  /** Starts a new solve. */
  begin(job: number): void {
    if (this.stream?.job !== job) this.show({ job, from: 0, points: [] }, []);
  }

  onIterates({ job, from, iterates }: Schemas['NewtonEvent']): void {
    const joined = mergeStream(this.stream, { job, from, points: iterates });
    if (joined) this.show(joined, this.stream?.job === job ? this.planner.model.s.steps : []);
    else void this.load();
  }

  onStep(step: Schemas['StepEvent']): void {
    const { steps } = this.planner.model.s;
    if (this.stream?.job !== step.job) void this.load();
    else if (!steps.some((known) => known.share === step.share)) this.planner.patch({ steps: [...steps, step] });
  }

  /** Reads all iterations of the last solve, if this server has run it. */
  async load(): Promise<void> {
    const job = lastJob(this.planner.model.s, 'predict');
    if (!job || this.isLoading) return;
    this.isLoading = true;
    const history = await this.planner.client.solveHistory(job.id).catch(() => null);
    this.isLoading = false;
    if (history) this.show({ job: history.job, from: history.from, points: history.iterates }, history.steps);
  }

  private show(stream: Stream<NewtonPoint>, steps: readonly Schemas['StepEvent'][]): void {
    this.stream = stream;
    this.planner.patch({ newton: stream.points, steps });
  }
}
