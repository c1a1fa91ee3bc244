import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { ApiError } from '../src/api';
import { faultOfChoice, faultOfVariantName, isOfVariants, withVariant, type Landmark } from '../src/model';
import { middleOfPane, paneCount, type Layout } from '../src/scene/view_events';
import { App } from '../src/ui/app';
import { FakeServer, planOf, wait } from './fake_server';

vi.mock('../src/workers', () => ({ prepareSurfaceAside: (surface: unknown) => Promise.resolve(surface) }));

const named = (...names: string[]) => names.map((name) => ({ name }));

describe('the name of a variant', () => {
  it('has letters, digits, hyphens and underscores', () => {
    for (const name of ['a', 'two-jaw_5', '7', 'x'.repeat(40)]) expect(faultOfVariantName(name, [], 12)).toBeNull();
    for (const name of ['', 'one/two', '../x', 'a b', 'Größe', '.', 'x'.repeat(41)])
      expect(faultOfVariantName(name, [], 12), name).not.toBeNull();
  });

  it('is not that of another, and variants are limited', () => {
    expect(faultOfVariantName('a', named('a'), 12)).toContain('There is a variant a');
    expect(faultOfVariantName('A', named('a'), 12)).toBeNull();
    expect(faultOfVariantName('c', named('a', 'b'), 2)).toContain('at most 2');
  });
});

describe('the chosen variants', () => {
  it('are in the order of the list', () => {
    expect(withVariant(['c'], 'a', named('a', 'b', 'c'))).toEqual(['a', 'c']);
    expect(withVariant(['a', 'c'], 'c', named('a', 'b', 'c'))).toEqual(['a']);
    expect(withVariant(['gone'], 'a', named('a', 'b'))).toEqual(['a']);
  });

  it('are two to four', () => {
    expect(faultOfChoice(['a'])).toContain('two to four');
    expect(faultOfChoice(['a', 'b', 'c', 'd'])).toBeNull();
    expect(faultOfChoice(['a', 'b', 'c', 'd', 'e'])).toContain('at most 4');
  });

  it('are those of a table in any order', () => {
    expect(isOfVariants(['a', 'b'], ['b', 'a'])).toBe(true);
    expect(isOfVariants(['a', 'b'], ['a'])).toBe(false);
    expect(isOfVariants(['a', 'b'], ['a', 'c'])).toBe(false);
  });
});

describe('pictures side by side', () => {
  it('have equal widths', () => {
    const panes = ['a', 'b', 'c'].map((name) => ({ bodies: [], name }));
    const layout: Layout = { mode: 'beside', panes };
    expect(paneCount(layout)).toBe(3);
    expect([0, 99, 100, 250, 300].map((x) => middleOfPane(layout, x, 300))).toEqual([50, 50, 150, 250, 250]);
    expect(middleOfPane({ mode: 'single' }, 299, 300)).toBe(150);
  });
});

describe('a variant of the plan', () => {
  const nasion = (z: number): readonly Landmark[] => [{ name: 'N', position_mm: [0, 0, z] }];
  const listeners = { onSurface: vi.fn(), onDepths: vi.fn(), onPreview: vi.fn(), onLabels: vi.fn(), onPaint: vi.fn() };
  let server: FakeServer;
  let app: App;

  beforeEach(async () => {
    vi.useFakeTimers();
    vi.stubGlobal('sessionStorage', { getItem: () => null, setItem: () => undefined });
    server = new FakeServer();
    app = new App(server.client, listeners);
    await app.start();
    app.setStep('compare');
    app.edit({ plan: planOf(1), landmarks: nasion(1) });
    app.patch({ variantName: ' one ' });
    await app.variants.keep();
  });

  afterEach(() => {
    vi.useRealTimers();
    vi.unstubAllGlobals();
  });

  it('is kept after the plan is saved, and chosen', () => {
    expect(server.requests.indexOf('putPlan')).toBeLessThan(server.requests.indexOf('keepVariant'));
    expect(app.model.s.variants.map((one) => [one.name, one.is_current])).toEqual([['one', true]]);
    expect(app.model.s.chosenVariants).toEqual(['one']);
    expect(app.model.s.variantName).toBe('');
  });

  it('is refused with a reason; the name stays', async () => {
    for (const name of ['one', 'a/b']) {
      app.patch({ variantName: name });
      await app.variants.keep();
      expect(app.model.s.variantFault).not.toBeNull();
      expect(app.model.s.variantName).toBe(name);
    }
    expect(server.count('keepVariant')).toBe(1);
    server.failure = { name: 'keepVariant', error: new ApiError(422, 'invalid', 'the check is out of date') };
    app.patch({ variantName: 'two' });
    await app.variants.keep();
    expect(app.model.s.variantFault).toBe('the check is out of date');
    expect(app.model.s.variantName).toBe('two');
  });

  it('is loaded after a confirmation, in one undo step, without the notice of another page', async () => {
    app.edit({ plan: planOf(2), landmarks: nasion(2) });
    await wait(1000);
    app.patch({ toasts: [] });
    const [one] = app.model.s.variants;
    app.variants.askToLoad({ ...one, is_current: false });
    expect(server.count('loadVariant')).toBe(0);
    expect(app.model.s.confirm?.title).toContain('one');
    app.model.s.confirm!.run();
    await wait(1000);
    expect(app.model.doc.plan.segments[0].path.keyframes![0].translation_mm).toEqual([0, -1, 0]);
    expect(app.model.doc.landmarks).toEqual(nasion(1));
    expect(app.model.s.toasts.map((toast) => toast.text)).toEqual(['The variant one is the current plan.']);
    expect(app.model.s.saving).toBe('saved');
    app.undo();
    expect(app.model.doc.landmarks).toEqual(nasion(2));
    expect(app.model.doc.plan.segments[0].path.keyframes![0].translation_mm).toEqual([0, -2, 0]);
    await wait(1000);
    expect(server.plan.value?.segments[0].path.keyframes![0].translation_mm).toEqual([0, -2, 0]);
  });

  it('that cannot be loaded changes nothing', async () => {
    app.edit({ plan: planOf(2) });
    await wait(1000);
    server.failure = { name: 'loadVariant', error: new ApiError(422, 'invalid', 'made on another scan') };
    app.variants.askToLoad(app.model.s.variants[0]);
    app.model.s.confirm!.run();
    await wait(1000);
    expect(app.model.doc.plan).toEqual(planOf(2));
    expect(server.plan.value?.segments[0].path.keyframes![0].translation_mm).toEqual([0, -2, 0]);
    expect(app.model.s.toasts.at(-1)).toMatchObject({ kind: 'error', text: 'made on another scan' });
  });

  it('is deleted after a confirmation, and is not chosen any more', async () => {
    app.variants.askToDelete(app.model.s.variants[0]);
    expect(server.kept.size).toBe(1);
    app.model.s.confirm!.run();
    await wait(1000);
    expect(server.kept.size).toBe(0);
    expect(app.model.s.variants).toEqual([]);
    expect(app.model.s.chosenVariants).toEqual([]);
    expect(app.model.doc.plan).toEqual(planOf(1));
  });

  it('that is chosen has its face loaded, others have not', async () => {
    app.edit({ plan: planOf(2) });
    app.patch({ variantName: 'two' });
    await app.variants.keep();
    app.variants.choose('one');
    server.surfaceEtags.set('variants/one', '"1"').set('variants/two', '"2"');
    expect(app.model.s.chosenVariants).toEqual(['two']);
    app.patch({ compareView: 'variants' });
    await wait(0);
    expect(server.requests.filter((name) => name.startsWith('surface '))).toEqual(['surface variants/two']);
    app.variants.choose('one');
    await wait(0);
    expect(server.count('surface variants/one')).toBe(1);
  });
});
