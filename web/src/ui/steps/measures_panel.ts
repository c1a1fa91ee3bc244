import { html } from 'lit-html';
import type { App } from '../app';
import { MEASURES, type MeasureName } from '../measure_state';
import { stageOf, type State } from '../state';
import { button, chip, empty, hint, type Html } from '../widgets';
import { airwaySection } from './airway_section';
import { archesSection } from './arches_section';
import { cephalogramSection } from './cephalogram_section';
import { guidesSection } from './guides_section';
import type { StageName } from './measure_parts';
import { nerveSection } from './nerve_section';
import { occlusionSection } from './occlusion_section';
import { splintSection } from './splint_section';
import { teethSection } from './teeth_section';

const SECTIONS: Record<MeasureName, (app: App, s: State) => Html> = {
  teeth: teethSection,
  arches: (app, s) => html`${archesSection(app, s)} ${occlusionSection(app, s)}`,
  splint: splintSection,
  nerve: nerveSection,
  guides: guidesSection,
  airway: airwaySection,
  cephalogram: cephalogramSection,
};

/** The stage whose state the list shows. */
function stageOfMeasure(s: State, measure: MeasureName): StageName {
  if (measure === 'splint') return `splint_${s.splintSettings.splint}`;
  // The registration comes first; its state is that of the occlusion once this exists.
  return measure === 'arches' && stageOf(s, 'occlusion').state !== 'missing' ? 'occlusion' : measure;
}

/** Teeth, occlusion, splints, canals of nerves, cutting guides, airway and cephalogram. */
export function measuresPanel(app: App, s: State): Html {
  if (!s.volume)
    return html`<h2>Teeth & measures</h2>
      ${empty(
        'No scan yet',
        'Open one in step 1, Case.',
        button('To the case', () => app.setStep('case')),
      )}`;
  return html`<h2>Teeth & measures</h2>
    ${hint('Each is optional. They use the labels and landmarks of the case; missing landmarks are found.')}
    <div class="list" role="group" aria-label="What is measured">
      ${MEASURES.map(({ name, title }) => measureRow(app, s, name, title))}
    </div>
    ${SECTIONS[s.measure](app, s)}
    ${hint('Research software, not for clinical use. Check each result together with the scan.')}`;
}

function measureRow(app: App, s: State, name: MeasureName, title: string): Html {
  const { state } = stageOf(s, stageOfMeasure(s, name));
  return html`<div class="list-row measure-row ${s.measure === name ? 'selected' : ''}">
    <button
      type="button"
      class="list-main"
      aria-pressed=${String(s.measure === name)}
      data-id=${`measure-${name}`}
      @click=${() => app.patch({ measure: name })}
    >
      <b>${title}</b>
    </button>
    ${chip(state)}
  </div>`;
}
