import { html, nothing } from 'lit-html';
import type { Schemas } from '../../api';
import { fixed, mm, toVec3 } from '../../model';
import type { App } from '../app';
import { chooseFiles } from '../choose_files';
import { isBusyWith, lastJob, stageOf, type State } from '../state';
import { button, hint, notice, progressBar, section, segmented, toggle, type Html } from '../widgets';
import { inWords } from './movement_panel';
import { legend, missingRegions, regionName, valueCells } from './region_table';

/** Movements below this length are reported as none [mm]. */
const MIN_MOVEMENT_MM = 0.05;

/** Comparison of the prediction with the face after surgery. */
export function afterSurgerySection(app: App, s: State): Html {
  const isBusy = isBusyWith(s, 'compare') || s.upload !== null;
  return section('After surgery', isBusy ? progress(app, s) : result(app, s));
}

function progress(app: App, s: State): Html {
  const job = lastJob(s, 'compare');
  const stop = (id: number): Html =>
    button('Stop', () => void app.stopJob(id), { kind: 'danger', icon: 'stop', id: 'stop-compare' });
  return html`<div class="row">
      <span class="grow" data-id="compare-stage"
        >${s.upload ? `Uploading ${s.upload.name}` : job?.stage || 'waiting'}</span
      >
      ${job && isBusyWith(s, 'compare') ? stop(job.id) : nothing}
    </div>
    ${progressBar(s.upload?.fraction ?? job?.fraction ?? 0, 'Comparison')}`;
}

function result(app: App, s: State): Html {
  const stage = stageOf(s, 'comparison');
  const job = lastJob(s, 'compare');
  const send = (files: File[]): void => void app.outcome.compareWith(files);
  return html` ${stage.state === 'stale'
      ? notice('warning', 'This comparison is of an earlier prediction', stage.why)
      : nothing}
    ${job?.state === 'failed' ? notice('error', 'The comparison failed', job.message) : nothing}
    ${s.comparison
      ? comparisonResult(app, s, s.comparison)
      : hint(
          'A scan after surgery gives the movement of the bone and the error of the predicted face. ' +
            'A surface of the face (VTP, STL, PLY, OBJ, in the frame of the scan) gives the error only.',
        )}
    <div class="row wrap">
      ${button('Scan folder', () => chooseFiles(true, send), { icon: 'folder', id: 'compare-folder' })}
      ${button('Scan or surface', () => chooseFiles(false, send), { id: 'compare-files' })}
    </div>`;
}

/** A movement of bone in words. */
function describe({ shift_mm, turn_deg, largest_mm }: Schemas['MovementDifference']): string {
  if (largest_mm < MIN_MOVEMENT_MM) return 'has not moved';
  return `moved ${inWords({ translation_mm: toVec3(shift_mm), rotation_deg: toVec3(turn_deg), about_mm: [0, 0, 0] })}`;
}

function comparisonResult(app: App, s: State, found: Schemas['Comparison']): Html {
  return html` ${found.warnings.map((text) => notice('warning', 'About this scan', text))}
  ${found.movements.map(
    ({ segment, achieved, from_plan_to_achieved: difference }) =>
      html`<p data-id="achieved">
        <strong>${segment}</strong> ${describe(achieved)}.
        <span class="hint"
          >Difference from the plan: translation ${mm(difference.shift_length_mm)}, rotation
          ${fixed(difference.turn_angle_deg, 1)}°.</span
        >
      </p>`,
  )}
  ${found.registration
    ? hint(
        `Registration on stationary bone: RMS distance ${mm(found.registration.rms_mm, 2)}, ` +
          `${fixed(100 * found.registration.kept_share, 0)} % inliers.`,
      )
    : nothing}
  ${errorTable(found)} ${missingRegions(found.missing)} ${displayOptions(app, s)}`;
}

const errorTable = ({ regions }: Schemas['Comparison']): Html =>
  html`<table data-id="error-table">
      <thead>
        <tr>
          <th></th>
          <th colspan="2">Error of the prediction</th>
          <th colspan="2">Baseline: no change</th>
        </tr>
        <tr>
          <th></th>
          <th>P50</th>
          <th>P99</th>
          <th>P50</th>
          <th>P99</th>
        </tr>
      </thead>
      <tbody>
        ${regions.map(
          ({ region, face, if_unchanged: baseline }) =>
            html`<tr>
              <td>${regionName(region)}</td>
              ${valueCells([face.median_mm, face.p99_mm, baseline?.median_mm ?? null, baseline?.p99_mm ?? null])}
            </tr>`,
        )}
      </tbody>
    </table>
    ${hint('mm, over area. The prediction is useful where its error is below the baseline, the face before surgery.')}`;

function displayOptions(app: App, s: State): Html {
  const colorByError = (on: boolean): void =>
    app.patch(on ? { skinPaint: 'error', compareStep: s.prediction?.steps.length ?? 0 } : { skinPaint: 'none' });
  return html`${toggle('Color the face by its error', s.skinPaint === 'error', colorByError)}
  ${s.skinPaint === 'error' ? legend('distance', s.errorTop_mm, 'mm', 'error-legend') : nothing}
  ${app.model.surfaces.has('after_surgery')
    ? segmented(
        'Left',
        [
          { value: 'before', text: 'Before' },
          { value: 'after_surgery', text: 'After surgery' },
        ] as const,
        s.against,
        (v) => app.patch({ against: v }),
      )
    : nothing}`;
}
