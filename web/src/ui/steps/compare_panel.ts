import { html, nothing } from 'lit-html';
import type { Schemas } from '../../api';
import { bytes, fixed, gradientOf, mm, ticksOf, toVec3, type ScaleName, type Vec3 } from '../../model';
import type { App } from '../app';
import { chooseFiles } from '../choose_files';
import type { Viewer } from '../viewer';
import {
  button,
  chip,
  empty,
  hint,
  icon,
  notice,
  progressBar,
  section,
  segmented,
  toggle,
  type Html,
} from '../widgets';
import { profilePlot } from '../plot';
import { isBusyWith, lastJob, stageOf, type State } from '../state';
import { inWords } from './movement_panel';

const FILE_WORDS: Record<string, string> = {
  'report.html': 'Report, one page with pictures and numbers',
  'predicted_skin.stl': 'Predicted face',
  'predicted_skin.vtp': 'Predicted face with displacement',
  'skin_before.vtp': 'Face before',
  'bone_segment_moved.vtp': 'Moved segment',
  'bone_remainder.vtp': 'Bone that remains',
  'prediction.json': 'Every number of the solve',
  'plan.json': 'Plan',
  'landmarks.mrk.json': 'Landmarks',
  'check.json': 'Check of the plan',
  'cephalometry.csv': 'Cephalometry after the move',
  'compare.json': 'Every number of the comparison',
  'regions.csv': 'The comparison by region',
  'difference.vtp': 'Predicted face with its distance from the face after surgery',
  'movements.csv': 'Where the segments went',
  'skin_after.vtp': 'Face after surgery, laid onto the head before it',
};

export const MODES = [
  { value: 'slider', text: 'Slider' },
  { value: 'beside', text: 'Side by side' },
  { value: 'after', text: 'After' },
] as const;

const BONE_PAINTS = [
  { value: 'none', text: 'Plain' },
  { value: 'pressure', text: 'Pressure', title: 'What the tissue presses with on the moved bone' },
  {
    value: 'depth',
    text: 'Depth',
    title: 'How much deeper in the bone tissue lies than at rest: what contact lets through',
  },
] as const;

/** The colors of a map, from 0 to `top`. */
const legend = (scale: ScaleName, top: number, unit: string, id: string): Html =>
  html` <div class="legend" data-id=${id}>
    <div class="ramp" .style=${`background:${gradientOf(scale)}`}></div>
    <div class="ticks">${ticksOf(top).map((text) => html`<span>${text}</span>`)}<span>${unit}</span></div>
  </div>`;

/** What is missing for the regions that are not told. */
const missingRegions = (missing: readonly string[]): Html =>
  missing.length
    ? html`<details>
        <summary>Regions not told apart: ${missing.length}</summary>
        <div class="hint">Landmarks are wanting. ${missing.join('; ')}.</div>
      </details>`
    : nothing;

const ORIGIN: Vec3 = [0, 0, 0];

const capital = (text: string): string => text[0].toUpperCase() + text.slice(1);

function regionTable(regions: Schemas['RegionShifts']): Html {
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
        ${regions.regions.map(
          ({ region, shift }) =>
            html`<tr>
              <td>${REGION_WORDS[region] ?? capital(region)}</td>
              ${[shift.median_mm, shift.p99_mm, shift.max_mm].map(
                (v) => html`<td>${v === null ? '–' : fixed(v, 1)}</td>`,
              )}
            </tr>`,
        )}
      </tbody>
    </table>
    ${missingRegions(regions.missing)}`;
}

const REGION_WORDS: Record<string, string> = {
  whole: 'Whole skin',
  moved: 'Moved > 0.5 mm',
  'right cheek': 'Cheek, right',
  'left cheek': 'Cheek, left',
};

/** A movement of bone as the comparison tells it, in words. */
function wordsOf({ shift_mm, turn_deg, largest_mm }: Schemas['MovementDifference']): string {
  if (largest_mm < 0.05) return 'has not moved';
  const move = { translation_mm: toVec3(shift_mm), rotation_deg: toVec3(turn_deg), about_mm: ORIGIN };
  return `went ${inWords(move)}`;
}

function comparisonResult(app: App, s: State, found: Schemas['Comparison']): Html {
  return html` ${found.warnings.map((text) => notice('warning', 'About this scan', text))}
    ${found.movements.map(
      (one) =>
        html`<p data-id="achieved">
          <strong>${one.segment}</strong> ${wordsOf(one.achieved)}.
          <span class="hint"
            >From the plan it is ${mm(one.from_plan_to_achieved.shift_length_mm)} and
            ${fixed(one.from_plan_to_achieved.turn_angle_deg, 1)}° away.</span
          >
        </p>`,
    )}
    ${found.registration
      ? hint(
          `Bone that did not move lies ${mm(found.registration.rms_mm, 2)} apart in the two scans; ${fixed(100 * found.registration.kept_share, 0)} % of it was found again.`,
        )
      : nothing}
    <table data-id="error-table">
      <thead>
        <tr>
          <th></th>
          <th colspan="2">Predicted face is off</th>
          <th colspan="2">Had nothing changed</th>
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
        ${found.regions.map(
          (row) =>
            html`<tr>
              <td>${REGION_WORDS[row.region] ?? capital(row.region)}</td>
              ${[
                row.face.median_mm,
                row.face.p99_mm,
                row.if_unchanged?.median_mm ?? null,
                row.if_unchanged?.p99_mm ?? null,
              ].map((v) => html`<td>${v === null ? '–' : fixed(v, 1)}</td>`)}
            </tr>`,
        )}
      </tbody>
    </table>
    ${hint('mm, over area. A prediction is of use where it is nearer than “had nothing changed”.')}
    ${missingRegions(found.missing)}
    ${toggle('Color the face by it', s.skinPaint === 'error', (on) =>
      app.patch({ skinPaint: on ? 'error' : 'none', ...(on ? { compareStep: s.prediction?.steps.length ?? 0 } : {}) }),
    )}
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

/** The face after surgery, where there is one. */
function afterSurgery(app: App, s: State): Html {
  const stage = stageOf(s, 'comparison');
  const job = lastJob(s, 'compare');
  const running = isBusyWith(s, 'compare');
  const send = (files: File[]): void => void app.outcome.compareWith(files);
  return section(
    'After surgery',
    running || s.upload
      ? html`<div class="row">
            <span class="grow" data-id="compare-stage"
              >${s.upload ? `Handing over ${s.upload.name}` : job?.stage || 'waiting'}</span
            >
            ${job && running
              ? button('Stop', () => void app.stopJob(job.id), { kind: 'danger', icon: 'stop', id: 'stop-compare' })
              : nothing}
          </div>
          ${progressBar(s.upload?.fraction ?? job?.fraction ?? 0, 'Comparison')}`
      : html` ${stage.state === 'stale'
            ? notice('warning', 'This comparison is of an earlier prediction', stage.why)
            : nothing}
          ${job?.state === 'failed' ? notice('error', 'Not compared', job.message) : nothing}
          ${s.comparison
            ? comparisonResult(app, s, s.comparison)
            : hint(
                'A scan after surgery tells where the bone went and how far the predicted face is off; a surface of the face (VTP, STL, PLY, OBJ, in the frame of the scan) how far it is off.',
              )}
          <div class="row wrap">
            ${button('Scan folder', () => chooseFiles(true, send), { icon: 'folder', id: 'compare-folder' })}
            ${button('Scan or surface', () => chooseFiles(false, send), { id: 'compare-files' })}
          </div>`,
  );
}

export function comparePanel(app: App, s: State, view: Viewer): Html {
  const stage = stageOf(s, 'prediction');
  if (stage.state === 'missing' || stage.state === 'running' || !s.prediction)
    return html`<h2>Compare</h2>
      ${empty(
        'No prediction yet',
        stage.state === 'running' ? 'The face is being solved.' : 'Predict the face first.',
        button('To the prediction', () => app.setStep('predict')),
      )}`;
  if (!s.prediction.converged)
    return html`<h2>Compare ${chip('unconverged')}</h2>
      ${notice('error', 'Not converged: there is no face to compare', s.prediction.failure)}${button(
        'To the prediction',
        () => app.setStep('predict'),
      )}`;
  const profile = view.compare.profile();
  const isAtEnd = s.compareStep === s.prediction.steps.length;
  return html`
    <h2>Compare ${chip(stage.state)}</h2>
    ${stage.state === 'stale' ? notice('warning', 'Out of date: this face is of an earlier plan', stage.why) : nothing}
    ${segmented('How to compare', MODES, s.compareMode, (v) => app.patch({ compareMode: v }))}
    ${section(
      'Show',
      toggle('How far the skin moved', s.skinPaint === 'moved', (on) =>
        app.patch({ skinPaint: on ? 'moved' : 'none' }),
      ),
      s.skinPaint === 'moved' ? legend('distance', s.distanceTop_mm, 'mm', 'legend') : nothing,
      toggle('Bones under a clear skin', s.showBones, (on) => app.patch({ showBones: on })),
      s.showBones
        ? html`${segmented('Contact on the moved bone', BONE_PAINTS, s.bonePaint, (v) => app.patch({ bonePaint: v }))}
          ${s.bonePaint === 'none'
            ? nothing
            : s.boneTop !== null
              ? legend('depth', s.boneTop, s.bonePaint === 'pressure' ? 'kPa' : 'mm', 'bone-legend')
              : hint(
                  isAtEnd
                    ? 'This prediction holds no contact: tissue sticks to the bone, or it was made by an earlier lefort.'
                    : 'Contact is kept for the last step alone.',
                )}`
        : nothing,
    )}
    ${section(
      'How far the skin moved',
      s.regionShifts
        ? regionTable(s.regionShifts)
        : hint(s.compareStep === 0 ? 'Before surgery nothing has moved.' : 'Being measured …'),
      hint('mm, over area, at the step shown. A simulation, not held against this patient’s outcome.'),
    )}
    ${afterSurgery(app, s)}
    ${profile
      ? section(
          'Profile',
          profilePlot(profile.before, profile.after),
          hint('In the middle plane, from the right. Dashed: before.'),
        )
      : nothing}
    ${section(
      'Take along',
      html`<div class="row wrap">
        ${button('Picture', () => view.compare.savePicture(), { icon: 'camera', id: 'snapshot' })}
        ${stage.state === 'fresh'
          ? button('Report', () => void app.download('report.html'), {
              icon: 'download',
              kind: 'primary',
              id: 'report',
            })
          : nothing}
      </div>`,
      stage.state === 'fresh'
        ? html`<details>
            <summary>All files</summary>
            <div class="list">
              ${s.files.map(
                (file) =>
                  html` <button type="button" class="list-main" @click=${() => void app.download(file.name)}>
                    ${icon('download')}<span title=${FILE_WORDS[file.name] ?? ''}>${file.name}</span
                    ><span class="hint">${bytes(file.bytes)}</span>
                  </button>`,
              )}
            </div>
          </details>`
        : hint('A face that is out of date is not handed on. Predict it anew first.'),
    )}
  `;
}

/** Along the path: before surgery at the left, the whole move at the right. */
export function compareDock(app: App, s: State): Html {
  const steps = s.prediction?.converged ? s.prediction.steps.length : 0;
  if (steps === 0) return nothing;
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
