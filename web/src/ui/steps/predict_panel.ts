import { html, nothing } from 'lit-html';
import { fixed, mm } from '../../model';
import type { App } from '../app';
import { button, chip, empty, hint, notice, progressBar, section, type Html } from '../widgets';
import { residualPlot } from '../plot';
import { isBusyWith, lastJob, stageOf, type NewtonPoint, type State } from '../state';
import { overlapNotice, previewState } from './movement_panel';
import { toggle } from '../widgets';

/** Newton stops below this share of the first residual unless the plan says otherwise. */
const DEFAULT_TOLERANCE = 1e-6;

interface StepRow {
  step: number;
  newton_iterations: number;
  contact_nodes: number;
  p99_depth_mm: number;
  max_depth_mm: number;
}

const stepTable = (steps: readonly StepRow[]): Html =>
  html` <table data-id="step-table">
    <thead>
      <tr>
        <th>Step</th>
        <th>Iterations</th>
        <th>Contacts</th>
        <th title="99 % of the contact lies less deep in the bone">P99 depth</th>
        <th>Deepest</th>
      </tr>
    </thead>
    <tbody>
      ${[...steps].reverse().map(
        (x) =>
          html`<tr>
            <td>${x.step}</td>
            <td>${x.newton_iterations}</td>
            <td>${x.contact_nodes}</td>
            <td>${mm(x.p99_depth_mm, 2)}</td>
            <td>${mm(x.max_depth_mm, 2)}</td>
          </tr>`,
      )}
    </tbody>
  </table>`;

/** Where the solver is at this moment. */
const iterateNow = (at: NewtonPoint): Html =>
  html` <div class="stats" data-id="iterate-now">
    <div>
      <div class="big-number">${at.iteration}</div>
      <div class="hint">iterations of try ${at.attempt} for step ${at.step}</div>
    </div>
    <div>
      <div class="big-number">${at.contacts}</div>
      <div class="hint">points in contact</div>
    </div>
    <div>
      <div class="big-number">${fixed(at.deepest_mm, 2)} <small>mm</small></div>
      <div class="hint">deepest in the bone</div>
    </div>
  </div>`;

export function predictPanel(app: App, s: State): Html {
  const { plan } = app.model.doc;
  if (plan.segments.length === 0)
    return html`<h2>Predict</h2>
      ${empty(
        'No plan yet',
        'Cut a piece of bone free and move it first.',
        button('To the osteotomy', () => app.setStep('osteotomy')),
      )}`;
  const stage = stageOf(s, 'prediction');
  const job = lastJob(s, 'predict');
  const running = isBusyWith(s, 'predict');
  const tolerance = plan.solver?.relative_tolerance ?? DEFAULT_TOLERANCE;
  const done = s.steps.at(-1);
  const check = stageOf(s, 'check');
  const checkJob = lastJob(s, 'check');
  return html`
    <h2>Predict ${chip(running ? 'running' : stage.state)}</h2>
    ${stage.state === 'stale' && !running ? notice('warning', 'The prediction is out of date', stage.why) : nothing}
    ${stage.state === 'unconverged' && !running
      ? notice(
          'error',
          'The solver did not converge',
          html`${s.prediction?.failure || stage.why} Nothing of it is shown as a prediction. Smaller steps, or a smaller
          move, often help.`,
        )
      : nothing}
    ${stage.state === 'failed' && !running
      ? notice('error', 'The prediction failed', job?.message || stage.why)
      : nothing}
    ${job?.state === 'cancelled' && !running
      ? notice('info', 'Stopped', 'Finished stages are kept: starting again goes on from them.')
      : nothing}
    ${job?.state === 'interrupted' && !running
      ? notice('warning', 'Interrupted', 'The server was stopped in the middle. Finished stages are kept.')
      : nothing}
    ${running
      ? html` ${section(
          'Solving',
          html`<div class="row">
            <span class="grow" data-id="predict-stage">${job?.stage || 'waiting'}</span>
            <span class="hint"
              >${done ? `step ${done.step} of ${done.steps}` : `${fixed((job?.fraction ?? 0) * 100, 0)} %`}</span
            >
          </div>`,
          progressBar(done ? done.step / done.steps : (job?.fraction ?? 0), 'Along the path'),
          button('Stop', () => job && void app.stopJob(job.id), { kind: 'danger', icon: 'stop', id: 'stop-predict' }),
        )}
        ${section(
          'Residual',
          s.newton.length
            ? html`${residualPlot(s.newton, tolerance)}${iterateNow(s.newton[s.newton.length - 1])}`
            : hint('Appears when the equations are being solved; meshing comes first.'),
        )}
        ${s.steps.length ? section('Steps', stepTable(s.steps)) : nothing}`
      : html` ${section(
          'Preview',
          overlapNotice(s),
          toggle('Preview of the face', s.showPreview, (on) => app.patch({ showPreview: on })),
          previewState(app, s),
          s.preview.state === 'shown'
            ? html`<p class="hint">
                Skin moves by up to <b>${mm(s.preview.largest_mm)}</b>. Shown
                <span data-id="preview-latency" data-ms=${(s.preview.latency_ms ?? 0).toFixed(0)}
                  >${fixed((s.preview.latency_ms ?? 0) / 1000, 2)} s</span
                >
                after the change.
              </p>`
            : nothing,
        )}
        ${check.state === 'fresh' && checkJob?.has_findings
          ? notice(
              'warning',
              'Something was found against this plan',
              'The face can be predicted all the same. See step 5, Movement.',
            )
          : nothing}
        ${s.prediction && (stage.state === 'fresh' || stage.state === 'stale' || stage.state === 'unconverged')
          ? section(
              'Last solve',
              html`<div class="stats">
                <div>
                  <div class="big-number">${fixed(s.prediction.skin_largest_shift_mm, 1)} <small>mm</small></div>
                  <div class="hint">largest shift of the skin</div>
                </div>
                <div>
                  <div class="big-number">${s.prediction.steps.reduce((sum, x) => sum + x.newton_iterations, 0)}</div>
                  <div class="hint">iterations, ${s.prediction.steps.length} steps</div>
                </div>
              </div>`,
              s.previewDistance
                ? html`<p class="hint">
                    The preview of this plan is off by <b>${mm(s.previewDistance.p50_mm, 2)}</b> in the middle and
                    <b data-id="preview-p99" data-mm=${s.previewDistance.p99_mm.toFixed(3)}
                      >${mm(s.previewDistance.p99_mm, 2)}</b
                    >
                    at P99, where the face moves.
                  </p>`
                : nothing,
              s.newton.length ? residualPlot(s.newton, tolerance) : nothing,
              html`<details>
                <summary>Every step</summary>
                <div>${stepTable(s.prediction.steps)}</div>
              </details>`,
            )
          : nothing}`}
  `;
}

export function predictFoot(app: App, s: State): Html {
  const { plan } = app.model.doc;
  if (plan.segments.length === 0 || isBusyWith(s, 'predict')) return nothing;
  const stage = stageOf(s, 'prediction');
  const fresh = stage.state === 'fresh';
  const resumes = ['cancelled', 'interrupted'].includes(lastJob(s, 'predict')?.state ?? '');
  return html` ${button(
    fresh ? 'Predict again' : resumes ? 'Go on predicting' : 'Predict the face',
    () => void app.run({ kind: 'predict' }),
    { kind: fresh ? 'plain' : 'primary', disabled: s.saving === 'error', id: 'predict' },
  )}
  ${fresh
    ? button('Compare before and after', () => app.setStep('compare'), { kind: 'primary', id: 'to-compare' })
    : nothing}`;
}
