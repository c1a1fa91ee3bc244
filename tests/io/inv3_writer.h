/// \file
/// Writes InVesalius projects for tests, byte by byte.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace lefort::test {

/// A member of a tar archive: header block, bytes, padding. Its header may state another size.
inline std::string tar_member(const std::string& name, const std::string& bytes, char type = '0',
                              std::uint64_t claimed_bytes = 0) {
  std::string block(512, '\0');
  const auto put = [&](std::size_t at, const std::string& text) {
    block.replace(at, text.size(), text);
  };
  put(0, name);
  put(100, "0000644");
  put(124, fmt::format("{:011o}", claimed_bytes > 0 ? claimed_bytes : bytes.size()));
  put(136, "00000000000");
  put(156, std::string(1, type));
  put(257, "ustar");
  put(148, "        ");
  unsigned sum = 0;
  for (const char c : block) sum += static_cast<unsigned char>(c);
  put(148, fmt::format("{:06o}", sum));
  block[154] = '\0';
  return block + bytes + std::string((512 - bytes.size() % 512) % 512, '\0');
}

inline void write_gzip(const std::filesystem::path& file, const std::string& bytes) {
  gzFile stream = gzopen(file.c_str(), "wb");
  ASSERT_EQ(gzwrite(stream, bytes.data(), static_cast<unsigned>(bytes.size())),
            static_cast<int>(bytes.size()));
  gzclose(stream);
}

/// Contents of main.plist. The shape is in the order z, y, x, the spacing in the order x, y, z.
struct Inv3Plist {
  std::vector<std::string> shape{"2", "3", "4"};
  std::vector<std::string> spacing{"0.5", "0.75", "2.0"};
  std::string dtype = "int16", filename = "matrix.dat", modality = "CT", orientation = "1";
};

inline std::string to_xml(const Inv3Plist& plist) {
  const auto array = [](const char* type, const std::vector<std::string>& items) {
    std::string xml = "<array>\n";
    for (const std::string& item : items) xml += fmt::format("<{0}>{1}</{0}>\n", type, item);
    return xml + "</array>\n";
  };
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
         "<!DOCTYPE plist PUBLIC \"-//Apple Computer//DTD PLIST 1.0//EN\" "
         "\"http://www.apple.com/DTDs/PropertyList-1.0.dtd\">\n"
         "<plist version=\"1.0\">\n<dict>\n<key>annotations</key>\n<dict>\n</dict>\n"
         "<key>matrix</key>\n<dict>\n<key>dtype</key><string>" +
         plist.dtype + "</string>\n<key>filename</key><string>" + plist.filename +
         "</string>\n<key>shape</key>\n" + array("integer", plist.shape) +
         "</dict>\n<key>modality</key><string>" + plist.modality +
         "</string>\n<key>name</key><string>DOE JANE</string>\n<key>orientation</key><integer>" +
         plist.orientation + "</integer>\n<key>spacing</key>\n" + array("real", plist.spacing) +
         "</dict>\n</plist>\n";
}

inline std::string inv3_archive(const std::string& xml, const std::string& matrix) {
  return tar_member("tmpabc/matrix.dat", matrix) + tar_member("tmpabc/mask_0.dat", "xyz") +
         tar_member("tmpabc/main.plist", xml) + std::string(1024, '\0');
}

/// 4 x 3 x 2 voxels: value 100 k + 10 row + i - 1000, with row 0 posterior.
inline std::string inv3_matrix() {
  std::string bytes;
  for (int k = 0; k < 2; ++k)
    for (int row = 0; row < 3; ++row)
      for (int i = 0; i < 4; ++i) {
        const auto value = static_cast<std::int16_t>(100 * k + 10 * row + i - 1000);
        bytes.append(reinterpret_cast<const char*>(&value), 2);
      }
  return bytes;
}

}  // namespace lefort::test
