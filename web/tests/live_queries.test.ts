import { beforeEach, expect, it, vi } from 'vitest';
import type { Mat4 } from '../src/model';
import { LiveQueries } from '../src/ui/live_queries';
import type { Planner, SceneListeners } from '../src/ui/planner_context';

type Call = { poses: Record<string, Mat4>; dragging: boolean; signal: AbortSignal; done: (xyz: Float32Array) => void };

let calls: Call[];
let poses: Record<string, Mat4>;
let live: LiveQueries;
let shown: () => { state: string; latency_ms: number | null };
const onPreview = vi.fn();
const state = { showPreview: true, preview: { state: 'none', latency_ms: null as number | null, why: '', max_mm: 0 } };

const shifted = (x: number): Record<string, Mat4> => ({ front: [1, 0, 0, x, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] });
const settle = (): Promise<void> => new Promise((resolve) => setTimeout(resolve, 5));

beforeEach(() => {
  vi.stubGlobal('requestAnimationFrame', (draw: () => void) => setTimeout(draw, 0));
  vi.stubGlobal('cancelAnimationFrame', clearTimeout);
  calls = [];
  onPreview.mockClear();
  state.preview = { state: 'none', latency_ms: null, why: '', max_mm: 0 };
  const s = { ...state, case: { stages: { preview: { state: 'fresh' } } } };
  const planner = {
    model: { s },
    patch: (part: object) => Object.assign(s, part),
    cutPoses: () => poses,
    client: {
      preview: (p: Record<string, Mat4>, dragging: boolean, signal: AbortSignal) =>
        new Promise((done, stop) => {
          calls.push({ poses: p, dragging, signal, done });
          signal.addEventListener('abort', () => stop(new Error('aborted')));
        }),
    },
  };
  shown = () => s.preview;
  live = new LiveQueries(planner as unknown as Planner, { onPreview } as unknown as SceneListeners);
});

it('keeps only the newest poses of a drag, and ends with the equilibrium', async () => {
  for (const x of [1, 2, 3]) {
    poses = shifted(x);
    live.requestPreview(null);
  }
  expect(calls.map((call) => [call.poses.front[3], call.dragging])).toEqual([[1, true]]);
  calls[0].done(new Float32Array([1, 0, 0]));
  await settle();
  expect(calls.map((call) => [call.poses.front[3], call.dragging])).toEqual([
    [1, true],
    [3, true],
  ]);
  expect(shown()).toMatchObject({ state: 'shown', latency_ms: null });
  live.requestPreview(performance.now());
  calls[1].done(new Float32Array([3, 0, 0]));
  await settle();
  expect(calls).toHaveLength(3);
  expect(calls[2].dragging).toBe(false);
  calls[2].done(new Float32Array([3.1, 0, 0]));
  await settle();
  expect(onPreview).toHaveBeenCalledTimes(3);
  expect(shown().latency_ms).toBeGreaterThanOrEqual(0);
  expect(calls).toHaveLength(3);
});

it('draws nothing after the preview was dropped, and begins again', async () => {
  poses = shifted(1);
  live.requestPreview(null);
  live.dropPreview();
  expect(calls[0].signal.aborted).toBe(true);
  await settle();
  expect(onPreview.mock.calls).toEqual([[null]]);
  live.requestPreview(null);
  calls[1].done(new Float32Array([1, 0, 0]));
  await settle();
  expect(onPreview).toHaveBeenLastCalledWith(new Float32Array([1, 0, 0]));
});
