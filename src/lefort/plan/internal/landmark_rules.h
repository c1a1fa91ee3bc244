/// \file
/// The rules of find_landmarks(), by part of the head. All meshes and points are in F.
#pragma once

#include <lefort/geometry/triangle_mesh.h>
#include <lefort/plan/internal/facial_cavities.h>
#include <lefort/plan/internal/landmark_list.h>

#include <optional>

namespace lefort::plan::internal {

/// The surfaces of HeadSurfaces in F.
struct HeadInF {
  geometry::TriangleMesh skull;
  std::optional<geometry::TriangleMesh> mandible, skin, upper_teeth, lower_teeth;
};

/// Directions in F.
inline const Vec3 kAnterior(0.0, -1.0, 0.0), kPosterior(0.0, 1.0, 0.0);
inline const Vec3 kInferior(0.0, 0.0, -1.0), kSuperior(0.0, 0.0, 1.0);

/// Directions to the incisal edges along the mean axes of incisors: 65 degrees (lower) and 111
/// degrees (upper) to the Frankfurt horizontal \cite tweed1954 \cite jacobson2006.
inline const Vec3 kLowerIncisorAxis(0.0, -0.4226, 0.9063);
inline const Vec3 kUpperIncisorAxis(0.0, -0.3584, -0.9336);

/// A bound beyond any head [mm].
inline constexpr double kFar_mm = 1e3;

/// Distance of the lines of an orthographic view [mm].
inline constexpr double kPixel_mm = 0.5;

/// N, ANS, A, PNS, Or and FZ; U1 and U6 on the teeth, or else on the skull.
void find_midface(const HeadInF& head, const geometry::SurfaceCrossings& front,
                  const std::optional<FacialCavities>& cavities, LandmarkList& list);

/// Zy and Po, by views from both sides.
void find_lateral(const HeadInF& head, LandmarkList& list);

/// Pg, Gn, Me, B, Go, Co, Cdl, Cdm; L1 and L6.
void find_mandible_landmarks(const HeadInF& head, LandmarkList& list);

/// Landmarks of the skin.
void find_skin_landmarks(const HeadInF& head, const std::optional<FacialCavities>& cavities,
                         LandmarkList& list);

}  // namespace lefort::plan::internal
