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
  std::filesystem::path surface;  ///< .stl, .vtp, .ply or .obj [mm].
  std::filesystem::path output;   ///< .field.
  field::DistanceFieldOptions options;
};

/// Computes the distance field of a surface and writes it.
///
/// \returns the summary, or
///   - kFileNotFound, kFileUnsupported, kFileCorrupt  from io::read_surface();
///   - kMeshInvalid      the surface is empty, not finite, without extent, or too large;
///   - kInvalidArgument  an option is out of range, the field would be too large, or the output
///     does not end in .field;
///   - kFileUnwritable   the field cannot be written;
///   - kCancelled        `progress` requested a stop.
[[nodiscard]] Result<Summary> build_field(const BuildFieldJob& job, Progress& progress);

struct QueryFieldJob {
  std::filesystem::path field;
  /// Text, one point per line: x, y, z [mm] in frame B, separated by commas or spaces.
  std::filesystem::path points;
  std::filesystem::path output;  ///< CSV.
  bool smooth = false;           ///< Smooth interpolation.
};

/// Writes the signed distance [mm] (negative inside), its gradient and the zone of each point.
///
/// \returns the summary, or
///   - kFileNotFound     the field or the table of points does not exist;
///   - kFileUnsupported  the field is not one, or has another version;
///   - kFileCorrupt      the field is damaged, or a line of the table is not three numbers;
///   - kInvalidArgument  `smooth` is set, and the field was built without it;
///   - kFileUnwritable   the output cannot be written.
[[nodiscard]] Result<Summary> query_field(const QueryFieldJob& job, Progress& progress);

struct ExportFieldJob {
  std::filesystem::path field;
  std::filesystem::path output;   ///< .vdb or .nrrd.
  std::vector<double> region_mm;  ///< Empty, or six limits: from and to along x, y and z.
  int every = 1;                  ///< Every n-th sample along each axis.
};

/// Writes a field in a format that other programs read.
///
/// \returns the summary, or
///   - kFileNotFound, kFileUnsupported, kFileCorrupt  from io::read_field();
///   - kInvalidArgument  the region is not six ascending limits or contains no sample, or as
///     io::export_field();
///   - kOutOfMemory, kFileUnwritable, kCancelled  from io::export_field().
[[nodiscard]] Result<Summary> export_field(const ExportFieldJob& job, Progress& progress);

struct SliceFieldJob {
  std::filesystem::path field;
  std::filesystem::path output;               ///< .png.
  int axis = 2;                               ///< Normal of the plane: 0 x, 1 y, 2 z.
  double at_mm = 0.0;                         ///< Coordinate of the plane along its normal.
  int width_px = 1200;                        ///< Width of the picture; > 0.
  std::optional<int> every;                   ///< Instead of width_px: cells per pixel.
  std::vector<double> region_mm;              ///< As ExportFieldJob::region_mm.
  std::optional<std::filesystem::path> mesh;  ///< Surface whose section is drawn.
  bool smooth = false;                        ///< Smooth interpolation.
};

/// Draws a plane through a field.
///
/// \returns the summary, or
///   - kFileNotFound, kFileUnsupported, kFileCorrupt  from io::read_field() and io::read_surface();
///   - kMeshInvalid      `mesh` has no triangle;
///   - kInvalidArgument  the output does not end in .png; the region is not six ascending limits;
///     plane or region do not intersect the field; the picture would be too large; or `smooth` is
///     set, and the field was built without it;
///   - kFileUnwritable   the picture cannot be written.
[[nodiscard]] Result<Summary> slice_field(const SliceFieldJob& job, Progress& progress);

/// Reads a field, verifies its checksum, and counts its samples.
///
/// \returns storage, size and counts of samples by zone, or
///   - kFileNotFound, kFileUnsupported, kFileCorrupt  from io::read_field();
///   - kCancelled  `progress` requested a stop.
[[nodiscard]] Result<Summary> describe_field(const std::filesystem::path& field,
                                             Progress& progress);

}  // namespace lefort::pipeline
