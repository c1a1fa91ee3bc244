import {
  AmbientLight,
  Box3,
  DirectionalLight,
  DoubleSide,
  HemisphereLight,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  OrthographicCamera,
  PlaneGeometry,
  Quaternion,
  Scene,
  Vector3,
  WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import {
  add,
  COARSE_CELL_MM,
  rayHit,
  transformPoint,
  unit,
  VIEWS,
  type DrawnSurface,
  type Hit,
  type Mat4,
  type Rgb,
  type Vec3,
  type ViewName,
} from '../model';
import { Body } from './body';
import { Gizmo, type GizmoDrag } from './gizmo';
import {
  drawBrush,
  drawStroke,
  drawLabels,
  drawLine,
  drawPlaneOutline,
  drawScale,
  drawSides,
  drawTag,
  drawWipe,
  type PlaneMark,
  type Polyline,
  type Tag,
} from './overlay';
import { projectionOf, type Projection } from './projection';
import { drawsInSoftware } from './software';

/** A point drawn over the picture: a landmark, a corner of a curve. */
export interface Marker {
  id: string;
  position: Vec3;
  label?: string;
  color: string;
  selected?: boolean;
  /** Dim those that lie behind something. */
  hides?: boolean;
  draggable?: boolean;
}

export type Layout =
  | { mode: 'single' }
  | { mode: 'wipe'; share: number; left: string[]; right: string[]; names: [string, string] }
  | { mode: 'beside'; left: string[]; right: string[]; names: [string, string] };

export type Phase = 'start' | 'move' | 'end';

export interface View3dEvents {
  /** A press comes: what is shown must be of the state as it is, also if the last change of it waits to be drawn. */
  onPress(): void;
  onGizmo(drag: GizmoDrag, phase: Phase): void;
  /** True if a click places something now; the cursor says so. */
  isPlacing(): boolean;
  /** A click on a body, with a tool that places. */
  onPick(hit: Hit, body: string): void;
  /** True if a drag over a body paints it now. */
  isPainting(): boolean;
  /** The brush is put on a body, once a picture or more often; it ends off any. */
  onPaint(at: { hit: Hit; body: string } | null, phase: Phase): void;
  onMarkerDrag(id: string, hit: Hit, phase: Phase): void;
  onMarkerSelect(id: string): void;
  onWipe(share: number): void;
}

const IDLE_MS = 180;

/** A dab looks at every triangle: more of them would make a picture late. */
const STAMPS_PER_FRAME = 4;

/**
 * Pixels drawn per pixel shown, by the processor: multisampling would have it pay for four samples of every pixel, so
 * edges are smoothed by drawing larger once all stands still.
 */
const SOFTWARE_RATIO = { moving: 0.5, still: 2 };

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
  /** The bodies a tool works on; others are looked through. */
  pickable: (name: string) => boolean = () => true;

  private readonly canvas = document.createElement('canvas');
  private readonly overlay = document.createElement('canvas');
  private readonly renderer: WebGLRenderer;
  private readonly gl: WebGL2RenderingContext;
  private fence: WebGLSync | null = null;
  private readonly scene = new Scene();
  private readonly camera = new OrthographicCamera(-1, 1, 1, -1, 1, 4000);
  private readonly controls: OrbitControls;
  private readonly headlight = new DirectionalLight(0xffffff, 2.1);
  private readonly bodies = new Map<string, Body>();
  private readonly planes: { mark: PlaneMark; mesh: Mesh }[] = [];
  private layout_: Layout = { mode: 'single' };
  private hidden = new Set<string>();
  private behind = new Set<string>();
  private frame = 0;
  private idle = 0;
  private hiddenTimer = 0;
  private lastBusy = 0;
  private coarse = false;
  private dragged: { kind: 'gizmo' | 'marker' | 'wipe' | 'paint'; id: string } | null = null;
  /** Where the brush is to go: the pointer's way since the last picture. */
  private brushWay: [number, number][] = [];
  private brushAt: [number, number] | null = null;
  /** Where it was put since the bodies were drawn last. */
  private brushTrace: [number, number][] = [];
  private markerAtPointer: [number, number] | null = null;
  private pressed: { x: number; y: number; at: number } | null = null;
  private center = new Vector3(0, 0, 0);
  private radius_mm = 130;
  /** Frames drawn since the page began, for measuring. */
  framesDrawn = 0;

  constructor(private readonly events: View3dEvents) {
    this.element.className = 'view3d';
    this.overlay.className = 'overlay';
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute('role', 'img');
    this.canvas.setAttribute(
      'aria-label',
      '3D view of bone and skin. Drag to turn, wheel to zoom, right button to shift.',
    );
    this.element.append(this.canvas, this.overlay);
    this.renderer = new WebGLRenderer({
      canvas: this.canvas,
      antialias: !drawsInSoftware(),
      alpha: true,
      powerPreference: 'high-performance',
    });
    this.renderer.autoClear = false;
    this.renderer.debug.checkShaderErrors = false; // Waiting for the compiler's word stops the page for a second in software.
    this.gl = this.renderer.getContext() as WebGL2RenderingContext;
    this.camera.up.set(0, 0, 1);
    this.scene.add(new AmbientLight(0xffffff, 0.55), new HemisphereLight(0xffffff, 0x9aa4ae, 0.5), this.camera);
    this.scene.children[1].position.set(0, 0, 1); // Light from above is light from superior.
    this.camera.add(this.headlight);
    this.headlight.position.set(-0.35, 0.45, 1);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.enableDamping = false;
    this.controls.zoomToCursor = true;
    this.controls.addEventListener('start', () => this.markBusy());
    this.controls.addEventListener('change', () => {
      this.markBusy();
      this.render();
    });
    this.controls.addEventListener('end', () => this.markBusy());
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

  bodyNames(): string[] {
    return [...this.bodies.keys()];
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

  setPlanes(marks: PlaneMark[]): void {
    for (const { mesh } of this.planes) {
      mesh.geometry.dispose();
      (mesh.material as MeshBasicMaterial).dispose();
      mesh.removeFromParent();
    }
    this.planes.length = 0;
    for (const mark of marks) {
      const material = new MeshBasicMaterial({
        color: mark.color,
        transparent: true,
        opacity: mark.selected ? 0.34 : 0.16,
        side: DoubleSide,
        depthWrite: false,
      });
      const mesh = new Mesh(new PlaneGeometry(mark.size_mm, mark.size_mm), material);
      mesh.quaternion.copy(
        new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), new Vector3(...unit(mark.normal))),
      );
      mesh.position.set(...mark.point);
      mesh.renderOrder = 3;
      this.planes.push({ mark, mesh });
      this.scene.add(mesh);
    }
    this.render();
  }

  setLayout(layout: Layout): void {
    this.layout_ = layout;
    this.render();
  }

  get layout(): Layout {
    return this.layout_;
  }

  // Looking

  look(name: ViewName): void {
    const towards = unit(VIEWS[name]);
    this.controls.target.copy(this.center);
    this.camera.position.copy(this.center).addScaledVector(new Vector3(...towards), 1000);
    this.camera.lookAt(this.center);
    this.controls.update();
    this.render();
  }

  /** Brings all bodies into view. */
  frameAll(): void {
    const box = new Box3();
    for (const body of this.bodies.values()) box.expandByObject(body.group);
    if (box.isEmpty()) return;
    const offset = this.camera.position.clone().sub(this.controls.target);
    box.getCenter(this.center);
    this.radius_mm = box.getSize(new Vector3()).length() / 2;
    this.controls.target.copy(this.center);
    this.camera.position.copy(this.center).add(offset);
    this.camera.zoom = 1;
    this.resize();
    this.controls.update();
  }

  /** The projection of the half that a point of the view lies in. */
  projection(x = 0): Projection {
    const { width, height } = this.size();
    const beside = this.layout_.mode === 'beside';
    const center: [number, number] = beside
      ? [x < width / 2 ? width / 4 : (3 * width) / 4, height / 2]
      : [width / 2, height / 2];
    const forward = new Vector3();
    this.camera.getWorldDirection(forward);
    const up = new Vector3(0, 1, 0).applyQuaternion(this.camera.quaternion);
    const px_per_mm = (this.camera.zoom * height) / (this.camera.top - this.camera.bottom);
    return projectionOf(
      this.controls.target.toArray() as Vec3,
      forward.toArray() as Vec3,
      up.toArray() as Vec3,
      px_per_mm,
      center,
    );
  }

  private size(): { width: number; height: number } {
    return { width: this.element.clientWidth || 1, height: this.element.clientHeight || 1 };
  }

  private resize(): void {
    const { width, height } = this.size();
    this.renderer.setSize(width, height, false);
    const ratio = Math.min(2, devicePixelRatio);
    this.overlay.width = width * ratio;
    this.overlay.height = height * ratio;
    this.setFrustum(width / height);
    this.drawNow();
  }

  private setFrustum(aspect: number): void {
    // Room for the head in both directions; a face seen from the side is about as wide as high.
    const half = this.radius_mm * 0.82 * Math.max(1, 1 / aspect);
    this.camera.top = half;
    this.camera.bottom = -half;
    this.camera.left = -half * aspect;
    this.camera.right = half * aspect;
    this.camera.updateProjectionMatrix();
  }

  // Drawing

  /** While something moves, the processor draws coarse surfaces; they become fine again when it has stopped. */
  markBusy(): void {
    this.lastBusy = performance.now();
    if (drawsInSoftware() && !this.coarse && this.dragged?.kind !== 'paint') this.setCoarse(true);
    if (this.idle) return;
    const check = () => {
      const left = IDLE_MS - (performance.now() - this.lastBusy);
      if (left > 0 || (this.dragged && this.dragged.kind !== 'wipe')) {
        this.idle = window.setTimeout(check, Math.max(20, left));
        return;
      }
      this.idle = 0;
      this.setCoarse(false);
      this.updateHiddenMarkers();
      this.render();
    };
    this.idle = window.setTimeout(check, IDLE_MS);
  }

  private setCoarse(coarse: boolean): void {
    this.coarse = coarse;
    for (const body of this.bodies.values()) body.setCoarse(coarse);
  }

  render(): void {
    this.canvas.dataset.idle = 'false';
    if (this.frame) return;
    if (drawsInSoftware() && this.dragged?.kind === 'paint') {
      // The bodies in full would take the processor too long: the stroke is drawn over them until it has ended.
      this.frame = requestAnimationFrame(() => {
        this.frame = 0;
        this.dragBrush(STAMPS_PER_FRAME);
        this.drawOverlay();
      });
      return;
    }
    const whenReady = (): void => {
      // One picture at a time: on slow graphics pictures would pile up, and the page would lag behind the hand.
      if (this.fence && this.gl.getSyncParameter(this.fence, this.gl.SYNC_STATUS) !== this.gl.SIGNALED) {
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

  /** Once a picture, however many events came: a pick looks at every triangle. */
  private dragMarker(): void {
    if (!this.markerAtPointer || this.dragged?.kind !== 'marker') return;
    const found = this.pick(...this.markerAtPointer);
    this.markerAtPointer = null;
    if (found) this.events.onMarkerDrag(this.dragged.id, found.hit, 'move');
  }

  /** Puts the brush along the pointer's way, so closely that dabs join; what is not reached waits for the next picture. */
  private dragBrush(most: number): void {
    if (this.dragged?.kind !== 'paint') return;
    const step = Math.max(2, 0.5 * this.brush_mm * this.projection().px_per_mm);
    const isLast = most === Infinity;
    let n = 0;
    while (n < most && this.brushWay.length > 1) {
      const [from, to] = this.brushWay;
      const far = Math.hypot(to[0] - from[0], to[1] - from[1]);
      // A hand that is slower than the brush is wide leaves one dab, not one for each of its moves.
      if (far < step && (this.brushWay.length > 2 || !isLast)) {
        if (this.brushWay.length === 2) break;
        this.brushWay.splice(1, 1);
        continue;
      }
      const share = Math.min(1, step / (far || 1));
      const at: [number, number] = [from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])];
      if (share < 1) this.brushWay[0] = at;
      else this.brushWay.shift();
      const found = this.pick(...at);
      if (found) {
        this.brushTrace.push(at);
        this.events.onPaint(found, 'move');
      }
      n++;
    }
    if (n === most) this.render(); // There may be more.
  }

  drawNow(): void {
    const { width, height } = this.size();
    const renderer = this.renderer;
    const ratio = drawsInSoftware() ? SOFTWARE_RATIO[this.coarse ? 'moving' : 'still'] : Math.min(2, devicePixelRatio);
    if (renderer.getPixelRatio() !== ratio) renderer.setPixelRatio(ratio); // Empties the picture, so not before.
    renderer.setScissorTest(false);
    renderer.setViewport(0, 0, width, height);
    renderer.clear();
    const layout = this.layout_;
    if (layout.mode === 'single') {
      renderer.render(this.scene, this.camera);
    } else if (layout.mode === 'wipe') {
      const at = Math.round(width * layout.share);
      renderer.setScissorTest(true);
      renderer.setScissor(0, 0, at, height);
      this.renderOnly(layout.left);
      renderer.setScissor(at, 0, width - at, height);
      this.renderOnly(layout.right);
    } else {
      const half = Math.floor(width / 2);
      this.setFrustum(half / height);
      renderer.setScissorTest(true);
      for (const [x, names] of [
        [0, layout.left],
        [half, layout.right],
      ] as const) {
        renderer.setViewport(x, 0, half, height);
        renderer.setScissor(x, 0, half, height);
        this.renderOnly(names);
      }
    }
    if (layout.mode !== 'beside' && Math.abs(this.camera.right / this.camera.top - width / height) > 1e-6) {
      this.setFrustum(width / height);
      this.render();
    }
    if (this.fence) this.gl.deleteSync(this.fence);
    this.fence = this.gl.fenceSync(this.gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    this.gl.flush();
    this.framesDrawn++;
    this.brushTrace = [];
    this.drawOverlay();
    // For tests: nothing is still to be drawn.
    this.canvas.dataset.idle = String(!this.coarse && this.frame === 0);
  }

  private renderOnly(names: readonly string[]): void {
    for (const [name, body] of this.bodies) body.group.visible = names.includes(name);
    this.renderer.render(this.scene, this.camera);
    for (const body of this.bodies.values()) body.group.visible = true;
  }

  /** Which markers lie behind a body that is shown and not clear. */
  private updateHiddenMarkers(): void {
    this.behind.clear();
    const projection = this.projection();
    for (const marker of this.markers) {
      if (!marker.hides) continue;
      const [x, y] = projection.toScreen(marker.position);
      const { origin, direction } = projection.rayAt(x, y);
      const hit = this.pickAlong(origin, direction, () => true, true);
      const depth = (p: Vec3) =>
        (p[0] - origin[0]) * direction[0] + (p[1] - origin[1]) * direction[1] + (p[2] - origin[2]) * direction[2];
      if (hit && hit.hit.distance < depth(marker.position) - COARSE_CELL_MM) this.behind.add(marker.id);
    }
  }

  /** Markers, gizmo, sides and scale: crisp, and the same on any graphics. */
  private drawOverlay(): void {
    const context = this.overlay.getContext('2d', { willReadFrequently: drawsInSoftware() })!;
    const ratio = this.overlay.width / this.size().width;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    const { width, height } = this.size();
    context.clearRect(0, 0, width, height);
    const halves = this.layout_.mode === 'beside' ? [0, width / 2] : [0];
    for (const x of halves) {
      const projection = this.projection(x + 1);
      context.save();
      context.beginPath();
      context.rect(x, 0, width / halves.length, height);
      context.clip();
      for (const { mark } of this.planes) drawPlaneOutline(context, projection, mark);
      for (const line of this.lines) drawLine(context, projection, line);
      this.drawMarkers(context, projection);
      drawSides(context, projection, x, 0, width / halves.length, height, this.ink());
      context.restore();
      if (x === 0) drawScale(context, projection, width / halves.length, height, this.ink());
    }
    const layout = this.layout_;
    if (layout.mode === 'wipe') drawWipe(context, width * layout.share, height);
    if (layout.mode !== 'single') {
      const middle = layout.mode === 'wipe' ? width * layout.share : width / 2;
      drawTag(context, layout.names[0], middle - 12, 'right');
      drawTag(context, layout.names[1], middle + 12, 'left');
    }
    if (halves.length === 2) {
      context.fillStyle = this.ink();
      context.globalAlpha = 0.25;
      context.fillRect(width / 2 - 0.5, 0, 1, height);
      context.globalAlpha = 1;
    }
    this.gizmo.draw(context, this.projection());
    const radius_px = this.brush_mm * this.projection().px_per_mm;
    drawStroke(context, this.brushTrace, radius_px, this.brushColor);
    if (this.brushAt && this.events.isPainting()) drawBrush(context, this.brushAt, radius_px);
    this.publishHandles();
  }

  private ink(): string {
    return getComputedStyle(this.element).getPropertyValue('--view-ink').trim() || '#333';
  }

  /** Where handles and markers are on the screen, for tests and assistive scripts. */
  private publishHandles(): void {
    const projection = this.projection();
    const handles: Record<string, [number, number]> = {};
    for (const handle of this.gizmo.handles(projection)) {
      const [x, y] = handle.kind === 'translate' ? handle.line[1] : handle.line[8];
      const along = projection.directionOnScreen(handle.axis.direction);
      const towards = handle.line[1][0] - handle.line[0][0];
      const down = handle.line[1][1] - handle.line[0][1];
      const positive = along[0] * towards + along[1] * down > 0;
      handles[`${handle.kind} ${handle.axis.name}${handle.kind === 'translate' ? (positive ? ' +' : ' -') : ''}`] = [
        Math.round(x),
        Math.round(y),
      ];
    }
    for (const marker of this.markers) {
      const [x, y] = projection.toScreen(marker.position);
      handles[`marker ${marker.id}`] = [Math.round(x), Math.round(y)];
    }
    this.canvas.dataset.handles = JSON.stringify(handles);
    this.canvas.dataset.pxPerMm = projection.px_per_mm.toFixed(4);
  }

  private drawMarkers(context: CanvasRenderingContext2D, projection: Projection): void {
    const inOrder = [...this.markers].sort((a, b) => Number(b.selected ?? false) - Number(a.selected ?? false));
    for (const marker of inOrder) this.drawMarker(context, projection, marker);
    // A point behind the bone has no label, and its dim dot is in nobody's way.
    const shown = inOrder.filter((marker) => !this.behind.has(marker.id));
    const tags = shown
      .filter((marker) => marker.label)
      .map((marker): Tag => {
        const [x, y] = projection.toScreen(marker.position);
        return { x, y, text: marker.label!, strong: marker.selected ?? false };
      });
    drawLabels(
      context,
      tags,
      shown.map((marker) => projection.toScreen(marker.position)),
      7.5,
    );
  }

  private drawMarker(context: CanvasRenderingContext2D, projection: Projection, marker: Marker): void {
    const [x, y] = projection.toScreen(marker.position);
    const behind = this.behind.has(marker.id);
    context.globalAlpha = behind ? 0.3 : 1;
    context.beginPath();
    context.arc(x, y, marker.selected ? 6 : 4.5, 0, 2 * Math.PI);
    context.fillStyle = marker.color;
    context.fill();
    context.lineWidth = marker.selected ? 2.5 : 1.5;
    context.strokeStyle = marker.selected ? '#ffffff' : 'rgb(255 255 255 / 0.9)';
    context.stroke();
    context.beginPath();
    context.arc(x, y, marker.selected ? 7.5 : 5.5, 0, 2 * Math.PI);
    context.lineWidth = 1;
    context.strokeStyle = 'rgb(0 0 0 / 0.55)';
    context.stroke();
    context.globalAlpha = 1;
  }

  // Pointer

  private at(event: PointerEvent): [number, number] {
    const box = this.canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  /** The marker at the pointer. While a click places something, only those that can be dragged meanwhile: placing wins. */
  private markerAt(x: number, y: number): Marker | null {
    const projection = this.projection(x);
    const placing = this.events.isPlacing();
    let best: Marker | null = null;
    let nearest = 10;
    for (const marker of this.markers) {
      const [mx, my] = projection.toScreen(marker.position);
      const d = Math.hypot(mx - x, my - y);
      if (d < nearest && !this.behind.has(marker.id) && (marker.draggable || !placing)) {
        nearest = d;
        best = marker;
      }
    }
    return best;
  }

  /** First shown body along the ray of a point of the view. */
  pick(x: number, y: number): { hit: Hit; body: string } | null {
    const { origin, direction } = this.projection(x).rayAt(x, y);
    return this.pickAlong(origin, direction, this.pickable, false);
  }

  private pickAlong(
    origin: Vec3,
    direction: Vec3,
    wanted: (name: string) => boolean,
    coarse: boolean,
  ): { hit: Hit; body: string } | null {
    let best: { hit: Hit; body: string } | null = null;
    for (const [name, body] of this.bodies) {
      if (!body.shown || body.opacity < 0.3 || !wanted(name)) continue;
      const X = body.group.matrix;
      const inverse = rows(new Matrix4().copy(X).invert());
      const from = transformPoint(inverse, origin);
      const to = transformPoint(inverse, add(origin, direction));
      const along: Vec3 = [to[0] - from[0], to[1] - from[1], to[2] - from[2]];
      const surface = coarse ? body.coarseSurface : { points: body.points, triangles: body.surface.triangles };
      const hit = rayHit(surface, from, along);
      if (!hit || (best && hit.distance >= best.hit.distance)) continue;
      const pose = rows(X);
      const tip = transformPoint(pose, add(hit.point, hit.normal));
      const point = transformPoint(pose, hit.point);
      best = { body: name, hit: { ...hit, point, normal: [tip[0] - point[0], tip[1] - point[1], tip[2] - point[2]] } };
    }
    return best;
  }

  private onDown = (event: PointerEvent): void => {
    this.events.onPress();
    const [x, y] = this.at(event);
    this.controls.enabled = true;
    this.pressed = { x, y, at: performance.now() };
    if (event.button !== 0) return;
    const layout = this.layout_;
    if (layout.mode === 'wipe' && Math.abs(x - layout.share * this.size().width) < 14) {
      this.dragged = { kind: 'wipe', id: '' };
    } else if (this.gizmo.begin(this.projection(x), x, y)) {
      this.dragged = { kind: 'gizmo', id: '' };
      this.markBusy();
      this.events.onGizmo(this.gizmo.drag(this.projection(x), x, y)!, 'start');
    } else {
      const found = this.events.isPainting() ? this.pick(x, y) : null;
      const marker = found ? null : this.markerAt(x, y);
      if (found) {
        this.dragged = { kind: 'paint', id: found.body };
        this.brushWay = [[x, y]];
        this.brushTrace = [[x, y]];
        this.brushAt = [x, y];
        this.markBusy();
        this.events.onPaint(found, 'start');
      }
      if (marker) {
        this.events.onMarkerSelect(marker.id);
        if (marker.draggable) this.dragged = { kind: 'marker', id: marker.id };
      }
    }
    if (this.dragged) {
      this.controls.enabled = false;
      this.canvas.setPointerCapture(event.pointerId);
    }
  };

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
      this.brushWay.push([x, y]);
      this.brushAt = [x, y];
    } else if (this.dragged.kind === 'wipe') {
      this.events.onWipe(Math.min(0.98, Math.max(0.02, x / this.size().width)));
    } else {
      this.markBusy();
      this.markerAtPointer = [x, y];
    }
    this.render();
  };

  private onUp = (event: PointerEvent): void => {
    const [x, y] = this.at(event);
    if (this.dragged?.kind === 'paint') {
      this.dragBrush(Infinity);
      this.events.onPaint(null, 'end');
    }
    const dragged = this.dragged;
    this.dragged = null;
    this.controls.enabled = true;
    if (dragged?.kind === 'gizmo') {
      const drag = this.gizmo.drag(this.projection(x), x, y);
      this.gizmo.end();
      if (drag) this.events.onGizmo(drag, 'end');
    } else if (dragged?.kind === 'marker') {
      const found = this.pick(x, y);
      if (found) this.events.onMarkerDrag(dragged.id, found.hit, 'end');
    } else if (!dragged && event.button === 0 && this.pressed && this.events.isPlacing()) {
      // A click, not the end of turning the head.
      if (Math.hypot(x - this.pressed.x, y - this.pressed.y) < 4 && !this.markerAt(x, y)) {
        const found = this.pick(x, y);
        if (found) this.events.onPick(found.hit, found.body);
      }
    }
    this.pressed = null;
    if (dragged?.kind !== 'paint') this.markBusy();
    this.render();
  };

  private hover(at: [number, number] | null): void {
    const before = this.gizmo.hovered;
    this.gizmo.hovered = at ? this.gizmo.find(this.projection(at[0]), ...at) : null;
    const layout = this.layout_;
    const onWipe = at !== null && layout.mode === 'wipe' && Math.abs(at[0] - layout.share * this.size().width) < 14;
    const overMarker = at !== null && this.markerAt(...at) !== null;
    this.canvas.style.cursor = onWipe
      ? 'ew-resize'
      : this.gizmo.hovered || overMarker
        ? 'grab'
        : this.events.isPlacing() || this.events.isPainting()
          ? 'crosshair'
          : '';
    const brushed = this.brushAt;
    this.brushAt = this.events.isPainting() ? at : null;
    if ((brushed || this.brushAt) && this.frame === 0) this.drawOverlay(); // The ring alone: the picture stays.
    if (before?.axis !== this.gizmo.hovered?.axis || before?.kind !== this.gizmo.hovered?.kind) this.render();
  }

  /** Finds anew which markers are hidden, after they or the bodies have changed. */
  refreshMarkers(): void {
    clearTimeout(this.hiddenTimer);
    this.hiddenTimer = window.setTimeout(() => {
      this.updateHiddenMarkers();
      this.render();
    }, IDLE_MS);
    this.render();
  }

  /** The picture as it is, with a line of text below it. */
  snapshot(caption: string, background: string): HTMLCanvasElement {
    this.setCoarse(false);
    this.drawNow();
    const { width, height } = this.size();
    const picture = document.createElement('canvas');
    const foot = 28;
    picture.width = width;
    picture.height = height + foot;
    const context = picture.getContext('2d')!;
    context.fillStyle = background;
    context.fillRect(0, 0, width, height + foot);
    context.drawImage(this.canvas, 0, 0, width, height);
    context.drawImage(this.overlay, 0, 0, width, height);
    context.fillStyle = this.ink();
    context.font = '12px "Inter Variable", sans-serif';
    context.textBaseline = 'middle';
    context.fillText(caption, 12, height + foot / 2);
    return picture;
  }
}

const rows = (m: Matrix4): Mat4 => m.clone().transpose().toArray();
