import { html, nothing } from 'lit-html';
import type { Schemas } from '../../api';
import { faultOfChoice, isOfVariants } from '../../model';
import type { App } from '../app';
import { runningJob, stageOf, type State } from '../state';
import { button, empty, hint, iconButton, notice, section, type Html } from '../widgets';
import { downloads, jobControl, jobWarnings, staleNotice, type FileWords } from './measure_parts';

const FILES: readonly FileWords[] = [
  ['variants.pdf', 'Table and pictures, to print'],
  ['variants.html', 'The same as a page'],
  ['variants.csv', 'The table, for a spreadsheet'],
];

/** Plans of the case that were kept, and their comparison. */
export const variantsPanel = (app: App, s: State): Html =>
  html`${keepSection(app, s)} ${listSection(app, s)} ${tableSection(app, s)}
  ${hint('Research software, not for clinical use. Check each result together with the scan.')}`;

/** Why the current plan cannot be kept; null if it can. */
function whyNotKept(app: App, s: State): string | null {
  if (app.model.doc.plan.segments.length === 0) return 'The plan has no segment. Cut one in step 4, Osteotomy.';
  if (runningJob(s)) return 'A job is running. A plan can be kept when it has ended.';
  const check = stageOf(s, 'check');
  if (check.state === 'missing') return 'The plan is not checked. Check it in step 5, Movement.';
  if (check.state !== 'fresh')
    return `The check is out of date: ${check.why}. Check the plan again in step 5, Movement.`;
  return null;
}

const FACE_WORDS: Partial<Record<Schemas['Stage']['state'], string>> = {
  fresh: 'It is kept with its check and its predicted face.',
  missing: 'It is kept without a face: none is predicted.',
  unconverged: 'It is kept without a face: the prediction did not converge.',
};

function keepSection(app: App, s: State): Html {
  const why = whyNotKept(app, s);
  const current = s.variants.find((one) => one.is_current);
  return section(
    'Keep the current plan',
    current ? hint(html`The current plan is the variant <b>${current.name}</b>.`) : nothing,
    html`<form
      class="row"
      @submit=${(e: Event) => {
        e.preventDefault();
        if (why === null) void app.variants.keep();
      }}
    >
      <input
        class="text-input grow"
        type="text"
        maxlength="60"
        placeholder="Name, for example one-jaw"
        aria-label="Name of the variant"
        aria-invalid=${String(s.variantFault !== null)}
        data-id="variant-name"
        .value=${s.variantName}
        @input=${(e: Event) => app.patch({ variantName: (e.target as HTMLInputElement).value, variantFault: null })}
      />
      ${button('Keep', () => void app.variants.keep(), { kind: 'primary', disabled: why !== null, id: 'keep-variant' })}
    </form>`,
    s.variantFault !== null ? notice('error', 'Not kept', s.variantFault) : nothing,
    hint(
      why ?? FACE_WORDS[stageOf(s, 'prediction').state] ?? 'It is kept without a face: its prediction is out of date.',
    ),
  );
}

const countOf = (count: number, word: string): string => `${count || 'no'} ${word}${count === 1 ? '' : 's'}`;

function listSection(app: App, s: State): Html {
  return section(
    `Variants, ${s.variants.length} of at most ${s.maxVariants}`,
    s.variants.length === 0
      ? hint('None yet. A variant is a copy of the plan with its check and prediction. It stays with the case.')
      : html`<div class="list" role="group" aria-label="Variants" data-id="variants">
          ${s.variants.map((variant) => variantRow(app, s, variant))}
        </div>`,
  );
}

function variantRow(app: App, s: State, variant: Schemas['Variant']): Html {
  const { name, segments, findings, has_prediction, is_current, why } = variant;
  const isBusy = runningJob(s) !== null;
  const words = [countOf(findings, 'finding'), has_prediction ? 'face' : 'no face', ...(is_current ? ['current'] : [])];
  return html`<div class="list-row variant-row" data-id=${`variant-${name}`}>
    <label class="variant-choice" title=${segments.join(', ')}>
      <input
        type="checkbox"
        .checked=${s.chosenVariants.includes(name)}
        aria-label=${`Show ${name} side by side`}
        @change=${() => app.variants.choose(name)}
      />
      <span
        ><b>${name}</b><small class="hint">${why === '' ? words.join(' · ') : `Cannot be loaded: ${why}`}</small></span
      >
    </label>
    ${button('Load', () => app.variants.askToLoad(variant), {
      disabled: isBusy || is_current || why !== '',
      title: is_current ? 'It is the current plan' : why === '' ? 'Make it the current plan' : why,
      id: `load-${name}`,
    })}
    ${iconButton('trash', `Delete ${name}`, () => app.variants.askToDelete(variant), isBusy)}
  </div>`;
}

function tableSection(app: App, s: State): Html {
  const needs = faultOfChoice(s.chosenVariants);
  const { sideBySide } = s;
  const isOfChoice = sideBySide !== null && isOfVariants(sideBySide.variants, s.chosenVariants);
  const isFresh = isOfChoice && stageOf(s, 'variants').state === 'fresh';
  return section(
    'Side by side',
    staleNotice(s, 'variants'),
    jobControl(app, s, {
      kind: 'variants',
      start: isFresh ? 'Compare again' : `Compare ${s.chosenVariants.length} variants`,
      run: () => void app.variants.compare(),
      isFresh,
      needs,
    }),
    jobWarnings(s, 'variants'),
    sideBySide && !isOfChoice ? hint(`The tables are of ${sideBySide.variants.join(', ')}.`) : nothing,
    sideBySide ? sideBySide.tables.map(variantTable) : nothing,
    downloads(app, s, 'variants', FILES),
  );
}

const variantTable = ({ title, heads, rows }: Schemas['SideBySide']['tables'][number]): Html =>
  rows.length === 0
    ? nothing
    : html`<h4 class="table-title">${title}</h4>
        <div class="wide-table" tabindex="0" role="region" aria-label=${title} data-id="side-by-side">
          <table>
            <thead>
              <tr>
                ${heads.map((head) => html`<th scope="col">${head}</th>`)}
              </tr>
            </thead>
            <tbody>
              ${rows.map(
                ([name, ...values]) =>
                  html`<tr>
                    <th scope="row">${name}</th>
                    ${values.map((value) => html`<td>${value === '-' ? '–' : value}</td>`)}
                  </tr>`,
              )}
            </tbody>
          </table>
        </div>`;

/** What is shown in place of faces. */
export function variantsCover(s: State): Html {
  if (s.variants.length === 0)
    return cover(
      'No variants yet',
      'Check a plan, and keep it in the panel on the right. Then change it, and keep it again.',
    );
  if (s.chosenVariants.length === 0)
    return cover('No variant is chosen', 'Choose those to show in the panel on the right.');
  const hasFace = s.variants.some((one) => one.has_prediction && s.chosenVariants.includes(one.name));
  return hasFace
    ? nothing
    : cover('No predicted faces', 'None of the chosen variants has one. The table compares their bones.');
}

const cover = (title: string, text: string): Html => html`<div class="cover">${empty(title, text)}</div>`;
