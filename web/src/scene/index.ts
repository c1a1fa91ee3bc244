export { PATIENT_AXES, planeAxes, type GizmoDrag } from './gizmo';
export { SliceView, type SliceLines, type SliceMarker } from './slice_view';
export { View3d, type Layout, type Marker, type Phase, type PlaneMark, type Polyline } from './view3d';
