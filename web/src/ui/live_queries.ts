import { lengths, type Mat4 } from '../model';
import { messageOf } from './errors';
import type { Planner, SceneListeners } from './planner_context';
import { nextFrame } from './schedule';
import { stageOf } from './state';

/** Requests during a drag: overlap, and preview of the face. */
export class LiveQueries {
  private depthLoop: { wanted: Record<string, Mat4> | null; running: boolean; times: number[] } = {
    wanted: null,
    running: false,
    times: [],
  };
  private previewLoop: {
    wanted: { poses: Record<string, Mat4>; since: number | null } | null;
    /** Of the running loop; null if none runs. */
    aborter: AbortController | null;
  } = { wanted: null, aborter: null };

  constructor(
    private readonly planner: Planner,
    private readonly listeners: SceneListeners,
  ) {}

  /** Requests the overlap of these poses; while a request runs, only the newest poses are kept. */
  requestDepths(poses: Record<string, Mat4>): void {
    if (stageOf(this.planner.model.s, 'cut').state !== 'fresh' || Object.keys(poses).length === 0) {
      this.listeners.onDepths(null);
      if (this.planner.model.s.depth) this.planner.patch({ depth: null });
      return;
    }
    this.depthLoop.wanted = poses;
    if (!this.depthLoop.running) void this.runDepths();
  }

  private async runDepths(): Promise<void> {
    const loop = this.depthLoop;
    loop.running = true;
    while (loop.wanted) {
      const poses = loop.wanted;
      loop.wanted = null;
      try {
        const depths = await this.planner.client.depths(poses);
        const now = performance.now();
        loop.times = [...loop.times.filter((t) => now - t < 1000), now];
        this.listeners.onDepths(depths);
        const span = now - loop.times[0];
        const perSecond = loop.times.length > 2 ? ((loop.times.length - 1) * 1000) / span : 0;
        this.planner.patch({
          depth: { deepest_mm: depths.deepest_mm, depthIsLowerBound: depths.depthIsLowerBound, perSecond },
        });
      } catch {
        this.listeners.onDepths(null);
        this.planner.patch({ depth: null });
      }
    }
    loop.running = false;
  }

  /**
   * Requests the face for the current poses; while a request runs, only the newest poses are kept.
   * `since` is the time when the drag ended, null during a drag.
   */
  requestPreview(since: number | null): void {
    const { s } = this.planner.model;
    if (!s.showPreview || stageOf(s, 'preview').state !== 'fresh') {
      this.dropPreview();
      return;
    }
    this.previewLoop.wanted = { poses: this.planner.cutPoses(), since };
    if (since !== null || s.preview.state !== 'shown')
      this.planner.patch({ preview: { ...s.preview, state: 'waiting' } });
    if (!this.previewLoop.aborter) void this.runPreviews();
  }

  private async runPreviews(): Promise<void> {
    const loop = this.previewLoop;
    const aborter = (loop.aborter = new AbortController());
    while (loop.wanted && !aborter.signal.aborted) {
      const { poses, since } = loop.wanted;
      loop.wanted = null;
      try {
        const xyz = await this.planner.client.preview(poses, since === null, aborter.signal);
        if (aborter.signal.aborted) return;
        this.listeners.onPreview(xyz);
        const max_mm = lengths(xyz).reduce((a, b) => Math.max(a, b), 0);
        // The next request begins after the face is drawn, so that every update is seen.
        await new Promise<void>(nextFrame);
        if (aborter.signal.aborted) return;
        if (this.previewLoop.wanted?.since) continue; // Still waiting for the face at the end of the drag.
        const latency_ms = since === null ? null : performance.now() - since;
        this.planner.patch({ preview: { state: 'shown', latency_ms, why: '', max_mm } });
      } catch (error) {
        if (aborter.signal.aborted) return;
        this.listeners.onPreview(null);
        this.planner.patch({ preview: { state: 'failed', latency_ms: null, why: messageOf(error), max_mm: 0 } });
      }
    }
    if (loop.aborter === aborter) loop.aborter = null;
  }

  dropPreview(): void {
    this.previewLoop.aborter?.abort();
    this.previewLoop.aborter = this.previewLoop.wanted = null;
    this.listeners.onPreview(null);
    if (this.planner.model.s.preview.state !== 'none')
      this.planner.patch({ preview: { state: 'none', latency_ms: null, why: '', max_mm: 0 } });
  }
}
