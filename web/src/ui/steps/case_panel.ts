import { html, nothing } from 'lit-html';
import { fixed } from '../../model';
import type { App } from '../app';
import { chooseFiles, filesOf } from '../choose_files';
import { button, chip, hint, notice, progressBar, section, type Html } from '../widgets';
import { runningJob, stageOf, isBusyWith, type State } from '../state';

const importing = (s: State): boolean => isBusyWith(s, 'import') || s.upload !== null;

/** The first thing a person sees: how to begin. */
export function welcome(app: App, s: State): Html {
  const job = runningJob(s);
  const failed = s.jobs.at(-1);
  return html`
    <div class="cover">
      <div class="welcome">
        <div>
          <h1>Plan the operation, see the face.</h1>
          <p class="lead">Open a head CT. Nothing leaves this computer: the scan goes to lefort, which runs here.</p>
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
            ? html`<strong>${s.upload ? `Handing over ${s.upload.name}` : 'Reading the scan'}</strong>
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
              <span class="hint">No scan at hand?</span>
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
  const scan = s.case?.scan;
  const stage = stageOf(s, 'scan');
  if (!scan)
    return html`<h2>Case</h2>
      <p class="hint">
        A case is one folder: scan, anatomy, landmarks, plan, prediction. The command line reads and writes the very
        same files.
      </p>
      ${section(
        'What you will do',
        html`<p class="hint">
          Open a scan, look at its anatomy, cut the bone, move it, and see how the face follows. Each step on the left
          can be returned to; what it made goes out of date when something before it changes.
        </p>`,
      )}`;
  const extent = scan.size.map((n, axis) => n * scan.spacing_mm[axis]);
  return html`
    <h2>Case ${chip(stage.state)}</h2>
    ${stage.why ? notice(stage.state === 'stale' ? 'warning' : 'info', stage.why) : nothing}
    ${section(
      'Scan',
      html` <dl>
        <dt>Read from</dt>
        <dd>${scan.source_kind}</dd>
        <dt>Voxels</dt>
        <dd>${scan.size.join(' × ')}</dd>
        <dt>Spacing</dt>
        <dd>${scan.spacing_mm.map((v) => fixed(v, 2)).join(' × ')} mm</dd>
        <dt>Extent</dt>
        <dd>${extent.map((v) => fixed(v, 0)).join(' × ')} mm</dd>
      </dl>`,
    )}
    ${section(
      'Geometry',
      scan.warnings.length === 0
        ? notice(
            'good',
            'Nothing odd was found',
            'Slices are evenly spaced, the gantry was not tilted, and CT numbers are plausible.',
          )
        : scan.warnings.map((text) => notice('warning', 'Look at this', text)),
    )}
    ${section(
      'Open another scan',
      hint('It replaces this one. Landmarks and plan stay, and are out of date.'),
      html`<div class="row wrap">
        ${button('Folder', () => chooseFiles(true, (files) => void app.importFiles(files)), {
          icon: 'folder',
          disabled: importing(s),
        })}
        ${button('Files', () => chooseFiles(false, (files) => void app.importFiles(files)), { disabled: importing(s) })}
        ${s.case?.example_available
          ? button('Example', () => void app.openExample(), { disabled: importing(s) })
          : nothing}
      </div>`,
    )}
    ${section(
      'Privacy',
      hint(
        'Names, dates and numbers of the patient are not read into the case. A face in 3D can still be recognized: treat pictures as you treat the scan.',
      ),
    )}
  `;
}
