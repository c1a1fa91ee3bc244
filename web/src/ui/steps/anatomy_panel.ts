import { html, nothing } from 'lit-html';
import { fixed, presetOf, WINDOW_PRESETS } from '../../model';
import type { App } from '../app';
import { numberField } from '../number_field';
import { button, chip, empty, hint, notice, section, slider, toggle, type Html } from '../widgets';
import { isBusyWith, lastJob, stageOf, type State } from '../state';

export const LABEL_TINTS: readonly (readonly [number, number, number] | null)[] = [
  null,
  [242, 184, 75],
  [224, 128, 110],
  [90, 180, 224],
  [167, 139, 230],
  [96, 190, 140],
  [214, 140, 40],
  [196, 48, 96],
];

const percent = (value: number): string => `${Math.round(value * 100)} %`;

export function anatomyPanel(app: App, s: State): Html {
  const stage = stageOf(s, 'anatomy');
  const busy = isBusyWith(s, 'segment');
  const failed = lastJob(s, 'segment');
  if (!s.volume)
    return html`<h2>Anatomy</h2>
      ${empty(
        'No scan yet',
        'Open one in step 1, Case.',
        button('To the case', () => app.setStep('case')),
      )}`;
  const strokes = app.model.doc.strokes.length;
  return html`
    <h2>Anatomy ${chip(busy ? 'running' : stage.state)}</h2>
    ${stage.state === 'stale' ? notice('warning', 'Surfaces are out of date', stage.why) : nothing}
    ${failed?.state === 'failed' ? notice('error', 'The tissues could not be told apart', failed.message) : nothing}
    ${section(
      'Window',
      html`<div class="row wrap">
        ${WINDOW_PRESETS.map((preset) =>
          button(preset.name, () => app.patch({ window: { level_hu: preset.level_hu, window_hu: preset.window_hu } }), {
            pressed: presetOf(s.window) === preset.name,
          }),
        )}
      </div>`,
      hint(
        `Level ${fixed(s.window.level_hu, 0)}, width ${fixed(s.window.window_hu, 0)} HU. Drag with the right button on a slice to change them.`,
      ),
    )}
    ${section(
      'Surfaces',
      slider({
        label: 'Bone',
        value: s.skullOpacity,
        min: 0,
        max: 1,
        step: 0.05,
        show: percent,
        onInput: (v) => app.patch({ skullOpacity: v }),
      }),
      slider({
        label: 'Skin',
        value: s.skinOpacity,
        min: 0,
        max: 1,
        step: 0.05,
        show: percent,
        onInput: (v) => app.patch({ skinOpacity: v }),
      }),
    )}
    ${section(
      'Bone threshold',
      toggle('Show on the slices what counts as bone', s.thresholdOn, (on) => app.patch({ thresholdOn: on })),
      slider({
        label: 'Bone from',
        value: s.bone_hu,
        min: 50,
        max: 800,
        step: 1,
        show: (v) => `${fixed(v, 0)} HU`,
        onInput: (v) => app.patch({ bone_hu: v, thresholdOn: true }),
      }),
      button(
        busy ? 'Working …' : stage.state === 'missing' ? 'Tell tissues apart' : 'Make surfaces anew',
        () => void app.segment(s.bone_hu),
        {
          kind: stage.state === 'missing' || stage.state === 'stale' ? 'primary' : 'plain',
          disabled: busy,
          id: 'segment',
        },
      ),
    )}
    ${section(
      'Correct by hand',
      stage.state === 'missing'
        ? hint('After the tissues have been told apart, labels can be painted on the slices.')
        : html` ${toggle('Show labels on the slices', s.showLabels, (on) => {
            app.patch({ showLabels: on, tool: on ? s.tool : 'none' });
            if (on) void app.labelBrush.load();
          })}
          ${s.showLabels && s.labelsReady
            ? html` <div class="row wrap">
                  ${s.labelNames.map(
                    ({ value, name }) =>
                      html` <button
                        type="button"
                        class="button"
                        aria-pressed=${String(s.tool === 'brush' && s.brushLabel === value)}
                        @click=${() =>
                          app.patch({
                            tool: s.tool === 'brush' && s.brushLabel === value ? 'none' : 'brush',
                            brushLabel: value,
                          })}
                      >
                        <span
                          class="swatch"
                          .style=${`background:${LABEL_TINTS[value] ? `rgb(${LABEL_TINTS[value]!.join(' ')})` : 'var(--line-strong)'}`}
                        ></span
                        >${name}
                      </button>`,
                  )}
                </div>
                ${numberField({
                  label: 'Brush radius',
                  value: s.brush_mm,
                  unit: 'mm',
                  digits: 1,
                  step: 0.5,
                  min: 0.5,
                  max: 30,
                  onInput: (v) => app.patch({ brush_mm: v }),
                })}
                ${s.tool === 'brush'
                  ? hint('Paint on any slice. The brush is a ball: it reaches the neighboring slices too.')
                  : hint('Pick a tissue to paint it.')}
                ${strokes > 0
                  ? button(`Use ${strokes} ${strokes === 1 ? 'stroke' : 'strokes'}`, () => void app.labelBrush.use(), {
                      kind: 'primary',
                      disabled: busy,
                      id: 'use-labels',
                    })
                  : nothing}`
            : nothing}`,
    )}
  `;
}
