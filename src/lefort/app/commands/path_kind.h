/// \file
/// Kinds of files and folders on the command line. Help, manual pages, completion in a shell and
/// the description for 3D Slicer are made from them.
#pragma once

#include <CLI/CLI.hpp>

#include <string_view>

namespace lefort::app {

enum class PathKind {
  kScan,          ///< A volume that `lefort import` reads.
  kScanSource,    ///< The same, or an address.
  kSurface,       ///< A triangle mesh.
  kFace,          ///< A triangle mesh, or the folder of a prediction.
  kLandmarks,     ///< Points with names.
  kLabels,        ///< A segmentation.
  kPlan,          ///< A plan.
  kDeck,          ///< A deck.
  kTarget,        ///< Wanted positions of the face.
  kInputs,        ///< Distributions of uncertain inputs.
  kParameters,    ///< Parameter sets.
  kField,         ///< A distance field.
  kPoints,        ///< A table of points.
  kFolder,        ///< A folder that is read.
  kNewVolume,     ///< A volume to write, as are the following.
  kNewField,      ///< A distance field.
  kNewTable,      ///< A table.
  kNewPicture,    ///< A picture.
  kNewExport,     ///< A distance field in the format of another program.
  kNewLandmarks,  ///< Points with names.
  kNewFolder,     ///< A folder.
};

enum class PathForm { kFile, kVolume, kFolder };  ///< A volume is a file that holds an image.

/// What programs must know of a kind.
struct PathTraits {
  PathKind kind;
  std::string_view id;          ///< Unique.
  std::string_view name;        ///< For the value in help texts.
  std::string_view extensions;  ///< With periods, separated by commas; empty: any.
  PathForm form;
  bool is_output;  ///< It is written, not read.
};

/// Marks the values of `option` as paths of a kind.
/// \returns `option`.
CLI::Option* mark_path(CLI::Option* option, PathKind kind);

/// \returns the traits of the kind that mark_path() set; null if there is none.
[[nodiscard]] const PathTraits* path_traits(CLI::Option& option);

}  // namespace lefort::app
