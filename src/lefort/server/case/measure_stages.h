/// \file
/// The stages of teeth and measures: their results and inputs in the folder of a case.
#pragma once

#include <lefort/server/case/case_folder.h>

#include <filesystem>
#include <optional>
#include <string_view>

namespace lefort::server {

/// Whether a stage is one of teeth and measures.
[[nodiscard]] bool is_measure(std::string_view stage);

/// The folder of the results of such a stage.
/// \pre is_measure(stage).
[[nodiscard]] std::filesystem::path folder_of_measure(const CaseFolder& folder,
                                                      std::string_view stage);

/// The file whose existence shows that such a stage is computed.
/// \pre is_measure(stage).
[[nodiscard]] std::filesystem::path document_of_measure(const CaseFolder& folder,
                                                        std::string_view stage);

/// Fingerprints of the inputs of such a stage except the scan. An input that need not exist has an
/// empty one, and so has a result that is out of date.
///
/// \pre is_measure(stage).
/// \returns nothing if an input is missing without which the stage cannot be computed.
[[nodiscard]] std::optional<CaseFolder::Inputs> inputs_of_measure(const CaseFolder& folder,
                                                                  std::string_view stage);

/// The labels, if there are any of the present scan.
[[nodiscard]] std::optional<std::filesystem::path> labels_of_scan(const CaseFolder& folder);

/// The corrected numbers of teeth, if there are any for the present scan.
[[nodiscard]] std::optional<std::filesystem::path> tooth_corrections(const CaseFolder& folder);

/// The corrected points on the canals, if there are any for the present scan.
[[nodiscard]] std::optional<std::filesystem::path> nerve_points(const CaseFolder& folder);

/// Names under which record_scan() stores the scan of corrections.
inline constexpr const char* kToothCorrections = "tooth_corrections";
inline constexpr const char* kNervePoints = "nerve_points";

}  // namespace lefort::server
