import { html, nothing } from 'lit-html';
import type { Schemas } from '../../api';
import { cssOf, fixed, paintTolerance_mm, toVec3 } from '../../model';
import type { App } from '../app';
import { chooseFiles } from '../choose_files';
import { numberField } from '../number_field';
import type { State } from '../state';
import { button, hint, section, segmented, type Html } from '../widgets';

type Boundary = Schemas['Boundary'];

const LABEL_TITLES: Record<string, string> = {
  fixed: 'No displacement',
  free: 'No support; the mobilized segment can push it',
  'with segment': 'Moves with the mobilized segment',
  contact: 'No support; any bone can push it',
  bonded: 'Moves with the closest bone',
  elevated: 'Any bone can push it; heals to the bone where it then lies',
  sliding: 'Stays on the closest bone, moves freely along it',
};

const ERASE = 0;

const mm2 = (value: number): string => `${fixed(value, value < 100 ? 1 : 0)} mm²`;

/** Smallest radius of the brush: it must reach a voxel everywhere. */
function minRadius_mm(s: State): number {
  return s.volume ? Math.ceil(2 * paintTolerance_mm(s.volume.grid)) / 2 : 1;
}

export const setPaintRadius = (app: App, mm: number): void =>
  app.patch({ paint_mm: Math.min(30, Math.max(minRadius_mm(app.model.s), mm)) });

export function boundarySection(app: App, s: State): Html {
  if (!s.boundary || !s.volume || !app.boundaryBrush.labels) return nothing;
  if (app.model.doc.plan.segments.length === 0)
    return section('Painted boundary', hint('The boundary can be painted when the plan has a segment.'));
  return section(
    'Painted boundary',
    hint('Rules set the boundary conditions of the tissue. Paint where a rule is wrong.'),
    labelButtons(app, s, s.boundary),
    brushFields(app, s, s.boundary),
    paintedTable(s, s.boundary),
    fileButtons(app, s, s.boundary),
  );
}

function labelButtons(app: App, s: State, { names }: Boundary): Html {
  const isPainting = s.tool === 'paint';
  const pick = (label: number): void =>
    app.patch({ tool: isPainting && s.paintLabel === label ? 'none' : 'paint', paintLabel: label });
  const isPicked = (label: number): string => String(isPainting && s.paintLabel === label);
  return html`<div class="row wrap" role="group" aria-label="Label to paint">
    ${names.map(
      ({ value, name, color }) =>
        html` <button
          type="button"
          class="button"
          data-id="paint-${name.replaceAll(' ', '-')}"
          title=${LABEL_TITLES[name] ?? nothing}
          aria-pressed=${isPicked(value)}
          @click=${() => pick(value)}
        >
          <span class="swatch" .style=${`background:${cssOf(toVec3(color))}`}></span>${name}
        </button>`,
    )}
    <button
      type="button"
      class="button"
      data-id="paint-erase"
      title="Restore the rule"
      aria-pressed=${isPicked(ERASE)}
      @click=${() => pick(ERASE)}
    >
      Erase
    </button>
  </div>`;
}

function brushFields(app: App, s: State, { names }: Boundary): Html {
  const label = names.find((x) => x.value === s.paintLabel)?.name ?? '';
  return html`${segmented(
    'Paint on',
    [
      { value: 'bone', text: 'On bone' },
      { value: 'skin', text: 'On skin' },
    ] as const,
    s.paintOn,
    (paintOn) => app.patch({ paintOn }),
  )}
  ${numberField({
    label: 'Brush radius',
    hint: 'keys [ and ]',
    value: s.paint_mm,
    unit: 'mm',
    step: 0.5,
    min: minRadius_mm(s),
    max: 30,
    id: 'paint-radius',
    onInput: (v) => setPaintRadius(app, v),
  })}
  ${s.tool === 'paint'
    ? hint(
        html`<b>Drag over the ${s.paintOn}</b> to ${s.paintLabel === ERASE ? 'erase' : `paint ${label}`}; drag the
          background to rotate the head. Bones are shown at their scanned position.`,
      )
    : hint('Select a label to paint.')}`;
}

const paintedTable = (s: State, { names, map }: Boundary): Html =>
  html`<table data-id="painted-areas">
    <thead>
      <tr>
        <th>Painted</th>
        <th>On bone and skin</th>
        ${map ? html`<th title="Of the last tissue mesh">Of the mesh</th>` : nothing}
      </tr>
    </thead>
    <tbody>
      ${names.map(
        ({ value, name }) =>
          html`<tr>
            <td>${name}</td>
            <td data-set=${name} data-mm2=${(s.paintedAreas?.[value] ?? 0).toFixed(1)}>
              ${mm2(s.paintedAreas?.[value] ?? 0)}
            </td>
            ${map ? html`<td>${mm2(map.painted.find((x) => x.name === name)?.area_mm2 ?? 0)}</td>` : nothing}
          </tr>`,
      )}
    </tbody>
  </table>`;

function fileButtons(app: App, s: State, { names }: Boundary): Html {
  const isPainted = names.some(({ value }) => (s.paintedAreas?.[value] ?? 0) > 0);
  const open = (): void => chooseFiles(false, ([file]) => file && void app.boundaryBrush.upload(file));
  const title = `A segmentation of another program, with segments named ${names.map((x) => x.name).join(', ')}`;
  return html`<div class="row wrap">
    ${isPainted
      ? button('Erase all', () => app.boundaryBrush.eraseAll(), { kind: 'quiet', id: 'paint-erase-all' })
      : nothing}
    ${button('Open a .seg.nrrd …', open, { kind: 'quiet', title })}
    ${isPainted
      ? button('Download', () => void app.download('boundary.seg.nrrd'), { kind: 'quiet', icon: 'download' })
      : nothing}
  </div>`;
}
