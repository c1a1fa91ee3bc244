// Pages of one case, and the prediction.
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { accessible } from './accessible.mjs';
import { check, freshFolder, lefort, openPage, serve, test } from './harness.mjs';
import { dot, id, idle, saved, settled, step, type } from './planner.mjs';
import { output, picture, withShared } from './shared_case.mjs';

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

/** Uses the comparison: modes, steps, report and picture. */
async function useComparison(page) {
  await page.click(id('to-compare'));
  await settled(page);
  await page.waitForFunction((sel) => document.querySelectorAll(`${sel} tbody tr`).length >= 3, id('distance-table'));
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
}

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
      await useComparison(page);
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
