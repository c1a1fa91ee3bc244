#include <lefort/io/volume_files.h>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <zlib.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "io/sample_scan.h"
#include "io/volume_bytes.h"
#include "support/temporary_folder.h"

namespace lefort::io::test_volume_headers {
namespace {

using test::kEightVoxels;
using test::kPlacement;
using test::metaimage;
using test::nifti;
using test::nrrd;
using test::put_float;
using test::raw_bytes;
using test::TemporaryFolder;
using test::volume_error_code;
using test::write_bytes;

TEST(VolumeFiles, RejectsNiftiWithAShearedOrStretchedSformOrOtherUnits) {
  const TemporaryFolder folder;
  const std::string upright = nifti(1, {2, 0, 0, 10, 0, 3, 0, 20, 0, 0, 4, 30});
  // The second axis is inclined by 0.3 of its length and has the same length.
  const float along = 0.9F, up = std::sqrt(9.0F - along * along);
  const std::string sheared = nifti(1, {2, along, 0, 10, 0, up, 0, 20, 0, 0, 4, 30});
  EXPECT_EQ(volume_error_code(folder, "a.nii", sheared), ErrorCode::kFileUnsupported);
  EXPECT_EQ(
      volume_error_code(folder, "a.nii", nifti(1, {2.1F, 0, 0, 10, 0, 3, 0, 20, 0, 0, 4, 30})),
      ErrorCode::kFileCorrupt);
  std::string meters = upright;
  meters[123] = 1;
  EXPECT_EQ(volume_error_code(folder, "a.nii", meters), ErrorCode::kFileUnsupported);
  std::string unknown_unit = upright;
  unknown_unit[123] = 0;
  EXPECT_EQ(volume_error_code(folder, "a.nii", unknown_unit), ErrorCode::kNotConverged);
  std::string negative = upright;
  put_float(negative, 84, -3.0F);
  EXPECT_EQ(volume_error_code(folder, "a.nii", negative), ErrorCode::kFileCorrupt);
}

TEST(VolumeFiles, RejectsNiftiWithNonFiniteVoxelsAndCountsThem) {
  const TemporaryFolder folder;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInf = std::numeric_limits<float>::infinity();
  const auto error_message = [&](std::string bytes) {
    write_bytes(folder / "a.nii", bytes);
    const auto result = read_volume(folder / "a.nii");
    return result ? std::string("read") : result.error().message;
  };
  std::string singles = nifti(1, {2, 0, 0, 10, 0, 3, 0, 20, 0, 0, 4, 30}).substr(0, 352);
  std::string doubles = singles;
  singles[70] = 16, singles[72] = 32;  // Type and bits.
  doubles[70] = 64, doubles[72] = 64;
  for (const float value : {-100.0F, kNan, 40.0F, kInf, -kInf, 3e38F, 0.0F, -0.0F}) {
    singles.append(reinterpret_cast<const char*>(&value), 4);
    const auto wide = static_cast<double>(value);
    doubles.append(reinterpret_cast<const char*>(&wide), 8);
  }
  EXPECT_NE(error_message(singles).find("3 of 8 voxels"), std::string::npos)
      << error_message(singles);
  EXPECT_NE(error_message(doubles).find("3 of 8 voxels"), std::string::npos)
      << error_message(doubles);
  const image::ScalarVolume volume{{.size = {3, 1, 1}}, {-100, kNan, 40}};
  EXPECT_EQ(write_volume(folder / "b.nii.gz", volume).error().code, ErrorCode::kFileUnwritable);
}

TEST(VolumeFiles, RejectsNrrdInOtherUnitsOrWithoutDirections) {
  const TemporaryFolder folder;
  const std::string axes =
      "space: left-posterior-superior\nspace directions: (2,0,0) (0,3,0) (0,0,4)\n"
      "space origin: (10,20,30)";
  const auto read = [&](const std::string& fields) {
    return volume_error_code(folder, "a.nrrd", nrrd(fields));
  };
  EXPECT_EQ(read(axes), ErrorCode::kNotConverged);
  EXPECT_EQ(read(axes + "\nspace units: \"mm\" \"mm\" \"mm\""), ErrorCode::kNotConverged);
  EXPECT_EQ(read(axes + "\nspace units: \"m\" \"m\" \"m\""), ErrorCode::kFileUnsupported);
  EXPECT_EQ(read(axes + "\nspace units: \"mm\" \"mm\" \"um\""), ErrorCode::kFileUnsupported);
  EXPECT_EQ(read("space: left-posterior-superior"), ErrorCode::kFileUnsupported);
}

/// Returns `bytes` as a zlib stream.
std::string zlib_stream(const std::string& bytes) {
  std::string packed(1000, 'x');
  uLongf length = packed.size();
  EXPECT_EQ(compress(reinterpret_cast<Bytef*>(packed.data()), &length,
                     reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()),
            Z_OK);
  packed.resize(length);
  return packed;
}

TEST(VolumeFiles, InterpretsMetaImageAsItkDoes) {
  const TemporaryFolder folder;
  const std::string voxels = raw_bytes(kEightVoxels);
  const std::string lines = "BinaryData = True\n" + kPlacement;
  // Every word with the first letter t is true; a padded short stream must not be read as plain
  // voxels.
  for (const char* const yes : {"True", "TRUE", "true", "T", "1"}) {
    const auto packed = [&](const std::string& stream) {
      return metaimage(fmt::format("{}CompressedData = {}\nCompressedDataSize = {}\n", lines, yes,
                                   stream.size()),
                       stream);
    };
    for (const std::string& stream :
         {zlib_stream(voxels.substr(0, 6)) + voxels, zlib_stream(voxels) + "xx"})
      EXPECT_EQ(volume_error_code(folder, "a.mha", packed(stream)), ErrorCode::kFileCorrupt) << yes;
    write_bytes(folder / "a.mha", packed(zlib_stream(voxels)));
    write_bytes(folder / "a.zraw", zlib_stream(voxels));
    const std::string no_size = fmt::format("{}CompressedData = {}\n", lines, yes);
    write_bytes(folder / "a.mhd", metaimage(no_size, "", "a.zraw"));
    for (const char* const name : {"a.mha", "a.mhd"}) {
      const auto found = read_volume(folder / name);
      ASSERT_TRUE(found) << yes << ": " << found.error().message;
      EXPECT_EQ(found->ct.values, kEightVoxels) << name;
    }
    EXPECT_EQ(volume_error_code(folder, "a.mha", metaimage(no_size, zlib_stream(voxels))),
              ErrorCode::kFileUnsupported);
  }
  EXPECT_EQ(volume_error_code(folder, "a.mha",
                              metaimage("BinaryData = False\n" + kPlacement, "1 2 3 4 5 6 7 8")),
            ErrorCode::kFileUnsupported);
  EXPECT_EQ(volume_error_code(folder, "a.mha", metaimage(lines + "HeaderSize = -1\n", voxels)),
            ErrorCode::kFileUnsupported);
  EXPECT_EQ(volume_error_code(folder, "a.mha", metaimage(lines + "HeaderSize = 4\n", voxels)),
            ErrorCode::kFileUnsupported);
}

TEST(VolumeFiles, SkipsTheHeaderOfDetachedVoxels) {
  const TemporaryFolder folder;
  const std::string header =
      metaimage("BinaryData = True\nHeaderSize = 5\n" + kPlacement, "", "a.raw");
  write_bytes(folder / "a.raw", "12345" + raw_bytes(kEightVoxels));
  write_bytes(folder / "a.mhd", header);
  const auto found = read_volume(folder / "a.mhd");
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->ct.values, kEightVoxels);
  write_bytes(folder / "a.raw", "12345" + raw_bytes(kEightVoxels).substr(1));
  EXPECT_EQ(volume_error_code(folder, "a.mhd", header), ErrorCode::kFileCorrupt);
}

TEST(VolumeFiles, RejectsTwoAndFourDimensionsAndVectors) {
  const TemporaryFolder folder;
  const auto error_message = [&](const char* name, const std::string& bytes) {
    write_bytes(folder / name, bytes);
    const auto result = read_volume(folder / name);
    if (result) return std::string("read");
    EXPECT_EQ(result.error().code, ErrorCode::kFileUnsupported) << result.error().message;
    test::expect_one_sentence(result.error().message);
    return result.error().message;
  };
  const std::string head = "NRRD0004\ntype: short\nendian: little\nencoding: raw\n";
  const std::string voxels(64, '\1');
  EXPECT_NE(error_message("flat.nrrd", head + "dimension: 2\nsizes: 4 8\n\n" + voxels)
                .find("2 dimensions"),
            std::string::npos);
  EXPECT_NE(error_message("film.nrrd", head + "dimension: 4\nsizes: 2 2 2 4\n\n" + voxels)
                .find("4 dimensions"),
            std::string::npos);
  EXPECT_NE(error_message("vectors.nrrd",
                          head +
                              "dimension: 4\nsizes: 4 2 2 2\nkinds: vector domain domain domain\n"
                              "space: left-posterior-superior\n"
                              "space directions: none (1,0,0) (0,1,0) (0,0,1)\n\n" +
                              voxels)
                .find("4 values"),
            std::string::npos);
}

TEST(VolumeFiles, RejectsInvalidGrids) {
  const TemporaryFolder folder;
  const std::string lps =
      "space: left-posterior-superior\nspace origin: (0,0,0)\nspace directions: ";
  for (const char* const axes :
       {"(nan,0,0) (0,3,0) (0,0,4)", "(0,0,0) (0,3,0) (0,0,4)", "(1,0,0) (1,0,0) (0,0,4)",
        "(1,0,0) (0.5,1,0) (0,0,4)", "(inf,0,0) (0,1,0) (0,0,1)"}) {
    write_bytes(folder / "a.nrrd", nrrd(lps + axes));
    const auto result = read_volume(folder / "a.nrrd");
    ASSERT_FALSE(result) << axes;
    EXPECT_EQ(result.error().code, ErrorCode::kFileCorrupt) << axes;
    test::expect_one_sentence(result.error().message);
  }
}

TEST(VolumeFiles, RejectsAHugeSizeWithoutAllocating) {
  const TemporaryFolder folder;
  for (const char* const sizes : {"1200 1200 1200", "2000000 2000000 2000000",
                                  "4294967296 4294967296 4294967296", "-1 2 2", "0 2 2"}) {
    write_bytes(folder / "a.nrrd",
                std::string("NRRD0004\ntype: short\ndimension: 3\nsizes: ") + sizes +
                    "\nendian: little\nencoding: raw\nspace: left-posterior-superior\n"
                    "space directions: (1,0,0) (0,1,0) (0,0,1)\n\nxxxx");
    const auto result = read_volume(folder / "a.nrrd");
    ASSERT_FALSE(result) << sizes;
    EXPECT_EQ(result.error().code, ErrorCode::kFileCorrupt) << result.error().message;
  }
}

TEST(VolumeFiles, ReadsAHeaderWithDetachedVoxels) {
  const TemporaryFolder folder;
  write_bytes(folder / "a.nhdr",
              "NRRD0004\ntype: short\ndimension: 3\nsizes: 2 2 2\nendian: little\nencoding: raw\n"
              "space: left-posterior-superior\nspace directions: (2,0,0) (0,3,0) (0,0,4)\n"
              "space origin: (10,20,30)\ndata file: a.raw\n");
  write_bytes(folder / "a.raw", raw_bytes(kEightVoxels));
  const auto found = read_volume(folder / "a.nhdr");
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->ct.values, kEightVoxels);
  std::filesystem::remove(folder / "a.raw");
  EXPECT_EQ(read_volume(folder / "a.nhdr").error().code, ErrorCode::kFileCorrupt);
}

/// Returns headers that name `where` as their voxel file.
std::vector<std::pair<const char*, std::string>> headers_with_voxels_in(const std::string& where) {
  const std::string fields =
      "space: left-posterior-superior\nspace directions: (2,0,0) (0,3,0) (0,0,4)\n"
      "space origin: (10,20,30)\n";
  const std::string nhdr =
      "NRRD0004\ntype: short\ndimension: 3\nsizes: 2 2 2\nendian: little\nencoding: raw\n" + fields;
  return {{"a.nhdr", nhdr + "data file: " + where + "\n"},
          {"b.nhdr", nhdr + "datafile: " + where + "\n"},
          {"c.nrrd", nhdr + "Data File: " + where + "\n\n"},
          {"a.mhd", metaimage("BinaryData = True\n" + kPlacement, "", where)},
          {"b.mha", metaimage("BinaryData = True\n" + kPlacement, "", where)}};
}

TEST(VolumeFiles, ReadsVoxelsOnlyFromARegularFileInTheSameFolder) {
  const TemporaryFolder folder;
  const std::string voxels = raw_bytes(kEightVoxels);
  std::filesystem::create_directory(folder / "sub");
  write_bytes(folder / "a.raw", voxels);
  write_bytes(folder / "sub/a.raw", voxels);
  std::filesystem::create_symlink(folder / "a.raw", folder / "link.raw");
  std::filesystem::create_directory(folder / "folder.raw");
  ASSERT_EQ(::mkfifo((folder / "pipe.raw").c_str(), 0600), 0);  // Opening it would block.
  for (const auto& [name, bytes] : headers_with_voxels_in("a.raw"))
    EXPECT_EQ(volume_error_code(folder, name, bytes), ErrorCode::kNotConverged) << name;
  for (const std::string& where :
       {std::string("/etc/passwd"), (folder / "a.raw").string(), std::string("sub/a.raw"),
        std::string("../a.raw"), std::string(".."), std::string("LIST"),
        std::string("%d.raw 1 1 1")})
    for (const auto& [name, bytes] : headers_with_voxels_in(where))
      EXPECT_EQ(volume_error_code(folder, name, bytes), ErrorCode::kFileUnsupported)
          << name << where;
  for (const char* const where : {"pipe.raw", "link.raw", "folder.raw", "none.raw"})
    for (const auto& [name, bytes] : headers_with_voxels_in(where))
      EXPECT_EQ(volume_error_code(folder, name, bytes), ErrorCode::kFileCorrupt) << name << where;
  write_bytes(folder / "a.raw", voxels.substr(1));
  for (const auto& [name, bytes] : headers_with_voxels_in("a.raw"))
    EXPECT_EQ(volume_error_code(folder, name, bytes), ErrorCode::kFileCorrupt) << name;
}

}  // namespace
}  // namespace lefort::io::test_volume_headers
