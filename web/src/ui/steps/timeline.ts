import { html, nothing } from 'lit-html';
import { fixed, keyframesOf, pathFractionOf, retimeKeyframe, withKeyframeAfter, withoutKeyframe } from '../../model';
import type { App } from '../app';
import type { State } from '../state';
import { button, iconButton, type Html } from '../widgets';

/** Keyframes of the segment on their path. */
export function timeline(app: App, s: State): Html {
  const segment = app.model.doc.plan.segments[s.segment];
  if (!segment) return nothing;
  const keyframes = keyframesOf(segment);
  const last = keyframes.length - 1;
  const fraction = s.scrub ?? (last >= 0 ? pathFractionOf(keyframes, Math.min(s.keyframe, last)) : 1);
  return html` <div class="dock">
    ${keyframeButtons(app, s, keyframes.length)}
    <div class="timeline">
      <div class="rule"></div>
      <input
        type="range"
        min="0"
        max="1"
        step="0.01"
        aria-label="Position on the path"
        .value=${String(fraction)}
        data-id="scrub"
        ?disabled=${!s.planPoses}
        @input=${(e: Event) => app.patch({ scrub: Number((e.target as HTMLInputElement).value) })}
      />
      <button type="button" class="keyframe start" .style=${'left:0'} @click=${() => app.patch({ scrub: 0 })}>
        scanned
      </button>
      ${keyframes.map((_, k) => keyframeMark(app, s, k))}
    </div>
    <div class="hint" .style=${'min-width:78px;text-align:right'}>${fixed(fraction * 100, 0)} % of path</div>
  </div>`;
}

function keyframeButtons(app: App, s: State, count: number): Html {
  const { plan } = app.model.doc;
  const add = (): void => {
    app.edit({ plan: withKeyframeAfter(plan, s.segment, s.keyframe) });
    app.patch({ keyframe: s.keyframe + 1, scrub: null });
  };
  const remove = (): void => app.edit({ plan: withoutKeyframe(plan, s.segment, s.keyframe) });
  return html`<div class="row">
    ${button('Keyframe', add, { icon: 'plus', disabled: count === 0, id: 'add-keyframe' })}
    ${iconButton('trash', 'Remove this keyframe', remove, count < 2)}
  </div>`;
}

function keyframeMark(app: App, s: State, k: number): Html {
  const { plan } = app.model.doc;
  const keyframes = keyframesOf(plan.segments[s.segment]);
  const at = pathFractionOf(keyframes, k);
  const onKey = (e: KeyboardEvent): void => {
    const by = e.key === 'ArrowLeft' ? -0.02 : e.key === 'ArrowRight' ? 0.02 : 0;
    if (by) app.edit({ plan: retimeKeyframe(plan, s.segment, k, at + by) }, `time-${k}`);
  };
  return html` <button
    type="button"
    class="keyframe ${k === keyframes.length - 1 ? 'last' : ''}"
    .style=${`left:${at * 100}%`}
    aria-pressed=${String(k === s.keyframe && s.scrub === null)}
    title="Arrow keys move it along the path"
    @click=${() => app.patch({ keyframe: k, scrub: null })}
    @keydown=${onKey}
  >
    ${keyframes.length === 1 ? 'planned' : k + 1}
  </button>`;
}
