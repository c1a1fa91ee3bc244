/// \file
/// Numbers of the teeth of a head whose landmarks are known.
#pragma once

#include <lefort/anatomy/find_teeth.h>
#include <lefort/core/error.h>
#include <lefort/dental/number_teeth.h>
#include <lefort/plan/landmarks.h>

#include <filesystem>
#include <optional>
#include <span>

namespace lefort::pipeline {

/// \returns the numbered teeth; nothing without a landmark of the mid-sagittal plane (N, ANS, A),
///   or if the directions of the head are not known.
[[nodiscard]] std::optional<dental::NumberedTeeth> dental_numbers(
    const anatomy::ToothMap& teeth, std::span<const plan::Landmark> landmarks);

/// As above, with corrected numbers.
///
/// \param corrections  teeth_corrections.json; none: no corrections.
/// \returns the teeth; or the errors of read_tooth_corrections() and dental::renumbered().
[[nodiscard]] Result<std::optional<dental::NumberedTeeth>> corrected_numbers(
    const anatomy::ToothMap& teeth, std::span<const plan::Landmark> landmarks,
    const std::optional<std::filesystem::path>& corrections);

}  // namespace lefort::pipeline
