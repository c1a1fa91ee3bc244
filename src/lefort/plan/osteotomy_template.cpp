#include <lefort/plan/osteotomy_template.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

namespace lefort::plan {
namespace {

constexpr std::array<std::pair<OsteotomyTemplate, std::string_view>, 5> kNames{{
    {OsteotomyTemplate::kLeFort1, "le-fort-1"},
    {OsteotomyTemplate::kLeFort2, "le-fort-2"},
    {OsteotomyTemplate::kLeFort3, "le-fort-3"},
    {OsteotomyTemplate::kGenioplasty, "genioplasty"},
    {OsteotomyTemplate::kSagittalSplit, "sagittal-split"},
}};

std::vector<std::string> landmarks_for(OsteotomyTemplate kind) {
  switch (kind) {
    case OsteotomyTemplate::kLeFort1:
      return {"ANS", "PNS"};
    case OsteotomyTemplate::kLeFort2:
      return {"N", "Or-R", "Or-L", "ANS", "PNS"};
    case OsteotomyTemplate::kLeFort3:
      return {"N", "Or-R", "Or-L", "FZ-R", "FZ-L", "ANS", "PNS"};
    case OsteotomyTemplate::kGenioplasty:
      return {"Me", "Pg", "Go-R", "Go-L"};
    case OsteotomyTemplate::kSagittalSplit:
      return {"Me", "Go-R", "Go-L", "Co-R", "Co-L", "L6-R", "L6-L"};
  }
  return {};
}

/// Landmarks and anatomical directions.
struct Head {
  std::span<const Landmark> landmarks;
  Vec3 left, anterior, up;

  [[nodiscard]] Vec3 at(std::string_view name) const { return *find_landmark(landmarks, name); }
  [[nodiscard]] Vec3 middle(std::string_view name) const { return *pair_midpoint(landmarks, name); }
};

/// \returns the part of `v` normal to `unit`.
Vec3 without(const Vec3& v, const Vec3& unit) { return v - unit.dot(v) * unit; }

/// \param backwards, forwards  posterior and anterior point of the horizontal in lateral view.
/// \returns kPlanInvalid if sides are exchanged, or the line through the points is transverse or
///   does not point forwards.
Result<Head> head_along(std::span<const Landmark> landmarks, const Vec3& backwards,
                        const Vec3& forwards) {
  constexpr double kMinLength_mm = 1.0;       // As for two landmarks that coincide.
  constexpr double kMinAnteriorCosine = 0.5;  // Of 60 degrees, as for sides.
  const auto bad = [](const char* what) { return fail(ErrorCode::kPlanInvalid, what); };
  LEFORT_TRY(const Vec3 left, patient_left_axis(landmarks));
  const Vec3 ahead = without(forwards - backwards, left);
  if (!(ahead.norm() >= kMinLength_mm)) return bad("its landmarks lie on one transverse line");
  Head head{landmarks, left, ahead.normalized(), {}};
  head.up = head.anterior.cross(head.left);
  if (!(-head.anterior.y() > kMinAnteriorCosine))
    return bad(
        "the direction from its posterior to its anterior landmarks is more than 60 degrees off "
        "the patient's anterior direction; are they exchanged?");
  return head;
}

Osteotomy le_fort_1(const Head& head, const TemplateOptions& options) {
  Osteotomy cut;
  cut.planes = {{head.at("ANS") + options.above_palate_mm * head.up, -head.up},
                {head.at("PNS") - options.behind_palate_mm * head.anterior, head.anterior}};
  return cut;
}

/// Direction from nasion to the top of the pterygomaxillary fissure, which is posterior and
/// inferior to nasion, below the skull base.
Vec3 roof_backwards(const Head& head) {
  constexpr double kFissure = 0.45;  // Height of the fissure: fraction of that of N above PNS.
  const Vec3 rise = head.up.dot(head.at("N") - head.at("PNS")) * head.up;
  return without(head.at("PNS") + kFissure * rise - head.at("N"), head.left).normalized();
}

Osteotomy le_fort_2(const Head& head, const TemplateOptions& options) {
  Osteotomy cut;
  const Vec3 nasion = head.at("N"), backwards = roof_backwards(head);
  for (const char* const orbitale : {"Or-R", "Or-L"}) {
    Vec3 normal = backwards.cross(head.at(orbitale) - nasion).normalized();
    if (normal.dot(head.at("ANS") - nasion) < 0.0) normal = -normal;
    cut.planes.push_back({nasion, normal});
  }
  cut.planes.push_back({head.at("PNS") - options.behind_palate_mm * head.anterior, head.anterior});
  return cut;
}

Osteotomy le_fort_3(const Head& head, const TemplateOptions& options) {
  constexpr double kBeyondOrbitale = 1.3;  // Width of the middle part over the distance between Or.
  constexpr double kOverlap_mm = 6.0;      // Of the middle and the lateral parts.
  Osteotomy cut;
  const Vec3 nasion = head.at("N");
  const Vec3 middle = 0.5 * (head.at("Or-R") + head.at("Or-L"));
  const double half_mm = kBeyondOrbitale * 0.5 * head.left.dot(head.at("Or-L") - head.at("Or-R"));
  const Vec3 roof = head.left.cross(roof_backwards(head)).normalized();
  cut.planes = {{nasion, roof.dot(head.up) < 0.0 ? roof : Vec3(-roof)},
                {head.at("PNS") - options.behind_palate_mm * head.anterior, head.anterior},
                {middle + half_mm * head.left, -head.left},
                {middle - half_mm * head.left, head.left}};
  for (const bool is_left : {false, true}) {
    const Vec3 outwards = is_left ? head.left : Vec3(-head.left);
    const Vec3 suture = head.at(is_left ? "FZ-L" : "FZ-R");
    cut.additional_regions.push_back(
        {{{suture, -head.up},
          {suture - options.behind_rim_mm * head.anterior, head.anterior},
          {middle + (half_mm - kOverlap_mm) * outwards, outwards}},
         {}});
  }
  return cut;
}

Osteotomy genioplasty(const Head& head, const TemplateOptions& options) {
  constexpr double kExit = 0.5;  // Fraction of Me-Go at which the cut leaves the lower border.
  Osteotomy cut;
  const Vec3 front = head.at("Pg") + options.above_pogonion_mm * head.up;
  const Vec3 exit = head.at("Me") + kExit * (head.middle("Go") - head.at("Me"));
  Vec3 normal = head.left.cross(exit - front).normalized();
  if (normal.dot(head.at("Me") - front) < 0.0) normal = -normal;
  cut.planes = {{front, normal}};
  cut.anchor_points_L = {head.at("Me")};
  return cut;
}

/// The planes of one side of a sagittal split.
struct SplitPlane {
  Vec3 point_L, normal_L;
  [[nodiscard]] CutPlane cut() const { return {point_L, normal_L}; }
};
struct SplitPlanes {
  SplitPlane before_buccal, medial, below;
};

/// Landmarks of one side, and the superior direction.
struct Ramus {
  Vec3 go, co, up;
};

/// Moves the split to lateral and the medial cut to superior until the canal of the side is as far
/// from them as TemplateOptions requires.
Result<void> keep_free(const NerveCanal& canal, const std::string& side, double clearance_mm,
                       const Ramus& ramus, SplitPlanes& planes) {
  constexpr double kMinDepth_mm = 1.0, kMaxMedialCut = 0.8;
  const double free_mm = clearance_mm + canal.radius_mm;
  double inside_mm = std::numeric_limits<double>::infinity(), below_mm = inside_mm;
  const auto ahead = [&](const Vec3& p) {
    return planes.before_buccal.normal_L.dot(p - planes.before_buccal.point_L) - free_mm;
  };
  const auto include = [&](const Vec3& p) {
    inside_mm = std::min(inside_mm, planes.medial.normal_L.dot(p - planes.medial.point_L));
    below_mm = std::min(below_mm, planes.below.normal_L.dot(p - planes.below.point_L));
  };
  // Anterior to the buccal cut all bone belongs to the distal segment.
  for (std::size_t i = 0; i < canal.line_L.size(); ++i) {
    const Vec3& p = canal.line_L[i];
    if (ahead(p) <= 0.0) include(p);
    if (i == 0) continue;
    const Vec3& before = canal.line_L[i - 1];
    if ((ahead(before) <= 0.0) != (ahead(p) <= 0.0))
      include(before + ahead(before) / (ahead(before) - ahead(p)) * (p - before));
  }
  if (inside_mm < free_mm) planes.medial.point_L -= (free_mm - inside_mm) * planes.medial.normal_L;
  if (below_mm < free_mm) planes.below.point_L -= (free_mm - below_mm) * planes.below.normal_L;
  const double depth_mm = planes.medial.normal_L.dot(planes.medial.point_L - ramus.go);
  if (!(depth_mm >= kMinDepth_mm))
    return fail(ErrorCode::kPlanInvalid,
                fmt::format("the {} canal lies too lateral: {:g} mm (with the kerf) from it the "
                            "split would be {:.1f} mm medial to Go, must be {:g} or more; reduce "
                            "nerve_clearance_mm or draw the cuts",
                            side, clearance_mm, depth_mm, kMinDepth_mm));
  const double height = (ramus.co - ramus.go).norm();
  const double fraction = -planes.below.normal_L.dot(planes.below.point_L - ramus.go) / height;
  if (!(fraction <= kMaxMedialCut))
    return fail(ErrorCode::kPlanInvalid,
                fmt::format("the {} canal reaches too high: {:g} mm above it the medial cut would "
                            "be at {:.0f} % of the way from Go to Co, must be {:.0f} or less",
                            side, clearance_mm, 100.0 * fraction, 100.0 * kMaxMedialCut));
  return {};
}

/// keep_free(), with the split turned about the vertical through Go by the smallest angle for which
/// it is possible, up to 20 degrees.
Result<SplitPlanes> turned_free(const NerveCanal& canal, const std::string& side,
                                double clearance_mm, const Ramus& ramus,
                                const SplitPlanes& planes) {
  constexpr double kStep_rad = 2.0 * std::numbers::pi / 180.0;
  constexpr int kSteps = 10;
  std::optional<Error> first;
  // The same way on both sides: first that which moves the anterior part of the split to medial.
  const int inwards =
      ramus.up.cross(planes.before_buccal.normal_L).dot(planes.medial.normal_L) > 0.0 ? 1 : -1;
  for (int step = 0; step <= kSteps; ++step)
    for (const int sign : {inwards, -inwards}) {
      if (step == 0 && sign != inwards) continue;
      const Eigen::AngleAxisd turn(sign * step * kStep_rad, ramus.up);
      SplitPlanes turned = planes;
      turned.medial.normal_L = turn * planes.medial.normal_L;
      turned.medial.point_L = ramus.go + turn * (planes.medial.point_L - ramus.go);
      const Result<void> is_free = keep_free(canal, side, clearance_mm, ramus, turned);
      if (is_free) return turned;
      if (!first) first = is_free.error();
    }
  return tl::unexpected(*first);
}

/// The canal on a side of the head; nothing if there is none.
const NerveCanal* canal_at(std::span<const NerveCanal> canals, const Head& head,
                           const Vec3& outwards) {
  for (const NerveCanal& canal : canals) {
    Vec3 middle = Vec3::Zero();
    for (const Vec3& p : canal.line_L) middle += p / double(canal.line_L.size());
    if (!canal.line_L.empty() && outwards.dot(middle - head.at("Me")) > 0.0) return &canal;
  }
  return nullptr;
}

///   seen from the left, anterior to the left     The proximal segment is above the medial cut or
///                 ) Co                           lateral to the split, and posterior to the
///      medial cut -------\   proximal            buccal cut. The distal segment, which moves, is
///                        |                       on each side anterior to the buccal cut, or both
///      L6   | buccal cut | split medial to Go    below the medial cut and medial to the split.
///     -------------------/ Go
Result<Osteotomy> sagittal_split(const Head& head, const TemplateOptions& options) {
  constexpr double kMedialCut = 0.5;    // Fraction of Go-Co, above the lingula.
  constexpr double kStagger_mm = 0.01;  // So that regions do not end in the same plane.
  const auto side_of = [&](const char* side, const char* words,
                           const Vec3& outwards) -> Result<SplitPlanes> {
    const Vec3 go = head.at(std::string("Go") + side), co = head.at(std::string("Co") + side);
    const Vec3 molar = head.at(std::string("L6") + side);
    const Vec3 along = without(molar - go, head.up).normalized();
    Vec3 inwards = without(-outwards, along);
    inwards = without(inwards, head.up).normalized();
    SplitPlanes planes{{molar - options.behind_molar_mm * head.anterior, head.anterior},
                       {go + options.split_depth_mm * inwards, inwards},
                       {go + kMedialCut * (co - go), (go - co).normalized()}};
    if (options.canals.empty()) return planes;
    const NerveCanal* const canal = canal_at(options.canals, head, outwards);
    if (canal == nullptr)
      return fail(ErrorCode::kPlanInvalid, fmt::format("there is no {} canal", words));
    return turned_free(*canal, words, options.canal_clearance_mm, {go, co, head.up}, planes);
  };
  LEFORT_TRY(const SplitPlanes right, side_of("-R", "right", -head.left));
  LEFORT_TRY(const SplitPlanes left, side_of("-L", "left", head.left));
  const auto widened = [&](CutRegion region, int times) {
    for (CutPlane& plane : region.planes) plane.point_L -= times * kStagger_mm * plane.normal_L;
    return region;
  };
  Osteotomy cut;
  const CutPlane ahead_right = right.before_buccal.cut(), ahead_left = left.before_buccal.cut();
  const CutPlane inside_right = right.medial.cut(), inside_left = left.medial.cut();
  const CutPlane below_right = right.below.cut(), below_left = left.below.cut();
  cut.planes = {ahead_right, ahead_left};
  cut.additional_regions = {widened({{ahead_right, inside_left, below_left}, {}}, 1),
                            widened({{inside_right, below_right, ahead_left}, {}}, 2),
                            widened({{inside_right, below_right, inside_left, below_left}, {}}, 3)};
  cut.anchor_points_L = {head.at("Me")};
  return cut;
}

}  // namespace

std::string_view name_of(OsteotomyTemplate kind) {
  for (const auto& [one, name] : kNames)
    if (one == kind) return name;
  return {};
}

std::optional<OsteotomyTemplate> find_template(std::string_view name) {
  for (const auto& [kind, known] : kNames)
    if (known == name) return kind;
  return std::nullopt;
}

Result<Osteotomy> make_osteotomy(OsteotomyTemplate kind, const std::string& segment,
                                 std::span<const Landmark> landmarks,
                                 const TemplateOptions& options) {
  const auto bad = [&](const std::string& what) {
    return fail(ErrorCode::kPlanInvalid,
                fmt::format("template {} of '{}': {}", name_of(kind), segment, what));
  };
  const std::vector<std::string> needed = landmarks_for(kind);
  for (const std::string& name : needed)
    if (!find_landmark(landmarks, name))
      return bad(fmt::format("landmark {} ({}) is missing", name, full_name(name)));
  for (std::size_t i = 0; i < needed.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if ((*find_landmark(landmarks, needed[i]) - *find_landmark(landmarks, needed[j])).norm() <
          1.0)
        return bad(
            fmt::format("landmarks {} and {} are less than 1 mm apart", needed[j], needed[i]));

  const bool is_mandible =
      kind == OsteotomyTemplate::kGenioplasty || kind == OsteotomyTemplate::kSagittalSplit;
  const auto orbitale = pair_midpoint(landmarks, "Or"), porion = pair_midpoint(landmarks, "Po");
  Vec3 backwards, forwards;
  if (kind == OsteotomyTemplate::kLeFort1 || (!is_mandible && !(orbitale && porion))) {
    backwards = *find_landmark(landmarks, "PNS");
    forwards = *find_landmark(landmarks, "ANS");
  } else if (orbitale && porion) {
    backwards = *porion;
    forwards = *orbitale;
  } else {
    backwards = *pair_midpoint(landmarks, "Go");
    forwards = *find_landmark(landmarks, "Me");
  }
  const Result<Head> found = head_along(landmarks, backwards, forwards);
  if (!found) return bad(found.error().message);
  const Head& head = *found;
  Osteotomy cut;
  if (kind == OsteotomyTemplate::kLeFort1) cut = le_fort_1(head, options);
  if (kind == OsteotomyTemplate::kLeFort2) cut = le_fort_2(head, options);
  if (kind == OsteotomyTemplate::kLeFort3) cut = le_fort_3(head, options);
  if (kind == OsteotomyTemplate::kGenioplasty) cut = genioplasty(head, options);
  if (kind == OsteotomyTemplate::kSagittalSplit) {
    Result<Osteotomy> split = sagittal_split(head, options);
    if (!split) return bad(split.error().message);
    cut = *std::move(split);
  }
  if (!is_mandible) cut.anchor_points_L = {head.at("ANS")};
  cut.segment = segment;
  cut.procedure = kind;
  return cut;
}

}  // namespace lefort::plan
