import { html, nothing } from 'lit-html';
import { fixed, presetOf, WINDOW_PRESETS } from '../../model';
import type { App } from '../app';
import { numberField } from '../number_field';
import { isBusyWith, lastJob, stageOf, type State } from '../state';
import { button, chip, empty, hint, notice, section, slider, toggle, type Html } from '../widgets';

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
  const job = lastJob(s, 'segment');
  if (!s.volume)
    return html`<h2>Anatomy</h2>
      ${empty(
        'No scan yet',
        'Open one in step 1, Case.',
        button('To the case', () => app.setStep('case')),
      )}`;
  return html`
    <h2>Anatomy ${chip(isBusyWith(s, 'segment') ? 'running' : stage.state)}</h2>
    ${stage.state === 'stale' ? notice('warning', 'Surfaces are out of date', stage.why) : nothing}
    ${job?.state === 'failed' ? notice('error', 'The tissues could not be segmented', job.message) : nothing}
    ${windowSection(app, s)}
    ${section(
      'Surfaces',
      opacitySlider('Bone', s.skullOpacity, (v) => app.patch({ skullOpacity: v })),
      opacitySlider('Skin', s.skinOpacity, (v) => app.patch({ skinOpacity: v })),
    )}
    ${thresholdSection(app, s)} ${correctionSection(app, s)}
  `;
}

function windowSection(app: App, s: State): Html {
  const { level_hu, window_hu } = s.window;
  return section(
    'Window',
    html`<div class="row wrap">
      ${WINDOW_PRESETS.map((preset) =>
        button(preset.name, () => app.patch({ window: { level_hu: preset.level_hu, window_hu: preset.window_hu } }), {
          pressed: presetOf(s.window) === preset.name,
        }),
      )}
    </div>`,
    hint(
      `Level ${fixed(level_hu, 0)}, width ${fixed(window_hu, 0)} HU. Drag with the right button on a ` +
        'slice to change them.',
    ),
  );
}

const opacitySlider = (label: string, value: number, onInput: (value: number) => void): Html =>
  slider({ label, value, min: 0, max: 1, step: 0.05, show: percent, onInput });

function thresholdSection(app: App, s: State): Html {
  const { state } = stageOf(s, 'anatomy');
  const isBusy = isBusyWith(s, 'segment');
  const label = isBusy ? 'Working …' : state === 'missing' ? 'Segment tissues' : 'Rebuild surfaces';
  return section(
    'Bone threshold',
    toggle('Show the bone mask on the slices', s.thresholdOn, (on) => app.patch({ thresholdOn: on })),
    slider({
      label: 'Threshold',
      value: s.bone_hu,
      min: 50,
      max: 800,
      step: 1,
      show: (v) => `${fixed(v, 0)} HU`,
      onInput: (v) => app.patch({ bone_hu: v, thresholdOn: true }),
    }),
    button(label, () => void app.segment(s.bone_hu), {
      kind: state === 'missing' || state === 'stale' ? 'primary' : 'plain',
      disabled: isBusy,
      id: 'segment',
    }),
  );
}

function correctionSection(app: App, s: State): Html {
  if (stageOf(s, 'anatomy').state === 'missing')
    return section('Manual correction', hint('After the segmentation, labels can be painted on the slices.'));
  const show = (on: boolean): void => {
    app.patch({ showLabels: on, tool: on ? s.tool : 'none' });
    if (on) void app.labelBrush.load();
  };
  return section(
    'Manual correction',
    toggle('Show labels on the slices', s.showLabels, show),
    s.showLabels && s.labelsReady ? brushPart(app, s) : nothing,
  );
}

function brushPart(app: App, s: State): Html {
  const strokes = app.model.doc.strokes.length;
  return html` <div class="row wrap">${s.labelNames.map(({ value, name }) => labelButton(app, s, value, name))}</div>
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
      ? hint('Paint on any slice. The brush is a sphere, so it also paints neighboring slices.')
      : hint('Select a tissue to paint it.')}
    ${strokes > 0
      ? button(`Use ${strokes} ${strokes === 1 ? 'stroke' : 'strokes'}`, () => void app.labelBrush.use(), {
          kind: 'primary',
          disabled: isBusyWith(s, 'segment'),
          id: 'use-labels',
        })
      : nothing}`;
}

function labelButton(app: App, s: State, value: number, name: string): Html {
  const isPicked = s.tool === 'brush' && s.brushLabel === value;
  const tint = LABEL_TINTS[value];
  const background = tint ? `rgb(${tint.join(' ')})` : 'var(--line-strong)';
  return html` <button
    type="button"
    class="button"
    aria-pressed=${String(isPicked)}
    @click=${() => app.patch({ tool: isPicked ? 'none' : 'brush', brushLabel: value })}
  >
    <span class="swatch" .style=${`background:${background}`}></span>${name}
  </button>`;
}
