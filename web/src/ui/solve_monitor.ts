import type { Schemas } from '../api';
import { mergeStream, type Stream } from '../model';
import type { Planner } from './planner_context';
import { lastJob, type NewtonPoint } from './state';

/** What a solve tells while it runs; a page that comes in the middle is stream what was before. */
export class SolveMonitor {
  private stream: Stream<NewtonPoint> | null = null;
  private asking = false;

  constructor(private readonly planner: Planner) {}

  /** A solve has begun. */
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

  /** All that the last solve has stream so far, if this server has run it. */
  async load(): Promise<void> {
    const job = lastJob(this.planner.model.s, 'predict');
    if (!job || this.asking) return;
    this.asking = true;
    const history = await this.planner.client.solveHistory(job.id).catch(() => null);
    this.asking = false;
    if (history) this.show({ job: history.job, from: history.from, points: history.iterates }, history.steps);
  }

  private show(stream: Stream<NewtonPoint>, steps: readonly Schemas['StepEvent'][]): void {
    this.stream = stream;
    this.planner.patch({ newton: stream.points, steps });
  }
}
