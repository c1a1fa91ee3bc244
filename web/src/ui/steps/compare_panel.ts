import { html, nothing } from 'lit-html';
import { bytes, fixed, gradientOf } from '../../model';
import type { App } from '../app';
import type { Presenter } from '../present';
import { button, chip, empty, hint, icon, notice, section, segmented, toggle, type Part } from '../parts';
import { profilePlot } from '../plot';
import { stageOf, type State } from '../state';

/** Skin that moves less is "not moved" in means, as the command line has it [mm]. */
const MOVED_MM = 0.5;

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
};

export const MODES = [
  { value: 'slider', text: 'Slider' },
  { value: 'beside', text: 'Side by side' },
  { value: 'after', text: 'After' },
] as const;

export function comparePanel(app: App, s: State, view: Presenter): Part {
  const stage = stageOf(s, 'prediction');
  if (stage.state === 'missing' || stage.state === 'running' || !s.prediction)
    return html`<h2>Compare</h2>${empty('No prediction yet', stage.state === 'running' ? 'The face is being solved.' : 'Predict the face first.', button('To the prediction', () => app.setStep('predict')))}`;
  if (!s.prediction.converged)
    return html`<h2>Compare ${chip('unconverged')}</h2>${notice('error', 'Not converged: there is no face to compare', s.prediction.failure)}${button('To the prediction', () => app.setStep('predict'))}`;
  const profile = view.profile();
  return html`
    <h2>Compare ${chip(stage.state)}</h2>
    ${stage.state === 'stale' ? notice('warning', 'Out of date: this face is of an earlier plan', stage.why) : nothing}
    ${segmented('How to compare', MODES, s.compareMode, (v) => app.patch({ compareMode: v }))}
    ${section('Show',
      toggle('How far the skin moved', s.showDistance, (on) => app.patch({ showDistance: on })),
      s.showDistance ? html`<div class="legend" data-id="legend"><div class="ramp" .style=${`background:${gradientOf('distance')}`}></div>
        <div class="ticks">${[0, 0.25, 0.5, 0.75, 1].map((share) => html`<span>${fixed(share * s.distanceTop_mm, s.distanceTop_mm < 4 ? 2 : 1)}</span>`)}<span>mm</span></div></div>` : nothing,
      toggle('Bones under a clear skin', s.showBones, (on) => app.patch({ showBones: on })))}
    ${section('How far the skin moved',
      html`<table data-id="distance-table"><thead><tr><th></th><th>Mean</th><th>Median</th><th>P90</th><th>P95</th><th>Max</th></tr></thead>
        <tbody>${view.statistics(MOVED_MM).map(([name, x]) => html`<tr><td>${name}</td>${x
          ? [x.mean, x.median, x.p90, x.p95, x.max].map((v) => html`<td>${fixed(v, 1)}</td>`)
          : html`<td colspan="5">–</td>`}</tr>`)}</tbody></table>`,
      hint('mm, by vertex of the skin, at the step shown. A simulation, not held against this patient’s outcome.'))}
    ${profile ? section('Profile', profilePlot(profile.before, profile.after), hint('In the middle plane, from the right. Dashed: before.')) : nothing}
    ${section('Take along',
      html`<div class="row wrap">
        ${button('Picture', () => view.savePicture(), { icon: 'camera', id: 'snapshot' })}
        ${stage.state === 'fresh' ? button('Report', () => void app.download('report.html'), { icon: 'download', kind: 'primary', id: 'report' }) : nothing}</div>`,
      stage.state === 'fresh'
        ? html`<details><summary>All files</summary><div class="list">${s.files.map((file) => html`
            <button type="button" class="list-main" @click=${() => void app.download(file.name)}>${icon('download')}<span title=${FILE_WORDS[file.name] ?? ''}>${file.name}</span><span class="hint">${bytes(file.bytes)}</span></button>`)}</div></details>`
        : hint('A face that is out of date is not handed on. Predict it anew first.'))}
  `;
}

/** Along the path: before surgery at the left, the whole move at the right. */
export function compareDock(app: App, s: State): Part {
  const steps = s.prediction?.converged ? s.prediction.steps.length : 0;
  if (steps === 0) return nothing;
  return html`
    <div class="dock">
      <span class="hint">Along the path</span>
      <div class="timeline"><div class="rule"></div>
        <input type="range" min="0" max=${steps} step="1" .value=${String(s.compareStep)} aria-label="Step of the path" data-id="compare-step"
          @input=${(e: Event) => app.patch({ compareStep: Number((e.target as HTMLInputElement).value) })} />
        <button type="button" class="keyframe start" .style=${'left:0'} @click=${() => app.patch({ compareStep: 0 })}>before</button>
        <button type="button" class="keyframe last" .style=${'left:100%'} @click=${() => app.patch({ compareStep: steps })}>planned</button></div>
      <div class="hint" .style=${'min-width:78px;text-align:right'}>step ${s.compareStep} of ${steps}</div>
    </div>`;
}
