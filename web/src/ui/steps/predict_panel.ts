import { html, nothing } from 'lit-html';
import type { Schemas } from '../../api';
import { fixed, mm } from '../../model';
import type { App } from '../app';
import { residualPlot } from '../plot';
import { isBusyWith, lastJob, stageOf, type NewtonPoint, type State } from '../state';
import { button, chip, empty, hint, notice, progressBar, section, toggle, type Html } from '../widgets';
import { penetrationNotice } from './penetration_notice';
import { overlapNotice, previewState } from './preview_state';

/** Default of the plan: Newton's method stops below this fraction of the first residual. */
const DEFAULT_TOLERANCE = 1e-6;

interface StepRow {
  step: number;
  newton_iterations: number;
  contact_nodes: number;
  p99_penetration_increase_mm: number;
  max_penetration_increase_mm: number;
}

const stepTable = (steps: readonly StepRow[]): Html =>
  html` <table data-id="step-table">
    <thead>
      <tr>
        <th>Step</th>
        <th>Iterations</th>
        <th>Contacts</th>
        <th title="99 % of the contact area penetrates the bone less">P99 depth</th>
        <th>Max depth</th>
      </tr>
    </thead>
    <tbody>
      ${[...steps].reverse().map(
        (x) =>
          html`<tr>
            <td>${x.step}</td>
            <td>${x.newton_iterations}</td>
            <td>${x.contact_nodes}</td>
            <td>${mm(x.p99_penetration_increase_mm, 2)}</td>
            <td>${mm(x.max_penetration_increase_mm, 2)}</td>
          </tr>`,
      )}
    </tbody>
  </table>`;

const stat = (value: unknown, text: string): Html =>
  html`<div>
    <div class="big-number">${value}</div>
    <div class="hint">${text}</div>
  </div>`;

/** The current iteration of the solver. */
const iterateNow = (at: NewtonPoint): Html =>
  html` <div class="stats" data-id="iterate-now">
    ${stat(at.iteration, `iterations, step ${at.step}, attempt ${at.attempt}`)}
    ${stat(at.contact_points, 'points in contact')}
    ${stat(html`${fixed(at.max_penetration_increase_mm, 2)} <small>mm</small>`, 'max penetration of the bone')}
  </div>`;

const toleranceOf = (app: App): number => app.model.doc.plan.solver?.relative_tolerance ?? DEFAULT_TOLERANCE;

export function predictPanel(app: App, s: State): Html {
  if (app.model.doc.plan.segments.length === 0)
    return html`<h2>Predict</h2>
      ${empty(
        'No plan yet',
        'Cut and move a segment first.',
        button('To the osteotomy', () => app.setStep('osteotomy')),
      )}`;
  const isRunning = isBusyWith(s, 'predict');
  return html`
    <h2>Predict ${chip(isRunning ? 'running' : stageOf(s, 'prediction').state)}</h2>
    ${isRunning
      ? runningPart(app, s)
      : html`${endNotices(s)} ${previewSection(app, s)} ${checkNotice(s)} ${lastSolve(app, s)}`}
  `;
}

/** How the last prediction ended. */
function endNotices(s: State): Html {
  const stage = stageOf(s, 'prediction');
  const job = lastJob(s, 'predict');
  return html`${stage.state === 'stale' ? notice('warning', 'The prediction is out of date', stage.why) : nothing}
  ${stage.state === 'unconverged'
    ? notice(
        'error',
        'The solver did not converge',
        html`${s.prediction?.failure || stage.why} The result is not shown. Use more steps or a smaller movement.`,
      )
    : nothing}
  ${stage.state === 'failed' ? notice('error', 'The prediction failed', job?.message || stage.why) : nothing}
  ${job?.state === 'cancelled'
    ? notice('info', 'Stopped', 'Completed stages are stored. The next prediction resumes from them.')
    : nothing}
  ${job?.state === 'interrupted'
    ? notice('warning', 'Interrupted', 'The server stopped during the prediction. Completed stages are stored.')
    : nothing}`;
}

function runningPart(app: App, s: State): Html {
  const job = lastJob(s, 'predict');
  const done = s.steps.at(-1);
  const fraction = done ? done.step / done.steps : (job?.fraction ?? 0);
  return html`${section(
    'Solving',
    html`<div class="row">
      <span class="grow" data-id="predict-stage">${job?.stage || 'waiting'}</span>
      <span class="hint">${done ? `step ${done.step} of ${done.steps}` : `${fixed(fraction * 100, 0)} %`}</span>
    </div>`,
    progressBar(fraction, 'Path'),
    button('Stop', () => job && void app.stopJob(job.id), { kind: 'danger', icon: 'stop', id: 'stop-predict' }),
  )}
  ${section(
    'Residual',
    s.newton.length
      ? html`${residualPlot(s.newton, toleranceOf(app))}${iterateNow(s.newton[s.newton.length - 1])}`
      : hint('Shown when the solver starts, after meshing.'),
  )}
  ${s.steps.length ? section('Steps', stepTable(s.steps)) : nothing}`;
}

function previewSection(app: App, s: State): Html {
  const latency_ms = s.preview.latency_ms ?? 0;
  return section(
    'Preview',
    overlapNotice(s),
    toggle('Preview of the face', s.showPreview, (on) => app.patch({ showPreview: on })),
    previewState(app, s),
    s.preview.state === 'shown'
      ? html`<p class="hint">
          Skin moves by up to <b>${mm(s.preview.max_mm)}</b>. Shown
          <span data-id="preview-latency" data-ms=${latency_ms.toFixed(0)}>${fixed(latency_ms / 1000, 2)} s</span>
          after the change.
        </p>`
      : nothing,
  );
}

function checkNotice(s: State): Html {
  if (stageOf(s, 'check').state !== 'fresh' || !lastJob(s, 'check')?.has_findings) return nothing;
  return notice('warning', 'The check of the plan has findings', 'The prediction can still run. See step 5, Movement.');
}

function lastSolve(app: App, s: State): Html {
  const { state } = stageOf(s, 'prediction');
  if (!s.prediction || (state !== 'fresh' && state !== 'stale' && state !== 'unconverged')) return nothing;
  const { steps, skin_max_shift_mm } = s.prediction;
  const iterations = steps.reduce((sum, x) => sum + x.newton_iterations, 0);
  return section(
    'Last solve',
    penetrationNotice(s),
    html`<div class="stats">
      ${stat(html`${fixed(skin_max_shift_mm, 1)} <small>mm</small>`, 'max skin displacement')}
      ${stat(iterations, `iterations, ${steps.length} steps`)}
    </div>`,
    s.previewDistance ? previewError(s.previewDistance) : nothing,
    s.newton.length ? residualPlot(s.newton, toleranceOf(app)) : nothing,
    html`<details>
      <summary>All steps</summary>
      <div>${stepTable(steps)}</div>
    </details>`,
  );
}

const previewError = ({ p50_mm, p99_mm }: Schemas['PreviewDistance']): Html =>
  html`<p class="hint">
    Error of the preview of this plan where the face moves: median <b>${mm(p50_mm, 2)}</b>, P99
    <b data-id="preview-p99" data-mm=${p99_mm.toFixed(3)}>${mm(p99_mm, 2)}</b>.
  </p>`;

export function predictFoot(app: App, s: State): Html {
  if (app.model.doc.plan.segments.length === 0 || isBusyWith(s, 'predict')) return nothing;
  const isFresh = stageOf(s, 'prediction').state === 'fresh';
  const canResume = ['cancelled', 'interrupted'].includes(lastJob(s, 'predict')?.state ?? '');
  const label = isFresh ? 'Predict again' : canResume ? 'Resume prediction' : 'Predict the face';
  return html` ${button(label, () => void app.run({ kind: 'predict' }), {
    kind: isFresh ? 'plain' : 'primary',
    disabled: s.saving === 'error',
    id: 'predict',
  })}
  ${isFresh
    ? button('Compare before and after', () => app.setStep('compare'), { kind: 'primary', id: 'to-compare' })
    : nothing}`;
}
