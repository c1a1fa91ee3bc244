/// \file
/// Options of a prediction other than the planned bone motion. Plain values with defaults.
#pragma once

#include <lefort/contact/contact_term.h>
#include <lefort/core/types.h>

#include <optional>
#include <vector>

namespace lefort::predict {

/// Interface between tissue and mobilized segment.
enum class SegmentInterface {
  kSliding,  ///< Pushed; slides without friction (\cite lefort-paper).
  kBonded,   ///< Moves with the bone.
};

/// Boundary condition where the scanned volume ends.
enum class ScanBoundary { kFree, kFixed };

/// Skin as a separate layer on the deep tissue. Constants and their sources:
/// docs/theory/materials.md.
struct SkinOptions {
  double thickness_mm = 1.5;  ///< Of epidermis and dermis, > 0 (0.8 to 2: \cite chopra2015).
  int layers = 2;             ///< Of wedges, 1 to 8.
  double young_mpa = 0.0545;  ///< > 0. Barbarino 2011 at small strain.
  double poisson = 0.45;      ///< 0 <= nu < 0.5.
};

/// Mucosa: deep tissue within `thickness_mm` of the air of airway and sinuses.
struct MucosaOptions {
  double thickness_mm = 0.0;  ///< > 0.
  double young_mpa = 0.0;     ///< > 0.
  double poisson = 0.0;       ///< 0 <= nu < 0.5.
};

/// Muscle, as labeled in the segmentation.
struct MuscleOptions {
  double young_mpa = 0.0;  ///< > 0.
  double poisson = 0.0;    ///< 0 <= nu < 0.5.
};

/// Finer elements at lips and nose.
struct FaceSize {
  double element_size_mm = 0.0;  ///< Edge at the points; grows with the distance from them.
  /// Of lips and nose; if empty, the most anterior point of the tissue, the tip of the nose.
  std::vector<Vec3> points_L = {};
};

struct TissueOptions {
  double young_mpa = 0.015;          ///< > 0. Whole face, Nazari 2010 (docs/theory/materials.md).
  double poisson = 0.45;             ///< 0 <= nu < 0.5. Linear tetrahedra lock close to 0.5.
  double element_size_mm = 2.5;      ///< Edge near the mobilized segment.
  double far_element_size_mm = 5.0;  ///< Edge at the border of the region, >= element_size_mm.
  double margin_mm = 30.0;           ///< Tissue is meshed this far beyond the segment's box.
  std::optional<SkinOptions> skin = std::nullopt;      ///< Without: as deep tissue.
  std::optional<MucosaOptions> mucosa = std::nullopt;  ///< Without: as deep tissue.
  std::optional<MuscleOptions> muscle = std::nullopt;  ///< Without: as deep tissue.
  std::optional<FaceSize> face = std::nullopt;
};

struct BoundaryOptions {
  SegmentInterface segment_interface = SegmentInterface::kSliding;
  ScanBoundary scan_boundary = ScanBoundary::kFree;
  /// Tissue on stationary bone within this distance of the segment is elevated.
  double elevation_margin_mm = 8.0;
  /// Contact snap distance: boundary within this distance of a bone lies on it.
  double contact_snap_mm = 0.8;
};

struct ContactOptions {
  /// k_c = factor * Young's modulus / element size, > 0; default: stiffness_factor().
  std::optional<double> stiffness_factor = std::nullopt;
  contact::DetectionMethod detection = contact::DetectionMethod::kSmooth;
  contact::Integration integration = contact::Integration::kQuadrature;
  /// contact::ContactTerm::Options::penetration_tolerance_mm.
  std::optional<double> penetration_tolerance_mm = std::nullopt;
};

/// The factor in k_c. With a penetration tolerance it is larger: the augmented Lagrangian then
/// needs fewer Newton iterations, 370 instead of 631 on one path
/// (docs/studies/contact-on-a-real-head.md).
[[nodiscard]] inline double stiffness_factor(const ContactOptions& contact) {
  constexpr double kByPenalty = 10.0, kByMultipliers = 160.0;
  return contact.stiffness_factor.value_or(contact.penetration_tolerance_mm ? kByMultipliers
                                                                            : kByPenalty);
}

struct SolverOptions {
  double relative_tolerance = 1e-6;
  int max_iterations = 120;  ///< Of Newton; tissue sliding off convex bone has taken 68.
  double min_increment_ratio = 1.0 / 64.0;  ///< Min size of a halved increment, as a fraction.
};

}  // namespace lefort::predict
