import { html, nothing } from 'lit-html';
import { fixed } from '../../model';
import type { App } from '../app';
import { stageOf, type State } from '../state';
import { empty, hint, section, segmented, type Html } from '../widgets';
import { downloads, jobControl, jobWarnings, staleNotice } from './measure_parts';

const NORMS = [
  { value: 'female', text: 'Women' },
  { value: 'male', text: 'Men' },
] as const;

const RADIOGRAPHS = [
  { value: 'tracing.png', text: 'Tracing' },
  { value: 'lateral.png', text: 'Lateral' },
  { value: 'frontal.png', text: 'Frontal' },
] as const;

/** The cephalogram with its tracing and measurements. */
export function cephalogramSection(app: App, s: State): Html {
  return section(
    'Cephalogram',
    staleNotice(s, 'cephalogram'),
    s.cephalogram
      ? segmented('Picture', RADIOGRAPHS, s.radiograph, (value) => app.patch({ radiograph: value }))
      : hint(
          'Computes lateral and frontal cephalograms, traces bone and skin, and compares measurements with published ' +
            'norms. Check and prediction of the plan are included if they are up to date.',
        ),
    html`<div class="row">
      <span class="grow">Norms of</span>${segmented('Norms of', NORMS, s.norms, (value) => app.patch({ norms: value }))}
    </div>`,
    jobControl(app, s, {
      kind: 'cephalogram',
      start: s.cephalogram ? 'Compute the cephalogram again' : 'Compute the cephalogram',
      run: () => void app.run({ kind: 'cephalogram', norms: s.norms }),
      isFresh: stageOf(s, 'cephalogram').state === 'fresh',
    }),
    jobWarnings(s, 'cephalogram'),
    downloads(app, s, 'cephalogram', [
      ['cephalometry.pdf', 'Analysis with norms, to print (PDF)'],
      ['measurements.csv', 'Measurements (CSV)'],
      ['norms.csv', 'Measurements and norms (CSV)'],
      ['tracing.png', 'Tracing'],
    ]),
    measurementTable(s),
  );
}

function measurementTable({ cephalogram }: State): Html {
  if (!cephalogram) return nothing;
  const known = cephalogram.measurements.filter(({ before }) => before !== null);
  const hasAfter = known.some(({ after }) => after !== undefined);
  return html`<table data-id="cephalogram-table">
      <thead>
        <tr>
          <th>Measurement</th>
          <th>Before</th>
          ${hasAfter ? html`<th>After</th>` : nothing}
        </tr>
      </thead>
      <tbody>
        ${known.map(
          ({ measurement, meaning, unit, before, after }) =>
            html`<tr title=${meaning}>
              <td>${measurement}</td>
              <td>${fixed(before, 1)} ${unit === 'deg' ? '°' : unit}</td>
              ${hasAfter ? html`<td>${fixed(after ?? null, 1)}</td>` : nothing}
            </tr>`,
        )}
      </tbody>
    </table>
    ${cephalogram.has_frankfurt_horizontal
      ? nothing
      : hint('The Frankfurt horizontal is not known: directions are those of the scan.')}`;
}

const WORDS: Record<State['radiograph'], string> = {
  'tracing.png': 'Lateral cephalogram with tracing and landmarks',
  'lateral.png': 'Lateral cephalogram',
  'frontal.png': 'Frontal cephalogram',
};

/** The picture in place of the views. */
export function cephalogramCover(s: State): Html {
  const url = s.pictures[s.radiograph];
  if (!s.cephalogram || !url)
    return html`<div class="cover">${empty('No cephalogram yet', 'Compute it in the panel on the right.')}</div>`;
  return html`<div class="cover radiograph">
    <img src=${url} alt=${WORDS[s.radiograph]} data-id="radiograph" />
  </div>`;
}
