import {
  AppliedStrokes,
  areasByLabel,
  bytesWithin,
  joinEdits,
  labelsOfBox,
  labelVertices,
  paintedBox,
  paintTolerance_mm,
  paintSurface,
  type Hit,
  type LabelEdit,
  type Surface,
  type Vec3,
} from '../model';
import { isNotFound } from './errors';
import type { BoundaryFile } from './plan_store';
import type { Planner, SceneListeners } from './planner_context';
import { stageOf, type Doc } from './state';

/** Labels painted on the tissue boundary: voxels of the scan, in the format that the command line reads. */
export class BoundaryBrush implements BoundaryFile {
  /** One byte per voxel; null until the file of the server is read. */
  labels: Uint8Array | null = null;
  private stroke: LabelEdit | null = null;
  private readonly strokes = new AppliedStrokes();
  /** ETag of the file on the server; null if there is none. */
  private etag: string | null = null;
  /** The strokes that are saved. */
  private stored: readonly LabelEdit[] = [];
  /** `version` changes with every change of a label. */
  private readonly vertices = new Map<string, { surface: Surface; label: Uint8Array; version: number }>();
  private versions = 0;

  constructor(
    private readonly planner: Planner,
    private readonly listeners: SceneListeners,
  ) {}

  /** Discards the labels when the scan changes. */
  forget(): void {
    this.labels = null;
    this.vertices.clear();
  }

  /** Reads the boundary rules of the plan and their areas. */
  async loadRules(): Promise<void> {
    this.planner.patch({ boundary: await this.planner.client.boundary().catch(() => null) });
  }

  /** Reads the rules, and the paint unless it is up to date. */
  async load(replacesMine = false): Promise<void> {
    const { planner } = this;
    const { volume } = planner.model.s;
    if (!volume) return;
    await this.loadRules();
    const isMine = (etag: string | null): boolean =>
      this.labels !== null && (etag === this.etag || (this.isUnsaved() && !replacesMine));
    if (isMine(stageOf(planner.model.s, 'boundary').etag)) return;
    await planner.attempt(async () => {
      const found = await planner.client.boundaryData().catch((error: unknown) => {
        if (isNotFound(error)) return null;
        throw error;
      });
      if (isMine(found?.etag ?? null)) return; // The stage was older than this page's last save.
      this.labels = found ? labelsOfBox(found.value, volume.grid, found.box) : new Uint8Array(volume.data.length);
      this.etag = found?.etag ?? null;
      const none: readonly LabelEdit[] = [];
      this.strokes.setApplied(none);
      this.stored = none;
      const bare = (doc: Doc): Doc => ({ ...doc, paint: none });
      const { past, present, future } = planner.model.history.value;
      planner.model.history.set({
        past: past.map(bare),
        present: bare(present),
        future: future.map(bare),
        gesture: null,
      });
      this.changed();
    });
  }

  // Painting

  /** Applies the brush to a surface at its scanned pose. */
  stamp(hit: Hit, surface: Surface): void {
    const { planner, labels } = this;
    const { volume, boundary, paint_mm, paintLabel } = planner.model.s;
    if (!volume || !labels || !boundary) return;
    const brushStamp = {
      center_L: hit.point,
      normal: hit.normal,
      radius_mm: paint_mm,
      label: paintLabel,
      // Thick enough that every node that the plan snaps to this surface finds a painted voxel.
      thickness_mm: boundary.capture_mm + paintTolerance_mm(volume.grid),
    };
    const edit = paintSurface(labels, volume.grid, surface, brushStamp);
    this.stroke = this.stroke ? joinEdits(this.stroke, edit) : edit;
    if (edit.at.length > 0) this.show({ center: hit.point, radius_mm: paint_mm + 2 * paintTolerance_mm(volume.grid) });
  }

  endStroke(): void {
    const { stroke } = this;
    this.stroke = null;
    if (stroke && stroke.at.length > 0) this.add(stroke);
  }

  /** Erases all paint, as one stroke. */
  eraseAll(): void {
    const { labels } = this;
    if (!labels) return;
    const at: number[] = [];
    for (let n = 0; n < labels.length; n++) if (labels[n] !== 0) at.push(n);
    if (at.length === 0) return;
    const edit = { at: Uint32Array.from(at), before: Uint8Array.from(at, (n) => labels[n]), after: 0 };
    labels.fill(0);
    this.add(edit);
    this.changed();
  }

  private add(stroke: LabelEdit): void {
    const paint = [...this.planner.model.doc.paint, stroke];
    this.strokes.setApplied(paint); // The labels contain it already.
    this.planner.edit({ paint });
    this.measure();
  }

  /** Applies the strokes of the history after undo and redo. */
  apply(strokes: readonly LabelEdit[]): void {
    if (this.labels && this.strokes.apply(this.labels, strokes)) this.changed();
  }

  // Saving

  isUnsaved(): boolean {
    return this.labels !== null && this.planner.model.doc.paint !== this.stored;
  }

  get isPainted(): boolean {
    return this.labels?.some((label) => label !== 0) ?? false;
  }

  /** Sends the paint, if there is any; `overwrite`: also if another page changed it. */
  async save(overwrite = false): Promise<void> {
    const { grid } = this.planner.model.s.volume!;
    const strokes = this.planner.model.doc.paint;
    const box = paintedBox(this.labels!, grid);
    if (!box) return; // removeIfEmpty deletes the file after the plan has dropped it.
    this.etag = await this.planner.client.putBoundaryData(
      bytesWithin(this.labels!, grid, box),
      box,
      overwrite ? '*' : (this.etag ?? '*'),
    );
    this.stored = strokes;
  }

  /** Deletes the file after the plan has dropped it. */
  async removeIfEmpty(): Promise<void> {
    const strokes = this.planner.model.doc.paint;
    if (this.etag !== null) await this.planner.client.deleteBoundaryData(this.etag);
    this.etag = null;
    this.stored = strokes;
  }

  /** Replaces the paint by a file of another program. */
  async upload(file: File): Promise<void> {
    await this.planner.attempt(async () => {
      await this.planner.client.putBoundaryFile(file, this.etag ?? '*');
      this.labels = null;
      await this.planner.reload();
    });
  }

  // Display

  /** The label of each vertex of a surface at its scanned pose. */
  labelsOf(name: string, surface: Surface): { label: Uint8Array; version: number } | null {
    const { volume } = this.planner.model.s;
    if (!this.labels || !volume) return null;
    const known = this.vertices.get(name);
    if (known?.surface === surface) return known;
    const label = new Uint8Array(surface.points.length / 3);
    labelVertices(this.labels, volume.grid, surface.points, label);
    const made = { surface, label, version: ++this.versions };
    this.vertices.set(name, made);
    return made;
  }

  private show(within: { center: Vec3; radius_mm: number }): void {
    const { grid } = this.planner.model.s.volume!;
    for (const known of this.vertices.values())
      if (labelVertices(this.labels!, grid, known.surface.points, known.label, within)) known.version = ++this.versions;
    this.listeners.onPaint();
  }

  private changed(): void {
    this.vertices.clear();
    this.listeners.onPaint();
    this.measure();
  }

  /** Measures the painted area of bone and skin by label. */
  measure(): void {
    const areas: number[] = [];
    for (const [name, { surface }] of this.planner.boundarySurfaces()) {
      const found = this.labelsOf(name, surface);
      if (found) areasByLabel(surface, found.label, areas);
    }
    this.planner.patch({ paintedAreas: areas });
  }
}
