/// \file
/// Collects the landmarks of one search.
#pragma once

#include <lefort/plan/find_landmarks.h>
#include <lefort/plan/internal/find_extremum.h>

#include <array>
#include <optional>
#include <string>

namespace lefort::plan::internal {

/// The planes at which the scan truncates the patient: sides of the bounding box of the skin (else
/// of the skull) in which the surface has a flat area.
struct ScanEnds {
  Box3 box_L;
  std::array<bool, 3> is_low_cut{}, is_high_cut{};

  /// \returns whether the point is within `margin_mm` of an end.
  [[nodiscard]] bool is_at_end(const Vec3& p_L, double margin_mm) const;
};

[[nodiscard]] ScanEnds find_scan_ends(const HeadSurfaces& head);

/// The landmarks found so far, and the missing ones. add() and at() use the frame F; found()
/// returns positions in L.
class LandmarkList {
 public:
  LandmarkList(const RigidTransform& X_FL, const ScanEnds& ends, double voxel_mm)
      : X_FL_(X_FL), ends_(ends), voxel_mm_(voxel_mm) {}

  /// Adds a landmark. If it was not found, or lies where the scan ends, adds the reason instead.
  ///
  /// \param rule_mm  error of the rule: distance of the extremum from the anatomical point.
  void add(const std::string& name, const std::optional<Extremum>& found_F, double rule_mm,
           const std::string& reason);
  void miss(const std::string& name, const std::string& reason);

  /// The position in F; nothing if it was not found.
  [[nodiscard]] std::optional<Vec3> at(const std::string& name) const;
  [[nodiscard]] double voxel_mm() const { return voxel_mm_; }
  [[nodiscard]] const RigidTransform& X_FL() const { return X_FL_; }
  [[nodiscard]] const std::vector<FoundLandmark>& found() const { return found_; }  ///< In L.
  [[nodiscard]] const std::vector<MissingLandmark>& missing() const { return missing_; }

 private:
  RigidTransform X_FL_;
  ScanEnds ends_;
  double voxel_mm_;
  std::vector<FoundLandmark> found_;
  std::vector<MissingLandmark> missing_;
};

/// "-R" and "-L", and the sign of x on that side in F.
struct Side {
  const char* suffix;
  double sign;
};
inline constexpr std::array<Side, 2> kSides{{{"-R", -1.0}, {"-L", 1.0}}};

}  // namespace lefort::plan::internal
