/// \file
/// The anterior edges of upper and lower jaw, from labels: incisors, or alveolar ridge without
/// teeth.
#pragma once

#include <lefort/anatomy/label_map.h>

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace lefort::predict {

struct JawTeeth;

struct JawEdges {
  double middle_x_mm = 0.0;  ///< Middle of the anterior mandible.
  double upper_z_mm = 0.0;   ///< Lower edge of the upper jaw.
  double lower_z_mm = 0.0;   ///< Upper edge of the lower jaw; above upper_z_mm in an overbite.
  [[nodiscard]] double middle_z_mm() const { return 0.5 * (upper_z_mm + lower_z_mm); }
};

/// The upper median. \pre values are not empty.
[[nodiscard]] double median_of(std::vector<double> values);

/// \param labels  of the scan.
/// \param teeth   may be null. Their anterior teeth determine the edge of a jaw
///   (JawTeeth::edge_z_mm()); a jaw without them has the edge of its bone.
/// \returns nothing if less than 5 ml are mandible, or no other bone lies above it in the anterior
///   face.
[[nodiscard]] std::optional<JawEdges> find_jaw_edges(const anatomy::LabelMap& labels,
                                                     const JawTeeth* teeth = nullptr);

/// Anterior surface of both jaws near the level of their edges.
///
/// \param labels      of the scan.
/// \param first_x_mm  of the first column; the columns are 1 mm wide.
/// \param count       of the columns.
/// \param edges_z_mm  lowest and highest level of the edges; bone up to 6 mm beyond counts.
/// \param teeth       may be null: in a column with voxels of numbered teeth, only these count, so
///   that neither streaks of metal nor the alveolar process do.
/// \returns y of the surface in each column, smoothed; a column without bone has that of the
///   closest one with bone; empty if no column has bone.
[[nodiscard]] std::vector<double> anterior_surface_y_mm(const anatomy::LabelMap& labels,
                                                        double first_x_mm, std::size_t count,
                                                        const std::array<double, 2>& edges_z_mm,
                                                        const JawTeeth* teeth = nullptr);

}  // namespace lefort::predict
