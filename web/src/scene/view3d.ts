import { Scene } from 'three';
import { COARSE_CELL_MM, dot, sub, type DrawnSurface, type Mat4, type Rgb, type ViewName } from '../model';
import { Body } from './body';
import { BrushPath } from './brush_path';
import { CameraRig } from './camera_rig';
import { Gizmo } from './gizmo';
import { LayoutRenderer, type Size } from './layout_renderer';
import { drawDivider, withCaption } from './layout_overlay';
import { drawMarkers, handlePositions, markerAt } from './markers';
import {
  drawBrush,
  drawLine,
  drawPlaneOutline,
  drawScale,
  drawSides,
  drawStroke,
  type PlaneMark,
  type Polyline,
} from './overlay';
import { pickAlong } from './pick';
import { PlaneMeshes } from './plane_meshes';
import type { Projection } from './projection';
import { drawsInSoftware } from './software';
import { middleOfPane, paneCount, type BodyHit, type Layout, type Marker, type View3dEvents } from './view_events';

type Point = [number, number];

/** Time without input after which the picture is drawn in full. */
const IDLE_MS = 180;

/** Each stamp of the brush tests every triangle; more of them would delay the frame. */
const STAMPS_PER_FRAME = 4;

/** Distance from the divider of two pictures at which the pointer drags it. */
const WIPE_GRAB_PX = 14;

/** A longer way of the pointer is a drag, not a click. */
const CLICK_PX = 4;

/** The 3D view: bodies, marks drawn over them, and the pointer. */
export class View3d {
  readonly element = document.createElement('div');
  readonly gizmo = new Gizmo();
  markers: Marker[] = [];
  lines: Polyline[] = [];
  /** Called once, before the next picture. */
  beforePicture: (() => void) | null = null;
  /** Radius of the brush. */
  brush_mm = 4;
  brushColor = '#ffffff';
  /** The bodies that a tool works on; picking ignores others. */
  pickable: (name: string) => boolean = () => true;

  private readonly canvas = document.createElement('canvas');
  private readonly overlay = document.createElement('canvas');
  private readonly scene = new Scene();
  private readonly bodies = new Map<string, Body>();
  private readonly rig: CameraRig;
  private readonly renderer: LayoutRenderer;
  private readonly planes = new PlaneMeshes(this.scene);
  private readonly brush = new BrushPath();
  private layout_: Layout = { mode: 'single' };
  private hidden = new Set<string>();
  private hiddenMarkers = new Set<string>();
  private frame = 0;
  private idleTimer = 0;
  private markerTimer = 0;
  private lastBusy = 0;
  private coarse = false;
  private dragged: { kind: 'gizmo' | 'marker' | 'wipe' | 'paint'; id: string } | null = null;
  private markerAtPointer: Point | null = null;
  private pressed: Point | null = null;

  constructor(private readonly events: View3dEvents) {
    this.element.className = 'view3d';
    this.overlay.className = 'overlay';
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute('role', 'img');
    this.canvas.setAttribute(
      'aria-label',
      '3D view of bone and skin. Drag to rotate, wheel to zoom, right button to pan.',
    );
    this.element.append(this.canvas, this.overlay);
    this.rig = new CameraRig(this.scene, this.canvas);
    this.renderer = new LayoutRenderer(this.canvas, this.scene, this.rig, this.bodies);
    this.rig.controls.addEventListener('start', () => this.markBusy());
    this.rig.controls.addEventListener('change', () => {
      this.markBusy();
      this.render();
    });
    this.rig.controls.addEventListener('end', () => this.markBusy());
    this.canvas.addEventListener('pointerdown', this.onDown, { capture: true });
    this.canvas.addEventListener('pointermove', this.onMove);
    this.canvas.addEventListener('pointerup', this.onUp);
    this.canvas.addEventListener('pointercancel', this.onUp);
    this.canvas.addEventListener('pointerleave', () => this.hover(null));
    this.canvas.addEventListener('contextmenu', (event) => event.preventDefault());
    new ResizeObserver(() => this.resize()).observe(this.element);
    this.look('right three-quarter');
  }

  // Bodies

  setBody(name: string, surface: DrawnSurface, color: Rgb): Body {
    const old = this.bodies.get(name);
    const body = new Body(surface, color);
    if (old) {
      body.setOpacity(old.opacity);
      old.dispose();
    }
    body.setCoarse(this.coarse);
    body.shown = !this.hidden.has(name);
    body.update();
    this.bodies.set(name, body);
    this.scene.add(body.group);
    if (this.bodies.size === 1) this.frameAll();
    this.render();
    return body;
  }

  removeBody(name: string): void {
    this.bodies.get(name)?.dispose();
    this.bodies.delete(name);
    this.render();
  }

  body(name: string): Body | undefined {
    return this.bodies.get(name);
  }

  /** Shows these bodies and no others. */
  show(names: readonly string[]): void {
    this.hidden = new Set(this.bodies.keys());
    for (const name of names) this.hidden.delete(name);
    for (const [name, body] of this.bodies) {
      body.shown = !this.hidden.has(name);
      body.update();
    }
    this.render();
  }

  setOpacity(name: string, opacity: number): void {
    this.bodies.get(name)?.setOpacity(opacity);
    this.render();
  }

  setPose(name: string, X_LB: Mat4): void {
    this.bodies.get(name)?.setPose(X_LB);
    this.render();
  }

  setPlanes(marks: readonly PlaneMark[]): void {
    this.planes.set(marks);
    this.render();
  }

  setLayout(layout: Layout): void {
    this.layout_ = layout;
    this.render();
  }

  // Camera

  look(name: ViewName): void {
    this.rig.look(name);
    this.render();
  }

  /** Brings all bodies into view. */
  private frameAll(): void {
    this.bringIntoView([...this.bodies.keys()]);
  }

  /** Brings the bodies of these names into view. */
  bringIntoView(names: readonly string[]): void {
    if (!this.rig.frame(names.flatMap((name) => this.bodies.get(name)?.group ?? []))) return;
    this.resize();
    this.rig.controls.update();
  }

  /** The projection of the picture that a point of the view lies in. */
  private projection(x = 0): Projection {
    const { width, height } = this.size();
    return this.rig.projection(height, [middleOfPane(this.layout_, x, width), height / 2]);
  }

  private size(): Size {
    return { width: this.element.clientWidth || 1, height: this.element.clientHeight || 1 };
  }

  private resize(): void {
    const { width, height } = this.size();
    this.renderer.setSize({ width, height });
    const ratio = Math.min(2, devicePixelRatio);
    this.overlay.width = width * ratio;
    this.overlay.height = height * ratio;
    this.rig.aspect = width / height;
    this.drawNow();
  }

  // Drawing

  /** Software rendering draws coarse surfaces while something moves, and fine ones when it has stopped. */
  private markBusy(): void {
    this.lastBusy = performance.now();
    if (drawsInSoftware() && !this.coarse && this.dragged?.kind !== 'paint') this.setCoarse(true);
    if (this.idleTimer) return;
    const check = () => {
      const left = IDLE_MS - (performance.now() - this.lastBusy);
      if (left > 0 || (this.dragged && this.dragged.kind !== 'wipe')) {
        this.idleTimer = window.setTimeout(check, Math.max(20, left));
        return;
      }
      this.idleTimer = 0;
      this.setCoarse(false);
      this.updateHiddenMarkers();
      this.render();
    };
    this.idleTimer = window.setTimeout(check, IDLE_MS);
  }

  private setCoarse(coarse: boolean): void {
    this.coarse = coarse;
    for (const body of this.bodies.values()) body.setCoarse(coarse);
  }

  render(): void {
    this.canvas.dataset.idle = 'false';
    if (this.frame) return;
    if (drawsInSoftware() && this.dragged?.kind === 'paint') {
      // Software cannot render the bodies in time: until the stroke ends, it is drawn over them.
      this.frame = requestAnimationFrame(() => {
        this.frame = 0;
        this.dragBrush(STAMPS_PER_FRAME);
        this.drawOverlay();
      });
      return;
    }
    const whenReady = (): void => {
      if (!this.renderer.isReady) {
        this.frame = requestAnimationFrame(whenReady);
        return;
      }
      this.frame = 0;
      this.dragMarker();
      this.dragBrush(STAMPS_PER_FRAME);
      const prepare = this.beforePicture;
      this.beforePicture = null;
      prepare?.();
      this.drawNow();
    };
    this.frame = requestAnimationFrame(whenReady);
  }

  /** Once per frame, not per event: picking tests every triangle. */
  private dragMarker(): void {
    if (!this.markerAtPointer || this.dragged?.kind !== 'marker') return;
    const found = this.pick(...this.markerAtPointer);
    this.markerAtPointer = null;
    if (found) this.events.onMarkerDrag(this.dragged.id, found.hit, 'move');
  }

  /** Puts the brush along the pointer's path, at most `maxStamps` times; the rest waits for the next frame. */
  private dragBrush(maxStamps: number): void {
    if (this.dragged?.kind !== 'paint') return;
    const step = Math.max(2, 0.5 * this.brush_mm * this.projection().px_per_mm);
    let n = 0;
    while (n < maxStamps) {
      const at = this.brush.next(step, maxStamps === Infinity);
      if (!at) break;
      const found = this.pick(...at);
      if (found) {
        this.brush.trace.push(at);
        this.events.onPaint(found, 'move');
      }
      n++;
    }
    if (n === maxStamps) this.render();
  }

  private drawNow(): void {
    const { width, height } = this.size();
    this.renderer.render(this.layout_, { width, height }, this.coarse);
    if (this.layout_.mode !== 'beside' && Math.abs(this.rig.aspect - width / height) > 1e-6) {
      this.rig.aspect = width / height;
      this.render();
    }
    this.renderer.flush();
    this.brush.trace = [];
    this.drawOverlay();
    // For tests: the picture is complete.
    this.canvas.dataset.idle = String(!this.coarse && this.frame === 0);
  }

  /** Finds the markers that are behind a visible body. */
  private updateHiddenMarkers(): void {
    this.hiddenMarkers.clear();
    const projection = this.projection();
    for (const { id, position, hides } of this.markers) {
      if (!hides) continue;
      const { origin, direction } = projection.rayAt(...projection.toScreen(position));
      const found = pickAlong(this.bodies, origin, direction, () => true, true);
      const depth = dot(sub(position, origin), direction);
      if (found && found.hit.distance < depth - COARSE_CELL_MM) this.hiddenMarkers.add(id);
    }
  }

  /** Draws markers, gizmo, sides and scale. */
  private drawOverlay(): void {
    const context = this.overlay.getContext('2d', { willReadFrequently: drawsInSoftware() })!;
    const { width, height } = this.size();
    const ratio = this.overlay.width / width;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    const count = paneCount(this.layout_);
    for (let n = 0; n < count; n++) this.drawPictureOverlay(context, (n * width) / count, width / count, height);
    drawDivider(context, this.layout_, { width, height }, this.ink());
    const projection = this.projection();
    this.gizmo.draw(context, projection);
    const radius_px = this.brush_mm * projection.px_per_mm;
    drawStroke(context, this.brush.trace, radius_px, this.brushColor);
    if (this.brush.pointer && this.events.isPainting()) drawBrush(context, this.brush.pointer, radius_px);
    this.canvas.dataset.handles = JSON.stringify(handlePositions(this.gizmo, this.markers, projection));
    this.canvas.dataset.pxPerMm = projection.px_per_mm.toFixed(4);
  }

  /** Draws over one picture of the layout, which begins at x. */
  private drawPictureOverlay(context: CanvasRenderingContext2D, x: number, width: number, height: number): void {
    const projection = this.projection(x + 1);
    const ink = this.ink();
    context.save();
    context.beginPath();
    context.rect(x, 0, width, height);
    context.clip();
    for (const mark of this.planes.marks) drawPlaneOutline(context, projection, mark);
    for (const line of this.lines) drawLine(context, projection, line);
    drawMarkers(context, projection, this.markers, this.hiddenMarkers);
    drawSides(context, projection, x, 0, width, height, ink);
    context.restore();
    if (x === 0) drawScale(context, projection, width, height, ink);
  }

  private ink(): string {
    return getComputedStyle(this.element).getPropertyValue('--view-ink').trim() || '#333';
  }

  // Pointer

  private at(event: PointerEvent): Point {
    const box = this.canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  /** The marker at the pointer. While a click places something, only markers that can be dragged. */
  private markerAt(x: number, y: number): Marker | null {
    const isPlacing = this.events.isPlacing();
    const isWanted = (marker: Marker): boolean =>
      !this.hiddenMarkers.has(marker.id) && ((marker.draggable ?? false) || !isPlacing);
    return markerAt(this.markers, this.projection(x), [x, y], isWanted);
  }

  private isOnDivider(x: number): boolean {
    const layout = this.layout_;
    return layout.mode === 'wipe' && Math.abs(x - layout.fraction * this.size().width) < WIPE_GRAB_PX;
  }

  /** First visible body along the ray of a point of the view. */
  private pick(x: number, y: number): BodyHit | null {
    const { origin, direction } = this.projection(x).rayAt(x, y);
    return pickAlong(this.bodies, origin, direction, this.pickable, false);
  }

  private onDown = (event: PointerEvent): void => {
    this.events.onPress();
    const at = this.at(event);
    this.rig.controls.enabled = true;
    this.pressed = at;
    if (event.button !== 0) return;
    this.beginDrag(at);
    if (this.dragged) {
      this.rig.controls.enabled = false;
      this.canvas.setPointerCapture(event.pointerId);
    }
  };

  private beginDrag([x, y]: Point): void {
    if (this.isOnDivider(x)) {
      this.dragged = { kind: 'wipe', id: '' };
      return;
    }
    if (this.gizmo.begin(this.projection(x), x, y)) {
      this.dragged = { kind: 'gizmo', id: '' };
      this.markBusy();
      this.events.onGizmo(this.gizmo.drag(this.projection(x), x, y)!, 'start');
      return;
    }
    const found = this.events.isPainting() ? this.pick(x, y) : null;
    const marker = found ? null : this.markerAt(x, y);
    if (found) {
      this.dragged = { kind: 'paint', id: found.body };
      this.brush.begin([x, y]);
      this.markBusy();
      this.events.onPaint(found, 'start');
    }
    if (marker) {
      this.events.onMarkerSelect(marker.id);
      if (marker.draggable) this.dragged = { kind: 'marker', id: marker.id };
    }
  }

  private onMove = (event: PointerEvent): void => {
    const [x, y] = this.at(event);
    if (!this.dragged) {
      if (event.buttons === 0) this.hover([x, y]);
      return;
    }
    if (this.dragged.kind === 'gizmo') {
      this.markBusy();
      const drag = this.gizmo.drag(this.projection(x), x, y);
      if (drag) this.events.onGizmo(drag, 'move');
    } else if (this.dragged.kind === 'paint') {
      this.markBusy();
      this.brush.extend([x, y]);
    } else if (this.dragged.kind === 'wipe') {
      this.events.onWipe(Math.min(0.98, Math.max(0.02, x / this.size().width)));
    } else {
      this.markBusy();
      this.markerAtPointer = [x, y];
    }
    this.render();
  };

  private onUp = (event: PointerEvent): void => {
    const at = this.at(event);
    if (this.dragged?.kind === 'paint') {
      this.dragBrush(Infinity);
      this.events.onPaint(null, 'end');
    }
    const dragged = this.dragged;
    this.dragged = null;
    this.rig.controls.enabled = true;
    if (dragged?.kind === 'gizmo') {
      const drag = this.gizmo.drag(this.projection(at[0]), ...at);
      this.gizmo.end();
      if (drag) this.events.onGizmo(drag, 'end');
    } else if (dragged?.kind === 'marker') {
      const found = this.pick(...at);
      if (found) this.events.onMarkerDrag(dragged.id, found.hit, 'end');
    } else if (!dragged && event.button === 0) this.onClick(at);
    this.pressed = null;
    if (dragged?.kind !== 'paint') this.markBusy();
    this.render();
  };

  /** A press and release of the button, unless the pointer has turned the head in between. */
  private onClick(at: Point): void {
    if (!this.pressed || !this.events.isPlacing()) return;
    const way = Math.hypot(at[0] - this.pressed[0], at[1] - this.pressed[1]);
    if (way >= CLICK_PX || this.markerAt(...at)) return;
    const found = this.pick(...at);
    if (found) this.events.onPick(found.hit, found.body);
  }

  private hover(at: Point | null): void {
    const before = this.gizmo.hovered;
    this.gizmo.hovered = at ? this.gizmo.find(this.projection(at[0]), ...at) : null;
    this.canvas.style.cursor = this.cursorAt(at);
    const hadBrush = this.brush.pointer !== null;
    this.brush.pointer = this.events.isPainting() ? at : null;
    // The bodies are unchanged, so that the overlay suffices.
    if ((hadBrush || this.brush.pointer) && this.frame === 0) this.drawOverlay();
    if (before?.axis !== this.gizmo.hovered?.axis || before?.kind !== this.gizmo.hovered?.kind) this.render();
  }

  private cursorAt(at: Point | null): string {
    if (at && this.isOnDivider(at[0])) return 'ew-resize';
    if (this.gizmo.hovered || (at && this.markerAt(...at))) return 'grab';
    return this.events.isPlacing() || this.events.isPainting() ? 'crosshair' : '';
  }

  /** Finds the hidden markers after the markers or the bodies have changed. */
  refreshMarkers(): void {
    clearTimeout(this.markerTimer);
    this.markerTimer = window.setTimeout(() => {
      this.updateHiddenMarkers();
      this.render();
    }, IDLE_MS);
    this.render();
  }

  /** The picture with a line of text below it. */
  snapshot(caption: string, background: string): HTMLCanvasElement {
    this.setCoarse(false);
    this.drawNow();
    return withCaption([this.canvas, this.overlay], this.size(), caption, background, this.ink());
  }
}
