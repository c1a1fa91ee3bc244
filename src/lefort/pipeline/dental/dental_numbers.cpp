#include <lefort/pipeline/dental/dental_numbers.h>
#include <lefort/pipeline/dental/teeth_file.h>
#include <lefort/plan/head_directions.h>

namespace lefort::pipeline {

std::optional<dental::NumberedTeeth> dental_numbers(const anatomy::ToothMap& teeth,
                                                    std::span<const plan::Landmark> landmarks) {
  const auto directions = plan::head_directions(landmarks);
  if (!directions) return std::nullopt;
  for (const char* const name : {"N", "ANS", "A"})
    if (const auto midline_L = plan::find_landmark(landmarks, name))
      return dental::number_teeth(
          teeth, {directions->left_L, directions->anterior_L, directions->superior_L, *midline_L});
  return std::nullopt;
}

Result<std::optional<dental::NumberedTeeth>> corrected_numbers(
    const anatomy::ToothMap& teeth, std::span<const plan::Landmark> landmarks,
    const std::optional<std::filesystem::path>& corrections) {
  LEFORT_TRY(const auto corrected, read_tooth_corrections(corrections));
  const auto found = dental_numbers(teeth, landmarks);
  if (!found) return std::optional<dental::NumberedTeeth>();
  LEFORT_TRY(dental::NumberedTeeth teeth_found, dental::renumbered(*found, corrected));
  return std::optional(std::move(teeth_found));
}

}  // namespace lefort::pipeline
