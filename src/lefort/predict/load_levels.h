/// \file
/// The path fractions at which a prediction finds equilibrium.
#pragma once

#include <lefort/geometry/rigid_path.h>
#include <lefort/predict/face_model.h>
#include <lefort/predict/prediction_options.h>

#include <vector>

namespace lefort::predict {

/// A path fraction at which equilibrium is found. Keyframes are levels too, so that no increment
/// passes over a keyframe.
struct LoadLevel {
  double path_fraction;
  bool is_step;  ///< The state there is a step of the prediction.
};

/// \param paths       one for each segment.
/// \param increments  in each step, >= 1. Six steps of four increments have the same levels, bit by
///   bit, as 24 steps of one: division rounds equal ratios equally.
/// \returns the levels of all increments and keyframes, ascending.
[[nodiscard]] std::vector<LoadLevel> load_levels(const std::vector<geometry::RigidPath>& paths,
                                                 int increments);

/// Max motion of a segment in one increment, as a fraction of the element size. A regularized
/// obstacle has no edge that an element of tissue could pass over in one increment.
[[nodiscard]] constexpr double increment_element_fraction(Obstacle obstacle) {
  return obstacle == Obstacle::kRegularized ? 0.5 : 0.25;
}

/// Max motion of a vertex of a segment in one increment: increment_element_fraction() of an
/// element, or half of `max_distance_mm` (docs/theory/contact.md, Load stepping).
///
/// \param tissue           its element size is used.
/// \param obstacle         obstacle_of() the model.
/// \param max_distance_mm  minimum of those of the segments' distance queries, > 0.
[[nodiscard]] double max_increment_mm(const TissueOptions& tissue, Obstacle obstacle,
                                      double max_distance_mm);

/// Number of equal increments of a step. In one increment no vertex of a segment moves further
/// than max_increment_mm(). Plans that differ only in their steps can have the same increments.
///
/// \param tissue           its element size is used.
/// \param obstacle         obstacle_of() the model.
/// \param paths            one for each segment.
/// \param segments         in the order of `paths`.
/// \param max_distance_mm  minimum of those of the segments' distance queries, > 0.
[[nodiscard]] int increments_of_step(const TissueOptions& tissue, Obstacle obstacle,
                                     const std::vector<geometry::RigidPath>& paths,
                                     const std::vector<ContactBone>& segments,
                                     double max_distance_mm);

}  // namespace lefort::predict
