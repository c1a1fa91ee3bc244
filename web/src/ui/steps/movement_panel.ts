import { html, nothing } from 'lit-html';
import {
  COMPONENTS,
  componentOf,
  cssOf,
  DEFAULT_STEPS,
  editSegment,
  fixed,
  hasLowerTeeth,
  keyframesOf,
  segmentColor,
  withComponent,
  type ComponentKey,
  type Move,
  type Path,
  type Segment,
} from '../../model';
import type { App } from '../app';
import { numberField } from '../number_field';
import { checkedFragments, describeFragment } from '../fragments';
import { isBusyWith, lastJob, stageOf, type State } from '../state';
import { button, chip, empty, notice, section, segmented, select, toggle, type Html } from '../widgets';
import type { Viewer } from '../viewer';
import { jobWarnings } from './measure_parts';
import { overlapNotice, previewState } from './preview_state';
import { profileTargetSection } from './profile_section';

/** A move in words: "12.0 mm anterior, 5.0 mm inferior". */
export function inWords(move: Move): string {
  const words = COMPONENTS.map(({ key, unit, plus, minus }) => {
    const value = componentOf(move, key);
    if (Math.abs(value) < 0.05) return null;
    return `${fixed(Math.abs(value), 1)}${unit === '°' ? '°' : ' mm'} ${value > 0 ? plus : minus}`;
  }).filter((text) => text !== null);
  return words.length ? words.join(', ') : 'not moved';
}

const TITLES: Record<ComponentKey, string> = {
  anterior: 'Anterior',
  superior: 'Superior',
  left: 'To the left',
  pitch: 'Pitch',
  roll: 'Roll',
  yaw: 'Yaw',
};

export function movementPanel(app: App, s: State, view: Viewer): Html {
  const { plan } = app.model.doc;
  const segment = plan.segments[s.segment];
  if (!segment)
    return html`<h2>Movement</h2>
      ${empty(
        'No segment yet',
        'Cut a segment of bone before it can move.',
        button('To the osteotomy', () => app.setStep('osteotomy')),
      )}`;
  const move = app.move();
  return html`
    <h2>Movement</h2>
    ${segmentChoice(app, s)} ${cutNotice(app, s)}
    ${move
      ? html` <p class="lead-move" data-id="in-words"><strong>${inWords(move)}</strong></p>
          ${toOcclusion(app, s, segment)} ${overlapNotice(s)}
          ${section('Translation', componentFields(app, move, 'translate'))}
          ${section('Rotation', componentFields(app, move, 'rotate'), pivotRow(app, s, segment))}`
      : notice(
          'info',
          'This path has no numbers to edit',
          'It is given by targets, a file or days of distraction. It can be shown and predicted, but not edited here.',
        )}
    ${move ? profileTargetSection(s, view.profileDrag) : nothing} ${pathSection(app, s, segment)}
    ${checkSection(app, s)}
    ${section(
      'Show',
      toggle('Slices with the moved outline', s.showSlices, (on) => app.showSlices(on)),
      toggle('Overlap of bones', s.showOverlap, (on) => app.patch({ showOverlap: on })),
      toggle('Preview of the face', s.showPreview, (on) => app.patch({ showPreview: on })),
      previewState(app, s),
    )}
  `;
}

function segmentChoice(app: App, s: State): Html {
  const { segments } = app.model.doc.plan;
  const swatch = (index: number): Html =>
    html`<span class="swatch" .style=${`background:${cssOf(segmentColor(index))}`}></span>`;
  if (segments.length === 1) return html`<div class="row">${swatch(0)}<strong>${segments[0].name}</strong></div>`;
  const pick = (segment: Segment, index: number): void =>
    app.patch({ segment: index, keyframe: Math.max(0, keyframesOf(segment).length - 1), plane: null });
  return html`<div class="row wrap">
    ${segments.map(
      (segment, index) =>
        html` <button
          type="button"
          class="button"
          aria-pressed=${String(index === s.segment)}
          @click=${() => pick(segment, index)}
        >
          ${swatch(index)}${segment.name}
        </button>`,
    )}
  </div>`;
}

function cutNotice(app: App, s: State): Html {
  const cut = stageOf(s, 'cut');
  if (cut.state === 'fresh') return nothing;
  const title = cut.state === 'stale' ? 'The cut is out of date' : 'The bone is not cut yet';
  const action = button('Cut the bone', () => void app.run({ kind: 'cut' }), { disabled: isBusyWith(s, 'cut') });
  return notice('warning', title, cut.why || 'The overlap is known after the cut.', action);
}

function componentFields(app: App, move: Move, kind: 'translate' | 'rotate'): Html {
  const isTranslation = kind === 'translate';
  // The current move, not `move`: a drag changes it before the panel is drawn.
  const set = (key: ComponentKey, value: number): void => {
    const now = app.move();
    if (now) app.setMove(withComponent(now, key, value), `move-${key}`);
  };
  return html`<div class="numbers">
    ${COMPONENTS.filter((component) => component.kind === kind).map(({ key, plus, minus, unit }) =>
      numberField({
        label: TITLES[key],
        hint: isTranslation ? `− is ${minus}` : `+ is ${plus}`,
        value: componentOf(move, key),
        unit,
        step: 0.5,
        min: isTranslation ? -60 : -90,
        max: isTranslation ? 60 : 90,
        id: `move-${key}`,
        onInput: (v) => set(key, v),
        onDone: () => app.settle(),
      }),
    )}
  </div>`;
}

/** Takes the occlusion of step 9 as the movement. */
function toOcclusion(app: App, s: State, segment: Segment): Html {
  if (stageOf(s, 'occlusion').state !== 'fresh' || !hasLowerTeeth(segment)) return nothing;
  return html`<div class="row">
    ${button('To the occlusion', () => void app.moveToOcclusion(), {
      id: 'to-occlusion',
      title: 'Moves the segment of the lower teeth to the occlusion of step 9, with the upper jaw where it is planned',
    })}
  </div>`;
}

function pivotRow(app: App, s: State, segment: Segment): Html {
  const keyframe = keyframesOf(segment)[s.keyframe];
  const pivots = [
    { value: '', text: keyframe?.about_mm ? 'A point' : 'Centroid of the segment' },
    ...app.model.doc.landmarks.map(({ name }) => ({ value: name, text: name })),
  ];
  return html`<div class="row">
    <div class="grow">
      ${select('Pivot', pivots, keyframe?.about ?? '', (v) => app.setPivot(v || app.pivotOf(segment.name)))}
    </div>
    ${button('Pick', () => app.patch({ tool: s.tool === 'pivot' ? 'none' : 'pivot' }), {
      icon: 'target',
      pressed: s.tool === 'pivot',
      title: 'Click on the bone to rotate about that point',
    })}
  </div>`;
}

function pathSection(app: App, s: State, segment: Segment): Html {
  const setPath = (part: Partial<Path>, gesture: string | null = null): void => {
    const { plan } = app.model.doc;
    app.edit({ plan: editSegment(plan, s.segment, (x) => ({ ...x, path: { ...x.path, ...part } })) }, gesture);
  };
  return section(
    'Path',
    segmented(
      'Between keyframes',
      [
        { value: 'straight', text: 'Straight', title: 'The pivot moves along a line; the rotation is uniform' },
        { value: 'screw', text: 'Screw', title: 'Rotation about one axis and translation along it' },
      ] as const,
      segment.path.interpolation ?? 'straight',
      (interpolation) => setPath({ interpolation }),
    ),
    numberField({
      label: 'Steps',
      hint: 'equilibria along the path',
      value: segment.path.steps ?? DEFAULT_STEPS,
      unit: '',
      digits: 0,
      step: 1,
      min: 1,
      max: 200,
      id: 'path-steps',
      onInput: (v) => setPath({ steps: Math.round(v) }, 'steps'),
    }),
  );
}

/** Findings of a check as text. */
function findingsOf(result: unknown): string[] {
  const { findings = [] } = (result ?? {}) as { findings?: unknown[] };
  return findings.map((finding) => {
    if (typeof finding === 'string') return finding;
    const { message, text } = finding as { message?: string; text?: string };
    return message ?? text ?? JSON.stringify(finding);
  });
}

/** Loose pieces of bone, and the part to which each belongs; nothing if there are none. */
function fragmentList(s: State): Html | typeof nothing {
  const fragments = checkedFragments(s);
  if (fragments.length === 0) return nothing;
  return html`<details id="fragments">
    <summary>${fragments.length === 1 ? '1 fragment' : `${fragments.length} fragments`} of bone</summary>
    <ul>
      ${fragments.map((one) => html`<li>${describeFragment(one)}</li>`)}
    </ul>
  </details>`;
}

function checkSection(app: App, s: State): Html {
  const stage = stageOf(s, 'check');
  const isBusy = isBusyWith(s, 'check');
  const job = lastJob(s, 'check');
  const findings = findingsOf(job?.result);
  const list = html`<ul>
    ${findings.map((finding) => html`<li>${finding}</li>`)}
  </ul>`;
  const count = findings.length === 1 ? '1 finding' : `${findings.length || ''} findings`.trim();
  const title = `The check has ${count}`;
  return section(
    'Whole path',
    html`<div class="row">
      <span class="grow hint">Overlap, gaps and support at every step.</span>${chip(isBusy ? 'running' : stage.state)}
    </div>`,
    stage.state === 'fresh' && job?.state === 'done'
      ? job.has_findings
        ? notice('error', title, findings.length ? list : job.message)
        : notice('good', 'The check has no findings')
      : nothing,
    fragmentList(s),
    stage.state === 'fresh' ? jobWarnings(s, 'check') : nothing,
    job?.state === 'failed' ? notice('error', 'The check failed', job.message) : nothing,
    button(isBusy ? 'Checking …' : 'Check the plan', () => void app.run({ kind: 'check' }), {
      disabled: isBusy,
      id: 'check',
    }),
  );
}
