import { withoutKeyframe, withoutLandmark, withoutPlane } from '../model';
import type { App } from './app';
import type { Viewer } from './viewer';
import { STEPS } from './state';
import { setPaintRadius } from './steps/boundary_section';
import { closeCurve } from './steps/osteotomy_panel';

/** Keyboard shortcuts; they do not apply while the user types in a field. */
export function listenToKeys(app: App, view: Viewer): void {
  addEventListener('keydown', (event) => {
    const { s, doc } = app.model;
    const typing =
      event.target instanceof HTMLInputElement && event.target.type !== 'range' && event.target.type !== 'checkbox';
    const field = typing || event.target instanceof HTMLSelectElement;
    const command = event.ctrlKey || event.metaKey;
    const done = (): void => event.preventDefault();
    if (command && event.key.toLowerCase() === 'z' && !typing) {
      done();
      if (event.shiftKey) app.redo();
      else app.undo();
    } else if (command && event.key.toLowerCase() === 'y' && !typing) {
      done();
      app.redo();
    } else if (command || event.altKey || field) {
      return;
    } else if (/^[1-9]$/.test(event.key)) {
      app.setStep(STEPS[Number(event.key) - 1].name);
    } else if (event.key === '?') {
      app.patch({ help: !s.help });
    } else if (event.key === 'Escape') {
      app.patch({ help: false, confirm: null, tool: 'none', curveDraft: null, plane: null, scrub: null });
    } else if (event.key === 'Enter' && s.tool === 'curve') {
      closeCurve(app);
    } else if (event.key === 'Delete' || event.key === 'Backspace') {
      if (s.step === 'landmarks' && s.landmark) app.edit({ landmarks: withoutLandmark(doc.landmarks, s.landmark) });
      else if (s.step === 'osteotomy' && s.plane !== null)
        app.edit({ plan: withoutPlane(doc.plan, s.segment, s.plane) });
      else if (s.step === 'measures' && s.nervePoint && s.nervePoint in s.nervePoints)
        void app.measures.removePoint(s.nervePoint);
      else if (s.step === 'movement' && doc.plan.segments[s.segment])
        app.edit({ plan: withoutKeyframe(doc.plan, s.segment, s.keyframe) });
    } else if ((event.key === '[' || event.key === ']') && s.step === 'compare') {
      app.patch({ wipe: Math.min(1, Math.max(0, s.wipe + (event.key === '[' ? -0.05 : 0.05))) });
    } else if ((event.key === '[' || event.key === ']') && s.step === 'tissue') {
      setPaintRadius(app, s.paint_mm + (event.key === '[' ? -0.5 : 0.5));
    } else if (event.key.toLowerCase() === 'e' && s.step === 'tissue' && s.tool === 'paint') {
      app.patch({ paintLabel: s.paintLabel === 0 ? 1 : 0 });
    } else {
      const look = ({ f: 'front', r: 'right', l: 'left', b: 'below' } as const)[event.key.toLowerCase()];
      if (look) view.view.look(look);
    }
  });
}
