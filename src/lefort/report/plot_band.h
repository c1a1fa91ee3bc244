/// \file
/// A curve with an uncertainty band in a plane, as inline SVG; both axes have the same scale.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <string>
#include <vector>

namespace lefort::report {

/// One piece of the curve, at both of its ends [mm]; y upwards.
struct BandPiece {
  std::array<Eigen::Vector2d, 2> low{}, middle{}, high{};  ///< P5, P50, P95.
  std::array<Eigen::Vector2d, 2> before{};                 ///< Another curve, dashed.
};

struct BandPlot {
  std::string title{};
  std::string low_name{}, middle_name{}, high_name{}, before_name{};
  std::vector<BandPiece> pieces{};
};

/// \param plot  any texts; pieces with coordinates that are not finite are left out.
/// \returns one well-formed <svg> element with a scale bar of 10 mm; 720 units wide.
[[nodiscard]] std::string plot_band(const BandPlot& plot);

}  // namespace lefort::report
