import type { Hit, Vec3 } from '../model';
import type { GizmoDrag } from './gizmo';

/** A point drawn over the picture: a landmark, a corner of a curve. */
export interface Marker {
  id: string;
  position: Vec3;
  label?: string;
  color: string;
  selected?: boolean;
  /** Dim the marker where it is behind a body. */
  hides?: boolean;
  draggable?: boolean;
}

/** One of several pictures from the same view. */
export interface Pane {
  bodies: readonly string[];
  name: string;
}

export type Layout =
  | { mode: 'single' }
  | { mode: 'wipe'; fraction: number; left: string[]; right: string[]; names: [string, string] }
  | { mode: 'beside'; panes: readonly Pane[] };

/** The number of pictures side by side. */
export const paneCount = (layout: Layout): number => (layout.mode === 'beside' ? layout.panes.length : 1);

/** The middle of the picture at x in a view of this width. */
export function middleOfPane(layout: Layout, x: number, width: number): number {
  const count = paneCount(layout);
  const at = Math.max(0, Math.min(count - 1, Math.floor((x * count) / width)));
  return ((at + 0.5) * width) / count;
}

export type Phase = 'start' | 'move' | 'end';

/** A point on a body. */
export interface BodyHit {
  hit: Hit;
  body: string;
}

export interface View3dEvents {
  /** The pointer was pressed. The view must show the current state, so pending changes must be drawn now. */
  onPress(): void;
  onGizmo(drag: GizmoDrag, phase: Phase): void;
  /** True if a click places something; the pointer's shape depends on it. */
  isPlacing(): boolean;
  /** A click on a body, with a tool that places. */
  onPick(hit: Hit, body: string): void;
  /** True if a drag over a body paints it. */
  isPainting(): boolean;
  /** The brush was put on a body, at least once per frame; null at the end of a stroke. */
  onPaint(at: BodyHit | null, phase: Phase): void;
  onMarkerDrag(id: string, hit: Hit, phase: Phase): void;
  onMarkerSelect(id: string): void;
  onWipe(fraction: number): void;
}
