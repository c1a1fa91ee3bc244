import { html, nothing } from 'lit-html';
import type { Schemas } from '../../api';
import { bytes } from '../../model';
import type { App } from '../app';
import { profilePlot } from '../plot';
import { stageOf, type State } from '../state';
import type { Viewer } from '../viewer';
import { button, chip, empty, hint, icon, notice, section, segmented, toggle, type Html } from '../widgets';
import { afterSurgerySection } from './after_surgery_section';
import { penetrationNotice } from './penetration_notice';
import { legend, missingRegions, regionName, valueCells } from './region_table';
import { uncertaintyPanel } from './uncertainty_panel';
import { variantsPanel } from './variants_panel';

const FILE_WORDS: Record<string, string> = {
  'report.html': 'Report with pictures and numbers',
  'predicted_skin.stl': 'Predicted face',
  'predicted_skin.vtp': 'Predicted face with displacement',
  'skin_before.vtp': 'Face before',
  'bone_segment_moved.vtp': 'Moved segment',
  'bone_remainder.vtp': 'Remaining bone',
  'interface.vtp': 'Interface map',
  'prediction.json': 'All results of the solve',
  'plan.json': 'Plan',
  'landmarks.mrk.json': 'Landmarks',
  'check.json': 'Check of the plan',
  'cephalometry.csv': 'Cephalometry after the movement',
  'worksheet.pdf': 'Worksheet for the operating room',
  'planned_movements.csv': 'Planned movements of segments and landmarks',
  'compare.json': 'All results of the comparison',
  'regions.csv': 'Comparison by region',
  'difference.vtp': 'Predicted face with its distance to the face after surgery',
  'movements.csv': 'Movements of the segments',
  'skin_after.vtp': 'Face after surgery, registered to the scan before surgery',
  'uncertainty_report.html': 'Report of the band by uncertain inputs',
  'uncertainty.json': 'All results of the band',
  'uncertainty.vtp': 'Median face with its band',
  'samples.csv': 'Samples of the uncertain inputs',
  'uncertain_inputs.json': 'Inputs of the band, with distributions',
};

const MODES = [
  { value: 'slider', text: 'Slider' },
  { value: 'beside', text: 'Side by side' },
  { value: 'after', text: 'After' },
] as const;

const BONE_PAINTS = [
  { value: 'none', text: 'Plain' },
  { value: 'pressure', text: 'Pressure', title: 'Contact pressure of the tissue on the mobilized segment' },
  { value: 'depth', text: 'Depth', title: 'Increase of the penetration of tissue into bone since the rest state' },
] as const;

const COMPARE_VIEWS = [
  { value: 'faces', text: 'Faces', title: 'The face before surgery and the predicted one' },
  { value: 'band', text: 'Uncertainty', title: 'The band of the predicted face by uncertain inputs' },
  { value: 'variants', text: 'Plans', title: 'Variants of the plan side by side' },
] as const;

const STAGE_OF_VIEW = { faces: 'prediction', band: 'uncertainty', variants: 'variants' } as const;

const stateChip = (state: Schemas['Stage']['state']): Html => (state === 'missing' ? nothing : chip(state));

export const comparePanel = (app: App, s: State, view: Viewer): Html =>
  html`<h2>Compare ${stateChip(stageOf(s, STAGE_OF_VIEW[s.compareView]).state)}</h2>
    ${segmented('What is shown', COMPARE_VIEWS, s.compareView, (v) => void app.outcome.show(v))}
    ${s.compareView === 'band'
      ? uncertaintyPanel(app, s, view)
      : s.compareView === 'variants'
        ? variantsPanel(app, s)
        : facesPanel(app, s, view)}`;

function facesPanel(app: App, s: State, view: Viewer): Html {
  const stage = stageOf(s, 'prediction');
  const toPrediction = button('To the prediction', () => app.setStep('predict'));
  if (stage.state === 'missing' || stage.state === 'running' || !s.prediction)
    return empty(
      'No prediction yet',
      stage.state === 'running' ? 'The prediction is running.' : 'Predict the face first.',
      toPrediction,
    );
  if (!s.prediction.converged)
    return html`${notice('error', 'Not converged: there is no face to compare', s.prediction.failure)}${toPrediction}`;
  return html`
    ${stage.state === 'stale' ? notice('warning', 'Out of date: predicted for an earlier plan', stage.why) : nothing}
    ${penetrationNotice(s)} ${segmented('Comparison mode', MODES, s.compareMode, (v) => app.patch({ compareMode: v }))}
    ${showSection(app, s)} ${displacementSection(s)} ${afterSurgerySection(app, s)} ${profileSection(view)}
    ${exportSection(app, s, view)}
  `;
}

function showSection(app: App, s: State): Html {
  return section(
    'Show',
    toggle('Skin displacement', s.skinPaint === 'moved', (on) => app.patch({ skinPaint: on ? 'moved' : 'none' })),
    s.skinPaint === 'moved' ? legend('distance', s.distanceTop_mm, 'mm', 'legend') : nothing,
    toggle('Bones under transparent skin', s.showBones, (on) => app.patch({ showBones: on })),
    s.showBones
      ? segmented('Contact on the mobilized segment', BONE_PAINTS, s.bonePaint, (v) => app.patch({ bonePaint: v }))
      : nothing,
    s.showBones && s.bonePaint !== 'none' ? contactLegend(s) : nothing,
  );
}

function contactLegend(s: State): Html {
  if (s.boneTop !== null) return legend('depth', s.boneTop, s.bonePaint === 'pressure' ? 'kPa' : 'mm', 'bone-legend');
  const isLastStep = s.compareStep === s.prediction?.steps.length;
  return hint(
    isLastStep
      ? 'This prediction has no contact: the tissue is bonded to the bone, or an earlier version of lefort made it.'
      : 'Contact is stored for the last step only.',
  );
}

function displacementSection(s: State): Html {
  return section(
    'Skin displacement',
    s.regionShifts
      ? displacementTable(s)
      : hint(s.compareStep === 0 ? 'Before surgery, nothing has moved.' : 'Measuring …'),
    hint('mm, over area, at the step shown. Simulation only; not compared with this patient’s outcome.'),
  );
}

function displacementTable({ regionShifts }: State): Html {
  if (!regionShifts) return nothing;
  return html`<table data-id="distance-table">
      <thead>
        <tr>
          <th></th>
          <th title="Half of the area moved less">P50</th>
          <th title="99 % of the area moved less">P99</th>
          <th>Max</th>
        </tr>
      </thead>
      <tbody>
        ${regionShifts.regions.map(
          ({ region, shift }) =>
            html`<tr>
              <td>${regionName(region)}</td>
              ${valueCells([shift.median_mm, shift.p99_mm, shift.max_mm])}
            </tr>`,
        )}
      </tbody>
    </table>
    ${missingRegions(regionShifts.missing)}`;
}

function profileSection(view: Viewer): Html {
  const profile = view.compare.profile();
  if (!profile) return nothing;
  return section(
    'Profile',
    profilePlot(profile.before, profile.after),
    hint('In the mid-sagittal plane, from the right. Dashed: before.'),
  );
}

function exportSection(app: App, s: State, view: Viewer): Html {
  const isFresh = stageOf(s, 'prediction').state === 'fresh';
  return section(
    'Export',
    html`<div class="row wrap">
      ${button('Picture', () => view.compare.savePicture(), { icon: 'camera', id: 'snapshot' })}
      ${isFresh
        ? button('Report', () => void app.download('report.html'), { icon: 'download', kind: 'primary', id: 'report' })
        : nothing}
    </div>`,
    isFresh ? fileList(app, s) : hint('A prediction that is out of date cannot be exported. Predict again first.'),
  );
}

const fileList = (app: App, s: State): Html => {
  // A band can be out of date if the prediction is not.
  const isExported = ({ stage }: { stage: string }): boolean =>
    (stage !== 'uncertainty' && stage !== 'variants') || stageOf(s, stage).state === 'fresh';
  return html`<details>
    <summary>All files</summary>
    <div class="list">
      ${s.files
        .filter(isExported)
        .map(
          (file) =>
            html` <button type="button" class="list-main" @click=${() => void app.download(file.name)}>
              ${icon('download')}<span title=${FILE_WORDS[file.name] ?? ''}>${file.name}</span
              ><span class="hint">${bytes(file.bytes)}</span>
            </button>`,
        )}
    </div>
  </details>`;
};

/** Slider of the step: before surgery at the left, the planned position at the right. */
export function compareDock(app: App, s: State): Html {
  const steps = s.prediction?.converged ? s.prediction.steps.length : 0;
  if (steps === 0 || s.compareView !== 'faces') return nothing;
  return html` <div class="dock">
    <span class="hint">Along the path</span>
    <div class="timeline">
      <div class="rule"></div>
      <input
        type="range"
        min="0"
        max=${steps}
        step="1"
        .value=${String(s.compareStep)}
        aria-label="Step of the path"
        data-id="compare-step"
        @input=${(e: Event) => app.patch({ compareStep: Number((e.target as HTMLInputElement).value) })}
      />
      <button type="button" class="keyframe start" .style=${'left:0'} @click=${() => app.patch({ compareStep: 0 })}>
        before
      </button>
      <button
        type="button"
        class="keyframe last"
        .style=${'left:100%'}
        @click=${() => app.patch({ compareStep: steps })}
      >
        planned
      </button>
    </div>
    <div class="hint" .style=${'min-width:78px;text-align:right'}>step ${s.compareStep} of ${steps}</div>
  </div>`;
}
