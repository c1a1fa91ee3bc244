#include <lefort/plan/landmarks.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace lefort::plan {
namespace {

constexpr std::array<LandmarkKind, 36> kKinds{{
    {"N", "nasion", false, false},
    {"S", "sella", false, false},
    {"Or", "orbitale", false, true},
    {"Po", "porion", false, true},
    {"ANS", "anterior nasal spine", false, false},
    {"PNS", "posterior nasal spine", false, false},
    {"A", "A point", false, false},
    {"B", "B point", false, false},
    {"Pg", "pogonion", false, false},
    {"Gn", "gnathion", false, false},
    {"Me", "menton", false, false},
    {"Go", "gonion", false, true},
    {"Co", "condylion", false, true},
    {"Cdl", "lateral pole of the condyle", false, true},
    {"Cdm", "medial pole of the condyle", false, true},
    {"Ar", "articulare", false, true},
    {"U1", "upper incisor", false, false},
    {"L1", "lower incisor", false, false},
    {"U6", "upper first molar", false, true},
    {"L6", "lower first molar", false, true},
    {"Zy", "zygion", false, true},
    {"FZ", "frontozygomatic point", false, true},
    {"N'", "soft-tissue nasion", true, false},
    {"Prn", "pronasale", true, false},
    {"Sn", "subnasale", true, false},
    {"A'", "soft-tissue A point", true, false},
    {"Ls", "labrale superius", true, false},
    {"Li", "labrale inferius", true, false},
    {"Stm", "stomion", true, false},
    {"B'", "soft-tissue B point", true, false},
    {"Pg'", "soft-tissue pogonion", true, false},
    {"Me'", "soft-tissue menton", true, false},
    {"Ex", "exocanthion", true, true},
    {"En", "endocanthion", true, true},
    {"Al", "alare", true, true},
    {"Ch", "cheilion", true, true},
}};

/// "Or" and "-R" of "Or-R"; no side for other names.
struct NameParts {
  std::string_view stem, side;
};

NameParts split(std::string_view name) {
  const bool has_side = name.ends_with("-R") || name.ends_with("-L");
  if (!has_side) return {name, {}};
  return {name.substr(0, name.size() - 2), name.substr(name.size() - 2)};
}

// Heuristic limits: no head is tilted, and no face asymmetric, by more.
constexpr double kMinCosine = 0.5;        // Of 60 degrees.
constexpr double kBeyondMiddle_mm = 5.0;  // Of a landmark beyond the mid-plane.

/// Both sides of one kind.
struct Pair {
  std::string_view stem;
  Vec3 to_left;  ///< Unit length.
  Vec3 middle_L;
};

std::vector<Pair> pairs_in(std::span<const Landmark> landmarks) {
  std::vector<Pair> pairs;
  for (const Landmark& right : landmarks) {
    const auto [stem, side] = split(right.name);
    if (side != "-R" || landmark_definition(right.name) == nullptr) continue;
    const auto left_L = find_landmark(landmarks, std::string(stem) + "-L");
    if (left_L && (*left_L - right.point_L).norm() > 0.0)
      pairs.push_back(
          {stem, (*left_L - right.point_L).normalized(), 0.5 * (right.point_L + *left_L)});
  }
  return pairs;
}

tl::unexpected<Error> exchanged(std::string_view stem, const char* direction) {
  return fail(
      ErrorCode::kPlanInvalid,
      fmt::format("landmarks {0}-R and {0}-L: the direction from right to left is more than "
                  "60 degrees off {1}; are they exchanged?",
                  stem, direction));
}

/// Checks that each right or left landmark lies on its side of the mid-sagittal plane.
Result<void> check_sides(std::span<const Landmark> landmarks, std::span<const Pair> pairs,
                         const Vec3& left) {
  std::vector<Vec3> middles;
  for (const Pair& pair : pairs) middles.push_back(pair.middle_L);
  for (const Landmark& landmark : landmarks)
    if (const LandmarkKind* const kind = landmark_definition(landmark.name);
        kind && !kind->is_paired)
      middles.push_back(landmark.point_L);
  Vec3 middle_L = Vec3::Zero();
  for (const Vec3& p : middles) middle_L += p / double(middles.size());
  for (const Landmark& landmark : landmarks) {
    const std::string_view side = split(landmark.name).side;
    if (side.empty() || landmark_definition(landmark.name) == nullptr) continue;
    const double to_left_mm = left.dot(landmark.point_L - middle_L);
    if (!((side == "-L" ? -to_left_mm : to_left_mm) <= kBeyondMiddle_mm))
      return fail(
          ErrorCode::kPlanInvalid,
          fmt::format("landmark {} lies {:.1f} mm to the {} of the mid-sagittal plane; is "
                      "the side in its name wrong?",
                      landmark.name, std::abs(to_left_mm), side == "-L" ? "right" : "left"));
  }
  return {};
}

}  // namespace

std::span<const LandmarkKind> landmark_kinds() { return kKinds; }

const LandmarkKind* landmark_definition(std::string_view name) {
  const auto [stem, side] = split(name);
  for (const LandmarkKind& kind : kKinds)
    if (stem == kind.abbreviation && side.empty() != kind.is_paired) return &kind;
  return nullptr;
}

std::string full_name(std::string_view name) {
  const LandmarkKind* const kind = landmark_definition(name);
  if (kind == nullptr) return std::string(name);
  if (!kind->is_paired) return kind->name;
  return std::string(name.ends_with("-R") ? "right " : "left ") + kind->name;
}

std::optional<Vec3> find_landmark(std::span<const Landmark> landmarks, std::string_view name) {
  const auto found = std::find_if(landmarks.begin(), landmarks.end(),
                                  [&](const Landmark& landmark) { return landmark.name == name; });
  if (found == landmarks.end()) return std::nullopt;
  return found->point_L;
}

std::optional<Vec3> pair_midpoint(std::span<const Landmark> landmarks, std::string_view name) {
  if (const auto middle = find_landmark(landmarks, name)) return middle;
  const auto right = find_landmark(landmarks, std::string(name) + "-R");
  const auto left = find_landmark(landmarks, std::string(name) + "-L");
  if (right && left) return Vec3(0.5 * (*right + *left));
  return right ? right : left;
}

Result<Vec3> patient_left_axis(std::span<const Landmark> landmarks) {
  const std::vector<Pair> pairs = pairs_in(landmarks);
  Vec3 sum = Vec3::Zero();
  for (const Pair& pair : pairs) {
    if (!(pair.to_left.x() > kMinCosine)) return exchanged(pair.stem, "the patient's left");
    sum += pair.to_left;
  }
  if (pairs.empty()) return Vec3(Vec3::UnitX());
  const Vec3 left = sum.normalized();
  for (const Pair& pair : pairs)
    if (!(left.dot(pair.to_left) > kMinCosine))
      return exchanged(pair.stem, "the mean direction of all pairs");
  LEFORT_TRY_VOID(check_sides(landmarks, pairs, left));
  return left;
}

std::optional<std::string> first_repeated_name(std::span<const Landmark> landmarks) {
  std::set<std::string_view> seen;
  for (const Landmark& landmark : landmarks)
    if (!seen.insert(landmark.name).second) return landmark.name;
  return std::nullopt;
}

}  // namespace lefort::plan
