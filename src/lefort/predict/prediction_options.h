/// \file
/// Options of a prediction other than the planned bone motion. Plain values with defaults.
#pragma once

#include <lefort/contact/distance_query.h>
#include <lefort/contact/integration.h>
#include <lefort/contact/penalty.h>
#include <lefort/core/types.h>

#include <optional>
#include <string_view>
#include <vector>

namespace lefort::predict {

/// How soft tissue is attached to bone (docs/theory/interface.md).
enum class TissueInterface {
  kClinical,  ///< Bonded, elevated or sliding, by anatomy and osteotomy (interface_map.h).
  kBonded,    ///< Tissue moves with its bone; on stationary bone near a segment it is not attached.
  kContact,   ///< As kBonded, but a segment only pushes tissue, without friction
              ///< (\cite lefort-paper).
};

/// Boundary condition where the mesh ends but the tissue of the patient continues.
enum class OuterBoundary {
  kRoller,      ///< The displacement normal to the plane is zero; tangential motion is free.
  kFree,        ///< No traction.
  kFixed,       ///< No displacement.
  kFoundation,  ///< Elastic foundation: tissue of thickness foundation_mm, fixed on its far side.
};

/// What happens between upper and lower lip of a closed mouth.
enum class Lips {
  kSeparate,  ///< They can touch, slide and open (separate_lips.h).
  kJoined,    ///< They are one body.
};

/// Names in plans and results.
[[nodiscard]] constexpr std::string_view name_of(Lips lips) {
  return lips == Lips::kJoined ? "joined" : "separate";
}
[[nodiscard]] constexpr std::string_view name_of(TissueInterface interface) {
  switch (interface) {
    case TissueInterface::kBonded:
      return "bonded";
    case TissueInterface::kContact:
      return "contact";
    default:
      return "clinical";
  }
}
[[nodiscard]] constexpr std::string_view name_of(OuterBoundary boundary) {
  switch (boundary) {
    case OuterBoundary::kFree:
      return "free";
    case OuterBoundary::kFixed:
      return "fixed";
    case OuterBoundary::kFoundation:
      return "foundation";
    default:
      return "roller";
  }
}

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
  int element_order = 1;             ///< 1: linear; 2: tet10 with curved boundary.
  double margin_mm = 30.0;           ///< Tissue is meshed this far beyond the segment's box.
  std::optional<SkinOptions> skin = std::nullopt;      ///< Without: as deep tissue.
  std::optional<MucosaOptions> mucosa = std::nullopt;  ///< Without: as deep tissue.
  std::optional<MuscleOptions> muscle = std::nullopt;  ///< Without: as deep tissue.
  std::optional<FaceSize> face = std::nullopt;
};

/// Distance of neighboring nodes near the mobilized segment [mm]: element_size_mm / element_order.
/// Stiffnesses of contact and rollers refer to it.
[[nodiscard]] constexpr double node_spacing_mm(const TissueOptions& tissue) {
  return tissue.element_size_mm / tissue.element_order;
}

struct BoundaryOptions {
  TissueInterface interface = TissueInterface::kClinical;
  OuterBoundary scan_boundary = OuterBoundary::kRoller;  ///< Where the scan ends.
  OuterBoundary cut_boundary = OuterBoundary::kRoller;   ///< Where the meshed region ends.
  /// Thickness of the tissue beyond an elastic foundation, > 0.
  double foundation_mm = 20.0;
  /// kClinical: tissue on bone within this distance of an osteotomy is elevated; if empty, the
  /// distances of the procedure (plan/elevation_zone.h). Other interfaces: tissue on stationary
  /// bone within this distance of a segment is not attached; if empty, kElevationMargin_mm.
  std::optional<double> elevation_margin_mm = std::nullopt;
  /// kClinical: tissue on bone within this distance of bone that moves relative to it, and that no
  /// osteotomy separates from it, slides: occluding teeth, jaw joint; >= 0.
  double joint_margin_mm = 8.0;
  /// kClinical: depth of the oral vestibule from gingival margin to fold (oral_vestibule.h):
  /// tissue on teeth and gingiva slides. 0: the joint margin alone decides.
  double vestibule_mm = 10.0;
  /// Thickness of the elastic layer between bone and tissue that slides on it, > 0
  /// (interface_supports.h).
  double interface_layer_mm = 1.0;
  /// Contact snap distance: tissue boundary within this distance of a bone counts as lying on it.
  double contact_snap_mm = 0.8;
  Lips lips = Lips::kSeparate;
  /// Traction that closes lips which touch at rest, >= 0: resting pressure of the lips on the
  /// incisors of adults, mean of upper (0.38 kPa) and lower lip (0.84 kPa) (\cite hellsing1987).
  double lip_tone_mpa = 0.0006;
};

/// elevation_margin_mm of interfaces other than kClinical, and of osteotomies without a template.
inline constexpr double kElevationMargin_mm = 8.0;

/// What contact reads in place of a bone.
enum class Obstacle {
  kRegularized,  ///< The bone at the resolution of the tissue mesh (regularized_bone.h).
  kBone,         ///< The bone itself, as in the paper.
};
[[nodiscard]] constexpr std::string_view name_of(Obstacle obstacle) {
  return obstacle == Obstacle::kBone ? "bone" : "regularized";
}

struct ContactOptions {
  Obstacle obstacle = Obstacle::kRegularized;
  /// k_c = factor * Young's modulus / node spacing, > 0; default: stiffness_factor().
  std::optional<double> stiffness_factor = std::nullopt;
  contact::DetectionMethod detection = contact::DetectionMethod::kSmooth;
  contact::Integration integration = contact::Integration::kQuadrature;
  /// Penetration increase at which the hardening term of the contact pressure is 4 E, E being
  /// Young's modulus of the deep tissue; > 0. Empty: the penalty of the paper alone
  /// (contact_law()).
  std::optional<double> penetration_tolerance_mm = 0.05;
};

/// The factor in k_c: that of `contact`, else 10, or with weighted gaps that of
/// contact::weighted_stiffness_mpa_per_mm().
[[nodiscard]] double stiffness_factor(const ContactOptions& contact, const TissueOptions& tissue);

/// Contact pressure with Young's modulus E of the deep tissue, the node spacing h, the factor f and
/// the penetration tolerance t (contact/penalty.h):
///
///   p(d) = 2 f E d / h + 4 E (d / t)^2,  d <= 2 t
///
/// Without a tolerance, and with weighted gaps, it has the first term only.
[[nodiscard]] contact::PressureLaw contact_law(const ContactOptions& contact,
                                               const TissueOptions& tissue);

struct SolverOptions {
  double relative_tolerance = 1e-6;  ///< Of the residual, relative to the residual reference.
  int max_iterations = 120;          ///< Of Newton; tissue sliding off convex bone has taken 68.
  double min_increment_ratio =
      1.0 / 64.0;  ///< Smallest increment divided by the first; failed ones are halved.
};

}  // namespace lefort::predict
