/// \file
/// Distance fields: build, query, export, slice, describe.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/field/build/build_distance_field.h>
#include <lefort/pipeline/summary.h>

#include <filesystem>
#include <optional>
#include <vector>

namespace lefort::pipeline {

struct BuildFieldJob {
  std::filesystem::path surface;
  std::filesystem::path output;
  field::DistanceFieldOptions options;
};

/// Computes the distance field of a surface and writes it.
[[nodiscard]] Result<Summary> build_field(const BuildFieldJob& job, Progress& progress);

struct QueryFieldJob {
  std::filesystem::path field;
  std::filesystem::path points;  ///< Text: x, y, z in mm a line, separated by commas or spaces.
  std::filesystem::path output;  ///< CSV.
  bool smooth = false;           ///< Smooth interpolation.
};

/// Writes distance [mm], gradient and zone of each point.
[[nodiscard]] Result<Summary> query_field(const QueryFieldJob& job, Progress& progress);

struct ExportFieldJob {
  std::filesystem::path field;
  std::filesystem::path output;   ///< .vdb or .nrrd.
  std::vector<double> region_mm;  ///< Empty, or from and to along x, y and z.
  int every = 1;                  ///< Every n-th sample along each axis.
};

/// Writes a field in a format that other programs read.
[[nodiscard]] Result<Summary> export_field(const ExportFieldJob& job, Progress& progress);

struct SliceFieldJob {
  std::filesystem::path field;
  std::filesystem::path output;               ///< .png.
  int axis = 2;                               ///< Across the plane: 0 x, 1 y, 2 z.
  double at_mm = 0.0;                         ///< Coordinate of the plane on this axis.
  int width_px = 1200;                        ///< Pixels across the plane.
  std::optional<int> every;                   ///< Instead of width_px: cells per pixel.
  std::vector<double> region_mm;              ///< Empty, or from and to along x, y and z.
  std::optional<std::filesystem::path> mesh;  ///< Surface whose section is drawn.
  bool smooth = false;                        ///< Smooth interpolation.
};

/// Draws a plane through a field.
[[nodiscard]] Result<Summary> slice_field(const SliceFieldJob& job, Progress& progress);

/// \returns the storage, size and checksum of a field; or what io::read_field() returns.
[[nodiscard]] Result<Summary> describe_field(const std::filesystem::path& field,
                                             Progress& progress);

}  // namespace lefort::pipeline
