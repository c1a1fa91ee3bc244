/// \file
/// Releases tissue from bone that lies in another bone along the path. Described in
/// docs/theory/interface.md.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/predict/face_model.h>

#include <span>

namespace lefort::predict {

/// Tissue between two bones that overlap has no space, so that no equilibrium exists. At surgery
/// such bone is removed. Tissue on it is therefore free: nothing holds it, and no bone pushes it
/// (InterfaceRule::kOverlap). Free are the nodes that are bonded to a bone or slide on it and at
/// any step of the path lie deeper than the contact snap distance in another bone, by more than
/// that deeper than at rest, and such nodes that share an element with them. Paint, elevated tissue
/// and planes are kept.
///
/// \param model            its interface map and its sets change.
/// \param paths            one for each segment.
/// \param contact_snap_mm  boundary.contact_snap_mm.
/// \returns the number of nodes released; or the errors of contact::field_distance_query().
[[nodiscard]] Result<Index> release_overlap(FaceModel& model,
                                            std::span<const geometry::RigidPath> paths,
                                            double contact_snap_mm);

}  // namespace lefort::predict
