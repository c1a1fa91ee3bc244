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

/** What is painted on the tissue's boundary: voxels of the scan, which go to the server as the command line reads them. */
export class BoundaryBrush implements BoundaryFile {
  /** One byte per voxel; null until it is known what the server has. */
  labels: Uint8Array | null = null;
  private stroke: LabelEdit | null = null;
  private readonly strokes = new AppliedStrokes();
  /** Of what the server has; null where it has nothing. */
  private etag: string | null = null;
  /** The strokes that the server has. */
  private stored: readonly LabelEdit[] = [];
  /** `version`: another one whenever a label has changed. */
  private readonly vertices = new Map<string, { surface: Surface; label: Uint8Array; version: number }>();
  private versions = 0;

  constructor(
    private readonly planner: Planner,
    private readonly listeners: SceneListeners,
  ) {}

  /** Another scan, or none. */
  forget(): void {
    this.labels = null;
    this.vertices.clear();
  }

  /** What the plan's rules are, and hold. */
  async loadRules(): Promise<void> {
    this.planner.patch({ boundary: await this.planner.client.boundary().catch(() => null) });
  }

  /** The rules, and what is painted, unless it is known. */
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
      if (isMine(found?.etag ?? null)) return; // What this page knew of the server was older than what it had sent.
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

  // The hand

  /** Puts the brush on a surface that stands as scanned. */
  stamp(hit: Hit, surface: Surface): void {
    const { planner, labels } = this;
    const { volume, boundary, paint_mm, paintLabel } = planner.model.s;
    if (!volume || !labels || !boundary) return;
    const brushStamp = {
      center_L: hit.point,
      normal: hit.normal,
      radius_mm: paint_mm,
      label: paintLabel,
      // So that each node that the plan takes to lie on this surface has a painted voxel within reach.
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

  /** Takes all paint away, as one stroke. */
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
    this.strokes.setApplied(paint); // They are painted already.
    this.planner.edit({ paint });
    this.measure();
  }

  /** After undo and redo. */
  apply(strokes: readonly LabelEdit[]): void {
    if (this.labels && this.strokes.apply(this.labels, strokes)) this.changed();
  }

  // Keeping

  isUnsaved(): boolean {
    return this.labels !== null && this.planner.model.doc.paint !== this.stored;
  }

  get isPainted(): boolean {
    return this.labels?.some((label) => label !== 0) ?? false;
  }

  /** Sends what is painted, if anything is; `forces` also over what another page painted. */
  async save(forces = false): Promise<void> {
    const { grid } = this.planner.model.s.volume!;
    const strokes = this.planner.model.doc.paint;
    const box = paintedBox(this.labels!, grid);
    if (!box) return; // The plan must let go of it first.
    this.etag = await this.planner.client.putBoundaryData(
      bytesWithin(this.labels!, grid, box),
      box,
      forces ? '*' : (this.etag ?? '*'),
    );
    this.stored = strokes;
  }

  /** When the plan names it no more. */
  async removeIfEmpty(): Promise<void> {
    const strokes = this.planner.model.doc.paint;
    if (this.etag !== null) await this.planner.client.deleteBoundaryData(this.etag);
    this.etag = null;
    this.stored = strokes;
  }

  /** A file that another program has painted, in the place of all that is painted. */
  async upload(file: File): Promise<void> {
    await this.planner.attempt(async () => {
      await this.planner.client.putBoundaryFile(file, this.etag ?? '*');
      this.labels = null;
      await this.planner.reload();
    });
  }

  // Showing

  /** The label of each vertex of a surface that stands as scanned. */
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

  /** How much of bone and skin is painted with what. */
  measure(): void {
    const areas: number[] = [];
    for (const [name, { surface }] of this.planner.boundarySurfaces()) {
      const found = this.labelsOf(name, surface);
      if (found) areasByLabel(surface, found.label, areas);
    }
    this.planner.patch({ paintedAreas: areas });
  }
}
