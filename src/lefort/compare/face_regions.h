/// \file
/// Regions of the face (nose, lips, chin, cheeks), defined by landmarks on the skin.
#pragma once

#include <lefort/core/error.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/plan/landmarks.h>

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lefort::compare {

enum class FaceRegion : std::uint8_t {
  kElsewhere,
  kNose,
  kUpperLip,
  kLowerLip,
  kChin,
  kRightCheek,  ///< The patient's.
  kLeftCheek,
};

inline constexpr std::array<FaceRegion, 6> kFaceRegions{
    FaceRegion::kNose, FaceRegion::kUpperLip,   FaceRegion::kLowerLip,
    FaceRegion::kChin, FaceRegion::kRightCheek, FaceRegion::kLeftCheek};

/// \param region  a region.
/// \returns "nose", "upper lip", ..., or "elsewhere".
[[nodiscard]] const char* name_of(FaceRegion region);

/// Assigns points of the skin to regions.
class FaceRegions {
 public:
  /// Defines the regions in the frame of patient_left_axis() and the Frankfurt horizontal (without
  /// Po and Or: with the line Sn-N' as up). Heights are those of landmarks, widths are measured
  /// from the mid-plane:
  ///
  ///     N' ----- /\ -----     nose       Sn to N'; at Sn 1.15 times as wide as Al, at N' as En
  ///             /  \          upper lip  Stm to Sn, as wide as Ch
  ///     Sn ----/----\----     lower lip  midpoint of Pg' and Li, to Stm; as wide as Ch
  ///     Stm --|------|---     chin       Me' to midpoint of Pg' and Li, 1.2 times as wide as Ch
  ///           |      |        cheeks     Ch (without it: Sn) to En, lateral to nose and lips,
  ///     Me' --+------+---                1.2 times as wide as Ex
  ///
  /// Each region ends 25 mm posterior to the landmarks that define its width. The factors and the
  /// depth are heuristic.
  ///
  /// \param landmarks_L  of the skin, and Po and Or.
  /// \returns the regions, or kPlanInvalid if sides are exchanged (patient_left_axis()). A region
  ///   with a missing landmark is omitted.
  [[nodiscard]] static Result<FaceRegions> from(std::span<const plan::Landmark> landmarks_L);

  /// \param p_L  a point of the skin [mm].
  /// \returns the first region that contains the point, or kElsewhere.
  [[nodiscard]] FaceRegion at(const Vec3& p_L) const;

  /// \returns the missing landmarks of each omitted region: "upper lip: Stm".
  [[nodiscard]] const std::vector<std::string>& missing() const { return missing_; }

 private:
  /// The points between two heights and within two widths, on both sides or one.
  struct Part {
    FaceRegion region;
    double low_mm, high_mm;              ///< Heights.
    double width_low_mm, width_high_mm;  ///< Half widths at these heights; linear in between.
    double behind_mm;                    ///< Smallest anterior coordinate.
    int side = 0;                        ///< 1: the patient's left only, -1: right, 0: both.
  };
  [[nodiscard]] bool contains(const Part& part, const Vec3& local) const;

  Mat3 R_FL_ = Mat3::Identity();  ///< Rows: left, anterior, superior.
  Vec3 middle_L_ = Vec3::Zero();
  std::vector<Part> parts_;  ///< By priority.
  std::vector<std::string> missing_;
};

}  // namespace lefort::compare
