import { html, nothing } from 'lit-html';
import type { Schemas } from '../../api';
import { fixed } from '../../model';
import type { App } from '../app';
import { chooseFile } from '../choose_files';
import { stageOf, type State } from '../state';
import { button, hint, notice, progressBar, section, type Html } from '../widgets';
import { cells, downloads, jobControl, jobWarnings, staleNotice } from './measure_parts';

const JAWS = ['upper', 'lower'] as const;
type Jaw = (typeof JAWS)[number];

const SEXTANTS = [
  ['right', 'Right'],
  ['anterior', 'Anterior'],
  ['left', 'Left'],
] as const;

/** Kinds of files of intraoral scans. */
export const SURFACE_FILES = '.stl,.ply,.obj,.vtp';

/** Intraoral scans, registered with the crowns in the CT. */
export function archesSection(app: App, s: State): Html {
  const isFresh = stageOf(s, 'arches').state === 'fresh';
  const isChosen = s.archFiles.upper !== null || s.archFiles.lower !== null;
  return section(
    'Intraoral scans',
    staleNotice(s, 'arches'),
    s.arches
      ? html`${archesTable(s.arches)} ${archNotes(s.arches)}`
      : hint('A scan of each jaw in mm (STL, PLY, OBJ, VTP). Its position in the CT is found from the crowns.'),
    s.upload ? progressBar(s.upload.fraction, 'Upload') : html`${JAWS.map((jaw) => chooseRow(app, s, jaw))}`,
    jobControl(app, s, {
      kind: 'arches',
      start: s.arches && !isChosen ? 'Register again' : 'Register',
      run: () => void app.measures.register(),
      isFresh: isFresh && !isChosen,
      needs: isChosen || s.arches ? null : 'Choose the scan of one jaw or of both.',
    }),
    jobWarnings(s, 'arches'),
    downloads(
      app,
      s,
      'arches',
      JAWS.filter((jaw) => s.arches?.[jaw]).flatMap((jaw) => [
        [`${jaw}.stl`, `${NAMES[jaw]} arch in the frame of the CT`] as const,
        [`${jaw}.tfm`, `Motion of the ${jaw} scan`] as const,
      ]),
    ),
  );
}

const NAMES: Record<Jaw, string> = { upper: 'Upper', lower: 'Lower' };

function chooseRow(app: App, s: State, jaw: Jaw): Html {
  const file = s.archFiles[jaw];
  const state = file ? 'chosen' : s.arches?.[jaw] ? 'registered' : 'none';
  const take = (chosen: File): void => app.patch({ archFiles: { ...app.model.s.archFiles, [jaw]: chosen } });
  return html`<div class="row">
    <span class="grow">${NAMES[jaw]} jaw <span class="hint">${state}</span></span>
    ${button('Choose', () => chooseFile(SURFACE_FILES, take), {
      icon: 'folder',
      id: `choose-${jaw}`,
      title: `Choose the intraoral scan of the ${jaw} jaw`,
    })}
  </div>`;
}

const archesTable = (arches: Schemas['Arches']): Html =>
  html`<table data-id="arches-table">
      <thead>
        <tr>
          <th></th>
          <th>RMS</th>
          <th title="95 % of the crowns are closer">P95</th>
        </tr>
      </thead>
      <tbody>
        ${JAWS.map((jaw) => {
          const arch = arches[jaw];
          return arch
            ? html`<tr>
                  <td><strong>${NAMES[jaw]} jaw</strong></td>
                  ${cells([arch.distances.rms_mm, arch.distances.p95_mm], 2)}
                </tr>
                ${SEXTANTS.map(
                  ([sextant, title]) =>
                    html`<tr>
                      <td>${title}</td>
                      ${cells(distancesOf(arch.sextants[sextant]), 2)}
                    </tr>`,
                )}`
            : nothing;
        })}
      </tbody>
    </table>
    ${hint('Distance of the crowns of the CT from the scan, in mm. A sextant with metal may differ.')}`;

/** RMS and P95; without a counterpart there are none. */
const distancesOf = ({ points, rms_mm, p95_mm }: Schemas['CrownDistances']): (number | null)[] =>
  points > 0 ? [rms_mm, p95_mm] : [null, null];

const archNotes = (arches: Schemas['Arches']): Html =>
  html`${JAWS.map((jaw) => {
    const arch = arches[jaw];
    if (!arch) return nothing;
    return html`${arch.is_reversed
      ? notice('info', `${NAMES[jaw]} scan`, 'Its triangles faced inward and were turned.')
      : nothing}
    ${hint(`${NAMES[jaw]}: ${fixed(100 * (arch.distances.fraction ?? 0), 0)} % of the crowns have a counterpart.`)}`;
  })}`;
