import { html, nothing } from 'lit-html';
import type { Schemas } from '../../api';
import { fixed, MAX_REQUEST_MM, mm, relationRows, requestRows, REQUESTS } from '../../model';
import type { App } from '../app';
import { chooseFile } from '../choose_files';
import { GAP_TOP_MM } from '../measures_view';
import { numberField } from '../number_field';
import { lastJob, stageOf, type State } from '../state';
import { button, hint, notice, progressBar, section, segmented, toggle, type Html } from '../widgets';
import { SURFACE_FILES } from './arches_section';
import { downloads, figures, jobControl, jobWarnings, staleNotice } from './measure_parts';
import { legend } from './region_table';

const SOURCES = [
  { value: 'search', text: 'Intercuspation', title: 'Search the maximum intercuspation' },
  { value: 'as_scanned', text: 'As scanned', title: 'The scanner has exported both arches in occlusion' },
  { value: 'bite', text: 'Bite scan', title: 'Scans of the teeth in occlusion, from the cheek' },
] as const;

const SOURCE_HINTS = {
  search: 'Moves the lower arch to maximum intercuspation.',
  as_scanned: 'Takes the position of both arches in the files of the intraoral scans.',
  bite: 'Takes the position of both arches in one or two scans of the closed teeth, in mm.',
} as const;

/** The occlusion of both arches. */
export function occlusionSection(app: App, s: State): Html {
  return section(
    'Occlusion',
    staleNotice(s, 'occlusion'),
    s.occlusion ? html`${occlusionFigures(s.occlusion)} ${display(app, s)}` : nothing,
    segmented('Where the occlusion comes from', SOURCES, s.occlusionSource, (occlusionSource) =>
      app.patch({ occlusionSource }),
    ),
    hint(SOURCE_HINTS[s.occlusionSource]),
    s.occlusionSource === 'search' ? requestFields(app, s) : nothing,
    s.occlusionSource === 'bite' ? biteFiles(app, s) : nothing,
    jobControl(app, s, {
      kind: 'occlusion',
      start: s.occlusion ? 'Find the occlusion again' : 'Find the occlusion',
      run: () => void app.measures.findOcclusion(),
      isFresh: stageOf(s, 'occlusion').state === 'fresh',
      needs: lackingForOcclusion(s),
    }),
    jobWarnings(s, 'occlusion'),
    summaryOf(s),
    downloads(app, s, 'occlusion', [
      ['lower_in_occlusion.stl', 'Lower arch in occlusion'],
      ['lower_to_occlusion.tfm', 'Its motion, for the path of a plan'],
      ['lower_contacts.vtp', 'Lower arch with gaps'],
    ]),
  );
}

/** What must be done before; null if nothing. */
function lackingForOcclusion(s: State): string | null {
  if (!bothArches(s)) return 'Both jaws must be registered first.';
  if (
    s.occlusionSource === 'search' &&
    s.occlusionRequests.midline_mm !== null &&
    stageOf(s, 'teeth').state !== 'fresh'
  )
    return 'Number the teeth first: a requested midline needs their numbers.';
  const { bite, bite2 } = s.biteFiles;
  return s.occlusionSource === 'bite' && !bite && !bite2 ? 'Choose a bite scan.' : null;
}

/** What the occlusion has to be; empty fields are not requested. */
function requestFields(app: App, s: State): Html {
  const set = (key: (typeof REQUESTS)[number]['key'], value: number | null): void =>
    app.patch({ occlusionRequests: { ...app.model.s.occlusionRequests, [key]: value } });
  return html`${REQUESTS.map(({ key, name, hint: words }) =>
    numberField({
      label: `Requested ${name.toLowerCase()}`,
      hint: words,
      value: s.occlusionRequests[key],
      unit: 'mm',
      step: 0.5,
      min: -MAX_REQUEST_MM,
      max: MAX_REQUEST_MM,
      id: `request-${key}`,
      onInput: (value) => set(key, value),
      onClear: () => set(key, null),
    }),
  )}
  ${hint('An empty field is not requested. Where the teeth do not allow a request, it is not reached.')}`;
}

const biteFiles = (app: App, s: State): Html =>
  s.upload
    ? progressBar(s.upload.fraction, 'Upload')
    : html`${(['bite', 'bite2'] as const).map(
        (key) =>
          html`<div class="row">
            <span class="grow"
              >${key === 'bite' ? 'Bite scan' : 'Second bite scan'}
              <span class="hint"
                >${s.biteFiles[key] ? 'chosen' : key === 'bite' ? 'none' : 'none, optional'}</span
              ></span
            >
            ${button(
              'Choose',
              () =>
                chooseFile(SURFACE_FILES, (file) =>
                  app.patch({ biteFiles: { ...app.model.s.biteFiles, [key]: file } }),
                ),
              { icon: 'folder', id: `choose-${key}` },
            )}
          </div>`,
      )}`;

/** The summary of the last job, as of the command line. */
function summaryOf(s: State): Html {
  const job = lastJob(s, 'occlusion');
  if (job?.state !== 'done' || !job.message || stageOf(s, 'occlusion').state !== 'fresh') return nothing;
  return html`<p class="hint" data-id="occlusion-summary">${job.message}</p>`;
}

/** Both jaws are registered and not out of date. */
export const bothArches = (s: State): boolean =>
  stageOf(s, 'arches').state === 'fresh' && s.arches?.upper !== undefined && s.arches.lower !== undefined;

/** What was requested, and warnings where it is not reached. */
function requestFigures(occlusion: Schemas['Occlusion']): Html {
  const rows = requestRows(occlusion);
  if (rows.length === 0) return nothing;
  return html`${figures(
    'request-table',
    rows.map(({ name, requested, reached }) => [
      `${name}, requested`,
      `${mm(requested)}, reached ${reached === null ? 'unknown' : mm(reached)}`,
    ]),
  )}
  ${rows
    .filter(({ isMet }) => !isMet)
    .map(({ name, requested, reached }) =>
      notice(
        'warning',
        `${name}: the request is not reached`,
        reached === null
          ? `${mm(requested)} was requested. What was reached is not known.`
          : `${mm(requested)} was requested, it is ${mm(reached)}.`,
      ),
    )}`;
}

const occlusionFigures = (occlusion: Schemas['Occlusion']): Html => {
  const { source, contacts, movement, overjet_mm, overbite_mm } = occlusion;
  return html`${source === undefined ? nothing : hint(`Occlusion: ${source}.`)}
  ${figures('occlusion-table', [
    ['Contact, right', `${fixed(contacts.right_mm2, 1)} mm²`],
    ['Contact, left', `${fixed(contacts.left_mm2, 1)} mm²`],
    ['Contacts', String(contacts.patches)],
    ['Penetration', mm(contacts.max_penetration_mm, 2)],
    ['Overjet', mm(overjet_mm)],
    ['Overbite', mm(overbite_mm)],
    ...relationRows(occlusion),
    ['Movement to superior', mm(movement.superior_mm)],
    ['Movement to anterior', mm(movement.anterior_mm)],
    ['Rotation', `${fixed(movement.rotation_deg, 1)}°`],
  ])}
  ${requestFigures(occlusion)} ${hint('Contact: gap of 0.2 mm or less. Overjet and overbite from edge to edge.')}
  ${occlusion.relations
    ? hint('Canines and molars: Angle class, and the lower tooth to mesial from class I.')
    : nothing}`;
};

const display = (app: App, s: State): Html =>
  html`${toggle('Lower arch in occlusion', s.showOcclusion, (on) => app.patch({ showOcclusion: on }))}
  ${s.showOcclusion
    ? html`${legend('gap', GAP_TOP_MM, 'mm', 'gap-legend')} ${hint('Gap of the lower arch to the upper one.')}`
    : nothing}`;
