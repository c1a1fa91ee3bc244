import { html, nothing } from 'lit-html';
import {
  CATALOG,
  fixed,
  kindOf,
  landmarkSearch,
  placed,
  uncertaintyOf,
  withFound,
  withoutLandmark,
  type LandmarkKind,
  type LandmarkSearch,
} from '../../model';
import type { App } from '../app';
import { button, empty, hint, iconButton, notice, section, type Html } from '../widgets';
import { lastJob, stageOf, type State } from '../state';
import { jobControl, jobWarnings } from './measure_parts';

export function landmarkPanel(app: App, s: State): Html {
  const { landmarks } = app.model.doc;
  if (!s.volume)
    return html`<h2>Landmarks</h2>
      ${empty(
        'No scan yet',
        'Open one in step 1, Case.',
        button('To the case', () => app.setStep('case')),
      )}`;
  const search = searchOfScan(s);
  const row = (kind: LandmarkKind): Html => landmarkRow(app, s, kind, search);
  const others = landmarks.filter((l) => !kindOf(l.name));
  return html`
    <h2>Landmarks <span class="chip">${landmarks.length} placed</span></h2>
    ${notices(s)} ${findSection(app, s, search)}
    ${section('On bone and teeth', html`<div class="list">${CATALOG.filter((k) => k.on === 'bone').map(row)}</div>`)}
    ${section('On the skin', html`<div class="list">${CATALOG.filter((k) => k.on === 'skin').map(row)}</div>`)}
    ${others.length
      ? section(
          'Others',
          html`<div class="list">${others.map((l) => row({ name: l.name, full: '', on: 'bone' }))}</div>`,
        )
      : nothing}
    ${cephalometrySection(s)}
  `;
}

/** What the last job has found, unless a scan was opened since. */
function searchOfScan(s: State): LandmarkSearch | null {
  const job = lastJob(s, 'landmarks');
  const opened = lastJob(s, 'import');
  return job && job.id > (opened?.id ?? 0) ? landmarkSearch(job.result) : null;
}

function notices(s: State): Html {
  const stage = stageOf(s, 'landmarks');
  const armed = s.tool === 'landmark' && s.landmark ? kindOf(s.landmark) : undefined;
  return html`${armed
    ? notice(
        'info',
        `Click on the ${armed.full}`,
        `On the ${armed.on === 'bone' ? 'bone' : 'skin'} in 3D, or on any slice. Escape cancels.`,
      )
    : hint('Select a name, then click on bone, skin or a slice. Drag a point to move it. Sides are of the patient.')}
  ${stage.state === 'stale' ? notice('warning', 'Landmarks may be out of date', stage.why) : nothing}
  ${s.measurementError ? notice('error', 'These landmarks are inconsistent', s.measurementError) : nothing}`;
}

/** Finds landmarks in the scan. Those that are placed stay. */
function findSection(app: App, s: State, search: LandmarkSearch | null): Html {
  const { landmarks } = app.model.doc;
  const place = (): void => {
    const found = searchOfScan(app.model.s);
    if (found) app.edit({ landmarks: withFound(app.model.doc.landmarks, found) });
  };
  const missing = Object.entries(search?.missing ?? {}).filter(([name]) => !placed(landmarks, name));
  return section(
    'Find',
    hint('Finds landmarks on bone, teeth and skin. Those that are placed stay. Check each point on the slices.'),
    jobControl(app, s, {
      kind: 'landmarks',
      start: 'Find the landmarks',
      run: () => void app.run({ kind: 'landmarks' }, place),
      isFresh: landmarks.length > 0,
    }),
    jobWarnings(s, 'landmarks'),
    missing.length === 0
      ? nothing
      : html`<details data-id="landmarks-missing">
          <summary>${missing.length} not found</summary>
          <div>${missing.map(([name, reason]) => html`<p>${name}: ${reason}</p>`)}</div>
        </details>`,
  );
}

function landmarkRow(app: App, s: State, kind: LandmarkKind, search: LandmarkSearch | null): Html {
  const { landmarks } = app.model.doc;
  const there = placed(landmarks, kind.name);
  const isSelected = s.landmark === kind.name;
  const select = (): void => {
    const isArmed = isSelected && s.tool === 'landmark';
    app.patch({
      landmark: isArmed ? null : kind.name,
      tool: isArmed || there ? 'none' : 'landmark',
      ...(there ? { cursor_L: there.position_mm } : {}),
    });
  };
  const remove = (): void => app.edit({ landmarks: withoutLandmark(landmarks, kind.name) });
  const uncertainty_mm = there ? uncertaintyOf(there, search) : null;
  return html` <div class="list-row ${isSelected ? 'selected' : ''} ${there ? '' : 'unplaced'}">
    <span></span>
    <button
      type="button"
      class="list-main"
      aria-pressed=${String(isSelected)}
      data-id=${`landmark-${kind.name}`}
      @click=${select}
    >
      <b>${kind.name}</b><span>${kind.full}</span>
      ${uncertainty_mm === null
        ? nothing
        : html`<span class="aside" title="Found, with its standard uncertainty"
            >± ${fixed(uncertainty_mm, 1)} mm</span
          >`}
    </button>
    ${there ? iconButton('trash', `Remove ${kind.full}`, remove) : nothing}
  </div>`;
}

function cephalometrySection(s: State): Html {
  const known = s.measurements?.filter((m) => m.before !== null) ?? [];
  return section(
    'Cephalometry',
    known.length === 0
      ? hint('Angles and distances are shown when their landmarks are placed.')
      : html`<table data-id="cephalometry">
          <thead>
            <tr>
              <th>Measure</th>
              <th>Before</th>
            </tr>
          </thead>
          <tbody>
            ${known.map(
              (m) =>
                html`<tr title=${m.meaning}>
                  <td>${m.measurement}</td>
                  <td>${fixed(m.before, 1)} ${m.unit === 'deg' ? '°' : m.unit}</td>
                </tr>`,
            )}
          </tbody>
        </table>`,
    hint('Lateral projection, as a lateral cephalogram without magnification.'),
  );
}
