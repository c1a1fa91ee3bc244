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

/// Which names an array may have.
enum class NameMatch { kWhole, kBeginning };

/// An array that a reader needs. Of several with this name in one piece, the first counts.
struct WantedArray {
  std::string parent;                   ///< The element it stands in: Points, Polys, FieldData, ...
  std::string name;                     ///< Empty for any: then the first of all.
  NameMatch match = NameMatch::kWhole;  ///< kBeginning: all whose names begin so.
};

/// One DataArray element; all numbers as double, which holds every vertex number exactly.
struct XmlArray {
  std::string parent;
  std::string name;
  int piece = 0;  ///< Counted from 1; 0 outside all pieces.
  std::vector<double> values;
};

struct XmlArrays {
  std::vector<XmlArray> arrays;
  int pieces = 0;
};

/// The values of an array, or null if the file has none of that name (empty: any) there.
[[nodiscard]] const std::vector<double>* find_array(const XmlArrays& file, int piece,
                                                    std::string_view parent, std::string_view name);

/// Decodes the arrays of `wanted` and no others: text, base64 or appended, zlib or plain,
/// little-endian.
///
/// \returns kFileCorrupt if the file is no VTK XML file of this type (PolyData, ...), damaged or
///   cut short, or if its arrays share data, are too many or unpack to far more than a surface or
///   mesh of its length does; kFileUnsupported for other compressors and byte orders.
[[nodiscard]] Result<XmlArrays> parse_vtk_xml(std::string_view bytes, const std::string& name,
                                              const std::string& type,
                                              const std::vector<WantedArray>& wanted);

}  // namespace lefort::io::internal
