// Actions of a user, as functions of a page.
export const step = async (page, name) => {
  await page.click(`[data-step=${name}]`);
  await page.waitForSelector(`[data-step=${name}][aria-current=step]`);
};

/** Waits until the dot of a step has a state. */
export const dot = (page, name, state, timeout = 600000) =>
  page.waitForSelector(`[data-step=${name}] .dot.${state}`, { timeout, state: 'attached' });

export const id = (name) => `[data-id="${name}"]`;

/** All surfaces and the scan are loaded and drawn. */
export async function settled(page) {
  await page.waitForSelector('main[aria-busy=false]', { timeout: 180000 });
  await drawn(page);
}

/** The 3D view is drawn in full. */
export async function drawn(page) {
  await page.waitForTimeout(400);
  await page.waitForSelector('.view3d canvas[data-idle=true]', { timeout: 180000 });
}

/** No job is running or queued. */
export const idle = (page, timeout = 900000) => page.waitForSelector(id('job'), { state: 'detached', timeout });

/** All changes are saved. Waits first, until the last change is shown as unsaved. */
export async function saved(page) {
  await page.waitForTimeout(300);
  await page.waitForFunction(() => document.querySelector('[data-id=saving]')?.textContent.trim() === 'Saved', null, {
    timeout: 60000,
  });
}

export async function handles(page) {
  return JSON.parse(await page.getAttribute('.view3d canvas:not(.overlay)', 'data-handles'));
}

/** Waits until a handle exists at a position that `holds` accepts; returns the position. */
export async function handleWhere(page, name, holds = () => true) {
  const until = Date.now() + 60000;
  for (;;) {
    const at = (await handles(page))[name];
    if (at && holds(at)) return at;
    if (Date.now() > until) throw new Error(`the view has no handle "${name}" where it should be: ${at}`);
    await page.waitForTimeout(100);
  }
}

/** Presses on a handle of the 3D view and drags it by pixels. Returns how long it took [ms]. */
export async function dragHandle(page, name, dx, dy, steps = 40) {
  await drawn(page);
  const found = await handleWhere(page, name);
  const box = await page.locator('.view3d canvas:not(.overlay)').boundingBox();
  const [x, y] = [box.x + found[0], box.y + found[1]];
  const since = Date.now();
  await page.mouse.move(x, y);
  await page.mouse.down();
  for (let n = 1; n <= steps; n++) await page.mouse.move(x + (dx * n) / steps, y + (dy * n) / steps);
  await page.mouse.up();
  return Date.now() - since;
}

/** Clicks in the 3D view, by fractions of its size. */
export async function click3d(page, u, v) {
  const box = await page.locator('.view3d canvas:not(.overlay)').boundingBox();
  await page.mouse.click(box.x + u * box.width, box.y + v * box.height);
}

export async function look(page, title) {
  await page.click(`.view-bar button[title="${title}"]`);
  await drawn(page);
}

/** Types a number into a field and leaves it. */
export async function type(page, field, value) {
  await page.fill(id(field), String(value));
  await page.press(id(field), 'Enter');
}

export async function openExample(page) {
  await page.click(id('open-example'));
  await dot(page, 'anatomy', 'fresh');
  await idle(page);
  await settled(page);
}
