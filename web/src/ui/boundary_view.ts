import { BONE, linearOf, segmentColor, SKIN, toVec3, type Rgb } from '../model';
import type { Body, View3d } from '../scene';
import type { App } from './app';
import type { State } from './state';

/** Colors bone and skin, at their scanned pose, by the paint on the tissue boundary. */
export class BoundaryView {
  /** The bodies that are colored, and the version of their paint. */
  private readonly colored = new Map<string, { body: Body; version: number }>();

  constructor(
    private readonly view: View3d,
    private readonly app: App,
  ) {}

  /** The brush applies to what is drawn opaque. */
  isPaintable(s: State, name: string): boolean {
    return (s.paintOn === 'skin') === (name === 'skin');
  }

  present(s: State): void {
    const { view, app } = this;
    const isOn = s.step === 'tissue' && s.boundary !== null && app.boundaryBrush.labels !== null;
    const palette = [BONE, ...(s.boundary?.names.map((x) => toVec3(x.colour)) ?? [])];
    let hasChanged = false;
    for (const [name, { surface }] of isOn ? app.boundarySurfaces() : []) {
      const body = view.body(name);
      const before = this.colored.get(name);
      const labels = body ? app.boundaryBrush.labelsOf(name, surface) : null;
      if (!body || !labels || labels.label.length !== body.surface.points.length / 3) continue;
      if (before?.body === body && before.version === labels.version) continue;
      palette[0] = this.plain(name);
      body.setLabels(labels.label, palette.map(linearOf));
      this.colored.set(name, { body, version: labels.version });
      hasChanged = true;
    }
    if (!isOn)
      for (const [name, { body }] of this.colored) {
        if (view.body(name) === body) body.setColor(this.plain(name));
        this.colored.delete(name);
        hasChanged = true;
      }
    if (hasChanged) view.render();
  }

  private plain(name: string): Rgb {
    const index = this.app.model.doc.plan.segments.findIndex((x) => `segments/${x.name}` === name);
    return index >= 0 ? segmentColor(index) : name === 'skin' ? SKIN : BONE;
  }
}
