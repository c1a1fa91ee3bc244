import { Client } from '../api';
import { App } from './app';
import { listenToKeys } from './keyboard';
import { Viewer } from './viewer';
import { drawShell } from './shell';
import { idle, nextFrame } from './schedule';
import type { State } from './state';

/** Reads the token after # in the address, stores it for reloads of this tab, and removes it from the address. */
function takeToken(): string | null {
  const given = new URLSearchParams(location.hash.slice(1)).get('token');
  if (given) {
    sessionStorage.setItem('lefort-token', given);
    history.replaceState(null, '', location.pathname);
  }
  return sessionStorage.getItem('lefort-token');
}

function applyTheme(theme: State['theme']): void {
  const dark = theme === 'dark' || (theme === 'system' && matchMedia('(prefers-color-scheme: dark)').matches);
  document.documentElement.dataset.theme = dark ? 'dark' : 'light';
}

export function startPlanner(root: HTMLElement): void {
  root.textContent = ''; // index.html shows a text until the page is loaded.
  const view = new Viewer();
  const token = takeToken();
  const app = new App(new Client('api/v1', token ?? ''), view);
  view.attach(app);
  const theme = localStorage.getItem('lefort-theme');
  if (theme === 'light' || theme === 'dark') app.patch({ theme });
  applyTheme(app.model.s.theme);
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
    applyTheme(app.model.s.theme);
    view.view.render();
  });

  let waits = false;
  let isDrawing = false;
  const drawNow = (): void => {
    waits = false;
    isDrawing = true;
    try {
      drawShell(root, app, view);
    } finally {
      isDrawing = false;
    }
  };
  const drawWaiting = (): void => {
    if (waits) drawNow();
  };
  const draw = (): void => {
    if (waits) return;
    waits = true;
    // During a drag, the 3D view has priority over the numbers of the panel.
    if (view.isDragging) idle(drawWaiting);
    else nextFrame(drawWaiting);
  };
  app.model.state.subscribe((state, before) => {
    if (state.theme !== before.theme) {
      applyTheme(state.theme);
      view.view.render();
    }
    draw();
  });
  // Without delay: a control edits the plan with which it was drawn, and must not revert an earlier edit. Drawing can
  // remove an input field, which then reports its last value; drawing must not start again within that.
  app.model.history.subscribe(() => {
    if (view.isDragging || isDrawing) draw();
    else drawNow();
  });
  listenToKeys(app, view);
  addEventListener('beforeunload', (event) => {
    if (app.model.s.saving === 'unsaved' || app.model.s.saving === 'saving') event.preventDefault();
  });
  drawShell(root, app, view);
  performance.mark('planner shown');
  if (token === null) app.patch({ fatal: 'The address has no token.' });
  else void app.start();
}
