import { html, nothing } from 'lit-html';
import { fixed, mm } from '../../model';
import type { App } from '../app';
import { isBusyWith, stageOf, type State } from '../state';
import { button, hint, notice, type Html } from '../widgets';

/** Overlap of bones above which a plan is marked: the limit of `lefort plan check` [mm]. */
const OVERLAP_LIMIT_MM = 0.5;

/** Overlap of the bones at the shown pose. */
export function overlapNotice(s: State): Html {
  if (!s.depth) return nothing;
  const { deepest_mm, depthIsLowerBound, perSecond } = s.depth;
  const rate =
    perSecond > 0
      ? html`<small data-id="update-rate" data-rate=${perSecond.toFixed(1)}> ${fixed(perSecond, 0)} updates/s</small>`
      : nothing;
  if (depthIsLowerBound)
    return notice(
      'error',
      'Bones overlap deeply',
      html`The overlap is deeper than what is measured. Change the movement, or remove this bone.${rate}`,
    );
  if (deepest_mm > OVERLAP_LIMIT_MM)
    return notice(
      'error',
      `Bones overlap by ${mm(deepest_mm)}`,
      html`More than ${OVERLAP_LIMIT_MM} mm of bone must be removed for this movement.${rate}`,
    );
  const title = deepest_mm > 0.05 ? `Bones touch, overlap ${mm(deepest_mm)}` : 'No bones overlap';
  return notice('good', title, html`At the pose shown.${rate}`);
}

/** State of the preview, and how to prepare it. */
export function previewState(app: App, s: State): Html {
  if (!s.showPreview) return nothing;
  const stage = stageOf(s, 'preview');
  if (isBusyWith(s, 'preview-factor')) return hint('Preparing the preview. This is done once.');
  if (stage.state !== 'fresh')
    return html`${hint(
      stage.state === 'stale' ? stage.why : 'The preview must be prepared once for this cut and these tissues.',
    )}
    ${button('Prepare the preview', () => void app.run({ kind: 'preview-factor' }), {
      disabled: stageOf(s, 'cut').state !== 'fresh',
      id: 'prepare-preview',
    })}`;
  if (s.preview.state === 'failed') return notice('error', 'No preview', s.preview.why);
  return hint('Preview, not a prediction: its mesh is coarse.');
}
