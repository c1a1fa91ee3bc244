import { html, nothing } from 'lit-html';
import type { Schemas } from '../../api';
import { cssOf, fixed, toVec3 } from '../../model';
import type { App } from '../app';
import { isBusyWith, stageOf, type State } from '../state';
import { button, hint, notice, section, toggle, type Html } from '../widgets';

type Boundary = Schemas['Boundary'];
type Group = NonNullable<Boundary['map']>['groups'][number];

const RULE_TITLES: Record<string, string> = {
  painted: 'Painted',
  osteotomy: 'Near an osteotomy',
  joint: 'Teeth and joints',
  segment: 'Mobilized segment',
  'stationary bone': 'Stationary bone',
  brain: 'Cranial cavity',
  'scan boundary': 'The scan ends',
  'cut boundary': 'The region ends',
  skin: 'Skin',
  air: 'Airway, sinus, oral cavity',
  lips: 'Between the lips',
  vestibule: 'Teeth and gingiva',
  crown: 'Crowns of teeth',
  overlap: 'Bone that enters other bone',
};

const CONDITION_TITLES: Record<string, string> = {
  free: 'No traction',
  contact: 'Bone pushes it, nothing holds it',
  bonded: 'Moves with its bone',
  elevated: 'Bone pushes it; heals to the bone where it then lies',
  sliding: 'Stays on its bone, moves freely along it',
  fixed: 'No displacement',
  roller: 'No displacement normal to the plane',
  foundation: 'Elastic layer at the plane',
};

/** Rules whose nodes may lie on any bone; the others say which. */
const NAMES_BONE = new Set(['painted', 'osteotomy', 'joint', 'segment', 'vestibule', 'crown']);

/** The interface map of the newest tissue mesh: a condition for each node of its boundary, and the rule that set it. */
export function interfaceMapSection(app: App, s: State): Html {
  if (!s.boundary || app.model.doc.plan.segments.length === 0) return nothing;
  const { map, conditions } = s.boundary;
  if (!map) return section('Interface map', noMap(app, s));
  return section(
    'Interface map',
    hint(`What holds the tissue, by the rules, in the mesh of the ${map.stage}.`),
    toggle('Show on bone', s.showInterface, (showInterface) => app.patch({ showInterface })),
    html`<ul class="swatches" data-id="interface-legend" aria-label="Colors of the conditions">
      ${conditions
        .filter(({ name }) => map.groups.some((group) => group.condition === name && group.rule !== 'skin'))
        .map(
          ({ name }) => html`<li title=${CONDITION_TITLES[name] ?? nothing}>${swatch(s.boundary!, name)}${name}</li>`,
        )}
    </ul>`,
    groupTable(s.boundary, map.groups),
  );
}

function noMap(app: App, s: State): Html {
  const preview = stageOf(s, 'preview');
  const why = 'The map shows what holds the tissue, by the rules.';
  if (stageOf(s, 'cut').state !== 'fresh') return hint(`${why} It is known after the osteotomy and the preview.`);
  const isStale = preview.state === 'stale';
  const prepare = button(
    isStale ? 'Update preview' : 'Prepare preview',
    () => void app.run({ kind: 'preview-factor' }),
    {
      disabled: isBusyWith(s, 'preview-factor'),
      id: 'prepare-preview',
    },
  );
  return isStale
    ? notice('warning', 'The preview is out of date', preview.why, prepare)
    : html`${hint(`${why} It is known after the preview is prepared.`)}${prepare}`;
}

function swatch({ conditions }: Boundary, name: string): Html {
  const color = conditions.find((x) => x.name === name)?.color;
  return color ? html`<span class="swatch" .style=${`background:${cssOf(toVec3(color))}`}></span>` : nothing;
}

const boneOf = ({ rule, segment, on_stationary_bone }: Group): string => {
  if (!NAMES_BONE.has(rule)) return '';
  return segment ?? (on_stationary_bone ? 'stationary bone' : '');
};

const groupTable = (boundary: Boundary, groups: readonly Group[]): Html =>
  html`<table data-id="interface-map">
    <thead>
      <tr>
        <th>Rule</th>
        <th>Condition</th>
        <th>cm²</th>
      </tr>
    </thead>
    <tbody>
      ${groups.map((group) => {
        const bone = boneOf(group);
        return html`<tr data-rule=${group.rule}>
          <td>${RULE_TITLES[group.rule] ?? group.rule}${bone ? html`<small>${bone}</small>` : nothing}</td>
          <td title=${CONDITION_TITLES[group.condition] ?? nothing}>
            ${swatch(boundary, group.condition)}${group.condition}
          </td>
          <td title=${`${group.nodes} nodes`}>${fixed(group.area_mm2 / 100, group.area_mm2 < 1000 ? 2 : 1)}</td>
        </tr>`;
      })}
    </tbody>
  </table>`;
