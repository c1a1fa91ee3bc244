/// \file
/// The parts of a face that studies report apart, told from landmarks on the skin.
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

/// "nose", "upper lip", ...; "elsewhere".
[[nodiscard]] const char* name_of(FaceRegion region);

/// Which region each point of a skin belongs to.
class FaceRegions {
 public:
  /// The rules, in the frame of patient_left_axis() and the Frankfurt horizontal (without Po and
  /// Or: of the line Sn-N' as up). Heights are those of landmarks, widths are from the mid-plane:
  ///
  ///     N' ----- /\ -----     nose       Sn to N'; as wide as 1.15 Al at Sn, En at N'
  ///             /  \          upper lip  Stm to Sn, as wide as Ch
  ///     Sn ----/----\----     lower lip  half-way from Pg' to Li, to Stm; as wide as Ch
  ///     Stm --|------|---     chin       Me' to half-way from Pg' to Li, 1.2 times as wide as Ch
  ///           |      |        cheeks     Ch (without it: Sn) to En, beside nose and lips,
  ///     Me' --+------+---                1.2 times as wide as Ex
  ///
  /// all of it within 25 mm behind the foremost of the landmarks that bound it in width.
  ///
  /// \returns the rules, or kPlanInvalid if sides are exchanged (patient_left_axis()). A region
  ///   whose landmarks are not all there is left out; that is no error.
  [[nodiscard]] static Result<FaceRegions> from(std::span<const plan::Landmark> landmarks_L);

  [[nodiscard]] FaceRegion at(const Vec3& p_L) const;

  /// What is missing for each region that is left out: "upper lip: Stm".
  [[nodiscard]] const std::vector<std::string>& missing() const { return missing_; }

 private:
  /// What lies between two heights and two widths, on both sides or one.
  struct Part {
    FaceRegion region;
    double low_mm, high_mm;              ///< Heights.
    double width_low_mm, width_high_mm;  ///< Half, at these heights; linear between.
    double behind_mm;                    ///< Least depth towards the front.
    int side = 0;                        ///< 1: the patient's left alone, -1: right, 0: both.
  };
  [[nodiscard]] bool holds(const Part& part, const Vec3& local) const;

  Mat3 R_FL_ = Mat3::Identity();  ///< Rows: left, front, up.
  Vec3 middle_L_ = Vec3::Zero();
  std::vector<Part> parts_;  ///< The first that holds a point counts.
  std::vector<std::string> missing_;
};

}  // namespace lefort::compare
