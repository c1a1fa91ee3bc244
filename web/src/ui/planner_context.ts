import type { Client, Depths, Schemas } from '../api';
import type { DrawnSurface, Mat4 } from '../model';
import type { Doc, Model, State } from './state';

/** Interface between the planner and its parts. The parts import this file only; `App` implements it. */
export interface Planner {
  readonly model: Model;
  readonly client: Client;
  patch(part: Partial<State>): void;
  /** Changes the document; changes of one gesture are one undo step. */
  edit(next: Partial<Doc>, gesture?: string | null): void;
  toast(text: string, kind?: 'info' | 'error'): void;
  /** Runs an operation that can fail; shows the error and returns null if it does. */
  attempt<T>(work: () => Promise<T>): Promise<T | null>;
  /** Saves, then starts a job; calls `then` when the job is done. */
  run(request: Schemas['JobRequest'], then?: () => void): Promise<void>;
  /** Uploads files; returns the upload's id, or null after an error, which is shown. */
  upload(files: readonly File[]): Promise<string | null>;
  /** Reads the case from the server again and loads what has changed. */
  reload(): Promise<void>;
  /** Surfaces on which the tissue boundary can be painted. */
  boundarySurfaces(): [string, { surface: DrawnSurface }][];
  /** Poses of the segments that have a surface. */
  cutPoses(): Record<string, Mat4>;
}

/** Receives results that are drawn in the 3D view and in the slices. */
export interface SceneListeners {
  /** A surface was loaded; null: it was removed. */
  onSurface(name: string, surface: DrawnSurface | null): void;
  onDepths(depths: Depths | null): void;
  /** Displacement of the skin; null resets it. */
  onPreview(xyz: Float32Array | null): void;
  onLabels(): void;
  /** The paint on the tissue boundary has changed. */
  onPaint(): void;
}
