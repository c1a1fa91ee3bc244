#include <lefort/plan/landmarks.h>

#include <algorithm>
#include <array>
#include <set>

namespace lefort::plan {
namespace {

constexpr std::array<LandmarkKind, 32> kKinds{{
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
    {"Ls", "labrale superius", true, false},
    {"Li", "labrale inferius", true, false},
    {"Stm", "stomion", true, false},
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

}  // namespace

std::span<const LandmarkKind> landmark_kinds() { return kKinds; }

const LandmarkKind* find_kind(std::string_view name) {
  const auto [stem, side] = split(name);
  for (const LandmarkKind& kind : kKinds)
    if (stem == kind.abbreviation && side.empty() != kind.is_paired) return &kind;
  return nullptr;
}

std::string full_name(std::string_view name) {
  const LandmarkKind* const kind = find_kind(name);
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

std::optional<Vec3> find_middle(std::span<const Landmark> landmarks, std::string_view name) {
  if (const auto middle = find_landmark(landmarks, name)) return middle;
  const auto right = find_landmark(landmarks, std::string(name) + "-R");
  const auto left = find_landmark(landmarks, std::string(name) + "-L");
  if (right && left) return Vec3(0.5 * (*right + *left));
  return right ? right : left;
}

Vec3 left_of(std::span<const Landmark> landmarks) {
  Vec3 sum = Vec3::Zero();
  for (const Landmark& right : landmarks) {
    const auto [stem, side] = split(right.name);
    if (side != "-R") continue;
    const auto left = find_landmark(landmarks, std::string(stem) + "-L");
    if (left && (*left - right.point_L).norm() > 0.0) sum += (*left - right.point_L).normalized();
  }
  return sum.norm() > 0.0 ? Vec3(sum.normalized()) : Vec3(Vec3::UnitX());
}

std::optional<std::string> first_repeated_name(std::span<const Landmark> landmarks) {
  std::set<std::string_view> seen;
  for (const Landmark& landmark : landmarks)
    if (!seen.insert(landmark.name).second) return landmark.name;
  return std::nullopt;
}

}  // namespace lefort::plan
