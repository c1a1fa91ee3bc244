import { html, nothing, render } from 'lit-html';
import type { ViewName } from '../model';
import { canRedo, canUndo } from '../model';
import type { App } from './app';
import { JOB_NAMES } from './job_tracker';
import { button, empty, icon, iconButton, progressBar, segmented, type Html } from './widgets';
import type { Viewer } from './viewer';
import { isVariantsShown, runningJob, stageOf, STEPS, type State, type StepName } from './state';
import { anatomyPanel } from './steps/anatomy_panel';
import { casePanel, welcome } from './steps/case_panel';
import { compareDock, comparePanel } from './steps/compare_panel';
import { landmarkPanel } from './steps/landmark_panel';
import { cephalogramCover } from './steps/cephalogram_section';
import { measuresPanel } from './steps/measures_panel';
import { movementPanel } from './steps/movement_panel';
import { osteotomyFoot, osteotomyPanel } from './steps/osteotomy_panel';
import { predictFoot, predictPanel } from './steps/predict_panel';
import { timeline } from './steps/timeline';
import { tissuePanel } from './steps/tissue_panel';
import { variantsCover } from './steps/variants_panel';

const PANELS: Record<StepName, (app: App, s: State, view: Viewer) => Html> = {
  case: casePanel,
  anatomy: anatomyPanel,
  landmarks: landmarkPanel,
  osteotomy: osteotomyPanel,
  movement: movementPanel,
  tissue: tissuePanel,
  predict: predictPanel,
  compare: comparePanel,
  measures: measuresPanel,
};

const FEET: Partial<Record<StepName, (app: App, s: State) => Html>> = {
  osteotomy: osteotomyFoot,
  predict: predictFoot,
};

const LAYOUTS: Record<StepName, 'four' | 'slices' | 'three'> = {
  case: 'four',
  anatomy: 'four',
  landmarks: 'four',
  osteotomy: 'slices',
  movement: 'three',
  tissue: 'three',
  predict: 'three',
  compare: 'three',
  measures: 'three',
};

/** Points and numbers are checked on slices. */
const isOnSlices = (s: State): boolean => s.step === 'measures' && (s.measure === 'teeth' || s.measure === 'nerve');

function layoutOf(s: State): 'four' | 'slices' | 'three' {
  if (isOnSlices(s)) return 'four';
  return s.step === 'movement' && s.showSlices ? 'slices' : LAYOUTS[s.step];
}

const VIEWS: { value: ViewName; text: string; title: string }[] = [
  { value: 'front', text: 'Front', title: 'From the front' },
  { value: 'right', text: 'R', title: 'From the patient’s right' },
  { value: 'right three-quarter', text: '¾ R', title: 'Three-quarter, from the patient’s right' },
  { value: 'left three-quarter', text: '¾ L', title: 'Three-quarter, from the patient’s left' },
  { value: 'left', text: 'L', title: 'From the patient’s left' },
  { value: 'below', text: 'Below', title: 'From below' },
];

/** The state of a step, shown by a dot. */
function dotOf(app: App, s: State, step: StepName): string {
  const stage = {
    case: 'scan',
    anatomy: 'anatomy',
    landmarks: 'landmarks',
    osteotomy: 'cut',
    movement: 'check',
    tissue: null,
    predict: 'prediction',
    compare: null,
    measures: null,
  }[step] as 'scan' | 'anatomy' | 'landmarks' | 'cut' | 'check' | 'prediction' | null;
  if (!stage) return '';
  if (stage === 'check' && app.model.doc.plan.segments.length === 0) return '';
  const { state } = stageOf(s, stage);
  return state === 'missing' ? '' : state;
}

const DOT_WORDS: Record<string, string> = {
  fresh: 'up to date',
  stale: 'out of date',
  running: 'working',
  failed: 'failed',
  unconverged: 'not converged',
};

function topBar(app: App, s: State): Html {
  const job = runningJob(s);
  const history = app.model.history.value;
  const waiting = s.jobs.filter((x) => x.state === 'queued').length - (job?.state === 'queued' ? 1 : 0);
  const saving = { saved: 'Saved', saving: 'Saving …', unsaved: 'Not saved', error: 'Not saved' }[s.saving];
  return html` <header class="top">
    <div class="mark">
      <svg viewBox="0 0 32 32" aria-hidden="true">
        <rect width="32" height="32" rx="7" fill="#0f5f73"></rect>
        <path
          d="M9 7v18h14M9 18h9"
          fill="none"
          stroke="#fff"
          stroke-width="3.2"
          stroke-linecap="round"
          stroke-linejoin="round"
        ></path></svg
      >lefort
    </div>
    ${s.case?.title ? html`<div class="case-title">${s.case.title}</div>` : nothing}
    <div class="spring"></div>
    ${job
      ? html`<div class="job" data-id="job">
          <div class="job-text">
            ${JOB_NAMES[job.kind]}
            <small>${job.state === 'queued' ? 'waiting' : job.stage}${waiting > 0 ? `, ${waiting} waiting` : ''}</small>
          </div>
          ${progressBar(job.fraction, JOB_NAMES[job.kind])}${iconButton('stop', 'Stop', () => void app.stopJob(job.id))}
        </div>`
      : nothing}
    <div class="not-clinical" role="note">Research software – not for clinical use</div>
    <div class="saved ${s.saving === 'error' ? 'error' : ''}" title=${s.saveError ?? ''} role="status" data-id="saving">
      ${s.saveError && s.saving === 'error' ? 'Not saved' : saving}
    </div>
    <div class="top-buttons">
      ${iconButton('undo', 'Undo (Ctrl+Z)', () => app.undo(), !canUndo(history))}
      ${iconButton('redo', 'Redo (Ctrl+Shift+Z)', () => app.redo(), !canRedo(history))}
      ${iconButton(s.theme === 'system' ? 'system' : s.theme === 'light' ? 'sun' : 'moon', `Colors: ${s.theme}`, () =>
        nextTheme(app, s),
      )}
      ${iconButton('help', 'Keyboard (?)', () => app.patch({ help: true }))}
    </div>
  </header>`;
}

function nextTheme(app: App, s: State): void {
  const theme = ({ system: 'light', light: 'dark', dark: 'system' } as const)[s.theme];
  localStorage.setItem('lefort-theme', theme);
  app.patch({ theme });
}

function rail(app: App, s: State): Html {
  return html` <nav class="rail" aria-label="Steps">
    ${STEPS.map(({ name, title }, index) => {
      const dot = dotOf(app, s, name);
      return html`<button
        type="button"
        class="step"
        data-step=${name}
        aria-current=${s.step === name ? 'step' : nothing}
        @click=${() => app.setStep(name)}
      >
        <span class="step-number">${index + 1}</span><span>${title}</span>
        <span class="dot ${dot}" title=${DOT_WORDS[dot] ?? ''}
          >${dot ? html`<span class="visually-hidden">${DOT_WORDS[dot]}</span>` : nothing}</span
        >
      </button>`;
    })}
    <div class="rail-foot">
      ${s.case ? html`lefort ${s.case.version}<br />` : nothing}Simulation only; not compared with this patient’s
      outcome.
    </div>
  </nav>`;
}

function bandBanner(s: State): Html {
  if (s.step !== 'compare' || s.compareView !== 'band' || !s.uncertainty) return nothing;
  return stageOf(s, 'uncertainty').state === 'stale'
    ? html`<div class="banner warning" data-id="stale-band">
        Out of date <small>this band is of another plan or scan</small>
      </div>`
    : html`<div class="banner" data-id="band-banner">
        Width of the band P5 to P95 <small>by the named inputs only; a simulation</small>
      </div>`;
}

function banners(s: State): Html {
  const stage = stageOf(s, 'prediction');
  const previewing =
    (s.step === 'movement' || s.step === 'predict') &&
    s.showPreview &&
    (s.preview.state === 'shown' || s.preview.state === 'waiting');
  return html`<div class="view-banner" aria-live="polite">
    ${s.connection === 'lost'
      ? html`<div class="banner error">
          The server does not respond <small>Reconnecting. Saved changes are safe.</small>
        </div>`
      : nothing}
    ${previewing
      ? html`<div class="banner preview" data-id="preview-banner">
          Preview, not a prediction
          <small
            >${s.preview.state === 'waiting'
              ? '…'
              : s.preview.latency_ms !== null
                ? html`<span data-id="preview-latency" data-ms=${s.preview.latency_ms.toFixed(0)}
                    >${(s.preview.latency_ms / 1000).toFixed(2)} s</span
                  >`
                : ''}</small
          >
        </div>`
      : nothing}
    ${bandBanner(s)}
    ${s.step === 'compare' && s.compareView === 'faces' && stage.state === 'stale'
      ? html`<div class="banner warning" data-id="stale-banner">
          Out of date <small>the plan has changed since this face was predicted</small>
        </div>`
      : nothing}
    ${s.step === 'compare' && s.compareView === 'faces' && stage.state === 'fresh'
      ? html`<div class="banner">
          Prediction <small>a simulation; step ${s.compareStep} of ${s.prediction?.steps.length ?? 0}</small>
        </div>`
      : nothing}
    ${s.scrub !== null ? html`<div class="banner">${Math.round(s.scrub * 100)} % of the path</div>` : nothing}
    ${s.surfacesLoading > 0 || s.volumeLoading
      ? html`<div class="banner" role="status">Loading ${s.volumeLoading ? 'the scan' : 'surfaces'} …</div>`
      : nothing}
  </div>`;
}

function covers(app: App, s: State): Html {
  if (s.fatal)
    return html`<div class="cover">
      <div class="cover-card">
        <h2>The planner cannot continue</h2>
        <p>${s.fatal}</p>
        <p>Open the address that <code>lefort serve</code> printed. It ends with a token that changes at each start.</p>
      </div>
    </div>`;
  if (!s.case)
    return html`<div class="cover" aria-busy="true">
      <div class="cover-card">
        <h2>Opening the case …</h2>
        ${progressBar(0.3, 'Opening')}
      </div>
    </div>`;
  if (!s.case.scan)
    return s.step === 'case'
      ? welcome(app, s)
      : html`<div class="cover">
          ${empty(
            'No scan yet',
            'Start with a head CT.',
            button('To the case', () => app.setStep('case'), { kind: 'primary' }),
          )}
        </div>`;
  if (s.step === 'measures' && s.measure === 'cephalogram') return cephalogramCover(s);
  if (s.step === 'compare' && s.compareView === 'band')
    return stageOf(s, 'uncertainty').etag === null
      ? html`<div class="cover">
          ${stageOf(s, 'uncertainty').state === 'running'
            ? empty('Computing the band …', 'Each sample is a prediction on a coarse mesh.')
            : empty('No band yet', 'Compute it in the panel on the right.')}
        </div>`
      : nothing;
  if (isVariantsShown(s)) return variantsCover(s);
  if (s.step === 'compare' && stageOf(s, 'prediction').state === 'missing')
    return html`<div class="cover">
      ${empty(
        'Nothing to compare yet',
        'After the prediction, the faces before and after surgery are compared here.',
        button('To the prediction', () => app.setStep('predict'), { kind: 'primary' }),
      )}
    </div>`;
  return nothing;
}

const KEYS: [string, string][] = [
  ['1 – 9', 'Go to a step'],
  ['Ctrl+Z, Ctrl+Shift+Z', 'Undo, redo'],
  ['F, R, L, B', 'View from the front, the right, the left, below'],
  ['↑ ↓, PgUp PgDn', 'Next and previous slice, when a slice has the focus'],
  ['↑ ↓ in a number', 'Change by one step; with Shift by ten'],
  ['[ and ]', 'Move the divider between before and after; radius of the boundary brush'],
  ['E', 'Switch the boundary brush between painting and erasing'],
  ['Delete', 'Remove the selected landmark, plane, keyframe or corrected point'],
  ['Enter, Escape', 'Close the curve; cancel a tool'],
  ['?', 'Show this list'],
];

function dialogs(app: App, s: State): Html {
  if (s.conflict)
    return html`<div class="scrim">
      <div class="dialog" role="alertdialog" aria-modal="true" aria-labelledby="conflict-title" data-id="conflict">
        <h2 id="conflict-title">
          Another page changed
          ${{ plan: 'the plan', landmarks: 'the landmarks', boundary: 'the painted boundary' }[s.conflict]} first
        </h2>
        <p>
          This page has changes that are not saved. Only one of the two versions can be kept; undo on this page restores
          the other.
        </p>
        <div class="row">
          ${button('Use theirs', () => void app.resolveConflict('theirs'), { id: 'take-theirs' })}${button(
            'Keep mine',
            () => void app.resolveConflict('mine'),
            { kind: 'primary', id: 'keep-mine' },
          )}
        </div>
      </div>
    </div>`;
  if (s.confirm) {
    const { title, text, action, run } = s.confirm;
    const answer = (isYes: boolean): void => {
      app.patch({ confirm: null });
      if (isYes) run();
    };
    return html`<div class="scrim">
      <div class="dialog" role="alertdialog" aria-modal="true" aria-labelledby="confirm-title" data-id="confirm">
        <h2 id="confirm-title">${title}</h2>
        <p>${text}</p>
        <div class="row">
          ${button('Cancel', () => answer(false), { id: 'confirm-no' })}${button(action, () => answer(true), {
            kind: action === 'Delete' ? 'danger' : 'primary',
            id: 'confirm-yes',
          })}
        </div>
      </div>
    </div>`;
  }
  if (s.help)
    return html`<div class="scrim" @click=${(e: Event) => e.target === e.currentTarget && app.patch({ help: false })}>
      <div class="dialog" role="dialog" aria-modal="true" aria-labelledby="help-title">
        <h2 id="help-title">Keyboard and mouse</h2>
        <div class="keys">${KEYS.map(([key, what]) => html`<kbd>${key}</kbd><span>${what}</span>`)}</div>
        <p class="hint">
          3D: drag rotates, wheel zooms, right button pans. Slices: click moves the cursor, wheel changes the slice,
          right button changes the window, Ctrl and wheel zooms, Alt and drag pans.
        </p>
        <div class="row">${button('Close', () => app.patch({ help: false }), { kind: 'primary' })}</div>
      </div>
    </div>`;
  return nothing;
}

export function drawShell(root: HTMLElement, app: App, view: Viewer): void {
  const { s } = app.model;
  const layout = layoutOf(s);
  const panel = PANELS[s.step](app, s, view);
  const foot = FEET[s.step]?.(app, s) ?? nothing;
  const dock = s.step === 'movement' ? timeline(app, s) : s.step === 'compare' ? compareDock(app, s) : nothing;
  render(
    html` <div class="shell">
        ${topBar(app, s)} ${rail(app, s)}
        <main
          class="stage"
          aria-busy=${String(
            s.case === null ||
              s.volumeLoading ||
              s.surfacesLoading > 0 ||
              (s.case.scan !== null && s.volume === null && !s.fatal),
          )}
          aria-label=${STEPS.find((x) => x.name === s.step)!.title}
        >
          <div class="views" data-layout=${layout}>
            ${layout === 'slices' ? html`${view.view.element}` : nothing} ${view.slices[0].element}
            ${layout !== 'slices' ? html`${view.view.element}` : nothing}
            ${view.slices[1].element}${view.slices[2].element}
          </div>
          ${dock} ${banners(s)}
          <div class="view-bar">
            ${layout !== 'four' ? segmented('View from', VIEWS, null, (name) => view.view.look(name)) : nothing}
          </div>
          ${covers(app, s)}
        </main>
        <aside class="panel" aria-label="Tools of this step">
          <div class="panel-body">${panel}</div>
          ${foot === nothing ? nothing : html`<div class="panel-foot">${foot}</div>`}
        </aside>
      </div>
      <div class="toasts" role="status">
        ${s.toasts.map(
          (t) =>
            html`<div class="toast ${t.kind}">
              ${t.kind === 'error' ? icon('warning') : nothing}<span>${t.text}</span>${iconButton(
                'close',
                'Dismiss',
                () => app.dismiss(t.id),
              )}
            </div>`,
        )}
      </div>
      ${dialogs(app, s)}`,
    root,
  );
}
