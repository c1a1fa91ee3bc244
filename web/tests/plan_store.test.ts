import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { ApiError } from '../src/api';
import { undo, type Landmark, type Plan } from '../src/model';
import { App } from '../src/ui/app';
import { FakeServer, makeGate, planOf, wait } from './fake_server';

vi.mock('../src/workers', () => ({ prepareSurfaceAside: (surface: unknown) => Promise.resolve(surface) }));

const DELAY_MS = 300;
const nasion = (z: number): Landmark => ({ name: 'N', position_mm: [0, 0, z] });

const listeners = {
  onSurface: vi.fn(),
  onDepths: vi.fn(),
  onPreview: vi.fn(),
  onLabels: vi.fn(),
  onPaint: vi.fn(),
};

let server: FakeServer;
let app: App;

/** How far the plan of the server moves the segment forward [mm]. */
const storedMm = (): number | undefined =>
  server.plan.value ? -server.plan.value.segments[0].path.keyframes![0].translation_mm![1] : undefined;
const shownMm = (): number => -app.model.doc.plan.segments[0].path.keyframes![0].translation_mm![1];

beforeEach(async () => {
  vi.useFakeTimers();
  vi.stubGlobal('sessionStorage', { getItem: () => null, setItem: () => undefined });
  server = new FakeServer();
  app = new App(server.client, listeners);
  await app.start();
});

afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

describe('saving', () => {
  it('sends the last of several edits, once, after a delay', async () => {
    for (const mm of [1, 2, 3]) {
      app.edit({ plan: planOf(mm) });
      await wait(DELAY_MS / 2);
    }
    expect(server.count('putPlan')).toBe(0);
    expect(app.model.s.saving).toBe('unsaved');
    await wait(DELAY_MS);
    expect(server.count('putPlan')).toBe(1);
    expect(storedMm()).toBe(3);
    expect(app.model.s.saving).toBe('saved');
  });

  it('sends nothing when an edit is undone before the save', async () => {
    app.edit({ plan: planOf(1) });
    await wait(DELAY_MS);
    app.edit({ plan: planOf(2) });
    app.model.history.set(undo(app.model.history.value));
    expect(app.model.s.saving).toBe('saved');
    await wait(2 * DELAY_MS);
    expect(server.count('putPlan')).toBe(1);
  });

  it('sends an edit that is made during a save after that save, with its ETag', async () => {
    const gate = (server.gate = makeGate('putPlan'));
    app.edit({ plan: planOf(1) });
    await wait(DELAY_MS);
    expect(app.model.s.saving).toBe('saving');
    app.edit({ plan: planOf(2) });
    app.edit({ plan: planOf(3) });
    await wait(2 * DELAY_MS);
    expect(server.count('putPlan')).toBe(1);
    const states: string[] = [];
    app.model.state.subscribe((s) => {
      if (s.saving === 'saved') states.push(`saved at ${storedMm()}`);
    });
    gate.open();
    await wait(2 * DELAY_MS);
    expect(server.count('putPlan')).toBe(2);
    expect(server.maxWriters).toBe(1);
    expect(storedMm()).toBe(3);
    expect(app.model.s.conflict).toBeNull();
    expect(new Set(states)).toEqual(new Set(['saved at 3']));
  });

  it('names the file of the landmarks in the plan, and sends the landmarks first', async () => {
    app.edit({ plan: planOf(1), landmarks: [nasion(1)] });
    await wait(DELAY_MS);
    const puts = server.requests.filter((name) => name.startsWith('put'));
    expect(puts).toEqual(['putLandmarks', 'putPlan']);
    expect(server.plan.value?.landmarks).toBe('landmarks.mrk.json');
    expect(server.landmarks.value).toEqual({ N: [0, 0, 1] });
  });

  it('shows an error, and repeats only what was not stored', async () => {
    server.failure = { name: 'putPlan', error: new ApiError(0, 'unreachable', 'no answer') };
    app.edit({ plan: planOf(1), landmarks: [nasion(1)] });
    await wait(DELAY_MS);
    expect(app.model.s.saving).toBe('error');
    expect(app.model.s.saveError).toBe('no answer');
    app.edit({ plan: planOf(2) });
    await wait(DELAY_MS);
    expect(app.model.s.saving).toBe('saved');
    expect(app.model.s.saveError).toBeNull();
    expect(server.count('putLandmarks')).toBe(1);
    expect(storedMm()).toBe(2);
  });
});

describe('conflicts', () => {
  const theirs: Plan = planOf(9);

  beforeEach(async () => {
    app.edit({ plan: planOf(1) });
    await wait(DELAY_MS);
    server.plan.put(theirs, '*'); // Another page.
    app.edit({ plan: planOf(2) });
    await wait(DELAY_MS);
  });

  it('are found by the ETag; nothing is overwritten, and nothing more is sent', async () => {
    expect(app.model.s.conflict).toBe('plan');
    expect(app.model.s.saving).toBe('unsaved');
    expect(storedMm()).toBe(9);
    const sent = server.count('putPlan');
    app.edit({ plan: planOf(3) });
    await wait(2 * DELAY_MS);
    expect(server.count('putPlan')).toBe(sent);
    expect(shownMm()).toBe(3);
  });

  it('end with the other version, which undo reverts', async () => {
    await app.resolveConflict('theirs');
    expect(app.model.s.conflict).toBeNull();
    expect(shownMm()).toBe(9);
    expect(app.model.s.saving).toBe('saved');
    app.undo();
    await wait(DELAY_MS);
    expect(storedMm()).toBe(2);
    expect(app.model.s.conflict).toBeNull();
  });

  it('end with the own version, which replaces the other', async () => {
    await app.resolveConflict('mine');
    expect(app.model.s.conflict).toBeNull();
    expect(storedMm()).toBe(2);
    app.edit({ plan: planOf(4) });
    await wait(DELAY_MS);
    expect(storedMm()).toBe(4);
    expect(app.model.s.conflict).toBeNull();
  });
});

describe('a conflict of landmarks', () => {
  it('does not touch the plan', async () => {
    app.edit({ landmarks: [nasion(1)] });
    await wait(DELAY_MS);
    server.landmarks.put({ N: [0, 0, 7] }, '*');
    app.edit({ landmarks: [nasion(2)], plan: planOf(1) });
    await wait(DELAY_MS);
    expect(app.model.s.conflict).toBe('landmarks');
    expect(server.count('putPlan')).toBe(0);
    await app.resolveConflict('mine');
    expect(server.landmarks.value).toEqual({ N: [0, 0, 2] });
    expect(storedMm()).toBe(1);
  });
});
