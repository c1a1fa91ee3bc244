/// \file
/// Ratios of the movement of soft tissue to that of bone, beside published ranges.
#pragma once

#include <lefort/compare/published_ratios.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/plan/cut_segments.h>
#include <lefort/plan/landmarks.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lefort::compare {

/// Unit vectors of the face, orthogonal.
struct FaceAxes {
  Vec3 anterior_L = -Vec3::UnitY();
  Vec3 superior_L = Vec3::UnitZ();
  Vec3 left_L = Vec3::UnitX();

  [[nodiscard]] const Vec3& along(FaceAxis axis) const;
};

/// \param landmarks_L  before surgery.
/// \returns axes with the Frankfurt horizontal (Po to Or) as anterior and patient_left_axis() as
///   left. Without Po and Or, anterior is normal to left and to the z axis. If right and left
///   landmarks are exchanged, the axes are those of L.
[[nodiscard]] FaceAxes face_axes(std::span<const plan::Landmark> landmarks_L);

/// Name of the skin anterior to the anterior surface of a segment (facing_movement()).
inline constexpr std::string_view kFacingSkin = "facing skin";

/// Movements of a part of the skin and of bone along one axis of the face.
struct SoftTissueRatio {
  std::string segment;
  Procedure procedure = Procedure::kUnknown;
  Direction direction = Direction::kAny;  ///< Of the bone.
  FaceAxis axis = FaceAxis::kAnterior;
  bool is_main_axis = false;  ///< The axis with the largest movement of the segment.
  std::string soft;           ///< Landmark of the skin, with its side; kUpperLip; or kFacingSkin.
  std::string hard;      ///< Landmark of bone; or kSegment: mean of its anterior surface, or of
                         ///< all its vertices if no skin is anterior to it.
  double soft_mm = 0.0;  ///< Displacement of the skin to anterior, superior, or left.
  double hard_mm = 0.0;  ///< Of the bone, as soft_mm; at least 1 mm in magnitude.
  std::optional<PublishedRange> published{};

  /// soft_mm / hard_mm: positive if skin and bone move in the same direction, also in a setback or
  /// an impaction.
  [[nodiscard]] double ratio() const { return soft_mm / hard_mm; }
};

/// The segments of a plan, cut and moved.
struct MovedSegments {
  std::span<const plan::PlannedSegment> planned;
  const plan::CutSegments& cut;
  std::span<const RigidTransform> X_LB;  ///< Pose of each segment after its movement.
};

/// The ratio of a landmark of the skin to one of bone is the ratio of their displacements along an
/// axis. The displacement of the skin is interpolated at the closest point of the skin, within
/// 5 mm; that of bone is the rigid motion of the segment that the landmark lies on
/// (plan::bones_of_landmarks()). The pairs are those of published_ratios(); for each landmark of
/// the skin, those with a published range for the movement, otherwise the first pair. Paired
/// landmarks of the skin have a ratio along the lateral axis only, on the side to which the segment
/// moves.
///
/// The skin that faces a segment has a ratio without any landmark: mean displacement of that skin
/// over mean displacement of the segment's anterior surface. Its published range is that of all
/// rows for the movement except those of Prn, Al and kUpperLip.
///
/// A ratio is given if the bone moves by 1 mm or more along the axis: below that, it is mostly the
/// error of the displacements. Published ranges depend on the procedure: the template of the
/// osteotomy; without one, the landmarks on the segment; without these, the segment it was cut
/// from. Parts of the maxilla that move apart laterally by 1 mm or more count as an expansion. If a
/// Le Fort I segment and the distal segment of a sagittal split both move, studies of bimaxillary
/// surgery are included.
///
/// \param skin_L           before surgery.
/// \param displacement_mm  predicted, one per vertex of the skin.
/// \param segments         \pre one planned segment, surface and pose each.
/// \param landmarks_L      before surgery; may be empty.
/// \returns the ratios by segment, then axis; of each the facing skin first.
[[nodiscard]] std::vector<SoftTissueRatio> soft_tissue_ratios(
    const geometry::TriangleMesh& skin_L, std::span<const Vec3> displacement_mm,
    const MovedSegments& segments, std::span<const plan::Landmark> landmarks_L);

}  // namespace lefort::compare
