// From the scan to the plan.
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { accessible } from './accessible.mjs';
import { check, test } from './harness.mjs';
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
import { measured, output, picture, withShared } from './shared_case.mjs';

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
    for (let part = 0; part < 1; ) {
      part = Math.min(1, 1 - (until - Date.now()) / 3000);
      await page.mouse.move(box.x + found[0] + 12 * px * part, box.y + found[1]);
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
    await page.waitForSelector(id('interface-map'));
    await page.locator(id('interface-map')).scrollIntoViewIfNeeded();
    await picture(page, 'interface');
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
