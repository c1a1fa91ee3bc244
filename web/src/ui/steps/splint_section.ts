import { html, nothing } from 'lit-html';
import type { Schemas } from '../../api';
import {
  faultOfSplint,
  fixed,
  MAX_LETTERS,
  maxillaOf,
  MIN_THICKNESS_MM,
  ml,
  mm,
  SPLINT_LIMITS,
  type SplintSettings,
} from '../../model';
import type { App } from '../app';
import { numberField } from '../number_field';
import { stageOf, type State } from '../state';
import { hint, notice, section, segmented, select, type Html } from '../widgets';
import { cells, downloads, figures, jobControl, staleNotice } from './measure_parts';
import { bothArches } from './occlusion_section';

const KINDS = [
  { value: 'intermediate', text: 'Intermediate', title: 'Maxilla moved, mandible as scanned' },
  { value: 'final', text: 'Final', title: 'Both arches in occlusion' },
] as const;

const LENGTHS = [
  { key: 'open_mm', label: 'Opening', hint: 'of the lower arch to inferior', step: 0.5, digits: 1 },
  { key: 'clearance_mm', label: 'Clearance', hint: 'between crowns and splint', step: 0.05, digits: 2 },
  { key: 'cover_mm', label: 'Cover', hint: 'height of the crowns', step: 0.5, digits: 1 },
  { key: 'wall_mm', label: 'Wall', hint: 'beyond the covered crowns', step: 0.5, digits: 1 },
  { key: 'rim_mm', label: 'Rim', hint: 'the wall beside the crowns', step: 0.5, digits: 1 },
  { key: 'edge_mm', label: 'Edges', hint: 'radius', step: 0.1, digits: 1 },
] as const;

/** The final and the intermediate splint. */
export function splintSection(app: App, s: State): Html {
  const { splint } = s.splintSettings;
  const set = (part: Partial<SplintSettings>): void =>
    app.patch({ splintSettings: { ...app.model.s.splintSettings, ...part } });
  const stage = `splint_${splint}` as const;
  const found = s.splints[splint];
  const segment = s.splintSettings.segment ?? maxillaOf(app.model.doc.plan.segments);
  return section(
    'Splint',
    segmented('Kind of splint', KINDS, splint, (value) => set({ splint: value })),
    hint(
      splint === 'final'
        ? 'Between the upper arch and the lower one in occlusion.'
        : 'Between the upper arch, moved as in the check of the plan, and the lower one as scanned.',
    ),
    staleNotice(s, stage),
    splint === 'intermediate' ? segmentField(app, segment, set) : nothing,
    LENGTHS.map(({ key, ...field }) =>
      numberField({
        ...field,
        value: s.splintSettings[key],
        unit: 'mm',
        min: SPLINT_LIMITS[key][0],
        max: SPLINT_LIMITS[key][1],
        id: `splint-${key}`,
        onInput: (value) => set({ [key]: value }),
      }),
    ),
    textField(s, set),
    jobControl(app, s, {
      kind: 'splint',
      start: found ? 'Make the splint again' : 'Make the splint',
      run: () => void app.measures.makeSplint(segment),
      isFresh: stageOf(s, stage).state === 'fresh',
      needs: lacking(s),
    }),
    found ? splintResult(found) : nothing,
    downloads(app, s, stage, [
      [`${stage}.stl`, 'Splint, for a printer'],
      [`${stage}.3mf`, 'Splint with its unit and title, for a printer'],
      [`${stage}.json`, 'All measures of the splint'],
    ]),
  );
}

const textField = (s: State, set: (part: Partial<SplintSettings>) => void): Html =>
  html`<label class="field">
    <span>Text, engraved into the front: ${MAX_LETTERS} letters or fewer</span>
    <input
      type="text"
      data-id="splint-text"
      maxlength=${MAX_LETTERS}
      spellcheck="false"
      autocomplete="off"
      .value=${s.splintSettings.text}
      @input=${(e: Event) => set({ text: (e.target as HTMLInputElement).value })}
    />
  </label>`;

function segmentField(app: App, segment: string | null, set: (part: Partial<SplintSettings>) => void): Html {
  const names = app.model.doc.plan.segments.map(({ name }) => name);
  if (names.length < 2) return nothing;
  return select(
    'Segment of the maxilla',
    names.map((name) => ({ value: name, text: name })),
    segment ?? names[0],
    (value) => set({ segment: value }),
  );
}

/** What must be done before; null if nothing. */
function lacking(s: State): string | null {
  if (!bothArches(s)) return 'Register the intraoral scans of both jaws first.';
  const fault = faultOfSplint(s.splintSettings);
  if (fault !== null) return fault;
  if (s.splintSettings.splint === 'final')
    return stageOf(s, 'occlusion').state === 'fresh' ? null : 'Find the occlusion first.';
  return stageOf(s, 'check').state === 'fresh' ? null : 'Check the plan first, in step 5, Movement.';
}

const splintResult = (found: Schemas['Splint']): Html =>
  html`${thicknessNotice(found)}
  ${found.parts > 1
    ? notice('warning', `The splint has ${found.parts} parts`, 'Nothing connects them. Widen the wall.')
    : nothing}
  ${figures('splint-figures', [
    ['Smallest thickness', mm(found.min_thickness_mm, 2)],
    ['Volume', ml(found.volume_ml)],
    ['Opening', mm(found.open_mm)],
    ...(found.text ? [['Text', found.text] as const] : []),
  ])}
  ${fitTable(found)}`;

function thicknessNotice({ min_thickness_mm }: Schemas['Splint']): Html {
  if (min_thickness_mm >= MIN_THICKNESS_MM) return nothing;
  const title = min_thickness_mm > 0 ? 'The splint is thin' : 'The splint has holes where teeth touch';
  return notice('warning', title, `Open the jaws until it is ${fixed(MIN_THICKNESS_MM, 0)} mm thick.`);
}

const fitTable = (found: Schemas['Splint']): Html =>
  html`<table data-id="splint-table">
      <thead>
        <tr>
          <th>Clearance</th>
          <th>P5</th>
          <th>P50</th>
          <th>P95</th>
          <th title="Deepest penetration of the arch on the way of 10 mm in">Way in</th>
        </tr>
      </thead>
      <tbody>
        ${(['upper', 'lower'] as const).map((jaw) => {
          const { clearance_mm: clearance, max_penetration_mm } = found[jaw];
          return html`<tr>
            <td>${jaw === 'upper' ? 'Upper' : 'Lower'}</td>
            ${cells([clearance.p5, clearance.median, clearance.p95, max_penetration_mm], 2)}
          </tr>`;
        })}
      </tbody>
    </table>
    ${hint('mm. Way in: deepest penetration on the way of 10 mm in.')}`;
