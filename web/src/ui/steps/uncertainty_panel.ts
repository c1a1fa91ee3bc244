import { html, nothing } from 'lit-html';
import type { Schemas } from '../../api';
import {
  cssOf,
  distributionText,
  fixed,
  INTERACTIONS,
  mainInputs,
  mm,
  OTHER_INPUTS,
  percent,
  segmentColor,
  sobolBars,
} from '../../model';
import type { App } from '../app';
import { bandProfilePlot, convergencePlot } from '../band_plots';
import { numberField } from '../number_field';
import { isBusyWith, lastJob, stageOf, type State } from '../state';
import type { Viewer } from '../viewer';
import { button, empty, hint, notice, progressBar, section, select, type Html } from '../widgets';
import { legend, regionName } from './region_table';

type Uncertainty = Schemas['Uncertainty'];
type Input = Schemas['UncertainInput'];

/** Inputs with a color of their own; the others are drawn together. */
const COLORED_INPUTS = 7;

/** Q2 below which the surrogate does not reproduce the samples well. */
const GOOD_Q2 = 0.9;

/** Limits of the number of samples, as in the contract. */
const [MIN_SAMPLES, MAX_SAMPLES] = [20, 20000];

const TITLES: Record<string, string> = {
  poisson: 'Poisson’s ratio of the tissue',
  skin_ratio_factor: 'Stiffness of skin',
  interface_layer_mm: 'Layer below sliding tissue',
  contact_stiffness_factor: 'Stiffness of contact',
  elevation_margin_mm: 'Elevation margin',
  bone_threshold_hu: 'Threshold of bone',
  landmark_error_mm: 'Errors of landmarks',
  execution_translation_mm: 'Execution error, position',
  execution_rotation_deg: 'Execution error, orientation',
};

/** An input has the name of its parameter, or that of a segment and an axis. */
const titleOf = (name: string): string => TITLES[name] ?? name;

/** The band of the predicted face by the uncertainty of its inputs. */
export function uncertaintyPanel(app: App, s: State, view: Viewer): Html {
  const stage = stageOf(s, 'uncertainty');
  return html`${stage.state === 'stale' && s.uncertainty
    ? notice('warning', 'Out of date: this band is of another plan or scan', stage.why)
    : nothing}
  ${bandResult(app, s, view)} ${computeSection(app, s)}`;
}

function bandResult(app: App, s: State, view: Viewer): Html {
  if (s.uncertainty)
    return html`${scopeNotice(s.uncertainty)} ${biasNotice(s.uncertainty)} ${widthSection(s, s.uncertainty)}
    ${profileSection(view)} ${causesSection(app, s, s.uncertainty)} ${inputsSection(s.uncertainty)}
    ${samplesSection(s.uncertainty)} ${exportSection(app, s, view)}`;
  if (stageOf(s, 'uncertainty').etag !== null)
    return notice('error', 'The band cannot be read', 'Compute it again, or with this version of the program.');
  if (isBusyWith(s, 'uncertainty')) return nothing;
  return empty(
    'No band yet',
    'The band from P5 to P95 shows how far the predicted face may vary if the materials, the segmentation, the ' +
      'landmarks and the position of the segments vary as stated.',
  );
}

const scopeNotice = (found: Uncertainty): Html =>
  html`<div data-id="band-scope">
    ${notice(
      'info',
      'The band covers the named inputs only',
      `The error of the model itself is not part of it. ${found.notice}`,
    )}
  </div>`;

const biasNotice = ({ samples: { biased, failed, count } }: Uncertainty): Html =>
  biased
    ? notice(
        'error',
        'The band is biased',
        `${failed} of ${count} samples have no result, more than 5 %. The band leaves out what their inputs lead to.`,
      )
    : nothing;

function widthSection(s: State, found: Uncertainty): Html {
  const [moved] = found.regions;
  return section(
    'Width of the band, P5 to P95',
    legend('distance', s.bandTop_mm, 'mm', 'band-legend'),
    hint('Along the normal of the skin, on the median face. Plain skin: not part of the mesh.'),
    html`<div class="stats">
      <div>
        <div class="big-number">${fixed(moved.mean_band_mm, 1)} <small>mm</small></div>
        <div class="hint">mean of the moved skin</div>
      </div>
      <div>
        <div class="big-number">${fixed(moved.max_band_mm, 1)} <small>mm</small></div>
        <div class="hint">widest point</div>
      </div>
    </div>`,
    widthTable(found),
    found.regions.some(({ q2 }) => q2 !== null && q2 < GOOD_Q2)
      ? notice('warning', 'The surrogate is not accurate', 'A Q2 is below 0.9. Use more samples.')
      : nothing,
  );
}

const widthTable = ({ regions }: Uncertainty): Html =>
  html`<table data-id="band-table">
    <thead>
      <tr>
        <th></th>
        <th>Mean</th>
        <th>Max</th>
        <th title="Standard deviation, mean over the region">SD</th>
        <th title="1: the surrogate reproduces samples that it was not fitted to">Q2</th>
      </tr>
    </thead>
    <tbody>
      ${regions.map(
        (x) =>
          html`<tr>
            <td>${regionName(x.region)}</td>
            <td>${fixed(x.mean_band_mm, 1)}</td>
            <td>${fixed(x.max_band_mm, 1)}</td>
            <td>${fixed(x.mean_standard_deviation_mm, 2)}</td>
            <td>${fixed(x.q2, 2)}</td>
          </tr>`,
      )}
    </tbody>
  </table>`;

function profileSection(view: Viewer): Html {
  const band = view.band.profile();
  const before = view.compare.profile()?.before ?? null;
  const plot = band && bandProfilePlot(band, before);
  if (!plot) return nothing;
  return section(
    'Profile with the band',
    plot,
    hint(
      `In the mid-sagittal plane, from the right. Line: median; area: P5 to P95${before ? '; dashed: before' : ''}.`,
    ),
  );
}

const OTHER_COLORS: Record<string, string> = {
  [OTHER_INPUTS]: 'var(--ink-3)',
  [INTERACTIONS]: 'var(--line-strong)',
};

function causesSection(app: App, s: State, found: Uncertainty): Html {
  const shown = mainInputs(found.regions, COLORED_INPUTS);
  const bars = sobolBars(found.regions, shown);
  const color = (name: string): string => OTHER_COLORS[name] ?? cssOf(segmentColor(shown.indexOf(name)));
  const names = [...shown, OTHER_INPUTS, INTERACTIONS].filter((name) =>
    bars.some(({ parts }) => parts.some((part) => part.name === name && part.fraction >= 0.005)),
  );
  return section(
    'Which input causes it',
    html`<div class="sobol" data-id="sobol">
      ${bars.map(
        ({ region, parts }) =>
          html`<div class="sobol-row">
            <span>${regionName(region)}</span>
            <div
              class="sobol-bar"
              role="img"
              aria-label=${parts
                .filter((part) => part.fraction >= 0.005)
                .map((part) => `${titleOf(part.name)} ${percent(part.fraction)}`)
                .join(', ')}
            >
              ${parts.map(
                ({ name, fraction }) =>
                  html`<span
                    title=${`${titleOf(name)}: ${percent(fraction)}`}
                    .style=${`width:${(100 * fraction).toFixed(2)}%;background:${color(name)}`}
                  ></span>`,
              )}
            </div>
          </div>`,
      )}
    </div>`,
    html`<ul class="swatches" aria-label="Colors of the inputs">
      ${names.map(
        (name) => html`<li><span class="swatch" .style=${`background:${color(name)}`}></span>${titleOf(name)}</li>`,
      )}
    </ul>`,
    hint('Sobol indices of first order: fraction of the variance by one input alone.'),
    indexDetails(app, s, found),
  );
}

function indexDetails(app: App, s: State, found: Uncertainty): Html {
  const region = found.regions[s.bandRegion] ?? found.regions[0];
  const interval = (range: number[] | undefined): string =>
    range ? `${fixed(range[0], 2)} to ${fixed(range[1], 2)}` : '–';
  return html`<details>
    <summary>All indices</summary>
    <div>
      ${found.regions.length > 1
        ? select(
            'Region',
            found.regions.map((x, n) => ({ value: String(n), text: regionName(x.region) })),
            String(found.regions.indexOf(region)),
            (value) => app.patch({ bandRegion: Number(value) }),
          )
        : nothing}
      <table data-id="sobol-table">
        <thead>
          <tr>
            <th>Input</th>
            <th title="By the input alone">First</th>
            <th title="With its interactions">Total</th>
            <th>${percent(found.interval_level)} of total</th>
          </tr>
        </thead>
        <tbody>
          ${region.sobol.map(
            ({ name, first, total, total_interval }) =>
              html`<tr>
                <td>${titleOf(name)}</td>
                <td>${fixed(first, 2)}</td>
                <td>${fixed(total, 2)}</td>
                <td>${interval(total_interval)}</td>
              </tr>`,
          )}
        </tbody>
      </table>
    </div>
  </details>`;
}

/** Inputs of one entry: the axes of an execution error have one distribution. */
function entriesOf(inputs: readonly Input[]): { input: Input; names: string[] }[] {
  const entries = new Map<string, { input: Input; names: string[] }>();
  for (const input of inputs) {
    const key = JSON.stringify([input.parameter, input.distribution, input.source]);
    const entry = entries.get(key) ?? { input, names: [] };
    entry.names.push(input.name);
    entries.set(key, entry);
  }
  return [...entries.values()];
}

const inputsSection = ({ inputs, inputs_without_effect }: Uncertainty): Html =>
  section(
    'Inputs and their sources',
    html`<div class="inputs" data-id="band-inputs">
      ${entriesOf(inputs).map(
        ({ input, names }) =>
          html`<div title=${input.meaning}>
            <strong>${titleOf(input.parameter)}</strong>${input.unit ? html` <small>${input.unit}</small>` : nothing}
            <div>
              ${distributionText(input.distribution)}${input.levels?.values && input.distribution.kind !== 'discrete'
                ? `; ${input.levels.values.length} levels`
                : nothing}
            </div>
            ${names.length > 1 ? html`<div class="hint">${names.join(', ')}</div>` : nothing}
            <div class="hint">Source: ${input.source}</div>
          </div>`,
      )}
    </div>`,
    inputs_without_effect.length > 0
      ? html`<details>
          <summary>Inputs without effect: ${inputs_without_effect.length}</summary>
          <div>${inputs_without_effect.map((text) => hint(text))}</div>
        </details>`
      : nothing,
  );

function samplesSection(found: Uncertainty): Html {
  const { samples, correction, path_check: path, element_size_mm: size } = found;
  const failures = [...samples.failures, ...samples.fine_failures];
  const row = (name: string, value: string): Html =>
    html`<dt>${name}</dt>
      <dd>${value}</dd>`;
  return section(
    'Samples and convergence',
    html`<dl class="figures" data-id="band-samples">
      ${row(`Samples, elements of ${fixed(size.coarse, 1)} mm`, String(samples.count))}
      ${row('Without result', String(samples.failed))}
      ${row(`Fine samples, ${fixed(size.fine, 1)} mm`, samples.fine > 0 ? String(samples.fine) : 'none')}
      ${row('Correction of the mean width', correction ? mm(correction.mean_band_change_mm, 2) : 'none')}
      ${path ? row(`Whole path, ${path.samples} samples: max difference`, mm(path.max_difference_mm, 2)) : nothing}
    </dl>`,
    convergencePlot(found.convergence, found.interval_level),
    failures.length > 0
      ? html`<details>
          <summary>Why samples have no result</summary>
          <div>${failures.slice(0, MAX_REASONS).map(({ sample, reason }) => hint(`${sample}: ${reason}`))}</div>
        </details>`
      : nothing,
  );
}

/** Reasons that are listed; uncertainty.json has all. */
const MAX_REASONS = 50;

function exportSection(app: App, s: State, view: Viewer): Html {
  const isFresh = stageOf(s, 'uncertainty').state === 'fresh';
  return section(
    'Export',
    html`<div class="row wrap">
      ${button('Picture', () => view.band.savePicture(s), { icon: 'camera', id: 'band-snapshot' })}
      ${isFresh
        ? button('Report', () => void app.download('uncertainty_report.html'), { icon: 'download', id: 'band-report' })
        : nothing}
    </div>`,
    isFresh ? nothing : hint('A band that is out of date cannot be exported. Compute it again first.'),
  );
}

function computeSection(app: App, s: State): Html {
  if (app.model.doc.plan.segments.length === 0) return nothing;
  return section('Compute', isBusyWith(s, 'uncertainty') ? progress(app, s) : start(app, s));
}

function progress(app: App, s: State): Html {
  const job = lastJob(s, 'uncertainty');
  return html`<div class="row">
      <span class="grow" data-id="band-stage">${job?.stage || 'waiting'}</span>
      <span class="hint">${percent(job?.fraction ?? 0)}</span>
      ${job
        ? button('Stop', () => void app.stopJob(job.id), { kind: 'danger', icon: 'stop', id: 'stop-band' })
        : nothing}
    </div>
    ${progressBar(job?.fraction ?? 0, 'Band')}`;
}

function start(app: App, s: State): Html {
  const job = lastJob(s, 'uncertainty');
  const run = (): void => void app.run({ kind: 'uncertainty', samples: s.bandSamples });
  return html`${job?.state === 'failed' ? notice('error', 'The band could not be computed', job.message) : nothing}
  ${job?.state === 'cancelled' || job?.state === 'interrupted'
    ? notice('info', 'Stopped', 'Solved samples are stored. The next run uses them.')
    : nothing}
  ${numberField({
    label: 'Samples',
    hint: 'more are more accurate; solved ones are used again',
    value: s.bandSamples,
    unit: '',
    digits: 0,
    step: 20,
    min: MIN_SAMPLES,
    max: MAX_SAMPLES,
    id: 'band-count',
    onInput: (value) => app.patch({ bandSamples: Math.round(value) }),
  })}
  ${button(s.uncertainty ? 'Compute the band again' : 'Compute the band', run, {
    kind: s.uncertainty && stageOf(s, 'uncertainty').state === 'fresh' ? 'plain' : 'primary',
    disabled: s.saving === 'error',
    id: 'compute-band',
  })}
  ${hint('With the default inputs. Each sample is a prediction on a coarse mesh: this takes minutes to hours.')}`;
}
