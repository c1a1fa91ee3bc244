/// \file
/// The data arrays of a VTK XML file, decoded without trust: VTK's own reader crashes on damaged
/// files.
#pragma once

#include <lefort/core/error.h>

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace lefort::io::internal {

/// One DataArray element; all numbers as double, which holds every vertex number exactly.
struct XmlArray {
  std::string parent;  ///< The element it stands in: Points, Polys, FieldData, ...
  std::string name;
  int piece = 0;  ///< Counted from 1; 0 outside all pieces.
  std::vector<double> values;
};

struct XmlArrays {
  std::vector<XmlArray> arrays;
  int pieces = 0;
};

/// Decodes the arrays that stand in an element of `wanted_parents`: text, base64 or appended, zlib
/// or plain, little-endian.
///
/// \returns kFileCorrupt if the file is no VTK XML file of this type (PolyData, ...), damaged or
///   cut short; kFileUnsupported for other compressors and byte orders.
[[nodiscard]] Result<XmlArrays> parse_vtk_xml(std::string_view bytes, const std::string& name,
                                              const std::string& type,
                                              const std::vector<std::string>& wanted_parents);

}  // namespace lefort::io::internal
