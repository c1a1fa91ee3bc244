import { html, nothing } from 'lit-html';
import type { Schemas } from '../../api';
import { fixed, mm } from '../../model';
import type { App } from '../app';
import { GAP_TOP_MM } from '../measures_view';
import { stageOf, type State } from '../state';
import { hint, section, toggle, type Html } from '../widgets';
import { downloads, figures, jobControl, jobWarnings, staleNotice } from './measure_parts';
import { legend } from './region_table';

/** The maximum intercuspation of both arches. */
export function occlusionSection(app: App, s: State): Html {
  return section(
    'Occlusion',
    staleNotice(s, 'occlusion'),
    s.occlusion
      ? html`${occlusionFigures(s.occlusion)} ${display(app, s)}`
      : hint('Moves the lower arch to maximum intercuspation.'),
    jobControl(app, s, {
      kind: 'occlusion',
      start: s.occlusion ? 'Find the occlusion again' : 'Find the occlusion',
      run: () => void app.run({ kind: 'occlusion' }),
      isFresh: stageOf(s, 'occlusion').state === 'fresh',
      needs: bothArches(s) ? null : 'Both jaws must be registered first.',
    }),
    jobWarnings(s, 'occlusion'),
    downloads(app, s, 'occlusion', [
      ['lower_in_occlusion.stl', 'Lower arch in occlusion'],
      ['lower_to_occlusion.tfm', 'Its motion, for the path of a plan'],
      ['lower_contacts.vtp', 'Lower arch with gaps'],
    ]),
  );
}

/** Both jaws are registered and not out of date. */
export const bothArches = (s: State): boolean =>
  stageOf(s, 'arches').state === 'fresh' && s.arches?.upper !== undefined && s.arches.lower !== undefined;

const occlusionFigures = ({ contacts, movement, overjet_mm, overbite_mm }: Schemas['Occlusion']): Html =>
  html`${figures('occlusion-table', [
    ['Contact, right', `${fixed(contacts.right_mm2, 1)} mm²`],
    ['Contact, left', `${fixed(contacts.left_mm2, 1)} mm²`],
    ['Contacts', String(contacts.patches)],
    ['Penetration', mm(contacts.max_penetration_mm, 2)],
    ['Overjet', mm(overjet_mm)],
    ['Overbite', mm(overbite_mm)],
    ['Movement to superior', mm(movement.superior_mm)],
    ['Movement to anterior', mm(movement.anterior_mm)],
    ['Rotation', `${fixed(movement.rotation_deg, 1)}°`],
  ])}
  ${hint('Contact: gap of 0.2 mm or less. Overjet and overbite from edge to edge.')}`;

const display = (app: App, s: State): Html =>
  html`${toggle('Lower arch in occlusion', s.showOcclusion, (on) => app.patch({ showOcclusion: on }))}
  ${s.showOcclusion
    ? html`${legend('gap', GAP_TOP_MM, 'mm', 'gap-legend')} ${hint('Gap of the lower arch to the upper one.')}`
    : nothing}`;
