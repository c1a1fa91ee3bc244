import { html, nothing } from 'lit-html';
import {
  cssOf,
  fixed,
  keyframesOf,
  mm,
  COMPONENTS,
  componentOf,
  retimeKeyframe,
  segmentColor,
  pathFractionOf,
  withKeyframeAfter,
  withoutKeyframe,
  withComponent,
  type Move,
  type ComponentKey,
} from '../../model';
import type { App } from '../app';
import { numberField } from '../number_field';
import {
  button,
  chip,
  empty,
  hint,
  iconButton,
  notice,
  section,
  segmented,
  select,
  toggle,
  type Html,
} from '../widgets';
import { isBusyWith, lastJob, stageOf, type State } from '../state';

/** Overlap of bones above which a plan is marked: the limit of `lefort plan check` [mm]. */
const OVERLAP_LIMIT_MM = 0.5;

/** A move in words: "12.0 mm anterior, 5.0 mm inferior". */
export function inWords(move: Move): string {
  const words = COMPONENTS.map((part) => {
    const value = componentOf(move, part.key);
    if (Math.abs(value) < 0.05) return null;
    return `${fixed(Math.abs(value), 1)}${part.unit === '°' ? '°' : ' mm'} ${value > 0 ? part.plus : part.minus}`;
  }).filter((text) => text !== null);
  return words.length ? words.join(', ') : 'not moved';
}

const TITLES: Record<(typeof COMPONENTS)[number]['key'], string> = {
  anterior: 'Anterior',
  superior: 'Superior',
  left: 'To the left',
  pitch: 'Pitch',
  roll: 'Roll',
  yaw: 'Yaw',
};

export function overlapNotice(s: State): Html {
  if (!s.depth) return nothing;
  const { deepest_mm, beyondReach, perSecond } = s.depth;
  const rate =
    perSecond > 0
      ? html`<small data-id="update-rate" data-rate=${perSecond.toFixed(1)}> ${fixed(perSecond, 0)} updates/s</small>`
      : nothing;
  if (beyondReach)
    return notice(
      'error',
      'Bones lie deep in each other',
      html`Deeper than can be told here. This cannot be done.${rate}`,
    );
  if (deepest_mm > OVERLAP_LIMIT_MM)
    return notice(
      'error',
      `Bones overlap by ${mm(deepest_mm)}`,
      html`Not possible as it is: more than ${OVERLAP_LIMIT_MM} mm of bone must be taken off.${rate}`,
    );
  return notice(
    'good',
    deepest_mm > 0.05 ? `Bones touch, ${mm(deepest_mm)} deep` : 'No bones overlap',
    html`At the pose shown.${rate}`,
  );
}

function checkPart(app: App, s: State): Html {
  const stage = stageOf(s, 'check');
  const busy = isBusyWith(s, 'check');
  const job = lastJob(s, 'check');
  const findings = ((job?.result as { findings?: unknown[] } | null)?.findings ?? []).map((f) =>
    typeof f === 'string'
      ? f
      : ((f as { message?: string; text?: string }).message ?? (f as { text?: string }).text ?? JSON.stringify(f)),
  );
  return section(
    'The whole path',
    html`<div class="row">
      <span class="grow hint">Overlap, gaps and support at every step.</span>${chip(busy ? 'running' : stage.state)}
    </div>`,
    stage.state === 'fresh' && job?.state === 'done'
      ? job.has_findings
        ? notice(
            'error',
            findings.length
              ? `${findings.length} ${findings.length === 1 ? 'finding' : 'findings'} against the plan`
              : 'Found against the plan',
            findings.length
              ? html`<ul>
                  ${findings.map((f) => html`<li>${f}</li>`)}
                </ul>`
              : job.message,
          )
        : notice('good', 'Nothing was found against the plan')
      : nothing,
    job?.state === 'failed' ? notice('error', 'The check could not be done', job.message) : nothing,
    button(busy ? 'Checking …' : 'Check the plan', () => void app.run({ kind: 'check' }), {
      disabled: busy,
      id: 'check',
    }),
  );
}

export function movementPanel(app: App, s: State): Html {
  const { plan, landmarks } = app.model.doc;
  const segment = plan.segments[s.segment];
  if (!segment)
    return html`<h2>Movement</h2>
      ${empty(
        'Nothing is cut yet',
        'A piece of bone must be cut free before it can move.',
        button('To the osteotomy', () => app.setStep('osteotomy')),
      )}`;
  const cut = stageOf(s, 'cut');
  const move = app.move();
  const keyframe = keyframesOf(segment)[s.keyframe];
  // Of the move as it is then: what is dragged is drawn later here.
  const set = (key: ComponentKey, value: number): void => {
    const now = app.move();
    if (now) app.setMove(withComponent(now, key, value), `move-${key}`);
  };
  const pivots = [
    { value: '', text: keyframe?.about_mm ? 'A point' : 'Middle of the segment' },
    ...landmarks.map((l) => ({ value: l.name, text: l.name })),
  ];
  return html`
    <h2>Movement</h2>
    ${plan.segments.length > 1
      ? html`<div class="row wrap">
          ${plan.segments.map(
            (x, index) =>
              html` <button
                type="button"
                class="button"
                aria-pressed=${String(index === s.segment)}
                @click=${() =>
                  app.patch({ segment: index, keyframe: Math.max(0, keyframesOf(x).length - 1), plane: null })}
              >
                <span class="swatch" .style=${`background:${cssOf(segmentColor(index))}`}></span>${x.name}
              </button>`,
          )}
        </div>`
      : html`<div class="row">
          <span class="swatch" .style=${`background:${cssOf(segmentColor(0))}`}></span><strong>${segment.name}</strong>
        </div>`}
    ${cut.state !== 'fresh'
      ? notice(
          'warning',
          cut.state === 'stale' ? 'The cut is out of date' : 'The bone is not cut yet',
          cut.why || 'Until then nothing can be said about overlap.',
          button('Cut the bone', () => void app.run({ kind: 'cut' }), { disabled: isBusyWith(s, 'cut') }),
        )
      : nothing}
    ${move
      ? html` <p class="lead-move" data-id="in-words"><strong>${inWords(move)}</strong></p>
          ${overlapNotice(s)}
          ${section(
            'Shift',
            html`<div class="numbers">
              ${COMPONENTS.filter((p) => p.kind === 'translate').map((part) =>
                numberField({
                  label: TITLES[part.key],
                  hint: `− is ${part.minus}`,
                  value: componentOf(move, part.key),
                  unit: 'mm',
                  step: 0.5,
                  min: -60,
                  max: 60,
                  id: `move-${part.key}`,
                  onInput: (v) => set(part.key, v),
                  onDone: () => app.settle(),
                }),
              )}
            </div>`,
          )}
          ${section(
            'Turn',
            html`<div class="numbers">
              ${COMPONENTS.filter((p) => p.kind === 'rotate').map((part) =>
                numberField({
                  label: TITLES[part.key],
                  hint: `+ is ${part.plus}`,
                  value: componentOf(move, part.key),
                  unit: '°',
                  step: 0.5,
                  min: -90,
                  max: 90,
                  id: `move-${part.key}`,
                  onInput: (v) => set(part.key, v),
                  onDone: () => app.settle(),
                }),
              )}
            </div>`,
            html`<div class="row">
              <div class="grow">
                ${select('About', pivots, keyframe?.about ?? '', (v) => app.setPivot(v || app.pivotOf(segment.name)))}
              </div>
              ${button('Pick', () => app.patch({ tool: s.tool === 'pivot' ? 'none' : 'pivot' }), {
                icon: 'target',
                pressed: s.tool === 'pivot',
                title: 'Click on the bone to turn about that point',
              })}
            </div>`,
          )}`
      : notice(
          'info',
          'This path is not made of numbers',
          'It comes from targets, a file or days of distraction. It is shown and predicted, but not changed here.',
        )}
    ${section(
      'Path',
      segmented(
        'Between keyframes',
        [
          { value: 'straight', text: 'Straight', title: 'The pivot moves straight while the bone turns steadily' },
          { value: 'screw', text: 'Screw', title: 'The bone turns about one axis and glides along it' },
        ] as const,
        segment.path.interpolation ?? 'straight',
        (v) =>
          app.edit({
            plan: {
              ...plan,
              segments: plan.segments.map((x, n) =>
                n === s.segment ? { ...x, path: { ...x.path, interpolation: v } } : x,
              ),
            },
          }),
      ),
      numberField({
        label: 'Steps',
        hint: 'equilibria along the path',
        value: segment.path.steps ?? 12,
        unit: '',
        digits: 0,
        step: 1,
        min: 1,
        max: 200,
        id: 'path-steps',
        onInput: (v) =>
          app.edit(
            {
              plan: {
                ...plan,
                segments: plan.segments.map((x, n) =>
                  n === s.segment ? { ...x, path: { ...x.path, steps: Math.round(v) } } : x,
                ),
              },
            },
            'steps',
          ),
      }),
    )}
    ${checkPart(app, s)}
    ${section(
      'Show',
      toggle('Slices with the moved outline', s.showSlices, (on) => app.showSlices(on)),
      toggle('Overlap of bones', s.showOverlap, (on) => app.patch({ showOverlap: on })),
      toggle('Preview of the face', s.showPreview, (on) => app.patch({ showPreview: on })),
      previewState(app, s),
    )}
  `;
}

export function previewState(app: App, s: State): Html {
  if (!s.showPreview) return nothing;
  const stage = stageOf(s, 'preview');
  const busy = isBusyWith(s, 'preview-factor');
  if (busy) return hint('The preview is being prepared; this is done once.');
  if (stage.state !== 'fresh')
    return html`${hint(
      stage.state === 'stale' ? stage.why : 'The preview must be prepared once for this cut and these tissues.',
    )}
    ${button('Prepare the preview', () => void app.run({ kind: 'preview-factor' }), {
      disabled: stageOf(s, 'cut').state !== 'fresh',
      id: 'prepare-preview',
    })}`;
  if (s.preview.state === 'failed') return notice('error', 'No preview', s.preview.why);
  return hint('Preview, not a prediction: linearized about the scanned face, so it errs more the further bone moves.');
}

/** Keyframes of the segment on their path. */
export function timeline(app: App, s: State): Html {
  const segment = app.model.doc.plan.segments[s.segment];
  if (!segment) return nothing;
  const { plan } = app.model.doc;
  const keyframes = keyframesOf(segment);
  const share =
    s.scrub ?? (keyframes.length ? pathFractionOf(keyframes, Math.min(s.keyframe, keyframes.length - 1)) : 1);
  return html` <div class="dock">
    <div class="row">
      ${button(
        'Keyframe',
        () => {
          app.edit({ plan: withKeyframeAfter(plan, s.segment, s.keyframe) });
          app.patch({ keyframe: s.keyframe + 1, scrub: null });
        },
        { icon: 'plus', disabled: keyframes.length === 0, id: 'add-keyframe' },
      )}
      ${iconButton(
        'trash',
        'Remove this keyframe',
        () => app.edit({ plan: withoutKeyframe(plan, s.segment, s.keyframe) }),
        keyframes.length < 2,
      )}
    </div>
    <div class="timeline">
      <div class="rule"></div>
      <input
        type="range"
        min="0"
        max="1"
        step="0.01"
        aria-label="Along the path"
        .value=${String(share)}
        data-id="scrub"
        ?disabled=${!s.planPoses}
        @input=${(e: Event) => app.patch({ scrub: Number((e.target as HTMLInputElement).value) })}
      />
      <button type="button" class="keyframe start" .style=${'left:0'} @click=${() => app.patch({ scrub: 0 })}>
        scanned
      </button>
      ${keyframes.map(
        (_, k) =>
          html` <button
            type="button"
            class="keyframe ${k === keyframes.length - 1 ? 'last' : ''}"
            .style=${`left:${pathFractionOf(keyframes, k) * 100}%`}
            aria-pressed=${String(k === s.keyframe && s.scrub === null)}
            title="Arrow keys move it in time"
            @click=${() => app.patch({ keyframe: k, scrub: null })}
            @keydown=${(e: KeyboardEvent) => {
              const by = e.key === 'ArrowLeft' ? -0.02 : e.key === 'ArrowRight' ? 0.02 : 0;
              if (by)
                app.edit({ plan: retimeKeyframe(plan, s.segment, k, pathFractionOf(keyframes, k) + by) }, `time-${k}`);
            }}
          >
            ${keyframes.length === 1 ? 'planned' : k + 1}
          </button>`,
      )}
    </div>
    <div class="hint" .style=${'min-width:78px;text-align:right'}>${fixed(share * 100, 0)} % of path</div>
  </div>`;
}
