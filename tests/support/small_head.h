/// \file
/// A synthetic head that is solved in seconds: a ball of skin around a shell of bone, whose front
/// moves forward.
#pragma once

#include <lefort/image/volume.h>

#include <nlohmann/json.hpp>

#include <array>

namespace lefort::test {

inline image::CtVolume small_head() {
  constexpr Index kSize = 36;
  constexpr double kSpacing_mm = 3.0;
  image::CtVolume ct;
  ct.grid.size = {kSize, kSize, kSize};
  ct.grid.spacing_mm = Vec3::Constant(kSpacing_mm);
  ct.grid.origin_L = Vec3::Constant(-0.5 * kSpacing_mm * double(kSize - 1));
  for (Index v = 0; v < ct.grid.voxel_count(); ++v) {
    const Vec3 p_V{double(v % kSize), double(v / kSize % kSize), double(v / (kSize * kSize))};
    const double r_mm = ct.grid.point_L(p_V).norm();
    const bool bone = r_mm > 24.0 && r_mm < 32.0;
    ct.values.push_back(std::int16_t(r_mm > 47.0 ? -1000 : bone ? 1200 : 40));
  }
  return ct;
}

inline nlohmann::json small_plan() {
  return nlohmann::json::parse(R"({
    "lefort_plan": 1,
    "ct": "ct.nrrd",
    "segments": [{
      "name": "front",
      "osteotomy": {"planes": [{"point_mm": [0, -16, 0], "towards_segment": [0, -1, 0]}]},
      "path": {"steps": 2, "keyframes": [{"translation_mm": [0, -3, 0]}]}
    }],
    "tissue": {"element_size_mm": 5, "margin_mm": 10},
    "field": {"resolution": 64, "band_mm": 4}
  })");
}

/// `boundary` of a plan with the boundary conditions of the paper (paper_boundary.h).
inline nlohmann::json paper_boundary_json() {
  return {{"interface", "contact"}, {"scan_boundary", "free"}, {"cut_boundary", "fixed"}};
}

/// A plan with the boundary conditions of the paper.
inline nlohmann::json with_paper_boundary(nlohmann::json plan) {
  plan["boundary"] = paper_boundary_json();
  return plan;
}

/// The same front as two segments, cut in the middle.
inline nlohmann::json two_piece_plan(const std::array<double, 3>& left_mm,
                                     const std::array<double, 3>& right_mm) {
  nlohmann::json plan = small_plan();
  nlohmann::json& segments = plan["segments"];
  segments.push_back(segments[0]);
  segments[0]["name"] = "left";
  segments[0]["osteotomy"]["planes"].push_back(
      {{"point_mm", {0, 0, 0}}, {"towards_segment", {1, 0, 0}}});
  segments[0]["path"]["keyframes"][0]["translation_mm"] = left_mm;
  segments[1]["name"] = "right";
  segments[1]["path"]["keyframes"][0]["translation_mm"] = right_mm;
  return plan;
}

}  // namespace lefort::test
