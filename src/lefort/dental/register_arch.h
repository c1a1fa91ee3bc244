/// \file
/// Registers the intraoral scan of a jaw with its crowns in the CT.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/dental/crowns.h>
#include <lefort/geometry/triangle_mesh.h>

#include <array>
#include <vector>

namespace lefort::dental {

/// A third of an arch.
enum class Sextant { kRight, kAnterior, kLeft };  ///< Of the patient.

[[nodiscard]] constexpr const char* name_of(Sextant sextant) {
  switch (sextant) {
    case Sextant::kRight:
      return "right";
    case Sextant::kAnterior:
      return "anterior";
    default:
      return "left";
  }
}

/// Distances of crowns in the CT from the intraoral scan.
struct CrownDistances {
  Index points = 0;       ///< Vertices of crowns with a counterpart within 1 mm.
  double fraction = 0.0;  ///< Of all vertices of crowns.
  double rms_mm = 0.0;
  double p95_mm = 0.0;
};

/// A registered intraoral scan.
struct ArchFit {
  RigidTransform X_L_scan = RigidTransform::Identity();  ///< Maps the intraoral scan into the CT.
  bool is_reversed = false;  ///< The triangles of the scan are clockwise; they were turned.
  double scale = 1.0;        ///< Of the CT relative to the scan, estimated.
  CrownDistances all;
  std::array<CrownDistances, 3> sextants;  ///< In the order of Sextant.
  /// At each vertex of the crowns: signed distance to the scan [mm], positive outside of it; NaN
  /// without a counterpart within 1 mm.
  std::vector<double> distances_mm;
};

/// Registers an intraoral scan without initial alignment.
///
/// The vertices of the crowns are registered with the scan (compare/register_surface.h), so that
/// gingiva and palate in the scan do not matter, and metal in the CT is an outlier. Crowns more
/// than 1 mm beyond the border of the scan, as seen along its normal, are left out, as by
/// \cite turk1994.
/// Initial alignments turn the scan about its occlusal direction, which is the vector area of the
/// open surface, or the axis of least variance; the best one is refined.
///
/// \param scan    the intraoral scan [mm], in its own frame; open or closed.
/// \param crowns  of the same jaw.
/// \param other   crowns of the other jaw, to recognize a scan of that jaw; null: not checked.
/// \returns the fit, or
///   - kInvalidArgument  the scan is not 25 to 150 mm long, and which unit it may have; a scan that
///     fits the other jaw better, or its mirror image the same one; or a scale more than 1.5 % from
///     1;
///   - kNotConverged     the scan does not fit the crowns, or only with another scale;
///   - kCancelled        `progress` requested a stop.
[[nodiscard]] Result<ArchFit> register_arch(const geometry::TriangleMesh& scan,
                                            const Crowns& crowns, const Crowns* other,
                                            Progress& progress = Progress::none());

}  // namespace lefort::dental
