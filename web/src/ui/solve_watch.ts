import type { Schemas } from '../api';
import { joinTold, type Told } from '../model';
import type { App } from './app';
import { lastJob, type NewtonPoint } from './state';

/** What a solve tells while it runs; a page that comes in the middle is told what was before. */
export class SolveWatch {
  private told: Told<NewtonPoint> | null = null;
  private asking = false;

  constructor(private readonly app: App) {}

  /** A solve has begun. */
  begin(job: number): void {
    if (this.told?.job !== job) this.show({ job, from: 0, points: [] }, []);
  }

  onIterates({ job, from, iterates }: Schemas['NewtonEvent']): void {
    const joined = joinTold(this.told, { job, from, points: iterates });
    if (joined) this.show(joined, this.told?.job === job ? this.app.model.s.steps : []);
    else void this.load();
  }

  onStep(step: Schemas['StepEvent']): void {
    const { steps } = this.app.model.s;
    if (this.told?.job !== step.job) void this.load();
    else if (!steps.some((known) => known.share === step.share)) this.app.patch({ steps: [...steps, step] });
  }

  /** All that the last solve has told so far, if this server has run it. */
  async load(): Promise<void> {
    const job = lastJob(this.app.model.s, 'predict');
    if (!job || this.asking) return;
    this.asking = true;
    const history = await this.app.client.solveHistory(job.id).catch(() => null);
    this.asking = false;
    if (history) this.show({ job: history.job, from: history.from, points: history.iterates }, history.steps);
  }

  private show(told: Told<NewtonPoint>, steps: readonly Schemas['StepEvent'][]): void {
    this.told = told;
    this.app.patch({ newton: told.points, steps });
  }
}
