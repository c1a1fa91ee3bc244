import { html, nothing } from 'lit-html';
import { CATALOGUE, fixed, kindOf, placed, withoutLandmark, type LandmarkKind } from '../../model';
import type { App } from '../app';
import { button, empty, hint, iconButton, notice, section, type Html } from '../widgets';
import { stageOf, type State } from '../state';

export function landmarkPanel(app: App, s: State): Html {
  const { landmarks } = app.model.doc;
  const stage = stageOf(s, 'landmarks');
  if (!s.volume)
    return html`<h2>Landmarks</h2>
      ${empty(
        'No scan yet',
        'Open one in step 1, Case.',
        button('To the case', () => app.setStep('case')),
      )}`;
  const known = s.measurements?.filter((m) => m.before !== null) ?? [];
  const row = (kind: LandmarkKind) => {
    const there = placed(landmarks, kind.name);
    const armed = s.landmark === kind.name;
    return html` <div class="list-row ${armed ? 'selected' : ''} ${there ? '' : 'unplaced'}">
      <span></span>
      <button
        type="button"
        class="list-main"
        aria-pressed=${String(armed)}
        data-id=${`landmark-${kind.name}`}
        @click=${() =>
          app.patch({
            landmark: armed && s.tool === 'landmark' ? null : kind.name,
            tool: armed && s.tool === 'landmark' ? 'none' : there ? 'none' : 'landmark',
            ...(there ? { cursor_L: there.position_mm } : {}),
          })}
      >
        <b>${kind.name}</b><span>${kind.full}</span>
      </button>
      ${there
        ? iconButton('trash', `Remove ${kind.full}`, () =>
            app.edit({ landmarks: withoutLandmark(landmarks, kind.name) }),
          )
        : nothing}
    </div>`;
  };
  const others = landmarks.filter((l) => !kindOf(l.name));
  const armed = s.tool === 'landmark' && s.landmark ? kindOf(s.landmark) : undefined;
  return html`
    <h2>Landmarks <span class="chip">${landmarks.length} placed</span></h2>
    ${armed
      ? notice(
          'info',
          `Click where ${armed.full} is`,
          `On the ${armed.on === 'bone' ? 'bone' : 'skin'} in 3D, or on any slice. Escape stops.`,
        )
      : hint(
          'Pick a name, then click on the bone, the skin or a slice. Drag a point to move it. Sides are the patient’s.',
        )}
    ${stage.state === 'stale' ? notice('warning', 'Landmarks may be out of date', stage.why) : nothing}
    ${s.measurementError ? notice('error', 'These landmarks contradict each other', s.measurementError) : nothing}
    ${section('On bone and teeth', html`<div class="list">${CATALOGUE.filter((k) => k.on === 'bone').map(row)}</div>`)}
    ${section('On the skin', html`<div class="list">${CATALOGUE.filter((k) => k.on === 'skin').map(row)}</div>`)}
    ${others.length
      ? section(
          'Others',
          html`<div class="list">${others.map((l) => row({ name: l.name, full: '', on: 'bone' }))}</div>`,
        )
      : nothing}
    ${section(
      'Cephalometry',
      known.length === 0
        ? hint('Angles and distances appear when their landmarks are placed.')
        : html`<table data-id="cephalometry">
            <thead>
              <tr>
                <th>Measure</th>
                <th>Before</th>
              </tr>
            </thead>
            <tbody>
              ${known.map(
                (m) =>
                  html`<tr title=${m.meaning}>
                    <td>${m.measurement}</td>
                    <td>${fixed(m.before, 1)} ${m.unit === 'deg' ? '°' : m.unit}</td>
                  </tr>`,
              )}
            </tbody>
          </table>`,
      hint('Seen from the side, as on a lateral cephalogram without its magnification.'),
    )}
  `;
}
