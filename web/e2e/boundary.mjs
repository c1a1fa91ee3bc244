// Tests of the painted boundary and of tissue layers in a browser, on a synthetic head.
// node e2e/boundary.mjs [--only WORDS]; LEFORT names the program.
import { mkdirSync } from 'node:fs';
import { join } from 'node:path';
import { isDeepStrictEqual } from 'node:util';
import { accessible } from './accessible.mjs';
import { check, runTests, test } from './harness.mjs';
import { drawn, id, idle, look, saved, settled, step, type } from './planner.mjs';
import { endSmallCase, PLAN, planned, withPage } from './small_case.mjs';

const args = process.argv.slice(2);
const only = args.includes('--only') ? args[args.indexOf('--only') + 1] : null;
const output = new URL('output/', import.meta.url).pathname;
mkdirSync(output, { recursive: true });

const view = '.view3d canvas:not(.overlay)';

/** Drags in the 3D view from one place to another, by fractions of its size. */
async function drag3d(page, from, to, steps = 12) {
  const box = await page.locator(view).boundingBox();
  const at = ([u, v]) => [box.x + u * box.width, box.y + v * box.height];
  await page.mouse.move(...at(from));
  await page.mouse.down();
  for (let n = 1; n <= steps; n++) {
    const fraction = n / steps;
    await page.mouse.move(...at([from[0] + fraction * (to[0] - from[0]), from[1] + fraction * (to[1] - from[1])]));
  }
  await page.mouse.up();
  await drawn(page);
}

const area = async (page, set) =>
  Number(await page.getAttribute(`${id('painted-areas')} [data-set="${set}"]`, 'data-mm2'));

/** Waits until this area is painted. */
const areaIs = (page, set, mm2) =>
  page.waitForFunction(
    ([sel, value]) => Math.abs(Number(document.querySelector(sel)?.dataset.mm2) - value) < 0.06,
    [`${id('painted-areas')} [data-set="${set}"]`, mm2],
  );

/** How many pixels of the view have a hue that bone and segment do not have: of `with segment`, or of `bonded`. */
async function pixelsOf(page, label) {
  const png = (await page.locator('.view3d').screenshot()).toString('base64');
  return page.evaluate(
    async ([data, label]) => {
      const image = new Image();
      image.src = `data:image/png;base64,${data}`;
      await image.decode();
      const canvas = Object.assign(document.createElement('canvas'), { width: image.width, height: image.height });
      const context = canvas.getContext('2d');
      context.drawImage(image, 0, 0);
      const all = context.getImageData(0, 0, canvas.width, canvas.height).data;
      let count = 0;
      const isPurple = (r, g, b) => b > r && r > 1.1 * g && b > 1.15 * g;
      const isBlue = (r, g, b) => b > 1.3 * g && g > 1.5 * r;
      const isCounted = label === 'bonded' ? isBlue : isPurple;
      for (let n = 0; n < all.length; n += 4) if (isCounted(all[n], all[n + 1], all[n + 2])) count++;
      return count;
    },
    [png, label],
  );
}

/** Rows of the interface map's table. */
async function mapRows(page) {
  await page.waitForSelector(id('interface-map'));
  return page.locator(`${id('interface-map')} tbody tr`).allInnerTexts();
}

/** Paints and erases a label beside `painted` mm2 of another; undo must restore the bytes `kept`. */
async function eraseAndUndo(page, ask, painted, kept) {
  await page.click(id('paint-fixed'));
  await page.keyboard.press('Escape');
  await page.click(id('paint-fixed'));
  await drag3d(page, [0.42, 0.42], [0.46, 0.42], 5);
  const fixed = await area(page, 'fixed');
  check(`fixed is painted: ${fixed} mm2`, fixed > 20);
  await page.click(id('paint-erase'));
  await drag3d(page, [0.42, 0.42], [0.43, 0.42], 3);
  const less = await area(page, 'fixed');
  check(`erased: ${less} mm2`, less < fixed);
  await page.keyboard.press('Control+z');
  await areaIs(page, 'fixed', fixed);
  await page.keyboard.press('Control+z');
  await areaIs(page, 'fixed', 0);
  await areaIs(page, 'with segment', painted);
  await page.keyboard.press('Control+Shift+Z');
  await page.keyboard.press('Control+Shift+Z');
  await areaIs(page, 'fixed', less);
  await page.keyboard.press('Control+z');
  await page.keyboard.press('Control+z');
  await areaIs(page, 'fixed', 0);
  await saved(page);
  check(
    'the stored paint is the original',
    Buffer.from(await (await ask('GET', '/boundary/data')).arrayBuffer()).equals(kept),
  );
}

test('boundary painted on bone: shown, measured, undone, saved; the preview changes', () =>
  withPage(planned, async (page, { ask, put, run }) => {
    // Nothing is bonded to the segment by rule, so that paint changes the preview.
    await put('/plan', { ...PLAN, boundary: { interface: 'contact' } });
    await run({ kind: 'preview-factor' });
    const pose = JSON.stringify({ poses: { front: [1, 0, 0, 0, 0, 1, 0, -3, 0, 0, 1, 0, 0, 0, 0, 1] } });
    const preview = async () =>
      Buffer.from(await (await ask('POST', '/preview', pose, { 'Content-Type': 'application/json' })).arrayBuffer());
    const byRule = await preview();
    await step(page, 'tissue');
    await look(page, 'From the front');
    await settled(page);
    await page.click(id('paint-with-segment'));
    await type(page, 'paint-radius', 6);
    await drawn(page);
    const before = await pixelsOf(page, 'with segment');
    await drag3d(page, [0.45, 0.5], [0.55, 0.5]);
    await page.waitForFunction(
      (sel) => Number(document.querySelector(sel)?.dataset.mm2) > 50,
      `${id('painted-areas')} [data-set="with segment"]`,
    );
    const painted = await area(page, 'with segment');
    check(
      `the paint is visible: ${before} and ${await pixelsOf(page, 'with segment')} pixels`,
      (await pixelsOf(page, 'with segment')) > before + 200,
    );
    await saved(page);
    const { value: kept, box } = {
      value: Buffer.from(await (await ask('GET', '/boundary/data')).arrayBuffer()),
      box: (await ask('GET', '/boundary/data')).headers.get('x-lefort-box'),
    };
    check(`it is stored on voxels of the scan: ${box}`, kept.includes(3) && !kept.includes(1));
    const plan = async () => (await ask('GET', '/plan')).json();
    check('the plan names it', (await plan()).boundary.labels === 'boundary.seg.nrrd');

    await eraseAndUndo(page, ask, painted, kept);

    // A wider brush, with the keyboard.
    await page.locator(view).focus();
    await page.keyboard.press(']');
    await page.waitForFunction((sel) => document.querySelector(sel).value === '6.5', id('paint-radius'));
    await page.screenshot({ path: join(output, 'boundary.png') });
    await accessible(page, 'the brush');

    // The old preview is out of date; the updated one differs.
    await page.click(id('prepare-preview'));
    await page.waitForSelector(id('prepare-preview'), { state: 'detached' });
    await idle(page);
    check('the preview differs', !(await preview()).equals(byRule));
    const rules = await mapRows(page);
    check(
      `the map names what is painted: ${rules}`,
      rules.some((row) => /Painted.*bonded/s.test(row)) && rules.some((row) => /Mobilized segment.*contact/s.test(row)),
    );

    // A reloaded page shows the paint.
    await page.reload();
    await areaIs(page, 'with segment', painted);
    await page.click(id('paint-erase-all'));
    await saved(page);
    check('the plan no longer names it', (await plan()).boundary?.labels === undefined);
    const { stages } = await (await ask('GET', '/case')).json();
    check('the file is removed', stages.boundary.state === 'missing');
    await put('/plan', PLAN);
  }));

test('boundary painted on skin, dark theme', () =>
  withPage(
    planned,
    async (page) => {
      await step(page, 'tissue');
      await look(page, 'From the front');
      await page.getByRole('button', { name: 'On skin' }).click();
      await page.click(id('paint-free'));
      await drawn(page);
      await drag3d(page, [0.5, 0.4], [0.5, 0.6]);
      check('skin is painted', (await area(page, 'free')) > 50);
      await page.screenshot({ path: join(output, 'boundary-skin.png') });
      await accessible(page, 'the dark brush');
      await page.click(id('paint-erase-all'));
      await saved(page);
    },
    { scheme: 'dark', width: 1920, height: 1080 },
  ));

test('options of the interface; the map of the mesh on bone', () =>
  withPage(planned, async (page, { ask, put, run }) => {
    await put('/plan', PLAN);
    await run({ kind: 'preview-factor' });
    await step(page, 'tissue');
    await look(page, 'From the front');
    await settled(page);
    await mapRows(page);
    await page.waitForTimeout(500);
    await drawn(page);
    const shown = await pixelsOf(page, 'bonded');
    await page.screenshot({ path: join(output, 'interface.png') });
    await accessible(page, 'the interface map');
    await page.getByText('Show on bone').click();
    await drawn(page);
    const bare = await pixelsOf(page, 'bonded');
    check(`the map is drawn: ${bare} and ${shown} pixels`, shown > bare + 2000);
    await page.getByText('Show on bone').click();
    const cm2 = async (rule) =>
      Number(
        await page
          .locator(`${id('interface-map')} [data-rule="${rule}"] td`)
          .nth(2)
          .innerText(),
      );
    const elevated = await cm2('osteotomy');
    check(`an area is elevated: ${elevated} cm2`, elevated > 1);

    await page.getByText('Elevation margins of the procedure').click();
    await type(page, 'elevation-margin', 4);
    await type(page, 'joint-margin', 5);
    await type(page, 'interface-layer', 2);
    await page.getByLabel('Where the scan ends').selectOption('free');
    await page.getByLabel('Where the meshed region ends').selectOption('foundation');
    await type(page, 'foundation', 30);
    await saved(page);
    const boundary = async () => (await (await ask('GET', '/plan')).json()).boundary;
    const expected = {
      elevation_margin_mm: 4,
      joint_margin_mm: 5,
      interface_layer_mm: 2,
      scan_boundary: 'free',
      cut_boundary: 'foundation',
      foundation_mm: 30,
    };
    const stored = await boundary();
    check(`the plan has the options: ${JSON.stringify(stored)}`, isDeepStrictEqual(stored, expected));
    // The map is that of the plan: it goes with the preview, and returns with it.
    await page.waitForSelector(id('interface-map'), { state: 'detached' });
    await page.click(id('prepare-preview'));
    await mapRows(page);
    await idle(page);
    check('a smaller margin elevates less', (await cm2('osteotomy')) < elevated);
    await page.getByText('Elevation margins of the procedure').click();
    await page.getByRole('button', { name: 'Contact', exact: true }).click();
    await saved(page);
    const contact = await boundary();
    check('contact, with the default margin', contact.interface === 'contact' && !('elevation_margin_mm' in contact));
    await put('/plan', PLAN);
  }));

test('skin, mucosa and muscle are stored in the plan', () =>
  withPage(planned, async (page, { ask }) => {
    await step(page, 'tissue');
    const toggle = (name) =>
      page.locator('.part', { has: page.getByRole('heading', { name, exact: true }) }).getByRole('switch');
    await page.click(`${id('layers')} summary`);
    await toggle('Skin').check({ force: true });
    await type(page, 'skin-thickness', 1.8);
    await type(page, 'skin-layers', 3);
    await toggle('Mucosa').check({ force: true });
    await type(page, 'mucosa-thickness', 6);
    await page
      .locator('.part', { has: page.getByRole('heading', { name: 'Mucosa', exact: true }) })
      .getByRole('combobox')
      .selectOption('own');
    await type(page, 'mucosa-young', 12);
    await toggle('Muscle').check({ force: true });
    await saved(page);
    const { tissue } = await (await ask('GET', '/plan')).json();
    check(
      `the plan has: ${JSON.stringify(tissue)}`,
      tissue.skin.thickness_mm === 1.8 &&
        tissue.skin.layers === 3 &&
        tissue.mucosa.thickness_mm === 6 &&
        tissue.mucosa.material.young_kpa === 12 &&
        tissue.muscle.material === 'face-compressible',
    );
    await page.screenshot({ path: join(output, 'layers.png'), fullPage: true });
    await accessible(page, 'tissues of their own');
    await toggle('Skin').uncheck({ force: true });
    await toggle('Mucosa').uncheck({ force: true });
    await toggle('Muscle').uncheck({ force: true });
    await saved(page);
    check('removed again', (await (await ask('GET', '/plan')).json()).tissue.skin === undefined);
    await step(page, 'anatomy');
    await page.getByText('Show labels on the slices').click();
    await page.getByRole('button', { name: 'muscle', exact: true }).click();
    const tint = await page
      .getByRole('button', { name: 'muscle', exact: true })
      .locator('.swatch')
      .evaluate((swatch) => swatch.style.background);
    check(`muscle is a label of the brush, with its own color: ${tint}`, tint.startsWith('rgb('));
  }));

const ok = await runTests({ all: false, only });
await endSmallCase();
process.exit(ok ? 0 : 1);
