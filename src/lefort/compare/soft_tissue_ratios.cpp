#include <lefort/compare/displacement_at.h>
#include <lefort/compare/facing_skin.h>
#include <lefort/compare/procedures.h>
#include <lefort/compare/soft_tissue_ratios.h>
#include <lefort/geometry/bvh.h>
#include <lefort/plan/bones_of_landmarks.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace lefort::compare {
namespace {

constexpr double kMinMovement_mm = 1.0;
constexpr double kOnSkin_mm = 5.0;  // Largest distance of a picked landmark from the skin.
constexpr std::array kAxes{FaceAxis::kAnterior, FaceAxis::kSuperior, FaceAxis::kLateral};

struct LandmarkMovement {
  std::string name;
  Vec3 displacement_mm;
};

const Vec3* find(std::span<const LandmarkMovement> movements, std::string_view name) {
  for (const LandmarkMovement& one : movements)
    if (one.name == name) return &one.displacement_mm;
  return nullptr;
}

/// Of landmarks of the skin that lie on the skin, and of Stm relative to Sn.
std::vector<LandmarkMovement> soft_movements(const geometry::Bvh& skin,
                                             std::span<const Vec3> displacement_mm,
                                             std::span<const plan::Landmark> landmarks_L) {
  std::vector<LandmarkMovement> movements;
  for (const plan::Landmark& landmark : landmarks_L) {
    const plan::LandmarkKind* const kind = plan::landmark_definition(landmark.name);
    if (kind == nullptr || !kind->is_soft) continue;
    if (const auto on_skin = skin.closest_point(landmark.point_L, kOnSkin_mm))
      movements.push_back({landmark.name, displacement_at(skin.mesh(), on_skin->triangle,
                                                          on_skin->point, displacement_mm)});
  }
  const Vec3 *const mouth_mm = find(movements, "Stm"), *const base_mm = find(movements, "Sn");
  if (mouth_mm != nullptr && base_mm != nullptr)
    movements.push_back({std::string(kUpperLip), *mouth_mm - *base_mm});
  return movements;
}

/// A segment while its ratios are computed.
struct Segment {
  std::string name;
  Procedure procedure;
  FacingMovement facing;
  std::vector<LandmarkMovement> hard;
  FaceAxis main_axis = FaceAxis::kAnterior;
  bool is_widened = false;        ///< Moves away from another part of the maxilla.
  bool with_bimaxillary = false;  ///< Studies of both jaws apply.
};

/// Mean of the vertices of a segment that faces no skin.
FacingMovement mean_movement(const geometry::TriangleMesh& segment_L, const RigidTransform& X_LB) {
  FacingMovement mean;
  const double n = std::max<double>(1.0, double(segment_L.vertices.size()));
  for (const Vec3& v : segment_L.vertices) {
    mean.bone_mm += (X_LB * v - v) / n;
    mean.center_L += v / n;
  }
  return mean;
}

bool is_of_maxilla(Procedure procedure) {
  return procedure == Procedure::kLeFort1 || procedure == Procedure::kLeFort2 ||
         procedure == Procedure::kLeFort3;
}

/// Whether two parts of the maxilla move apart by 1 mm or more.
bool move_apart(const Segment& one, const Segment& other, const Vec3& left_L) {
  if (!is_of_maxilla(one.procedure) || !is_of_maxilla(other.procedure)) return false;
  const double side_mm = left_L.dot(one.facing.center_L - other.facing.center_L);
  const double apart_mm = left_L.dot(one.facing.bone_mm - other.facing.bone_mm);
  return std::copysign(apart_mm, apart_mm * side_mm) >= kMinMovement_mm;
}

std::vector<Segment> describe_segments(const geometry::Bvh& skin,
                                       std::span<const Vec3> displacement_mm,
                                       const MovedSegments& moved,
                                       std::span<const plan::Landmark> landmarks_L,
                                       const FaceAxes& axes) {
  const auto bones = plan::bones_of_landmarks(landmarks_L, moved.cut);
  const std::vector<Procedure> procedures = procedures_of(moved.planned, landmarks_L, bones);
  std::vector<Segment> segments;
  for (std::size_t k = 0; k < moved.planned.size(); ++k) {
    const geometry::TriangleMesh& surface_L = moved.cut.segments_L[k];
    const RigidTransform& X_LB = moved.X_LB[k];
    Segment& segment = segments.emplace_back();
    segment.name = moved.planned[k].osteotomy.segment;
    segment.procedure = procedures[k];
    segment.facing = facing_movement(surface_L, X_LB, skin, displacement_mm, axes.anterior_L);
    if (!(segment.facing.area_mm2 > 0.0)) segment.facing = mean_movement(surface_L, X_LB);
    for (std::size_t n = 0; n < landmarks_L.size(); ++n)
      if (bones[n] == k)
        segment.hard.push_back(
            {landmarks_L[n].name, X_LB * landmarks_L[n].point_L - landmarks_L[n].point_L});
    segment.main_axis = *std::max_element(kAxes.begin(), kAxes.end(), [&](FaceAxis a, FaceAxis b) {
      return std::abs(axes.along(a).dot(segment.facing.bone_mm)) <
             std::abs(axes.along(b).dot(segment.facing.bone_mm));
    });
  }
  return segments;
}

/// Sets what depends on the other segments.
void relate_segments(std::vector<Segment>& segments, const FaceAxes& axes) {
  const auto moves = [&](Procedure procedure) {
    return std::any_of(segments.begin(), segments.end(), [&](const Segment& one) {
      return one.procedure == procedure && one.facing.bone_mm.norm() >= kMinMovement_mm;
    });
  };
  const bool both_jaws = moves(Procedure::kLeFort1) && moves(Procedure::kSagittalSplit);
  for (Segment& segment : segments) {
    segment.with_bimaxillary = both_jaws && (segment.procedure == Procedure::kLeFort1 ||
                                             segment.procedure == Procedure::kSagittalSplit);
    segment.is_widened = std::any_of(segments.begin(), segments.end(), [&](const Segment& other) {
      return &other != &segment && move_apart(segment, other, axes.left_L);
    });
  }
}

bool is_on_facing_skin(std::string_view soft) {
  return soft != "Prn" && soft != "Al" && soft != kUpperLip;
}

/// Rows of the table for a ratio. `soft` without side; kFacingSkin stands for all landmarks on it.
std::optional<PublishedRange> find_published(const SoftTissueRatio& ratio, std::string_view soft,
                                             bool with_bimaxillary) {
  std::vector<PublishedRatio> rows;
  for (const PublishedRatio& row : published_ratios()) {
    const bool is_procedure = row.procedure == ratio.procedure ||
                              (with_bimaxillary && row.procedure == Procedure::kBimaxillary);
    const bool is_direction = row.direction == ratio.direction || row.direction == Direction::kAny;
    const bool is_place = soft == kFacingSkin ? is_on_facing_skin(row.soft)
                                              : row.soft == soft && row.hard == ratio.hard;
    if (is_procedure && is_direction && row.axis == ratio.axis && is_place) rows.push_back(row);
  }
  return range_of(rows);
}

/// Distinct pairs of landmarks of the table, in its order.
std::vector<std::pair<std::string_view, std::string_view>> pairs_of_table() {
  std::vector<std::pair<std::string_view, std::string_view>> pairs;
  for (const PublishedRatio& row : published_ratios()) {
    const std::pair pair(row.soft, row.hard);
    if (std::find(pairs.begin(), pairs.end(), pair) == pairs.end()) pairs.push_back(pair);
  }
  return pairs;
}

/// Keeps, of the pairs with the same landmark of the skin, those with a published range; without
/// any, the first pair.
std::vector<SoftTissueRatio> without_duplicates(const std::vector<SoftTissueRatio>& ratios) {
  std::vector<SoftTissueRatio> kept;
  for (const SoftTissueRatio& one : ratios) {
    const auto is_better = [&](const SoftTissueRatio& other) {
      return other.soft == one.soft && (other.published || &other < &one);
    };
    if (one.published || std::none_of(ratios.begin(), ratios.end(), is_better)) kept.push_back(one);
  }
  return kept;
}

/// The ratios of one segment along one axis.
class AxisRatios {
 public:
  AxisRatios(const Segment& segment, std::span<const LandmarkMovement> soft, FaceAxis axis,
             const Vec3& axis_L)
      : segment_(segment), soft_(soft), axis_(axis), axis_L_(axis_L) {}

  [[nodiscard]] std::vector<SoftTissueRatio> all() const {
    std::vector<SoftTissueRatio> ratios;
    const double segment_mm = axis_L_.dot(segment_.facing.bone_mm);
    if (segment_.facing.area_mm2 > 0.0)
      add(ratios, kFacingSkin, kFacingSkin, kSegment, segment_.facing.skin_mm,
          segment_.facing.bone_mm);
    for (const auto& [soft, hard] : pairs_of_table()) {
      if (soft == kUpperLip && axis_ != FaceAxis::kSuperior) continue;
      std::string name(soft);
      if (const plan::LandmarkKind* kind = plan::landmark_definition(name + "-L");
          kind != nullptr && kind->is_paired) {
        if (axis_ != FaceAxis::kLateral) continue;
        name += segment_mm > 0.0 ? "-L" : "-R";
      }
      const Vec3* const soft_mm = find(soft_, name);
      const Vec3* const hard_mm =
          hard == kSegment ? &segment_.facing.bone_mm : find(segment_.hard, hard);
      if (soft_mm != nullptr && hard_mm != nullptr)
        add(ratios, name, soft, hard, *soft_mm, *hard_mm);
    }
    return without_duplicates(ratios);
  }

 private:
  /// \param name  of the soft landmark, with its side.
  void add(std::vector<SoftTissueRatio>& ratios, std::string_view name, std::string_view soft,
           std::string_view hard, const Vec3& soft_mm, const Vec3& hard_mm) const {
    SoftTissueRatio ratio{.segment = segment_.name,
                          .procedure = segment_.procedure,
                          .direction = direction_of(axis_, axis_L_.dot(hard_mm)),
                          .axis = axis_,
                          .is_main_axis = axis_ == segment_.main_axis,
                          .soft = std::string(name),
                          .hard = std::string(hard),
                          .soft_mm = axis_L_.dot(soft_mm),
                          .hard_mm = axis_L_.dot(hard_mm)};
    if (!(std::abs(ratio.hard_mm) >= kMinMovement_mm)) return;
    if (axis_ == FaceAxis::kLateral && segment_.is_widened) {
      ratio.procedure = Procedure::kExpansion;
      ratio.direction = Direction::kWidening;
    }
    ratio.published = find_published(ratio, soft, segment_.with_bimaxillary);
    if (hard == kSegment && soft != kFacingSkin && !ratio.published) return;
    ratios.push_back(std::move(ratio));
  }

  const Segment& segment_;
  std::span<const LandmarkMovement> soft_;
  FaceAxis axis_;
  Vec3 axis_L_;
};

}  // namespace

const Vec3& FaceAxes::along(FaceAxis axis) const {
  if (axis == FaceAxis::kAnterior) return anterior_L;
  return axis == FaceAxis::kSuperior ? superior_L : left_L;
}

FaceAxes face_axes(std::span<const plan::Landmark> landmarks_L) {
  const auto left_L = plan::patient_left_axis(landmarks_L);
  if (!left_L) return {};
  const auto across_left = [&](const Vec3& v) { return Vec3(v - v.dot(*left_L) * *left_L); };
  const auto ear_L = plan::pair_midpoint(landmarks_L, "Po");
  const auto orbit_L = plan::pair_midpoint(landmarks_L, "Or");
  Vec3 anterior = left_L->cross(Vec3::UnitZ());
  if (ear_L && orbit_L && across_left(*orbit_L - *ear_L).norm() > kMinMovement_mm)
    anterior = across_left(*orbit_L - *ear_L);
  FaceAxes axes;
  axes.left_L = *left_L;
  axes.anterior_L = anterior.normalized();
  axes.superior_L = axes.anterior_L.cross(axes.left_L);
  return axes;
}

std::vector<SoftTissueRatio> soft_tissue_ratios(const geometry::TriangleMesh& skin_L,
                                                std::span<const Vec3> displacement_mm,
                                                const MovedSegments& segments,
                                                std::span<const plan::Landmark> landmarks_L) {
  const FaceAxes axes = face_axes(landmarks_L);
  const geometry::Bvh skin(skin_L);
  const std::vector<LandmarkMovement> soft = soft_movements(skin, displacement_mm, landmarks_L);
  std::vector<Segment> described =
      describe_segments(skin, displacement_mm, segments, landmarks_L, axes);
  relate_segments(described, axes);
  std::vector<SoftTissueRatio> ratios;
  for (const Segment& segment : described)
    for (const FaceAxis axis : kAxes)
      for (SoftTissueRatio& ratio : AxisRatios(segment, soft, axis, axes.along(axis)).all())
        ratios.push_back(std::move(ratio));
  return ratios;
}

}  // namespace lefort::compare
