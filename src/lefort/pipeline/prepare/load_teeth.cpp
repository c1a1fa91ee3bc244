#include <lefort/anatomy/find_teeth.h>
#include <lefort/io/segmentation_file.h>
#include <lefort/pipeline/dental/dental_numbers.h>
#include <lefort/pipeline/prepare/load_teeth.h>

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

namespace lefort::pipeline {
namespace {

using Numbers = image::Volume<std::uint8_t>;

constexpr const char* kNeedsMidline =
    "the teeth have no numbers, and the plan has no landmark N, ANS or A to find them from";

/// \returns an error if a map and the labels are not of one segmentation.
Result<void> check_teeth_are_bone(const Numbers& map, const anatomy::LabelMap& labels) {
  constexpr double kMinBone = 0.9;  // Labels may be corrected by hand at the border of a crown.
  Index teeth = 0, bone = 0;
  for (std::size_t v = 0; v < map.values.size(); ++v) {
    if (map.values[v] == 0) continue;
    ++teeth;
    bone += anatomy::is_bone(labels.values[v]) ? 1 : 0;
  }
  if (double(bone) >= kMinBone * double(teeth)) return {};
  return fail(ErrorCode::kPlanInvalid,
              fmt::format("{:.0f} % of their voxels are bone in the labels, expected {:.0f} % or "
                          "more: make both from one segmentation (`lefort segment --labels`)",
                          100.0 * double(bone) / double(teeth), 100.0 * kMinBone));
}

/// The FDI numbers of a map of both jaws.
std::optional<Numbers> numbers_of(anatomy::ToothMap map, const plan::Landmarks& landmarks) {
  auto numbered = dental_numbers(map, landmarks);
  if (!numbered) return std::nullopt;
  return std::move(numbered->numbers);
}

Result<Numbers> read_numbers(const io::PlanFile& plan, const ScannedHead& head,
                             Progress& progress) {
  Result<Numbers> read = io::read_teeth(*plan.teeth, head.labels.grid, progress);
  if (!read && read.error().code == ErrorCode::kFileCorrupt)
    return fail(
        read.error().code,
        fmt::format("{}; make it from this scan (`lefort segment` or `lefort dental teeth`)",
                    read.error().message));
  LEFORT_TRY(Numbers map, std::move(read));
  LEFORT_TRY_VOID(check_teeth_are_bone(map, head.labels));
  const std::uint8_t highest = *std::max_element(map.values.begin(), map.values.end());
  if (highest > std::uint8_t(anatomy::Tooth::kLower)) return map;
  anatomy::ToothMap jaws{map.grid, {}};
  jaws.values.reserve(map.values.size());
  for (const std::uint8_t value : map.values) jaws.values.push_back(anatomy::Tooth(value));
  auto numbers = numbers_of(std::move(jaws), plan.landmarks);
  if (!numbers) return fail(ErrorCode::kPlanInvalid, kNeedsMidline);
  return *std::move(numbers);
}

std::string in_words(const predict::JawTeeth& found) {
  std::string text = fmt::format("interface and lips use {} {}:", found.teeth.size(),
                                 found.teeth.size() == 1 ? "tooth" : "teeth");
  for (const predict::JawTooth& tooth : found.teeth) text += fmt::format(" {}", tooth.fdi);
  return text;
}

}  // namespace

Result<std::optional<predict::JawTeeth>> load_teeth(const io::PlanFile& plan,
                                                    const ScannedHead& head, Progress& progress) {
  using Found = std::optional<predict::JawTeeth>;
  if (plan.teeth_source == io::TeethSource::kNone) return Found();
  progress.begin_stage("find teeth");
  std::optional<Numbers> numbers;
  if (plan.teeth_source == io::TeethSource::kFile) {
    Result<Numbers> read = read_numbers(plan, head, progress);
    if (!read)
      return fail(read.error().code, fmt::format("segmentation.teeth {}: {}", plan.teeth->string(),
                                                 read.error().message));
    numbers = *std::move(read);
  } else if (has_mandible(head.labels)) {
    numbers = numbers_of(anatomy::find_teeth(head.scan.ct, head.labels, head.levels.bone_hu),
                         plan.landmarks);
    if (!numbers) progress.note(fmt::format("interface and lips use no teeth: {}", kNeedsMidline));
    if (!numbers) return Found();
  }
  predict::JawTeeth found;
  if (numbers) found = predict::find_jaw_teeth(*std::move(numbers));
  if (found.teeth.empty()) {
    progress.note("interface and lips use no teeth: none are found in both jaws");
    return Found();
  }
  progress.note(in_words(found));
  return Found(std::move(found));
}

}  // namespace lefort::pipeline
