/// \file
/// What a prediction can be told, apart from the bones' way. Plain values with defaults.
#pragma once

#include <lefort/contact/contact_term.h>
#include <lefort/core/types.h>

#include <optional>
#include <vector>

namespace lefort::predict {

/// What tissue that lies on the moved segment does.
enum class SegmentInterface {
  kSliding,  ///< Is pushed and slides without friction (paper, section 2.3).
  kBonded,   ///< Moves with the bone.
};

/// What holds tissue that ends only because the scan does.
enum class ScanBoundary { kFree, kFixed };

/// Skin of its own over the tissue inside. Constants and their sources: docs/theory/materials.md.
struct SkinOptions {
  double thickness_mm = 1.5;  ///< Of epidermis and dermis, > 0 (0.8 to 2: \cite chopra2015).
  int layers = 2;             ///< Of wedges, 1 to 8.
  double young_mpa = 0.0545;  ///< > 0. Barbarino 2011 at small strain.
  double poisson = 0.45;      ///< 0 <= nu < 0.5.
};

/// Mucosa: what is under no skin and nearer than this to the air of airway and sinuses.
struct MucosaOptions {
  double thickness_mm = 0.0;  ///< > 0.
  double young_mpa = 0.0;     ///< > 0.
  double poisson = 0.0;       ///< 0 <= nu < 0.5.
};

/// Muscle, where the labels name it.
struct MuscleOptions {
  double young_mpa = 0.0;  ///< > 0.
  double poisson = 0.0;    ///< 0 <= nu < 0.5.
};

/// Finer elements at lips and nose.
struct FaceSize {
  double element_size_mm = 0.0;  ///< Edge at the points; grows from there as from the segment.
  /// Of lips and nose; if empty the foremost point of the tissue, which is the tip of the nose.
  std::vector<Vec3> points_L = {};
};

struct TissueOptions {
  double young_mpa = 0.015;          ///< > 0. Whole face, Nazari 2010 (docs/theory/materials.md).
  double poisson = 0.45;             ///< 0 <= nu < 0.5. Linear tetrahedra lock nearer to 0.5.
  double element_size_mm = 2.5;      ///< Edge near the moved segment.
  double far_element_size_mm = 5.0;  ///< Edge at the rim of the region, >= element_size_mm.
  double margin_mm = 30.0;           ///< Tissue is meshed this far beyond the segment's box.
  std::optional<SkinOptions> skin = std::nullopt;      ///< Without, skin is made as what is inside.
  std::optional<MucosaOptions> mucosa = std::nullopt;  ///< Without, likewise.
  std::optional<MuscleOptions> muscle = std::nullopt;  ///< Without, likewise.
  std::optional<FaceSize> face = std::nullopt;
};

struct BoundaryOptions {
  SegmentInterface segment_interface = SegmentInterface::kSliding;
  ScanBoundary scan_boundary = ScanBoundary::kFree;
  double elevation_margin_mm =
      8.0;                  ///< Tissue on still bone nearer than this to the segment is elevated.
  double capture_mm = 0.8;  ///< Boundary nearer than this to a bone lies on it.
};

struct ContactOptions {
  /// k_c = factor * Young's modulus / element size, > 0; unless named, see stiffness_factor().
  std::optional<double> stiffness_factor = std::nullopt;
  contact::DetectionMethod detection = contact::DetectionMethod::kSmooth;
  contact::Integration integration = contact::Integration::kQuadrature;
  /// contact::ContactTerm::Options::penetration_tolerance_mm.
  std::optional<double> penetration_tolerance_mm = std::nullopt;
};

/// The factor in k_c. Where a depth is asked for, springs are stiffer from the start: multipliers
/// then get there in fewer Newton iterations, 370 instead of 631 on the way it was measured on
/// (docs/theory/contact.md).
[[nodiscard]] inline double stiffness_factor(const ContactOptions& contact) {
  constexpr double kByPenalty = 10.0, kByMultipliers = 160.0;
  return contact.stiffness_factor.value_or(contact.penetration_tolerance_mm ? kByMultipliers
                                                                            : kByPenalty);
}

struct SolverOptions {
  double relative_tolerance = 1e-6;
  int max_iterations = 120;  ///< Of Newton; tissue sliding off bulging bone has taken 68.
  double min_increment_ratio = 1.0 / 64.0;  ///< Share of an increment; below it halving gives up.
};

}  // namespace lefort::predict
