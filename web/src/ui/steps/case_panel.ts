import { html, nothing } from 'lit-html';
import type { Schemas } from '../../api';
import { fixed } from '../../model';
import type { App } from '../app';
import { chooseFiles, filesOf } from '../choose_files';
import { button, chip, hint, notice, progressBar, section, type Html } from '../widgets';
import { runningJob, stageOf, isBusyWith, type State } from '../state';

const importing = (s: State): boolean => isBusyWith(s, 'import') || s.upload !== null;

/** The first page: how to start. */
export function welcome(app: App, s: State): Html {
  const job = runningJob(s);
  const failed = s.jobs.at(-1);
  return html`
    <div class="cover">
      <div class="welcome">
        <div>
          <h1>Plan the operation, predict the face.</h1>
          <p class="lead">Open a head CT. The scan stays on this computer, where lefort runs.</p>
        </div>
        <div
          class="drop"
          data-id="drop"
          @dragover=${(e: DragEvent) => {
            e.preventDefault();
            (e.currentTarget as HTMLElement).classList.add('over');
          }}
          @dragleave=${(e: DragEvent) => (e.currentTarget as HTMLElement).classList.remove('over')}
          @drop=${async (e: DragEvent) => {
            e.preventDefault();
            (e.currentTarget as HTMLElement).classList.remove('over');
            if (e.dataTransfer) void app.importFiles(await filesOf(e.dataTransfer.items));
          }}
        >
          ${importing(s)
            ? html`<strong>${s.upload ? `Uploading ${s.upload.name}` : 'Reading the scan'}</strong>
                <div .style=${'width:260px'}>${progressBar(s.upload?.fraction ?? job?.fraction ?? 0, 'Import')}</div>`
            : html`<strong>Drop a scan here</strong>
                <span class="hint">A DICOM folder, NIfTI, NRRD, MetaImage, or an InVesalius project (.inv3)</span>
                <div class="row">
                  ${button('Choose a folder', () => chooseFiles(true, (files) => void app.importFiles(files)), {
                    icon: 'folder',
                  })}
                  ${button('Choose files', () => chooseFiles(false, (files) => void app.importFiles(files)))}
                </div>`}
        </div>
        ${failed?.kind === 'import' && failed.state === 'failed' && !importing(s)
          ? notice('error', 'The scan could not be read', failed.message)
          : nothing}
        ${s.case?.example_available
          ? html`<div class="row">
              <span class="hint">No scan available?</span>
              ${button('Open the example', () => void app.openExample(), {
                kind: 'primary',
                disabled: importing(s),
                id: 'open-example',
              })}
            </div>`
          : nothing}
      </div>
    </div>
  `;
}

export function casePanel(app: App, s: State): Html {
  const stage = stageOf(s, 'scan');
  if (!s.case?.scan) return introduction();
  const { scan } = s.case;
  return html`
    <h2>Case ${chip(stage.state)}</h2>
    ${stage.why ? notice(stage.state === 'stale' ? 'warning' : 'info', stage.why) : nothing} ${scanSection(scan)}
    ${section(
      'Geometry',
      scan.warnings.length === 0
        ? notice(
            'good',
            'No problems found',
            'Slices are evenly spaced, the gantry is not tilted, and CT numbers are plausible.',
          )
        : scan.warnings.map((text) => notice('warning', 'Please check', text)),
    )}
    ${openSection(app, s)}
    ${section(
      'Privacy',
      hint(
        'Names, dates and numbers of the patient are not copied to the case. A face in 3D can still ' +
          'be recognized: protect pictures as you protect the scan.',
      ),
    )}
  `;
}

const introduction = (): Html =>
  html`<h2>Case</h2>
    <p class="hint">
      A case is one folder: scan, anatomy, landmarks, plan, prediction. The command line reads and writes the same
      files.
    </p>
    ${section(
      'Steps',
      html`<p class="hint">
        Open a scan, review its anatomy, cut the bone, move it, and predict the face. You can return to each step on the
        left. A result is out of date when an earlier step changes.
      </p>`,
    )}`;

function scanSection(scan: NonNullable<Schemas['Case']['scan']>): Html {
  const extent = scan.size.map((n, axis) => n * scan.spacing_mm[axis]);
  return section(
    'Scan',
    html` <dl>
      <dt>Format</dt>
      <dd>${scan.source_kind}</dd>
      <dt>Voxels</dt>
      <dd>${scan.size.join(' × ')}</dd>
      <dt>Spacing</dt>
      <dd>${scan.spacing_mm.map((v) => fixed(v, 2)).join(' × ')} mm</dd>
      <dt>Extent</dt>
      <dd>${extent.map((v) => fixed(v, 0)).join(' × ')} mm</dd>
    </dl>`,
  );
}

function openSection(app: App, s: State): Html {
  const disabled = importing(s);
  const open = (folder: boolean): void => chooseFiles(folder, (files) => void app.importFiles(files));
  return section(
    'Open another scan',
    hint('It replaces this scan. Landmarks and plan stay, but are out of date.'),
    html`<div class="row wrap">
      ${button('Folder', () => open(true), { icon: 'folder', disabled })}
      ${button('Files', () => open(false), { disabled })}
      ${s.case?.example_available ? button('Example', () => void app.openExample(), { disabled }) : nothing}
    </div>`,
  );
}
