#include <lefort/pipeline/dental/dental_numbers.h>
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

}  // namespace lefort::pipeline
