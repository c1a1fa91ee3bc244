import { html, nothing, svg } from 'lit-html';
import { fixed, fromDrawing, profileFrame, profilePath, toDrawing, viewBoxOf, type ProfileFrame } from '../../model';
import type { ProfileDrag } from '../profile_drag';
import type { State } from '../state';
import { hint, notice, section, type Html } from '../widgets';

/** y and z under a pointer. */
function positionOf(event: PointerEvent, frame: ProfileFrame): [number, number] | null {
  const drawing = (event.currentTarget as Element).closest('svg');
  const toScreen = drawing?.getScreenCTM();
  if (!toScreen) return null;
  const { x, y } = new DOMPoint(event.clientX, event.clientY).matrixTransform(toScreen.inverse());
  return fromDrawing(frame, x, y);
}

/** The profile with a point that can be dragged; the segment follows. */
export function profileTargetSection(s: State, drag: ProfileDrag): Html {
  const outlines = drag.isReady ? drag.outlines() : null;
  const frame = outlines && profileFrame([outlines.before, outlines.after]);
  if (!outlines || !frame) return nothing;
  const follow = (event: PointerEvent, act: (y: number, z: number) => void): void => {
    const at = positionOf(event, frame);
    if (at) act(...at);
  };
  const press = (event: PointerEvent): void => {
    event.preventDefault();
    (event.currentTarget as Element).setPointerCapture(event.pointerId);
    follow(event, (y, z) => drag.start(y, z));
  };
  return section(
    'Target on the profile',
    html`<svg
      class="plot profile-target"
      viewBox=${viewBoxOf(frame)}
      role="img"
      aria-label="Profile from the right; drag a point, and the segment follows"
      data-id="profile-target"
      data-state=${s.profilePoint?.state ?? 'none'}
      @pointerdown=${press}
      @pointermove=${(event: PointerEvent) => follow(event, (y, z) => drag.move(y, z))}
      @pointerup=${() => drag.end()}
      @pointercancel=${() => drag.end()}
    >
      ${svg`<path d=${profilePath(outlines.before, frame)} fill="none" stroke="var(--ink-3)" stroke-width="1.4"
          vector-effect="non-scaling-stroke" stroke-dasharray="4 3"></path>
        <path d=${profilePath(outlines.after, frame)} fill="none" stroke="var(--accent)" stroke-width="2"
          vector-effect="non-scaling-stroke"></path>`} ${point(s, frame)}
    </svg>`,
    message(s),
  );
}

function point(s: State, frame: ProfileFrame): Html {
  if (!s.profilePoint) return nothing;
  const [x, y] = toDrawing(frame, ...s.profilePoint.wanted);
  const [rx, ry] = toDrawing(frame, ...s.profilePoint.reached);
  return svg`<line x1=${rx} y1=${ry} x2=${x} y2=${y} stroke="var(--bad)" stroke-width="1.4"
      vector-effect="non-scaling-stroke"></line>
    <circle cx=${rx} cy=${ry} r="1.6" fill="var(--accent)"></circle>
    <circle cx=${x} cy=${y} r="2.2" fill="none" stroke="var(--bad)" stroke-width="2"
      vector-effect="non-scaling-stroke"></circle>`;
}

function message({ profilePoint }: State): Html {
  const rest = hint(
    'Dashed: before. Drag a point of the profile: the selected segment moves forward, back, up or down.',
  );
  if (!profilePoint) return rest;
  if (profilePoint.state === 'failed') return notice('error', 'The segment does not follow', profilePoint.why);
  const distance = Math.hypot(
    profilePoint.wanted[0] - profilePoint.reached[0],
    profilePoint.wanted[1] - profilePoint.reached[1],
  );
  if (profilePoint.state === 'waiting') return hint('The segment follows …');
  if (profilePoint.state === 'limit')
    return notice('warning', 'The limit of 20 mm is reached', `The point is ${fixed(distance, 1)} mm from the target.`);
  return hint(
    distance < 0.1
      ? 'Target reached in the preview. Predict the face to confirm it.'
      : `${fixed(distance, 1)} mm from the target in the preview.`,
  );
}
