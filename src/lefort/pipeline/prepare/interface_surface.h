/// \file
/// The interface map as a surface file, for display.
#pragma once

#include <lefort/core/error.h>
#include <lefort/predict/face_model.h>

#include <filesystem>

namespace lefort::pipeline {

/// File of write_interface_surface() in the folder of a preview or prediction.
inline constexpr const char* kInterfaceFile = "interface.vtp";

/// Point data of kInterfaceFile: values of predict::InterfaceCondition and predict::InterfaceRule.
inline constexpr const char* kConditionArray = "condition";
inline constexpr const char* kRuleArray = "rule";

/// Writes the boundary of the tissue in the reference configuration, with condition and rule of
/// each vertex.
///
/// \param file   ending in .vtp.
/// \param model  triangles are counter-clockwise seen from outside the tissue.
/// \returns nothing, or kFileUnwritable.
[[nodiscard]] Result<void> write_interface_surface(const std::filesystem::path& file,
                                                   const predict::FaceModel& model);

}  // namespace lefort::pipeline
