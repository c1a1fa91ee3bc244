import { html, nothing } from 'lit-html';
import { cssOf, fixed, paintTolerance_mm, toVec3 } from '../../model';
import type { App } from '../app';
import { chooseFiles } from '../choose_files';
import { numberField } from '../number_field';
import { button, hint, notice, section, segmented, type Html } from '../widgets';
import { isBusyWith, stageOf, type State } from '../state';

/** What the rules' sets are, in the words of people. */
const SET_WORDS: Record<string, string> = {
  cut: 'Where the region was cut out',
  scan_edge: 'Where the scan ends',
  moved_bone: 'On moved bone',
  still_bone: 'On still bone',
  brain: 'On the brain',
  skin: 'Skin',
  free: 'All the rest, such as the airway',
};

const DOES: Record<string, string> = {
  fixed: 'Held where it is',
  free: 'Held by nothing; moved bone may push it',
  slides: 'Slides on still bone without entering it',
  'with segment': 'Goes with the moved bone, wherever it lies',
};

const mm2 = (value: number): string => `${fixed(value, value < 100 ? 1 : 0)} mm²`;

export const setPaintRadius = (app: App, mm: number): void => {
  const { volume } = app.model.s;
  const least = volume ? Math.ceil(2 * paintTolerance_mm(volume.grid)) / 2 : 1;
  app.patch({ paint_mm: Math.min(30, Math.max(least, mm)) });
};

export function boundarySection(app: App, s: State): Html {
  const { plan } = app.model.doc;
  if (!s.boundary || !s.volume || !app.boundaryBrush.labels) return nothing;
  if (plan.segments.length === 0)
    return section('Painted boundary', hint('Where tissue is held can be painted once a bone is to be moved.'));
  const { names, areas, rules, release_mm } = s.boundary;
  const isPainting = s.tool === 'paint';
  const pick = (label: number): void =>
    app.patch({ tool: isPainting && s.paintLabel === label ? 'none' : 'paint', paintLabel: label });
  const isPainted = names.some(({ value }) => (s.paintedAreas?.[value] ?? 0) > 0);
  const preview = stageOf(s, 'preview');
  return html` ${section(
      'Painted boundary',
      hint('What tissue does where it ends is decided by rule. Where the rule has it wrong, paint over it.'),
      html`<div class="row wrap" role="group" aria-label="What to paint">
        ${names.map(
          ({ value, name, colour }) =>
            html` <button
              type="button"
              class="button"
              data-id="paint-${name.replaceAll(' ', '-')}"
              title=${DOES[name] ?? nothing}
              aria-pressed=${String(isPainting && s.paintLabel === value)}
              @click=${() => pick(value)}
            >
              <span class="swatch" .style=${`background:${cssOf(toVec3(colour))}`}></span>${name}
            </button>`,
        )}
        <button
          type="button"
          class="button"
          data-id="paint-erase"
          title="Back to the rule"
          aria-pressed=${String(isPainting && s.paintLabel === 0)}
          @click=${() => pick(0)}
        >
          Rub out
        </button>
      </div>`,
      segmented(
        'Paint on',
        [
          { value: 'bone', text: 'On bone' },
          { value: 'skin', text: 'On skin' },
        ] as const,
        s.paintOn,
        (paintOn) => app.patch({ paintOn }),
      ),
      numberField({
        label: 'Brush radius',
        hint: 'keys [ and ]',
        value: s.paint_mm,
        unit: 'mm',
        step: 0.5,
        min: Math.ceil(2 * paintTolerance_mm(s.volume.grid)) / 2,
        max: 30,
        id: 'paint-radius',
        onInput: (v) => setPaintRadius(app, v),
      }),
      isPainting
        ? hint(
            html`<b>Drag over the ${s.paintOn}</b> to
              ${s.paintLabel === 0 ? 'rub out' : `paint ${names.find((x) => x.value === s.paintLabel)?.name ?? ''}`};
              drag beside it to turn the head. Bones stand as scanned.`,
          )
        : hint('Pick what to paint.'),
      html`<table data-id="painted-areas">
        <thead>
          <tr>
            <th>Painted</th>
            <th>On bone and skin</th>
            ${areas ? html`<th title="Of the tissue's mesh, as made last">Of the mesh</th>` : nothing}
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
                ${areas ? html`<td>${mm2(areas.painted.find((x) => x.name === name)?.mm2 ?? 0)}</td>` : nothing}
              </tr>`,
          )}
        </tbody>
      </table>`,
      html`<div class="row wrap">
        ${isPainted
          ? button('Rub out all', () => app.boundaryBrush.eraseAll(), { kind: 'quiet', id: 'paint-erase-all' })
          : nothing}
        ${button(
          'Open a .seg.nrrd …',
          () => chooseFiles(false, ([file]) => file && void app.boundaryBrush.upload(file)),
          {
            kind: 'quiet',
            title: 'Painted in another program, with segments called fixed, free, slides or with segment',
          },
        )}
        ${isPainted
          ? button('Save it', () => void app.download('boundary.seg.nrrd'), { kind: 'quiet', icon: 'download' })
          : nothing}
      </div>`,
      preview.state === 'stale' && stageOf(s, 'cut').state === 'fresh'
        ? notice(
            'warning',
            'The preview is out of date',
            preview.why,
            button('Prepare it anew', () => void app.run({ kind: 'preview-factor' }), {
              disabled: isBusyWith(s, 'preview-factor'),
              id: 'prepare-preview',
            }),
          )
        : nothing,
    )}
    <details class="group" data-id="boundary-rules">
      <summary>Boundary by rule</summary>
      <div>
        ${hint(
          html`The first that takes a place keeps it. Tissue on still bone or brain is let go within
            <b>${fixed(release_mm, 1)} mm</b> of the moved bone.`,
        )}
        <table>
          <thead>
            <tr>
              <th>Set</th>
              <th>Nearer than</th>
              ${areas
                ? html`<th>Fixed</th>
                    <th>Free</th>`
                : nothing}
            </tr>
          </thead>
          <tbody>
            ${rules.map(({ set, within_mm }) => {
              const area = areas?.rules.find((x) => x.set === set);
              return html`<tr>
                <td>${SET_WORDS[set] ?? set}</td>
                <td>${within_mm === null ? '–' : `${fixed(within_mm, 2)} mm`}</td>
                ${areas
                  ? html`<td>${area ? mm2(area.fixed) : ''}</td>
                      <td
                        title=${area && area.with_segment > 0
                          ? `and ${mm2(area.with_segment)} go with the bone`
                          : nothing}
                      >
                        ${area ? mm2(area.free + area.with_segment) : ''}
                      </td>`
                  : nothing}
              </tr>`;
            })}
          </tbody>
        </table>
        ${areas
          ? hint(`As of the last ${areas.stage}; without what is painted over.`)
          : hint('How much each holds is known when the preview is prepared.')}
      </div>
    </details>`;
}
