import { BONE, linearOf, segmentColor, SKIN, toVec3, type Rgb } from '../model';
import type { Body, View3d } from '../scene';
import type { App } from './app';
import type { State } from './state';

/** Name of the surface of the interface map. */
const INTERFACE = 'interface';

/** Colors bone and skin, at their scanned pose, by the paint on the tissue boundary, and the interface map. */
export class BoundaryView {
  private coloredMap: Body | null = null;
  /** The bodies that are colored, and the version of their paint. */
  private readonly colored = new Map<string, { body: Body; version: number }>();

  constructor(
    private readonly view: View3d,
    private readonly app: App,
  ) {}

  /** The brush applies to what is drawn opaque. */
  isPaintable(s: State, name: string): boolean {
    return name !== INTERFACE && (s.paintOn === 'skin') === (name === 'skin');
  }

  /** The interface map hides what is painted, so that it is not shown with the brush. */
  isMapShown(s: State): boolean {
    return s.step === 'tissue' && s.showInterface && s.tool !== 'paint' && this.view.body(INTERFACE) !== undefined;
  }

  present(s: State): void {
    this.colorMap(s);
    this.colorPaint(s);
  }

  /** Colors the interface map by condition. */
  private colorMap(s: State): void {
    const body = this.view.body(INTERFACE);
    const condition = this.app.model.surfaces.get(INTERFACE)?.condition;
    if (!body || !condition || !s.boundary || this.coloredMap === body) return;
    const palette: Rgb[] = [];
    for (const { value, color } of s.boundary.conditions) palette[value] = linearOf(toVec3(color));
    body.setLabels(condition, palette);
    this.coloredMap = body;
    this.view.render();
  }

  private colorPaint(s: State): void {
    const { view, app } = this;
    const isOn = s.step === 'tissue' && s.boundary !== null && app.boundaryBrush.labels !== null;
    const palette = [BONE, ...(s.boundary?.names.map((x) => toVec3(x.color)) ?? [])];
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
