import { html, nothing } from 'lit-html';
import type { Schemas } from '../../api';
import { describeNervePoint, fixed, mm, nerveDistances, percent, toVec3, type NerveDistance } from '../../model';
import type { App } from '../app';
import { lastJob, stageOf, type State } from '../state';
import { hint, iconButton, notice, section, type Html } from '../widgets';
import { downloads, jobControl, jobWarnings, staleNotice } from './measure_parts';

/** Fraction of a canal that is visible below which it is marked, as on the command line. */
const VISIBLE_ENOUGH = 0.6;

const SIDES = ['right', 'left'] as const;

/** The canals of the inferior alveolar nerves, and corrections of points on them. */
export function nerveSection(app: App, s: State): Html {
  return section(
    'Nerve',
    staleNotice(s, 'nerve'),
    s.nerve ? html`${canalTable(s.nerve)} ${cutDistances(s)} ${corrections(app, s)}` : introduction(),
    jobControl(app, s, {
      kind: 'nerve',
      start: s.nerve ? 'Trace the canals again' : 'Trace the canals',
      run: () => void app.run({ kind: 'nerve' }),
      isFresh: stageOf(s, 'nerve').state === 'fresh',
    }),
    jobWarnings(s, 'nerve'),
    downloads(app, s, 'nerve', [
      ['nerve.mrk.json', 'Points on the canals'],
      ['nerve_right.vtp', 'Right canal'],
      ['nerve_left.vtp', 'Left canal'],
      ['nerve.json', 'All results'],
    ]),
  );
}

const introduction = (): Html =>
  hint('Finds the canals of the inferior alveolar nerves. The check of the plan then includes the distances of cuts.');

const canalTable = (nerve: Schemas['Nerve']): Html =>
  html`<table data-id="nerve-table">
      <thead>
        <tr>
          <th></th>
          <th>Length</th>
          <th title="Fraction along which it is darker than the bone around it">Visible</th>
        </tr>
      </thead>
      <tbody>
        ${SIDES.map((side) => {
          const canal = nerve[side];
          return canal
            ? html`<tr>
                <td>${side === 'right' ? 'Right' : 'Left'}</td>
                <td>${mm(canal.length_mm, 0)}</td>
                <td>${percent(canal.visible_fraction)}</td>
              </tr>`
            : nothing;
        })}
      </tbody>
    </table>
    ${SIDES.filter((side) => (nerve[side]?.visible_fraction ?? 1) < VISIBLE_ENOUGH).map((side) =>
      notice('warning', `The ${side} canal is hardly visible`, 'Check it, and correct points on it.'),
    )}
    ${hint('Errors of 1 mm are usual, of 2 to 5 mm occur at the foramina. Check the course on the slices.')}`;

function cutDistances(s: State): Html {
  if (stageOf(s, 'check').state !== 'fresh')
    return hint('Distances of cuts from the canals: check the plan in step 5, Movement.');
  const distances = nerveDistances(lastJob(s, 'check')?.result);
  if (!distances) return nothing;
  if (distances.length === 0) return hint('No cut is closer than 10 mm to a canal.');
  return html`<table data-id="nerve-distances">
    <thead>
      <tr>
        <th>Cut</th>
        <th>Canal</th>
        <th>Distance</th>
      </tr>
    </thead>
    <tbody>
      ${distances.map(
        ({ segment, nerve, distance_mm }: NerveDistance) =>
          html`<tr>
            <td>${segment}</td>
            <td>${nerve}</td>
            <td>${fixed(distance_mm, 1)} mm</td>
          </tr>`,
      )}
    </tbody>
  </table>`;
}

function corrections(app: App, s: State): Html {
  const names = Object.keys(s.nervePoints).sort();
  return html`${hint(
    'To correct a canal, select a point in 3D or on a slice, drag it on a slice to its place, and trace again. The ' +
      'canal passes within about 1 mm of corrected points.',
  )}
  ${names.length > 0
    ? html`<div class="list" data-id="nerve-points" role="group" aria-label="Corrected points">
        ${names.map((name) => correctedPoint(app, s, name))}
      </div>`
    : nothing}`;
}

const correctedPoint = (app: App, s: State, name: string): Html =>
  html`<div class="list-row ${s.nervePoint === name ? 'selected' : ''}">
    <span></span>
    <button
      type="button"
      class="list-main"
      aria-pressed=${String(s.nervePoint === name)}
      @click=${() => app.patch({ nervePoint: name, cursor_L: toVec3(s.nervePoints[name]) })}
    >
      <b>${name}</b><span>${describeNervePoint(name)}</span>
    </button>
    ${iconButton(
      'trash',
      `Remove the corrected point: ${describeNervePoint(name)}`,
      () => void app.measures.removePoint(name),
    )}
  </div>`;
