import { html, nothing } from 'lit-html';
import type { Schemas } from '../../api';
import { fixed, mm, percent } from '../../model';
import type { App } from '../app';
import { stageOf, type State } from '../state';
import { hint, notice, section, type Html } from '../widgets';
import { cells, downloads, figures, jobControl, jobWarnings, staleNotice } from './measure_parts';

/** Distance of the airway from a limit above which it is reported [mm]. */
const NOTICE_MM = 3;

/** Volume and sections of the airway. */
export function airwaySection(app: App, s: State): Html {
  return section(
    'Airway',
    staleNotice(s, 'airway'),
    s.airway
      ? html`${airwayResult(s.airway)} ${airwayPlot(s)}`
      : hint('Measures the airway between planes parallel to the Frankfurt horizontal, through PNS and Me.'),
    jobControl(app, s, {
      kind: 'airway',
      start: s.airway ? 'Measure the airway again' : 'Measure the airway',
      run: () => void app.run({ kind: 'airway' }),
      isFresh: stageOf(s, 'airway').state === 'fresh',
    }),
    jobWarnings(s, 'airway'),
    downloads(app, s, 'airway', [
      ['airway.csv', 'Table of the sections'],
      ['airway.svg', 'Plot of the sections'],
      ['airway.vtp', 'Surface'],
      ...(s.airway?.after
        ? ([
            ['airway_after.csv', 'Table of the sections after the movement'],
            ['airway_after.svg', 'Plot of the sections after the movement'],
          ] as const)
        : []),
    ]),
  );
}

const area = (section_: Schemas['AirwaySection']): string => `${fixed(section_.area_mm2, 0)} mm²`;

const airwayResult = (found: Schemas['Airway']): Html =>
  html`<div class="stats" data-id="airway-stats">
      <div>
        <div class="big-number">${fixed(found.volume_ml, 1)} <small>ml</small></div>
        <div class="hint">volume</div>
      </div>
      <div>
        <div class="big-number">${fixed(found.min_section.area_mm2, 0)} <small>mm²</small></div>
        <div class="hint">smallest section</div>
      </div>
    </div>
    ${figures('airway-figures', [
      ['Smallest section, width', mm(found.min_section.width_mm)],
      ['Smallest section, depth', mm(found.min_section.depth_mm)],
      ['Below the upper end', mm(found.min_section.along_mm, 0)],
      ['Smallest axial section', area(found.min_axial_section)],
      ['Center line', mm(found.length_mm, 0)],
    ])}
    ${found.after ? afterTable(found, found.after) : nothing} ${airwayNotices(found)}
    ${hint('Breathing, swallowing and the position of the tongue change the airway within seconds.')}`;

const afterTable = (before: Schemas['Airway'], after: NonNullable<Schemas['Airway']['after']>): Html =>
  html`<table data-id="airway-after">
      <thead>
        <tr>
          <th></th>
          <th>Before</th>
          <th>After</th>
          <th>Change</th>
        </tr>
      </thead>
      <tbody>
        ${beforeAfter('Volume, ml', before.volume_ml, after.volume_ml, 1)}
        ${beforeAfter('Smallest section, mm²', before.min_section.area_mm2, after.min_section.area_mm2, 0)}
        ${beforeAfter(
          'Smallest axial section, mm²',
          before.min_axial_section.area_mm2,
          after.min_axial_section.area_mm2,
          0,
        )}
        ${beforeAfter('Closed along, mm', before.closed_mm, after.closed_mm, 0)}
      </tbody>
    </table>
    ${hint(
      `After: with the movement of the prediction. ${percent(after.wall_in_tissue_mesh)} of the wall of the airway ` +
        'lies in the tissue mesh; elsewhere the wall follows the points around it, or stays.',
    )}`;

const beforeAfter = (title: string, before: number, after: number, digits: number): Html =>
  html`<tr>
    <td>${title}</td>
    ${cells([before, after, after - before], digits)}
  </tr>`;

function airwayNotices(found: Schemas['Airway']): Html {
  const texts = [
    found.closed_mm > 0 ? `It is closed along ${mm(found.closed_mm, 0)}.` : null,
    found.below_upper_mm > NOTICE_MM ? `It starts ${mm(found.below_upper_mm, 0)} below ${found.upper}.` : null,
    found.above_lower_mm > NOTICE_MM ? `It ends ${mm(found.above_lower_mm, 0)} above ${found.lower}.` : null,
    found.has_frankfurt_horizontal
      ? null
      : 'The planes are parallel to the scan: the Frankfurt horizontal is not known.',
  ].filter((text) => text !== null);
  return texts.length > 0 ? notice('warning', 'About this airway', texts.join(' ')) : nothing;
}

const airwayPlot = (s: State): Html =>
  s.pictures['airway.svg']
    ? html`<img
        class="picture"
        src=${s.pictures['airway.svg']}
        alt="Areas of the sections along the center line of the airway"
        data-id="airway-plot"
      />`
    : nothing;
