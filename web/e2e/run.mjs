// Tests of the planner in a browser. node e2e/run.mjs [--all] [--only WORDS]; LEFORT names the program.
import { execFileSync } from 'node:child_process';
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { check, freshFolder, lefort, openPage, root, runTests, serve, test } from './harness.mjs';
import { shrinkPng } from './shrink_png.mjs';
import {
  click3d,
  dot,
  dragHandle,
  drawn,
  handleWhere,
  id,
  idle,
  look,
  openExample,
  saved,
  settled,
  step,
  type,
} from './planner.mjs';

const args = process.argv.slice(2);
const all = args.includes('--all');
const only = args.includes('--only') ? args[args.indexOf('--only') + 1] : null;

const axe = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
const output = new URL('output/', import.meta.url).pathname;
mkdirSync(output, { recursive: true });

/** One case shared by the tests; the first test creates it. */
let shared = null;
async function withShared(run, size) {
  shared ??= await (async () => {
    // LEFORT_CASE: an existing folder, to work on one test.
    const caseInfo = process.env.LEFORT_CASE
      ? { folder: process.env.LEFORT_CASE, remove: () => undefined }
      : freshFolder('planner');
    return { ...caseInfo, server: await serve(caseInfo.folder) };
  })();
  const page = await openPage(shared.server.address, size);
  try {
    await run(page, shared).catch(async (error) => {
      const path = join(output, 'failed.png');
      await page.screenshot({ path, timeout: 180000 }).catch(() => undefined);
      console.log(`     screenshot: ${path}`);
      throw error;
    });
    check(`no errors in the page: ${page.faults.join('; ')}`, page.faults.length === 0);
  } finally {
    await page.context().close();
  }
}

/** Checks accessibility with axe-core. */
async function accessible(page, where) {
  await page.evaluate(axe);
  const { violations } = await page.evaluate(() =>
    window.axe.run(document, { runOnly: ['wcag2a', 'wcag2aa', 'wcag21aa'] }),
  );
  const said = violations.map(
    (v) =>
      `${v.id}: ${v.nodes
        .slice(0, 3)
        .map((n) => n.html.slice(0, 120))
        .join(' | ')}`,
  );
  check(`${where} is accessible: ${said.join('; ')}`, violations.length === 0);
}

/** Prints a time or a rate and its target. It does not fail the test, because it depends on the load of the machine. */
function measured(what, value, unit, bound, budget) {
  const met = bound === 'at least' ? value >= budget : value <= budget;
  console.log(`     ${what}: ${value.toFixed(2)} ${unit}, ${bound} ${budget} required: ${met ? 'met' : 'missed'}`);
}

async function picture(page, name) {
  const path = join(root, 'docs/images', `planner-${name}.png`);
  await page.mouse.move(5, 790);
  await settled(page);
  const small = shrinkPng(await page.screenshot({ timeout: 180000 }));
  writeFileSync(all ? path : join(output, `planner-${name}.png`), small);
  check(`${name}.png is smaller than 300 kB: ${small.length}`, small.length < 300e3);
}

test('an empty case: the first view', () =>
  withShared(async (page) => {
    const [painted, shown] = await page.evaluate(() => [
      performance.getEntriesByType('paint').find((e) => e.name === 'first-contentful-paint')?.startTime ?? NaN,
      performance.getEntriesByName('planner shown')[0]?.startTime ?? NaN,
    ]);
    console.log(`     first paint ${(painted / 1000).toFixed(2)} s`);
    measured('first view', shown / 1000, 's', 'at most', 3);
    check('the notice is in view', await page.getByText('Research software – not for clinical use').isVisible());
    check('the token is out of sight', !page.url().includes('token'));
    await accessible(page, 'the first view');
    await step(page, 'movement');
    check('other steps lead to the case', await page.getByText('No scan yet').first().isVisible());
    await step(page, 'case');
    await picture(page, 'case');
  }));

test('a malformed scan is refused with a reason, and the page continues', () =>
  withShared(async (page) => {
    const file = join(output, 'Mustermann_Max.nrrd');
    writeFileSync(file, 'NRRD0004\ntype: short\ndimension: 3\nsizes: 9 9 9\nencoding: raw\n\nshort');
    const choosing = page.waitForEvent('filechooser');
    await page.getByText('Choose files').click();
    await (await choosing).setFiles(file);
    await page.getByText('The scan could not be read').waitFor();
    check('the file name is not shown', !(await page.locator('body').innerText()).includes('Mustermann'));
  }));

test('opening the example with one click loads scan and surfaces', () =>
  withShared(async (page) => {
    const since = Date.now();
    await openExample(page);
    console.log(`     from the click to surfaces ${((Date.now() - since) / 1000).toFixed(1)} s`);
    await page.waitForSelector('[data-step=anatomy][aria-current=step]');
  }));

test('anatomy: slices, window, linked cursor, threshold, brush and undo', () =>
  withShared(async (page) => {
    await step(page, 'anatomy');
    await settled(page);
    const readout = (name) => page.locator(`.slice[data-orientation=${name}] .slice-readout`).innerText();
    const before = await readout('axial');
    const coronal = await page.locator('.slice[data-orientation=coronal] canvas').boundingBox();
    await page.mouse.click(coronal.x + coronal.width / 2, coronal.y + coronal.height * 0.75);
    await page.waitForFunction(
      (old) => document.querySelector('.slice[data-orientation=axial] .slice-readout').textContent !== old,
      before,
    );
    check('a click on the coronal slice moves the axial one', (await readout('axial')) !== before);
    await page.locator('.slice[data-orientation=axial] canvas').focus();
    const at = await readout('axial');
    await page.keyboard.press('ArrowUp');
    await page.waitForFunction(
      (old) => document.querySelector('.slice[data-orientation=axial] .slice-readout').textContent !== old,
      at,
    );
    await page.getByRole('button', { name: 'Soft tissue' }).click();
    await page.getByText('Level 50, width 400 HU').waitFor();
    await page.mouse.move(coronal.x + 100, coronal.y + 100);
    await page.mouse.down({ button: 'right' });
    await page.mouse.move(coronal.x + 150, coronal.y + 130);
    await page.mouse.up({ button: 'right' });
    await page.getByText('Level 50, width 400 HU').waitFor({ state: 'detached' });
    await page.getByRole('button', { name: 'Bone', exact: true }).first().click();
    await page.getByText('Show the bone mask on the slices').click();
    await picture(page, 'anatomy');
    await page.getByText('Show the bone mask on the slices').click();
    await page.getByText('Show labels on the slices').click();
    await page
      .getByText('Brush radius')
      .waitFor({ state: 'attached' })
      .catch(() => undefined);
    await page
      .getByRole('button', { name: /^bone$/i })
      .last()
      .click();
    const axial = await page.locator('.slice[data-orientation=axial] canvas').boundingBox();
    await page.mouse.move(axial.x + axial.width / 2, axial.y + axial.height / 2);
    await page.mouse.down();
    await page.mouse.move(axial.x + axial.width / 2 + 30, axial.y + axial.height / 2, { steps: 6 });
    await page.mouse.up();
    await page.waitForSelector(id('use-labels'));
    await page.keyboard.press('Control+z');
    await page.waitForSelector(id('use-labels'), { state: 'detached' });
    await page.keyboard.press('Control+Shift+Z');
    await page.waitForSelector(id('use-labels'));
    await page.keyboard.press('Control+z');
    await accessible(page, 'the anatomy');
  }));

test('landmarks: placed, dragged, removed, undone, measured', () =>
  withShared(async (page) => {
    await step(page, 'landmarks');
    await settled(page);
    await page.waitForFunction((sel) => document.querySelectorAll(`${sel} tbody tr`).length > 3, id('cephalometry'));
    const value = (name) =>
      page
        .locator(`${id('cephalometry')} tr`, { hasText: name })
        .first()
        .innerText();
    const before = await value('N-ANS');
    await dragHandle(page, 'marker ANS', -6, 8, 8);
    await page.waitForFunction(
      ([sel, old]) =>
        [...document.querySelectorAll(`${sel} tr`)].some((r) => r.innerText.startsWith('N-ANS') && r.innerText !== old),
      [id('cephalometry'), before],
    );
    await page.keyboard.press('Control+z');
    await page.waitForFunction(
      ([sel, old]) => [...document.querySelectorAll(`${sel} tr`)].some((r) => r.innerText === old),
      [id('cephalometry'), before],
    );
    await page.click(id('landmark-Zy-R'));
    await page.keyboard.press('Delete');
    await page.locator('.list-row.unplaced', { hasText: 'Zy-R' }).waitFor();
    await page.keyboard.press('Control+z');
    await page.locator('.list-row.unplaced', { hasText: 'Zy-R' }).waitFor({ state: 'detached' });
    await page.click(id('landmark-Gn'));
    await click3d(page, 0.6, 0.6);
    await page.waitForFunction(
      () => ![...document.querySelectorAll('.list-row.unplaced')].some((r) => r.textContent.includes('gnathion')),
    );
    await page.keyboard.press('Control+z');
    await saved(page);
    await picture(page, 'landmarks');
    await accessible(page, 'the landmarks');
  }));

test('osteotomy: a plane and a curve by hand, then Le Fort III by its landmarks', () =>
  withShared(async (page) => {
    await step(page, 'osteotomy');
    await settled(page);
    await page.click(id('add-plane'));
    await click3d(page, 0.6, 0.6);
    await page.waitForSelector(id('plane-0-0'));
    await drawn(page);
    const at = await handleWhere(page, 'translate normal +');
    await dragHandle(page, 'translate normal +', 0, 25, 10);
    await handleWhere(page, 'translate normal +', (now) => Math.abs(now[1] - at[1] - 25) < 6);
    await page.keyboard.press('Control+z');
    await handleWhere(page, 'translate normal +', (now) => Math.abs(now[1] - at[1]) < 2);
    await page.keyboard.press('Escape');
    await page.click(id('add-curve'));
    for (const [u, v] of [
      [0.42, 0.4],
      [0.48, 0.36],
      [0.53, 0.4],
      [0.52, 0.46],
      [0.45, 0.47],
    ])
      await click3d(page, u, v);
    await page.getByText('point by point (5)').waitFor();
    await page.keyboard.press('Enter');
    await page.getByText('Curve 1').waitFor();
    for (let n = 0; n < 2; n++) await page.keyboard.press('Control+z');
    await page.waitForSelector('.card', { state: 'detached' });
    await page.click(id('template-le-fort-3'));
    await page.waitForSelector('.card');
    await saved(page);
    await picture(page, 'osteotomy-template');
    const since = Date.now();
    await page.click(id('cut'));
    await dot(page, 'osteotomy', 'fresh');
    await settled(page);
    console.log(`     cut in ${((Date.now() - since) / 1000).toFixed(1)} s`);
    check('the segment has a volume', /\d ml/.test(await page.locator('.card .chip').first().innerText()));
    await picture(page, 'osteotomy');
    await accessible(page, 'the osteotomy');
  }));

test('movement: 12 mm forward and 5 mm down by dragging, with overlap during the drag', () =>
  withShared(async (page) => {
    await step(page, 'movement');
    await settled(page);
    await look(page, 'From the patient’s right');
    const px = Number(await page.getAttribute('.view3d canvas:not(.overlay)', 'data-px-per-mm'));
    // At the speed of a user: 3 s for 12 mm.
    const found = await handleWhere(page, 'translate AP +');
    const box = await page.locator('.view3d canvas:not(.overlay)').boundingBox();
    await page.mouse.move(box.x + found[0], box.y + found[1]);
    await page.mouse.down();
    const rates = [];
    const until = Date.now() + 3000;
    for (let share = 0; share < 1; ) {
      share = Math.min(1, 1 - (until - Date.now()) / 3000);
      await page.mouse.move(box.x + found[0] + 12 * px * share, box.y + found[1]);
      rates.push(
        Number(
          await page
            .locator(id('update-rate'))
            .first()
            .getAttribute('data-rate', { timeout: 50 })
            .catch(() => 0),
        ),
      );
    }
    await page.mouse.up();
    const rate = Math.max(...rates);
    measured('overlap while dragging, best second', rate, 'updates/s', 'at least', 20);
    await type(page, 'move-anterior', 12);
    await dragHandle(page, 'translate SI -', 0, 5 * px, 10);
    await type(page, 'move-superior', -5);
    await page.getByText('12.0 mm anterior, 5.0 mm inferior').waitFor();
    await saved(page);
    await page.click(id('add-keyframe'));
    await page.waitForFunction(() => document.querySelectorAll('.keyframe').length === 3);
    await page.keyboard.press('Control+z');
    await page.waitForFunction(() => document.querySelectorAll('.keyframe').length === 2);
    await saved(page);
    await page.locator(id('scrub')).fill('0.5');
    await page.getByText('50 % of the path').waitFor();
    await page.keyboard.press('Escape');
    await look(page, 'Three-quarter, from the patient’s right');
    await picture(page, 'movement');
    await accessible(page, 'the movement');
  }));

test('preview: a face after the end of a drag', () =>
  withShared(async (page) => {
    await step(page, 'movement');
    await settled(page);
    if (
      await page
        .locator(id('prepare-preview'))
        .isVisible()
        .catch(() => false)
    )
      await page.click(id('prepare-preview'));
    await page.waitForSelector(id('preview-banner'), { timeout: 600000 });
    await idle(page);
    await page.waitForSelector(`${id('preview-banner')} ${id('preview-latency')}`);
    await settled(page);
    const shown = await page
      .locator(`${id('preview-banner')} ${id('preview-latency')}`)
      .first()
      .getAttribute('data-ms');
    await dragHandle(page, 'translate SI -', 0, 8, 8);
    await page.waitForFunction(
      ([sel, old]) => {
        const e = document.querySelector(sel);
        return e && e.dataset.ms !== old;
      },
      [`${id('preview-banner')} ${id('preview-latency')}`, shown],
    );
    const ms = Number(
      await page
        .locator(`${id('preview-banner')} ${id('preview-latency')}`)
        .first()
        .getAttribute('data-ms'),
    );
    measured('preview after the drag', ms / 1000, 's', 'at most', 2);
    check('it is marked as a preview', await page.getByText('Preview, not a prediction').first().isVisible());
    await page.keyboard.press('Control+z');
    await page.getByText('12.0 mm anterior, 5.0 mm inferior').waitFor();
    await saved(page);
  }));

test('tissue and solver: presets with sources, undone', () =>
  withShared(async (page) => {
    await step(page, 'tissue');
    await page.getByRole('button', { name: /Face, Nazari 2010/ }).click();
    await saved(page);
    await page.keyboard.press('Control+z');
    await saved(page);
    await picture(page, 'tissue');
    await accessible(page, 'tissue and solver');
  }));

test('boundary painted on a skull: speed of the brush', () =>
  withShared(async (page) => {
    await step(page, 'tissue');
    await look(page, 'From the front');
    await settled(page);
    const painted = (set) => page.getAttribute(`${id('painted-areas')} [data-set="${set}"]`, 'data-mm2').then(Number);
    const stroke = async (from, to) => {
      const box = await page.locator('.view3d canvas:not(.overlay)').boundingBox();
      const at = (p) => [box.x + p[0] * box.width, box.y + p[1] * box.height];
      await page.mouse.move(...at(from));
      const since = Date.now();
      await page.mouse.down();
      for (let n = 1; n <= 20; n++)
        await page.mouse.move(...at([from[0] + (n / 20) * (to[0] - from[0]), from[1] + (n / 20) * (to[1] - from[1])]));
      await page.mouse.up();
      return Date.now() - since;
    };
    await page.click(id('paint-fixed'));
    await drawn(page);
    const took = await stroke([0.42, 0.62], [0.58, 0.62]);
    await page.waitForFunction(
      (sel) => Number(document.querySelector(sel)?.dataset.mm2) > 100,
      `${id('painted-areas')} [data-set="fixed"]`,
    );
    console.log(`     a stroke of 20 moves over ${(await painted('fixed')).toFixed(0)} mm2 took ${took} ms`);
    await page.click(id('paint-with-segment'));
    await drawn(page);
    await stroke([0.45, 0.72], [0.55, 0.72]);
    await drawn(page);
    await page.locator(id('painted-areas')).scrollIntoViewIfNeeded();
    await picture(page, 'boundary');
    await accessible(page, 'the brush');
    await page.click(id('paint-erase-all'));
    await saved(page);
    check('no paint is left', (await painted('fixed')) === 0);
  }));

test('keyboard and colors', () =>
  withShared(
    async (page) => {
      await settled(page);
      for (const [key, name] of [
        ['2', 'anatomy'],
        ['5', 'movement'],
        ['1', 'case'],
      ]) {
        await page.keyboard.press(key);
        await page.waitForSelector(`[data-step=${name}][aria-current=step]`);
      }
      await page.keyboard.press('?');
      await page.getByText('Keyboard and mouse').waitFor();
      await page.keyboard.press('Escape');
      check('dark by the system', (await page.getAttribute('html', 'data-theme')) === 'dark');
      for (const name of ['case', 'anatomy', 'landmarks', 'osteotomy', 'movement', 'tissue', 'predict']) {
        await step(page, name);
        await accessible(page, `${name}, dark`);
      }
      await page.getByRole('button', { name: /Colors/ }).click();
      check('light by the switch', (await page.getAttribute('html', 'data-theme')) === 'light');
    },
    { scheme: 'dark' },
  ));

test('two pages on one case: one follows the other, and none overwrites the other', () =>
  withShared(async (page, { server }) => {
    const other = await openPage(server.address);
    await step(page, 'movement');
    await step(other, 'movement');
    await other.waitForSelector(id('move-anterior'));
    await page.waitForSelector(id('move-anterior'));
    await type(page, 'move-left', 1);
    await saved(page);
    await other.waitForFunction((sel) => document.querySelector(sel)?.value === '1.0', id('move-left'));
    // A page without events: it continues with an old version.
    await other.route('**/api/v1/events', (route) => route.abort());
    await other.reload();
    await other.waitForSelector(id('move-left'));
    await type(page, 'move-left', 2);
    await saved(page);
    await type(other, 'move-left', 3);
    await other.waitForSelector(id('conflict'));
    await other.click(id('take-theirs'));
    await other.waitForFunction((sel) => document.querySelector(sel)?.value === '2.0', id('move-left'));
    await type(page, 'move-left', 0);
    await saved(page);
    await other.context().close();
  }));

test('prediction: started, reloaded, stopped', () =>
  withShared(async (page) => {
    await step(page, 'predict');
    await page.click(id('predict'));
    await page.waitForSelector(id('stop-predict'));
    await page.waitForSelector(`${id('predict-stage')}:not(:empty)`);
    await page.reload();
    await page.waitForSelector(id('stop-predict'));
    check('the same step after a reload', (await page.getAttribute('[data-step=predict]', 'aria-current')) === 'step');
    await page.click(id('stop-predict'));
    await page.getByText('Stopped', { exact: true }).waitFor({ timeout: 300000 });
  }));

test(
  'a server killed during a solve: the next one resumes from the last step',
  () =>
    withShared(async (page, kept) => {
      const newest = async (of, least) => {
        const cell = of.locator(`${id('step-table')} tbody td`).first();
        await of.waitForFunction(
          ([sel, n]) => Number(document.querySelector(sel)?.textContent) >= n,
          [`${id('step-table')} tbody td`, least],
          { timeout: 900000 },
        );
        return Number(await cell.innerText());
      };
      await step(page, 'predict');
      await page.click(id('predict'));
      await page.waitForSelector(id('stop-predict'));
      const done = await newest(page, 2);
      await kept.server.kill('SIGKILL');
      await page.getByText('The server does not respond').waitFor();
      kept.server = await serve(kept.folder);
      const next = await openPage(kept.server.address);
      await step(next, 'predict');
      await next.getByText('Interrupted', { exact: true }).waitFor();
      await next.getByRole('button', { name: 'Resume prediction' }).click();
      await next.waitForSelector(id('stop-predict'));
      const first = await newest(next, 1);
      check(`it resumes after step ${done}, at ${first}`, first >= done);
      await next.click(id('stop-predict'));
      await next.getByText('Stopped', { exact: true }).waitFor({ timeout: 300000 });
      await next.context().close();
    }),
  { slow: true },
);

test(
  'the whole path: page and command line give the same face, bit for bit',
  () =>
    withShared(async (page, { folder }) => {
      await step(page, 'predict');
      await page.click(id('predict'));
      await page.waitForSelector(`${id('residual-plot')}`, { timeout: 1800000 });
      await page.waitForTimeout(5000);
      await picture(page, 'solving');
      await dot(page, 'predict', 'fresh', 3600000);
      await idle(page);
      await settled(page);
      await page.waitForSelector(id('preview-p99'));
      console.log(
        `     preview and prediction differ by ${await page.getAttribute(id('preview-p99'), 'data-mm')} mm at P99`,
      );
      await picture(page, 'predict');
      await page.click(id('to-compare'));
      await settled(page);
      await page.waitForFunction(
        (sel) => document.querySelectorAll(`${sel} tbody tr`).length >= 3,
        id('distance-table'),
      );
      await picture(page, 'compare');
      const box = await page.locator('.view3d canvas:not(.overlay)').boundingBox();
      await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
      await page.mouse.down();
      await page.mouse.move(box.x + box.width * 0.3, box.y + box.height / 2, { steps: 4 });
      await page.mouse.up();
      await page.getByText('Skin displacement').first().click();
      await page.getByRole('button', { name: 'Side by side' }).click();
      await settled(page);
      await picture(page, 'compare-distance');
      await accessible(page, 'the comparison');
      await page.locator(id('compare-step')).fill('4');
      await page.getByText('step 4 of').first().waitFor();
      const loading = page.waitForEvent('download');
      await page.click(id('report'));
      const report = readFileSync(await (await loading).path(), 'utf8');
      check('the report has the disclaimer', report.includes('not for clinical use'));
      const snapping = page.waitForEvent('download');
      await page.click(id('snapshot'));
      check(
        'the picture is a PNG',
        readFileSync(await (await snapping).path())
          .subarray(1, 4)
          .toString() === 'PNG',
      );
      const own = join(output, 'command-line');
      execFileSync(lefort, ['predict', join(folder, 'plan.json'), '--ct', join(folder, 'ct.nrrd'), '-o', own], {
        stdio: 'ignore',
      });
      for (const name of ['predicted_skin.vtp', 'predicted_skin.stl'])
        check(
          `${name} equals that of the command line`,
          readFileSync(join(own, name)).equals(readFileSync(join(folder, 'prediction', name))),
        );
      // An outdated prediction is marked.
      await step(page, 'movement');
      await type(page, 'move-anterior', 11);
      await saved(page);
      await dot(page, 'predict', 'stale');
      await step(page, 'compare');
      await page.waitForSelector(id('stale-banner'));
      await settled(page);
      await picture(page, 'stale');
      check('an outdated face cannot be exported', !(await page.locator(id('report')).isVisible()));
    }),
  { slow: true },
);

test(
  'each step at 1920 by 1080',
  () =>
    withShared(
      async (page) => {
        for (const name of ['case', 'anatomy', 'landmarks', 'osteotomy', 'movement', 'tissue', 'predict', 'compare']) {
          await step(page, name);
          await settled(page);
          await page.screenshot({ path: join(output, `large-${name}.png`), timeout: 180000 });
          const overflow = await page.evaluate(() => document.documentElement.scrollWidth > innerWidth);
          check(`${name} fits`, !overflow);
        }
      },
      { width: 1920, height: 1080, scheme: 'dark' },
    ),
  { slow: true },
);

test('a killed server: the page reports it and reconnects', async () => {
  const { folder, remove } = freshFolder('killed');
  const server = await serve(folder);
  const page = await openPage(server.address);
  await server.kill('SIGKILL');
  await page.getByText('The server does not respond').waitFor();
  await page.context().close();
  const again = await serve(folder);
  const next = await openPage(again.address);
  await next.waitForSelector(id('open-example'));
  await next.context().close();
  await again.kill();
  remove();
});

test('a page without the token is refused', async () => {
  const { folder, remove } = freshFolder('token');
  const server = await serve(folder);
  const page = await openPage(server.address.replace(/token=.*/, 'token=wrong'));
  await page.getByText('The planner cannot continue').waitFor();
  await page.context().close();
  await server.kill();
  remove();
});

const good = await runTests({ all, only });
if (shared) {
  await shared.server.kill();
  shared.remove();
}
process.exit(good ? 0 : 1);
