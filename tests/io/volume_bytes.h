/// \file
/// NRRD, NIfTI and MetaImage files in bytes, for tests.
#pragma once

#include <lefort/io/volume_files.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "io/sample_scan.h"
#include "support/temporary_folder.h"

namespace lefort::test {

inline std::string raw_bytes(const std::vector<std::int16_t>& values) {
  std::string bytes(values.size() * 2, '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

// Written byte by byte according to the definitions of the formats, independently of ITK. Voxel
// (0, 0, 0) is the brightest.
inline const std::vector<std::int16_t> kEightVoxels{1000, 1, 2, 3, 4, 5, 6, -1000};

inline std::string nrrd(const std::string& fields) {
  return "NRRD0004\ntype: short\ndimension: 3\nsizes: 2 2 2\nendian: little\nencoding: raw\n" +
         fields + "\n\n" + raw_bytes(kEightVoxels);
}

/// Returns a NIfTI-1 file with an sform, in RAS, according to its definition.
inline std::string nifti(std::int16_t sform_code, const std::array<float, 12>& sform,
                         std::int16_t dimensions = 3) {
  std::string bytes(352, '\0');
  const auto put = [&](std::size_t at, auto value) {
    std::memcpy(bytes.data() + at, &value, sizeof value);
  };
  put(0, std::int32_t{348});
  put(40, dimensions);
  for (std::size_t d = 0; d < 7; ++d)
    put(42 + 2 * d, std::int16_t{d < 3 ? std::int16_t{2} : std::int16_t{1}});
  put(70, std::int16_t{4});   // signed short
  put(72, std::int16_t{16});  // bits
  for (std::size_t d = 0; d < 4; ++d) put(76 + 4 * d, 1.0F + static_cast<float>(d));
  put(80, 2.0F), put(84, 3.0F), put(88, 4.0F);
  put(108, 352.0F);          // offset of the voxels
  put(123, std::int8_t{2});  // mm
  put(254, sform_code);
  for (std::size_t n = 0; n < 12; ++n) put(280 + 4 * n, sform[n]);
  std::memcpy(bytes.data() + 344, "n+1", 4);
  return bytes + raw_bytes(kEightVoxels);
}

/// Returns a MetaImage with these lines in addition to the common ones.
inline std::string metaimage(const std::string& lines, const std::string& voxels,
                             const std::string& where = "LOCAL") {
  return "ObjectType = Image\nNDims = 3\nBinaryDataByteOrderMSB = False\nDimSize = 2 2 2\n"
         "ElementType = MET_SHORT\n" +
         lines + "ElementDataFile = " + where + "\n" + voxels;
}

inline const std::string kPlacement =
    "TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 10 20 30\nElementSpacing = 2 3 4\n";

/// Returns the error code of reading `bytes` as a file named `name`; kNotConverged if there is no
/// error.
inline ErrorCode volume_error_code(const TemporaryFolder& folder, const char* name,
                                   const std::string& bytes) {
  write_bytes(folder / name, bytes);
  const auto result = io::read_volume(folder / name);
  if (result) return ErrorCode::kNotConverged;
  expect_one_sentence(result.error().message);
  return result.error().code;
}

inline void put_float(std::string& bytes, std::size_t at, float value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

}  // namespace lefort::test
