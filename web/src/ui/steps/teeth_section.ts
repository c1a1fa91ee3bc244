import { html, nothing } from 'lit-html';
import { repeat } from 'lit-html/directives/repeat.js';
import { fixed, parseNumber, toothRows, toVec3, type ToothRow } from '../../model';
import type { App } from '../app';
import { stageOf, type State } from '../state';
import { hint, notice, section, type Html } from '../widgets';
import { downloads, jobControl, jobWarnings, staleNotice } from './measure_parts';

/** Numbered teeth, and corrections of their numbers. */
export function teethSection(app: App, s: State): Html {
  const isFresh = stageOf(s, 'teeth').state === 'fresh';
  return section(
    'Teeth',
    staleNotice(s, 'teeth'),
    s.teeth
      ? html`${teethTable(app, s)} ${missingTeeth(s)}`
      : hint('Finds, separates and numbers the teeth of the CT by FDI. The teeth must show enamel.'),
    jobControl(app, s, {
      kind: 'teeth',
      start: s.teeth ? 'Number the teeth again' : 'Number the teeth',
      run: () => void app.run({ kind: 'teeth' }),
      isFresh,
    }),
    jobWarnings(s, 'teeth'),
    downloads(app, s, 'teeth', [
      ['teeth_numbered.seg.nrrd', 'Segmentation of the teeth'],
      ['teeth.csv', 'Table of the teeth'],
      ['teeth.mrk.json', 'Crowns and apexes'],
    ]),
  );
}

function teethTable(app: App, s: State): Html {
  const rows = toothRows(s.teeth?.teeth ?? [], s.toothCorrections);
  return html`${hint(
      'Check each number in the views: a selected field shows its tooth on the slices. To correct a number, type ' +
        'another one; 0 removes what is not a tooth.',
    )}
    ${s.toothFault ? notice('error', 'This number is not possible', s.toothFault) : nothing}
    <table data-id="teeth-table">
      <thead>
        <tr>
          <th>FDI number</th>
          <th>Length</th>
          <th title="Along the arch">Width</th>
        </tr>
      </thead>
      <tbody>
        ${repeat(
          rows,
          ({ found }) => found,
          (row) => toothRow(app, row),
        )}
      </tbody>
    </table>
    ${hint('Length and width in mm.')}`;
}

function toothRow(app: App, { found, fdi, tooth }: ToothRow): Html {
  const take = (input: HTMLInputElement): void => {
    const value = parseNumber(input.value);
    const isNumber = value !== null && Number.isInteger(value);
    input.setAttribute('aria-invalid', String(!isNumber));
    if (isNumber) void app.measures.setNumber(found, value).then(() => (input.value = shownNumber(app, found)));
    else input.value = String(fdi);
  };
  const name = `FDI number of the tooth found as ${found}`;
  return html`<tr class=${fdi === 0 ? 'quiet' : ''}>
    <td>
      <span class="number-box tooth-number">
        <input
          inputmode="numeric"
          size="3"
          maxlength="2"
          aria-label=${name}
          data-id=${`tooth-${found}`}
          .value=${String(fdi)}
          @change=${(e: Event) => take(e.target as HTMLInputElement)}
          @focus=${() => tooth && app.patch({ cursor_L: toVec3(tooth.crown) })}
          @keydown=${(e: KeyboardEvent) => e.key === 'Enter' && (e.target as HTMLInputElement).blur()}
        />
      </span>
      ${fdi !== found ? html`<small>${fdi === 0 ? 'not a tooth; ' : ''}found as ${found}</small>` : nothing}
    </td>
    <td>${fixed(tooth?.length_mm ?? null, 1)}</td>
    <td>${fixed(tooth?.width_mm ?? null, 1)}</td>
  </tr>`;
}

/** The number of a tooth after a correction was taken or refused. */
const shownNumber = (app: App, found: number): string =>
  String(app.model.s.toothCorrections.find((one) => one.found === found)?.fdi ?? found);

const missingTeeth = ({ teeth }: State): Html =>
  teeth && teeth.missing.length > 0 ? hint(`Not found: ${teeth.missing.join(', ')}.`) : nothing;
