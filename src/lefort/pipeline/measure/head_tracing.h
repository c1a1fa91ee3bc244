/// \file
/// Outlines of bone and skin in the mid-sagittal plane, before and after surgery.
#pragma once

#include <lefort/pipeline/cephalogram.h>
#include <lefort/pipeline/prepare/oriented_head.h>
#include <lefort/report/draw_cephalogram.h>

#include <string>
#include <vector>

namespace lefort::pipeline {

/// The lateral view of a head: pixels of the mid-sagittal plane, anterior to the right.
struct LateralView {
  Vec3 center_L = Vec3::Zero();
  plan::HeadDirections directions;
  double pixel_mm = 0.5;
  int columns = 1, rows = 1;

  /// \returns the position of a point, projected along the left axis, in pixels.
  [[nodiscard]] Eigen::Vector2d pixel_of(const Vec3& p_L) const;
};

/// Landmarks and outlines after surgery; empty where nothing is known.
struct HeadAfter {
  plan::Landmarks landmarks;
  std::vector<geometry::TriangleMesh> bones_L;
  geometry::TriangleMesh skin_L;
};

/// Reads what `job.check` and `job.prediction` contain.
[[nodiscard]] Result<HeadAfter> read_after(const CephalogramJob& job,
                                           const plan::Landmarks& landmarks, Progress& progress);

/// Outlines of bone and skin in the mid-sagittal plane, before and after surgery.
[[nodiscard]] Result<std::vector<report::Tracing>> trace_head(const OrientedHead& head,
                                                              const HeadAfter& after,
                                                              const LateralView& view,
                                                              Progress& progress);

}  // namespace lefort::pipeline
