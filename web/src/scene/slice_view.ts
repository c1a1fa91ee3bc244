import {
  draggedWindow,
  grayTable,
  indexToL,
  indexToPixel,
  lToIndex,
  mapVec3,
  pixelToIndex,
  sliceFrame,
  type Grid,
  type Orientation,
  type SliceFrame,
  type Vec3,
  type Window,
} from '../model';
import { drawLabels } from './overlay';

export interface SliceMarker {
  id: string;
  position: Vec3;
  label: string;
  color: string;
  selected: boolean;
}

/** Intersection of a plane or a surface with the slice: pairs of points in L. */
export interface SliceLines {
  lines: Float32Array;
  color: string;
  dashed?: boolean;
}

export interface SliceEvents {
  onCursor(p_L: Vec3): void;
  onWindow(window: Window): void;
  onMarkerDrag(id: string, p_L: Vec3, phase: 'move' | 'end'): void;
  onMarkerSelect(id: string): void;
  /** Use of a tool that places or paints. */
  onTool(p_L: Vec3, phase: 'start' | 'move' | 'end'): void;
}

/** One orientation of the scan: grays, labels, threshold, linked cursor. */
export class SliceView {
  readonly element = document.createElement('div');
  markers: SliceMarker[] = [];
  outlines: (slice: { point: Vec3; normal: Vec3 }) => SliceLines[] = () => [];
  tool: 'none' | 'place' | 'brush' = 'none';
  brush_mm = 3;
  private readonly canvas = document.createElement('canvas');
  private readonly picture = document.createElement('canvas');
  private readonly readout = document.createElement('div');
  private grid: Grid | null = null;
  private data: Int16Array | null = null;
  private frame: SliceFrame | null = null;
  private labels: Uint8Array | null = null;
  private labelColors: (readonly [number, number, number] | null)[] = [];
  private window_: Window = { level_hu: 500, window_hu: 2000 };
  private threshold_hu: number | null = null;
  private cursor_L: Vec3 = [0, 0, 0];
  private zoom = 1;
  private pan: [number, number] = [0, 0];
  private pending = 0;
  private pictureKey = '';
  private labelsVersion = 0;
  private drag: {
    kind: 'cursor' | 'window' | 'pan' | 'marker' | 'tool';
    id: string;
    x: number;
    y: number;
    window: Window;
  } | null = null;
  private hoverAt: [number, number] | null = null;

  constructor(
    readonly orientation: Orientation,
    private readonly events: SliceEvents,
  ) {
    this.element.className = 'slice';
    this.element.dataset.orientation = orientation;
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute('role', 'img');
    this.canvas.setAttribute('aria-label', `${orientation} slice`);
    this.readout.className = 'slice-readout';
    const name = document.createElement('div');
    name.className = 'slice-name';
    name.textContent = orientation[0].toUpperCase() + orientation.slice(1);
    this.element.append(this.canvas, name, this.readout);
    this.canvas.addEventListener('pointerdown', this.onDown);
    this.canvas.addEventListener('pointermove', this.onMove);
    this.canvas.addEventListener('pointerup', this.onUp);
    this.canvas.addEventListener('pointerleave', () => {
      this.hoverAt = null;
      this.draw();
    });
    this.canvas.addEventListener('contextmenu', (event) => event.preventDefault());
    this.canvas.addEventListener('wheel', this.onWheel, { passive: false });
    this.canvas.addEventListener('keydown', this.onKey);
    new ResizeObserver(() => this.drawNow()).observe(this.element);
  }

  setVolume(grid: Grid | null, data: Int16Array | null): void {
    this.grid = grid;
    this.data = data;
    this.frame = grid ? sliceFrame(grid, this.orientation) : null;
    this.pictureKey = '';
    this.zoom = 1;
    this.pan = [0, 0];
    this.draw();
  }

  setLabels(labels: Uint8Array | null, colors: (readonly [number, number, number] | null)[]): void {
    if (labels === this.labels) return; // labelsChanged() reports paint in the same array.
    this.labels = labels;
    this.labelColors = colors;
    this.labelsChanged();
  }

  labelsChanged(): void {
    this.labelsVersion++;
    this.draw();
  }

  set(part: { window?: Window; cursor_L?: Vec3; threshold_hu?: number | null }): void {
    if (part.window) this.window_ = part.window;
    if (part.cursor_L) this.cursor_L = part.cursor_L;
    if (part.threshold_hu !== undefined) this.threshold_hu = part.threshold_hu;
    this.draw();
  }

  draw(): void {
    if (this.pending) return;
    this.pending = requestAnimationFrame(() => {
      this.pending = 0;
      this.drawNow();
    });
  }

  /** Index of the slice at the cursor, clamped to the scan. */
  private slice(): number {
    const { grid, frame } = this;
    if (!grid || !frame) return 0;
    const index = lToIndex(grid, this.cursor_L)[frame.depth];
    return Math.min(grid.size[frame.depth] - 1, Math.max(0, Math.round(index)));
  }

  private fit(): { scaleX: number; scaleY: number; x0: number; y0: number } {
    const { grid, frame } = this;
    const width = this.element.clientWidth;
    const height = this.element.clientHeight;
    const w_mm = grid!.size[frame!.right] * grid!.spacing_mm[frame!.right];
    const h_mm = grid!.size[frame!.down] * grid!.spacing_mm[frame!.down];
    const px_per_mm = Math.min(width / w_mm, height / h_mm) * 0.97 * this.zoom;
    return {
      scaleX: px_per_mm * grid!.spacing_mm[frame!.right],
      scaleY: px_per_mm * grid!.spacing_mm[frame!.down],
      x0: (width - w_mm * px_per_mm) / 2 + this.pan[0],
      y0: (height - h_mm * px_per_mm) / 2 + this.pan[1],
    };
  }

  private toScreen(p_L: Vec3): [number, number] {
    const { column, row } = indexToPixel(this.grid!, this.frame!, lToIndex(this.grid!, p_L));
    const { scaleX, scaleY, x0, y0 } = this.fit();
    return [x0 + (column + 0.5) * scaleX, y0 + (row + 0.5) * scaleY];
  }

  private toL(x: number, y: number): Vec3 {
    const { scaleX, scaleY, x0, y0 } = this.fit();
    const depth = lToIndex(this.grid!, this.cursor_L)[this.frame!.depth];
    const clamped = Math.min(this.grid!.size[this.frame!.depth] - 1, Math.max(0, depth));
    const index = pixelToIndex(this.grid!, this.frame!, (x - x0) / scaleX - 0.5, (y - y0) / scaleY - 0.5, clamped);
    return indexToL(this.grid!, index);
  }

  private huAt(p_L: Vec3): number | null {
    const index = lToIndex(this.grid!, p_L).map(Math.round);
    const [nx, ny, nz] = this.grid!.size;
    if (index.some((i, axis) => i < 0 || i >= [nx, ny, nz][axis])) return null;
    return this.data![index[0] + nx * (index[1] + ny * index[2])];
  }

  private paintPicture(): void {
    const { grid, frame, data } = this;
    const slice = this.slice();
    const key = [slice, this.window_.level_hu, this.window_.window_hu, this.threshold_hu, this.labelsVersion].join();
    if (key === this.pictureKey || !grid || !frame || !data) return;
    this.pictureKey = key;
    const width = grid.size[frame.right];
    const height = grid.size[frame.down];
    this.picture.width = width;
    this.picture.height = height;
    const context = this.picture.getContext('2d')!;
    const image = context.createImageData(width, height);
    const pixels = new Uint32Array(image.data.buffer);
    const grays = grayTable(this.window_);
    const strides = [1, grid.size[0], grid.size[0] * grid.size[1]];
    const stepX = strides[frame.right] * (frame.flipRight ? -1 : 1);
    const stepY = strides[frame.down] * (frame.flipDown ? -1 : 1);
    const start =
      slice * strides[frame.depth] +
      (frame.flipRight ? (width - 1) * strides[frame.right] : 0) +
      (frame.flipDown ? (height - 1) * strides[frame.down] : 0);
    for (let row = 0; row < height; row++) {
      let n = start + row * stepY;
      for (let column = 0; column < width; column++, n += stepX) {
        const hu = data[n];
        const gray = grays[hu + 32768];
        let r = gray;
        let g = gray;
        let b = gray;
        const tint = this.labels ? this.labelColors[this.labels[n]] : null;
        if (tint) {
          r = 0.6 * r + 0.4 * tint[0];
          g = 0.6 * g + 0.4 * tint[1];
          b = 0.6 * b + 0.4 * tint[2];
        }
        if (this.threshold_hu !== null && hu >= this.threshold_hu) {
          r = 0.45 * r + 0.55 * 242;
          g = 0.45 * g + 0.55 * 184;
          b = 0.45 * b + 0.55 * 75;
        }
        pixels[row * width + column] = (255 << 24) | (b << 16) | (g << 8) | r;
      }
    }
    context.putImageData(image, 0, 0);
  }

  private drawNow(): void {
    const width = this.element.clientWidth;
    const height = this.element.clientHeight;
    if (width === 0 || height === 0) return;
    const ratio = Math.min(2, devicePixelRatio);
    if (this.canvas.width !== Math.round(width * ratio) || this.canvas.height !== Math.round(height * ratio)) {
      this.canvas.width = Math.round(width * ratio);
      this.canvas.height = Math.round(height * ratio);
    }
    const context = this.canvas.getContext('2d')!;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.fillStyle = '#05070a';
    context.fillRect(0, 0, width, height);
    if (!this.grid || !this.frame || !this.data) {
      this.readout.textContent = '';
      return;
    }
    this.paintPicture();
    const { scaleX, scaleY, x0, y0 } = this.fit();
    context.imageSmoothingEnabled = true;
    context.imageSmoothingQuality = 'high';
    context.drawImage(this.picture, x0, y0, this.picture.width * scaleX, this.picture.height * scaleY);
    this.drawOutlines(context);
    this.drawCursor(context, width, height);
    this.drawMarkers(context);
    if (this.tool === 'brush' && this.hoverAt) {
      context.beginPath();
      context.ellipse(
        ...this.hoverAt,
        (this.brush_mm * scaleX) / this.grid.spacing_mm[this.frame.right],
        (this.brush_mm * scaleY) / this.grid.spacing_mm[this.frame.down],
        0,
        0,
        2 * Math.PI,
      );
      context.strokeStyle = '#ffffff';
      context.lineWidth = 1.5;
      context.stroke();
    }
    this.drawSides(context, width, height);
    const hu = this.huAt(this.cursor_L);
    const position = `${this.slice() + 1} / ${this.grid.size[this.frame.depth]}`;
    this.readout.textContent = hu === null ? position : `${position}  ·  ${hu} HU`;
    this.canvas.setAttribute(
      'aria-label',
      `${this.orientation} slice ${this.slice() + 1} of ${this.grid.size[this.frame.depth]}. Arrow ` +
        'keys change the slice.',
    );
  }

  private drawOutlines(context: CanvasRenderingContext2D): void {
    const { grid, frame } = this;
    const axis = mapVec3([0, 3, 6], (row) => grid!.direction[row + frame!.depth]);
    const index: [number, number, number] = [0, 0, 0];
    index[frame!.depth] = this.slice();
    for (const { lines, color, dashed } of this.outlines({ point: indexToL(grid!, index), normal: axis })) {
      context.beginPath();
      for (let n = 0; n < lines.length; n += 6) {
        context.moveTo(...this.toScreen([lines[n], lines[n + 1], lines[n + 2]]));
        context.lineTo(...this.toScreen([lines[n + 3], lines[n + 4], lines[n + 5]]));
      }
      context.setLineDash(dashed ? [5, 4] : []);
      context.strokeStyle = color;
      context.lineWidth = 1.5;
      context.stroke();
      context.setLineDash([]);
    }
  }

  private drawCursor(context: CanvasRenderingContext2D, width: number, height: number): void {
    const [x, y] = this.toScreen(this.cursor_L);
    const gap = 9;
    context.strokeStyle = 'rgb(120 200 215 / 0.75)';
    context.lineWidth = 1;
    context.beginPath();
    for (const [a, b, c, d] of [
      [0, y, x - gap, y],
      [x + gap, y, width, y],
      [x, 0, x, y - gap],
      [x, y + gap, x, height],
    ]) {
      context.moveTo(a, b);
      context.lineTo(c, d);
    }
    context.stroke();
  }

  /** Markers within 3 mm of the slice. */
  private nearMarkers(): SliceMarker[] {
    const { grid, frame } = this;
    if (!grid || !frame) return [];
    const depth_mm = grid.spacing_mm[frame.depth];
    return this.markers.filter(
      (marker) => Math.abs(lToIndex(grid, marker.position)[frame.depth] - this.slice()) * depth_mm <= 3,
    );
  }

  private drawMarkers(context: CanvasRenderingContext2D): void {
    const markers = this.nearMarkers().sort((a, b) => Number(b.selected) - Number(a.selected));
    for (const marker of markers) {
      const [x, y] = this.toScreen(marker.position);
      context.beginPath();
      context.arc(x, y, marker.selected ? 5.5 : 4, 0, 2 * Math.PI);
      context.fillStyle = marker.color;
      context.fill();
      context.strokeStyle = '#ffffff';
      context.lineWidth = marker.selected ? 2 : 1.25;
      context.stroke();
    }
    const tags = markers.map((marker) => {
      const [x, y] = this.toScreen(marker.position);
      return { x, y, text: marker.label, strong: marker.selected };
    });
    drawLabels(
      context,
      tags.filter(({ text }) => text !== ''),
      tags.map(({ x, y }) => [x, y] as const),
      6.5,
    );
  }

  private drawSides(context: CanvasRenderingContext2D, width: number, height: number): void {
    const { labels } = this.frame!;
    context.font = '600 13px "Inter Variable", sans-serif';
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    context.lineWidth = 3;
    context.strokeStyle = 'rgb(0 0 0 / 0.8)';
    context.fillStyle = '#dfe6ea';
    for (const [text, x, y] of [
      [labels.left, 13, height / 2],
      [labels.right, width - 13, height / 2],
      [labels.top, width / 2, 15],
      [labels.bottom, width / 2, height - 14],
    ] as const) {
      context.strokeText(text, x, y);
      context.fillText(text, x, y);
    }
  }

  private at(event: { clientX: number; clientY: number }): [number, number] {
    const box = this.canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  private onDown = (event: PointerEvent): void => {
    if (!this.grid) return;
    const [x, y] = this.at(event);
    this.canvas.setPointerCapture(event.pointerId);
    const base = { id: '', x, y, window: this.window_ };
    if (event.button === 1 || (event.button === 0 && event.altKey)) this.drag = { ...base, kind: 'pan' };
    else if (event.button === 2 || event.shiftKey) this.drag = { ...base, kind: 'window' };
    else {
      const marker = this.nearMarkers().find((m) => Math.hypot(...sub2(this.toScreen(m.position), [x, y])) < 9);
      if (marker && this.tool !== 'brush') {
        this.events.onMarkerSelect(marker.id);
        this.drag = { ...base, kind: 'marker', id: marker.id };
      } else if (this.tool !== 'none') {
        this.drag = { ...base, kind: 'tool' };
        this.events.onTool(this.toL(x, y), 'start');
      } else {
        this.drag = { ...base, kind: 'cursor' };
        this.events.onCursor(this.toL(x, y));
      }
    }
    event.preventDefault();
    this.canvas.focus();
  };

  private onMove = (event: PointerEvent): void => {
    if (!this.grid) return;
    const [x, y] = this.at(event);
    this.hoverAt = [x, y];
    const drag = this.drag;
    if (!drag) {
      this.canvas.style.cursor = this.tool === 'none' ? '' : 'crosshair';
      if (this.tool === 'brush') this.draw();
      return;
    }
    if (drag.kind === 'cursor') this.events.onCursor(this.toL(x, y));
    else if (drag.kind === 'window') this.events.onWindow(draggedWindow(drag.window, x - drag.x, y - drag.y));
    else if (drag.kind === 'marker') this.events.onMarkerDrag(drag.id, this.toL(x, y), 'move');
    else if (drag.kind === 'tool') this.events.onTool(this.toL(x, y), 'move');
    else {
      this.pan = [this.pan[0] + x - drag.x, this.pan[1] + y - drag.y];
      drag.x = x;
      drag.y = y;
      this.draw();
    }
  };

  private onUp = (event: PointerEvent): void => {
    const drag = this.drag;
    this.drag = null;
    if (!drag || !this.grid) return;
    const p_L = this.toL(...this.at(event));
    if (drag.kind === 'marker') this.events.onMarkerDrag(drag.id, p_L, 'end');
    else if (drag.kind === 'tool') this.events.onTool(p_L, 'end');
  };

  private onWheel = (event: WheelEvent): void => {
    if (!this.grid) return;
    event.preventDefault();
    if (event.ctrlKey) {
      const factor = Math.exp(-event.deltaY / 300);
      const [x, y] = this.at(event);
      const [cx, cy] = [this.element.clientWidth / 2, this.element.clientHeight / 2];
      const zoom = Math.min(12, Math.max(1, this.zoom * factor));
      const applied = zoom / this.zoom;
      this.pan =
        zoom === 1 ? [0, 0] : [x - cx - (x - cx - this.pan[0]) * applied, y - cy - (y - cy - this.pan[1]) * applied];
      this.zoom = zoom;
      this.draw();
    } else this.step(event.deltaY > 0 ? 1 : -1);
  };

  /** Moves the cursor along the voxel axis of depth. */
  private step(by: number): void {
    const { grid, frame } = this;
    const index = [...lToIndex(grid!, this.cursor_L)] as [number, number, number];
    index[frame!.depth] = Math.min(grid!.size[frame!.depth] - 1, Math.max(0, this.slice() + by));
    this.events.onCursor(indexToL(grid!, index));
  }

  private onKey = (event: KeyboardEvent): void => {
    if (!this.grid) return;
    const by = { ArrowUp: 1, ArrowRight: 1, PageUp: 10, ArrowDown: -1, ArrowLeft: -1, PageDown: -10 }[event.key];
    if (by === undefined) return;
    event.preventDefault();
    this.step(by);
  };
}

const sub2 = (a: [number, number], b: [number, number]): [number, number] => [a[0] - b[0], a[1] - b[1]];
