export { type Body } from './body';
export { PATIENT_AXES, planeAxes, type GizmoDrag } from './gizmo';
export { type PlaneMark, type Polyline } from './overlay';
export { SliceView, type SliceLines, type SliceMarker } from './slice_view';
export { View3d } from './view3d';
export { type BodyHit, type Layout, type Marker, type Phase } from './view_events';
