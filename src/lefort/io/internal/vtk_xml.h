/// \file
/// Parses the data arrays of untrusted VTK XML files; VTK's own reader crashes on damaged files.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace lefort::io::internal {

/// How the name of an array must match.
enum class NameMatch { kWhole, kBeginning };

/// An array to decode if it exists. If a piece has several of the same name, the first is used.
struct WantedArray {
  std::string parent;                   ///< Its parent element: Points, Polys, FieldData, ...
  std::string name;                     ///< Empty: the first array with any name.
  NameMatch match = NameMatch::kWhole;  ///< kBeginning: all arrays whose names begin with `name`.
};

/// One DataArray element; numbers are stored as double, which represents every vertex number
/// exactly.
struct XmlArray {
  std::string parent;
  std::string name;
  int piece = 0;  ///< Counted from 1; 0 before the first piece.
  std::vector<double> values;
};

struct XmlArrays {
  std::vector<XmlArray> arrays;
  int pieces = 0;
};

/// Returns the values of an array, or null if `parent` has no array of this name (empty: any) in
/// this piece.
[[nodiscard]] const std::vector<double>* find_array(const XmlArrays& file, int piece,
                                                    std::string_view parent, std::string_view name);

/// Reads a file of at most 4 GiB, about ten million elements with a few fields, and decodes the
/// arrays of `wanted` in a child process (run_in_child.h).
///
/// \param file      to read.
/// \param subject   the file in messages, singular.
/// \param type      of the VTK file: PolyData, ...
/// \param wanted    arrays to decode.
/// \param progress  requests to stop.
/// \returns as parse_vtk_xml(); kFileNotFound; or kCancelled.
[[nodiscard]] Result<XmlArrays> read_vtk_xml(const std::filesystem::path& file,
                                             const std::string& subject, const std::string& type,
                                             const std::vector<WantedArray>& wanted,
                                             Progress& progress = Progress::none());

/// Decodes the arrays of `wanted` only: text, base64 or appended, zlib or uncompressed,
/// little-endian.
///
/// \param bytes   of the whole file.
/// \param name    of the file in messages.
/// \param type    of the VTK file: PolyData, ...
/// \param wanted  arrays to decode.
/// \returns the arrays; kFileCorrupt if the file is not a VTK XML file of this type, is damaged or
///   truncated, or its arrays have the same data offset, are too many, or need more memory than 64
///   MiB plus 64 times its size; kFileUnsupported for other compressors and byte orders.
[[nodiscard]] Result<XmlArrays> parse_vtk_xml(std::string_view bytes, const std::string& name,
                                              const std::string& type,
                                              const std::vector<WantedArray>& wanted);

}  // namespace lefort::io::internal
