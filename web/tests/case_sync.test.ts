import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { ApiError, type Schemas } from '../src/api';
import { App } from '../src/ui/app';
import { FakeServer, makeGate, makeJob, planOf, wait } from './fake_server';

vi.mock('../src/workers', () => ({ prepareSurfaceAside: (surface: unknown) => Promise.resolve(surface) }));

const onSurface = vi.fn();
const listeners = { onSurface, onDepths: vi.fn(), onPreview: vi.fn(), onLabels: vi.fn(), onPaint: vi.fn() };

let server: FakeServer;
let app: App;
let storedStep: string | null;

beforeEach(() => {
  vi.useFakeTimers();
  storedStep = null;
  vi.stubGlobal('sessionStorage', { getItem: () => storedStep, setItem: () => undefined });
  onSurface.mockClear();
  server = new FakeServer();
  server.surfaceEtags.set('skull', '"a"').set('skin', '"a"');
  app = new App(server.client, listeners);
});

afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

async function start(): Promise<void> {
  await app.start();
  await wait(0);
}

describe('the start', () => {
  it('loads plan, landmarks, scan and the surfaces of the step', async () => {
    server.plan.put(planOf(5), '*');
    server.landmarks.put({ N: [1, 2, 3] }, '*');
    server.surfaceEtags.set('predicted', '"a"');
    await start();
    expect(app.model.doc.plan).toEqual(planOf(5));
    expect(app.model.doc.landmarks).toEqual([{ name: 'N', position_mm: [1, 2, 3] }]);
    expect(app.model.s.volume?.grid.size).toEqual([2, 2, 2]);
    expect([...app.model.surfaces.keys()]).toEqual(['skull', 'skin']);
    expect(app.model.s.saving).toBe('saved');
    await wait(1000);
    expect(server.requests.filter((name) => name.startsWith('put'))).toEqual([]);
    expect(app.model.history.value.past).toEqual([]);
  });

  it('returns to the step before a reload of the page', async () => {
    storedStep = 'movement';
    await start();
    expect(app.model.s.step).toBe('movement');
  });

  it.each(['nonsense', '', 'constructor', '__proto__'])('ignores the stored step "%s"', async (name) => {
    storedStep = name;
    await start();
    expect(app.model.s.step).toBe('case');
  });

  it('stays at the first step without a scan', async () => {
    storedStep = 'movement';
    server.hasScan = false;
    await start();
    expect(app.model.s.step).toBe('case');
    expect(server.count('volumeData')).toBe(0);
  });
});

describe('new stages', () => {
  beforeEach(async () => {
    server.plan.put(planOf(1), '*');
    await start();
  });

  it('load a plan that another page has stored', async () => {
    server.plan.put(planOf(2), '*');
    server.sendStages();
    await wait(0);
    expect(app.model.doc.plan).toEqual(planOf(2));
    expect(app.model.s.toasts.map((toast) => toast.kind)).toEqual(['info']);
    app.undo();
    expect(app.model.doc.plan).toEqual(planOf(1));
  });

  it('keep an edit that is not saved; saving it finds the conflict', async () => {
    app.edit({ plan: planOf(7) });
    server.plan.put(planOf(2), '*');
    server.sendStages();
    await wait(0);
    expect(app.model.doc.plan).toEqual(planOf(7));
    await wait(1000);
    expect(app.model.s.conflict).toBe('plan');
    expect(server.plan.value).toEqual(planOf(2));
  });

  it('that arrive during a save are not taken for a change by another page', async () => {
    app.boundaryBrush.labels = new Uint8Array(8);
    app.edit({ paint: [{ at: Uint32Array.of(0), before: Uint8Array.of(0), after: 1 }] });
    const reads = server.count('plan');
    const gate = (server.gate = makeGate('putPlan'));
    await wait(300);
    expect(app.model.s.saving).toBe('saving');
    server.send('case', { stages: { ...server.stages(), plan: { state: 'fresh', why: '', etag: '"plan-2"' } } });
    await wait(0);
    gate.open();
    await wait(0);
    expect(server.plan.etag).toBe('"plan-2"');
    expect(server.plan.value?.boundary?.labels).toBe('boundary.seg.nrrd');
    expect(server.count('plan')).toBe(reads);
    expect(app.model.s.toasts).toEqual([]);
  });

  it('load only the surfaces that have changed', async () => {
    onSurface.mockClear();
    server.surfaceEtags.set('skin', '"b"');
    server.sendStages();
    await wait(0);
    expect(onSurface.mock.calls.map(([name]) => name)).toEqual(['skin']);
    expect(app.model.s.surfacesLoading).toBe(0);
  });

  it('remove the surfaces that are gone', async () => {
    onSurface.mockClear();
    server.surfaceEtags.delete('skull');
    server.sendStages();
    await wait(0);
    expect(onSurface.mock.calls).toEqual([['skull', null]]);
    expect([...app.model.surfaces.keys()]).toEqual(['skin']);
  });

  it('do not load an unchanged scan again', async () => {
    server.sendStages();
    await wait(0);
    expect(server.count('volumeData')).toBe(1);
  });
});

describe('the connection', () => {
  beforeEach(start);

  it('reads the case again when the server is back', async () => {
    server.connect(false, new ApiError(0, 'unreachable', ''));
    expect(app.model.s.connection).toBe('lost');
    server.plan.put(planOf(4), '*');
    server.connect(true);
    await wait(0);
    expect(app.model.s.connection).toBe('on');
    expect(app.model.doc.plan).toEqual(planOf(4));
  });

  it('ends with a refused token', () => {
    server.connect(false, new ApiError(403, 'forbidden', 'wrong token'));
    expect(app.model.s.fatal).toBe('wrong token');
  });
});

describe('jobs', () => {
  const event = (state: Schemas['JobState'], message = ''): Schemas['JobEvent'] => ({
    id: 1,
    kind: 'cut',
    state,
    stage: '',
    fraction: 0,
    line: null,
    message,
  });

  beforeEach(start);

  it('save the plan first, and call back when they are done', async () => {
    const then = vi.fn();
    app.edit({ plan: planOf(1) });
    await app.run({ kind: 'cut' }, then);
    expect(server.plan.value).toEqual(planOf(1));
    server.send('job', event('running'));
    await wait(0);
    expect(then).not.toHaveBeenCalled();
    server.send('job', event('done'));
    await wait(0);
    expect(then).toHaveBeenCalledOnce();
  });

  it('that fail show why, and do not call back', async () => {
    const then = vi.fn();
    await app.run({ kind: 'cut' }, then);
    server.send('job', event('failed', 'no bone'));
    await wait(0);
    expect(then).not.toHaveBeenCalled();
    expect(app.model.s.toasts.map((toast) => toast.text)).toEqual(['Cutting the bone failed: no bone']);
  });

  it('do not start on a plan that could not be saved', async () => {
    server.failure = { name: 'putPlan', error: new ApiError(0, 'unreachable', 'no answer') };
    app.edit({ plan: planOf(1) });
    await app.run({ kind: 'predict' });
    expect(server.count('startJob')).toBe(0);
    expect(app.model.s.toasts.map((toast) => toast.text)).toEqual(['no answer']);
  });

  it('of another page are shown', async () => {
    server.jobList = [makeJob(1, 'cut', 'running')];
    server.send('job', event('running'));
    await wait(0);
    expect(app.model.s.jobs.map((job) => job.id)).toEqual([1]);
  });
});
