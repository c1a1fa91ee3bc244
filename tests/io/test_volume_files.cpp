#include <lefort/io/volume_files.h>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <zlib.h>

#include <cmath>
#include <csignal>
#include <cstring>
#include <limits>

#include "io/sample_scan.h"
#include "support/temporary_folder.h"

namespace lefort::io {
namespace {

using test::bytes_of;
using test::expect_same_grid;
using test::expect_same_in_patient;
using test::oblique;
using test::sample_scan;
using test::TemporaryFolder;
using test::write_bytes;

std::string raw_bytes(const std::vector<std::int16_t>& values) {
  std::string bytes(values.size() * 2, '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

class EveryFormat : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(VolumeFiles, EveryFormat,
                         ::testing::Values("a.nrrd", "a.nii.gz", "a.nii", "a.mha"),
                         [](const auto& format) {
                           std::string name = format.param;
                           std::erase(name, '.');
                           return name;
                         });

TEST_P(EveryFormat, GivesBackAnObliqueScanAsItWas) {
  const TemporaryFolder folder;
  const auto ct = sample_scan(oblique());
  ASSERT_TRUE(write_volume(folder / GetParam(), ct));
  EXPECT_EQ(folder.entry_count(), 1);
  const auto found = read_volume(folder / GetParam());
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->ct.values, ct.values);
  // NIfTI stores the place as 32-bit floats; the texts of the others are rounded less.
  expect_same_grid(found->ct.grid, ct.grid, 2e-6);
  EXPECT_TRUE(found->warnings.empty());
}

TEST_P(EveryFormat, EqualVolumesGiveEqualBytes) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_volume(folder / GetParam(), sample_scan(oblique())));
  const std::string first = bytes_of(folder / GetParam());
  ASSERT_TRUE(write_volume(folder / GetParam(), sample_scan(oblique())));
  EXPECT_EQ(bytes_of(folder / GetParam()), first);
}

TEST_P(EveryFormat, KeepsTheFractionsOfAScalarVolume) {
  const TemporaryFolder folder;
  const image::ScalarVolume volume{{.size = {1, 2, 3}}, {0.25F, -7.75F, 0.0F, 3.0F, 4.0F, -900.4F}};
  ASSERT_TRUE(write_volume(folder / GetParam(), volume));
  const auto found = read_volume(folder / GetParam());
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->ct.values, (std::vector<std::int16_t>{0, -8, 0, 3, 4, -900}));
}

TEST_P(EveryFormat, BringsWhatNoCtHoldsIntoRangeAndSaysSo) {
  const TemporaryFolder folder;
  // NIfTI's library makes 0 of what is not finite, so we refuse it: see below.
  const bool keeps_nan = std::string(GetParam()).find(".nii") == std::string::npos;
  const float nan = keeps_nan ? std::numeric_limits<float>::quiet_NaN() : -9999.0F;
  const float inf = keeps_nan ? std::numeric_limits<float>::infinity() : 9999.0F;
  const image::ScalarVolume volume{
      {.size = {3, 2, 2}}, {nan, inf, -inf, 1e30F, -3024.0F, 3071.0F, -1024.0F, 0, 0, nan, 0, 0}};
  ASSERT_TRUE(write_volume(folder / GetParam(), volume));
  const auto found = read_volume(folder / GetParam());
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->ct.values, (std::vector<std::int16_t>{-1024, 3071, -1024, 3071, -1024, 3071,
                                                         -1024, 0, 0, -1024, 0, 0}));
  ASSERT_EQ(found->warnings.size(), keeps_nan ? 2U : 1U);
  EXPECT_EQ(found->warnings[0].substr(0, 14), keeps_nan ? "4 of 12 voxels" : "6 of 12 voxels");
  if (keeps_nan) {
    EXPECT_EQ(found->warnings[1].substr(0, 14), "2 of 12 voxels");
  }
}

TEST_P(EveryFormat, RefusesAnUnwritableFolderAndLeavesNothing) {
  const auto lost = write_volume(std::filesystem::path("/nonexistent") / GetParam(), sample_scan());
  EXPECT_EQ(lost.error().code, ErrorCode::kFileUnwritable);
}

/// While it lives, files cannot grow beyond 100 bytes, as on a full disk.
class FullDisk {
 public:
  FullDisk() : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit full{100, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &full);
  }
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  void (*handler_)(int);
  rlimit before_{};
};

TEST_P(EveryFormat, AFullDiskIsAnErrorAndLeavesNothing) {
  const TemporaryFolder folder;
  const auto scan = sample_scan();
  const auto lost = [&] {
    const FullDisk full;
    return write_volume(folder / GetParam(), scan);
  }();
  ASSERT_FALSE(lost);
  EXPECT_EQ(lost.error().code, ErrorCode::kFileUnwritable);
  test::expect_one_sentence(lost.error().message);
  EXPECT_EQ(folder.entry_count(), 0);
}

TEST(VolumeFiles, WarnsOfValuesThatCanHardlyBeHounsfieldUnits) {
  const TemporaryFolder folder;
  auto ct = sample_scan();
  for (auto& value : ct.values) value = static_cast<std::int16_t>(value + 1024);
  ASSERT_TRUE(write_volume(folder / "a.nrrd", ct));
  const auto found = read_volume(folder / "a.nrrd");
  ASSERT_EQ(found->warnings.size(), 1U);
  EXPECT_NE(found->warnings[0].find("may not be in HU"), std::string::npos);
}

TEST(VolumeFiles, WarnsOfAFieldOfViewThatCutsThePatientOff) {
  const TemporaryFolder folder;
  image::CtVolume ct{{.size = {40, 40, 4}}, {}};
  ct.values.assign(40 * 40 * 4, -1000);
  for (Index k = 0; k < 4; ++k)
    for (Index j = 10; j < 30; ++j)
      for (Index i = 10; i < 30; ++i) ct.at(i, j, k) = 40;
  ASSERT_TRUE(write_volume(folder / "a.nrrd", ct));
  const auto cut = read_volume(folder / "a.nrrd");
  ASSERT_EQ(cut->warnings.size(), 1U);
  EXPECT_NE(cut->warnings[0].find("ends in tissue over 3.2 cm2"), std::string::npos)
      << cut->warnings[0];
  for (Index k = 0; k < 4; ++k)  // With the half air, half tissue that skin has.
    for (Index n = 9; n < 31; ++n)
      for (const Index side : {9, 30}) ct.at(n, side, k) = ct.at(side, n, k) = -480;
  ASSERT_TRUE(write_volume(folder / "a.nrrd", ct));
  EXPECT_TRUE(read_volume(folder / "a.nrrd")->warnings.empty());
}

// The files below are written byte by byte, after the formats' own definitions, so that a mistake
// common to ITK's readers and writers would show. Voxel (0, 0, 0) is the brightest.
const std::vector<std::int16_t> kEightVoxels{1000, 1, 2, 3, 4, 5, 6, -1000};

/// Where the brightest voxel of a 2 x 2 x 2 volume lies.
Vec3 brightest_L(const image::CtVolume& ct) {
  for (Index n = 0; n < 8; ++n)
    if (ct.values[std::size_t(n)] == 1000)
      return ct.grid.point_L(Vec3(double(n & 1), double((n >> 1) & 1), double(n >> 2)));
  return Vec3::Constant(std::nan(""));
}

std::string nrrd(const std::string& fields) {
  return "NRRD0004\ntype: short\ndimension: 3\nsizes: 2 2 2\nendian: little\nencoding: raw\n" +
         fields + "\n\n" + raw_bytes(kEightVoxels);
}

TEST(Laterality, NrrdInLpsRasAndLas) {
  const TemporaryFolder folder;
  const std::string axes = "\nspace directions: (2,0,0) (0,3,0) (0,0,4)\nspace origin: (10,20,30)";
  const auto read = [&](const std::string& space) {
    write_bytes(folder / "a.nrrd", nrrd("space: " + space + axes));
    const auto found = read_volume(folder / "a.nrrd");
    EXPECT_TRUE(found) << found.error().message;
    EXPECT_EQ(found->ct.grid.spacing_mm, Vec3(2, 3, 4));
    EXPECT_GT(found->ct.grid.direction.determinant(), 0.0);
    return found->ct;
  };
  EXPECT_EQ(brightest_L(read("left-posterior-superior")), Vec3(10, 20, 30));
  EXPECT_EQ(brightest_L(read("right-anterior-superior")), Vec3(-10, -20, 30));
  EXPECT_EQ(brightest_L(read("RAS")), Vec3(-10, -20, 30));
}

TEST(Laterality, NrrdSpacesThatItkMirrorsAreRefused) {
  const TemporaryFolder folder;
  for (const char* const space :
       {"left-anterior-superior", "LAS", "scanner-xyz", "3D-left-handed"}) {
    write_bytes(folder / "a.nrrd",
                nrrd(std::string("space: ") + space +
                     "\nspace directions: (2,0,0) (0,3,0) (0,0,4)\nspace origin: (10,20,30)"));
    const auto refused = read_volume(folder / "a.nrrd");
    ASSERT_FALSE(refused) << space;
    EXPECT_EQ(refused.error().code, ErrorCode::kFileUnsupported);
  }
}

/// A NIfTI-1 file with an sform, in RAS, as its definition lays it out.
std::string nifti(std::int16_t sform_code, const std::array<float, 12>& sform,
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
  put(108, 352.0F);          // where the voxels begin
  put(123, std::int8_t{2});  // mm
  put(254, sform_code);
  for (std::size_t n = 0; n < 12; ++n) put(280 + 4 * n, sform[n]);
  std::memcpy(bytes.data() + 344, "n+1", 4);
  return bytes + raw_bytes(kEightVoxels);
}

TEST(Laterality, NiftiIsTurnedFromRas) {
  const TemporaryFolder folder;
  write_bytes(folder / "a.nii", nifti(1, {2, 0, 0, 10, 0, 3, 0, 20, 0, 0, 4, 30}));
  const auto found = read_volume(folder / "a.nii");
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(brightest_L(found->ct), Vec3(-10, -20, 30));
  EXPECT_EQ(found->ct.grid.direction.col(0), Vec3(-1, 0, 0));
}

TEST(Laterality, NiftiWithLeftHandedAxesIsMadeRightHandedInPlace) {
  const TemporaryFolder folder;
  write_bytes(folder / "a.nii", nifti(1, {-2, 0, 0, 10, 0, 3, 0, 20, 0, 0, 4, 30}));
  const auto found = read_volume(folder / "a.nii");
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(brightest_L(found->ct), Vec3(-10, -20, 30));
  EXPECT_NEAR(found->ct.grid.direction.determinant(), 1.0, 1e-6);
}

TEST(Laterality, MetaImageIsInLps) {
  const TemporaryFolder folder;
  const auto header = [](const std::string& matrix) {
    return "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
           "CompressedData = False\nTransformMatrix = " +
           matrix +
           "\nOffset = 10 20 30\n"
           "ElementSpacing = 2 3 4\nDimSize = 2 2 2\nElementType = MET_SHORT\n"
           "ElementDataFile = LOCAL\n" +
           raw_bytes(kEightVoxels);
  };
  write_bytes(folder / "a.mha", header("1 0 0 0 1 0 0 0 1"));
  const auto upright = read_volume(folder / "a.mha");
  ASSERT_TRUE(upright) << upright.error().message;
  EXPECT_EQ(brightest_L(upright->ct), Vec3(10, 20, 30));
  write_bytes(folder / "a.mha", header("0 1 0 1 0 0 0 0 1"));  // Rows run to posterior: mirrored.
  const auto mirrored = read_volume(folder / "a.mha");
  ASSERT_TRUE(mirrored) << mirrored.error().message;
  EXPECT_EQ(brightest_L(mirrored->ct), Vec3(10, 20, 30));
  EXPECT_NEAR(mirrored->ct.grid.direction.determinant(), 1.0, 1e-12);
}

TEST(Laterality, FilesThatLeaveItOpenAreRefused) {
  const TemporaryFolder folder;
  write_bytes(folder / "a.nrrd", nrrd("spacings: 2 3 4"));
  EXPECT_EQ(read_volume(folder / "a.nrrd").error().code, ErrorCode::kFileUnsupported);
  write_bytes(folder / "a.nii", nifti(0, {}));
  const auto nowhere = read_volume(folder / "a.nii");
  ASSERT_FALSE(nowhere);
  EXPECT_EQ(nowhere.error().code, ErrorCode::kFileUnsupported);
  EXPECT_NE(nowhere.error().message.find("left"), std::string::npos);
}

/// The code of the error that `bytes` give as a file called `name`; kNotConverged for none.
ErrorCode code_of(const TemporaryFolder& folder, const char* name, const std::string& bytes) {
  write_bytes(folder / name, bytes);
  const auto result = read_volume(folder / name);
  if (result) return ErrorCode::kNotConverged;
  test::expect_one_sentence(result.error().message);
  return result.error().code;
}

void put_float(std::string& bytes, std::size_t at, float value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

/// nifti() with a qform of no rotation too, at the same place but for the sign `qfac`.
std::string with_qform(std::string bytes, float qfac, float x_mm) {
  put_float(bytes, 76, qfac);
  bytes[252] = 1;
  put_float(bytes, 268, x_mm), put_float(bytes, 272, 20.0F), put_float(bytes, 276, 30.0F);
  return bytes;
}

TEST(Laterality, NiftiWhoseTwoPlacesContradictEachOtherIsRefused) {
  const TemporaryFolder folder;
  const std::string upright = nifti(1, {2, 0, 0, 10, 0, 3, 0, 20, 0, 0, 4, 30});
  EXPECT_EQ(code_of(folder, "a.nii", with_qform(upright, 1.0F, 10.0F)), ErrorCode::kNotConverged);
  EXPECT_EQ(code_of(folder, "a.nii", with_qform(upright, 1.0F, 12.0F)), ErrorCode::kFileCorrupt);
  EXPECT_EQ(code_of(folder, "a.nii", with_qform(upright, -1.0F, 10.0F)), ErrorCode::kFileCorrupt);
  const std::string mirrored = nifti(1, {-2, 0, 0, 10, 0, 3, 0, 20, 0, 0, 4, 30});
  EXPECT_EQ(code_of(folder, "a.nii", with_qform(mirrored, 1.0F, 10.0F)), ErrorCode::kFileCorrupt);
}

TEST(VolumeFiles, NiftiWithAShearedOrStretchedSformOrOtherUnitsIsRefused) {
  const TemporaryFolder folder;
  const std::string upright = nifti(1, {2, 0, 0, 10, 0, 3, 0, 20, 0, 0, 4, 30});
  // The second axis leans by 0.3 of its length and is as long as it was.
  const float along = 0.9F, up = std::sqrt(9.0F - along * along);
  const std::string sheared = nifti(1, {2, along, 0, 10, 0, up, 0, 20, 0, 0, 4, 30});
  EXPECT_EQ(code_of(folder, "a.nii", sheared), ErrorCode::kFileUnsupported);
  EXPECT_EQ(code_of(folder, "a.nii", nifti(1, {2.1F, 0, 0, 10, 0, 3, 0, 20, 0, 0, 4, 30})),
            ErrorCode::kFileCorrupt);
  std::string metres = upright;
  metres[123] = 1;
  EXPECT_EQ(code_of(folder, "a.nii", metres), ErrorCode::kFileUnsupported);
  std::string silent = upright;
  silent[123] = 0;
  EXPECT_EQ(code_of(folder, "a.nii", silent), ErrorCode::kNotConverged);
  std::string negative = upright;
  put_float(negative, 84, -3.0F);
  EXPECT_EQ(code_of(folder, "a.nii", negative), ErrorCode::kFileCorrupt);
}

TEST(VolumeFiles, NiftiWithVoxelsThatAreNoNumbersIsRefusedWithTheirCount) {
  const TemporaryFolder folder;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInf = std::numeric_limits<float>::infinity();
  const auto complaint = [&](std::string bytes) {
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
  EXPECT_NE(complaint(singles).find("3 of 8 voxels"), std::string::npos) << complaint(singles);
  EXPECT_NE(complaint(doubles).find("3 of 8 voxels"), std::string::npos) << complaint(doubles);
  const image::ScalarVolume volume{{.size = {3, 1, 1}}, {-100, kNan, 40}};
  EXPECT_EQ(write_volume(folder / "b.nii.gz", volume).error().code, ErrorCode::kFileUnwritable);
}

TEST(VolumeFiles, NrrdInOtherUnitsOrWithoutDirectionsIsRefused) {
  const TemporaryFolder folder;
  const std::string axes =
      "space: left-posterior-superior\nspace directions: (2,0,0) (0,3,0) (0,0,4)\n"
      "space origin: (10,20,30)";
  const auto read = [&](const std::string& fields) {
    return code_of(folder, "a.nrrd", nrrd(fields));
  };
  EXPECT_EQ(read(axes), ErrorCode::kNotConverged);
  EXPECT_EQ(read(axes + "\nspace units: \"mm\" \"mm\" \"mm\""), ErrorCode::kNotConverged);
  EXPECT_EQ(read(axes + "\nspace units: \"m\" \"m\" \"m\""), ErrorCode::kFileUnsupported);
  EXPECT_EQ(read(axes + "\nspace units: \"mm\" \"mm\" \"um\""), ErrorCode::kFileUnsupported);
  EXPECT_EQ(read("space: left-posterior-superior"), ErrorCode::kFileUnsupported);
}

/// A MetaImage with these lines beside those that every one has.
std::string metaimage(const std::string& lines, const std::string& voxels,
                      const std::string& where = "LOCAL") {
  return "ObjectType = Image\nNDims = 3\nBinaryDataByteOrderMSB = False\nDimSize = 2 2 2\n"
         "ElementType = MET_SHORT\n" +
         lines + "ElementDataFile = " + where + "\n" + voxels;
}

const std::string kPlaced =
    "TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 10 20 30\nElementSpacing = 2 3 4\n";

TEST(Laterality, MetaImageThatLeavesItsPlaceOpenOrContradictsItselfIsRefused) {
  const TemporaryFolder folder;
  const std::string binary = "BinaryData = True\n", voxels = raw_bytes(kEightVoxels);
  const auto read = [&](const std::string& lines) {
    return code_of(folder, "a.mha", metaimage(binary + lines, voxels));
  };
  EXPECT_EQ(read(kPlaced), ErrorCode::kNotConverged);
  EXPECT_EQ(read("ElementSpacing = 2 3 4\n"), ErrorCode::kFileUnsupported);
  EXPECT_EQ(read("AnatomicalOrientation = RAS\nElementSpacing = 2 3 4\n"),
            ErrorCode::kFileUnsupported);
  EXPECT_EQ(read("TransformMatrix = 1 0 0 0 1 0 0 0 1\n"), ErrorCode::kFileUnsupported);
  EXPECT_EQ(read(kPlaced + "DistanceUnits = cm\n"), ErrorCode::kFileUnsupported);
  EXPECT_EQ(read(kPlaced + "AnatomicalOrientation = RAI\n"), ErrorCode::kNotConverged);
  EXPECT_EQ(read(kPlaced + "AnatomicalOrientation = LPS\n"), ErrorCode::kNotConverged);
  EXPECT_EQ(read(kPlaced + "AnatomicalOrientation = ???\n"), ErrorCode::kNotConverged);
  EXPECT_EQ(read(kPlaced + "AnatomicalOrientation = RAS\n"), ErrorCode::kFileCorrupt);
}

/// `bytes` as a zlib stream.
std::string zlib_stream(const std::string& bytes) {
  std::string packed(1000, 'x');
  uLongf length = packed.size();
  EXPECT_EQ(compress(reinterpret_cast<Bytef*>(packed.data()), &length,
                     reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()),
            Z_OK);
  packed.resize(length);
  return packed;
}

TEST(VolumeFiles, MetaImageIsUnderstoodAsItkUnderstandsIt) {
  const TemporaryFolder folder;
  const std::string voxels = raw_bytes(kEightVoxels);
  const std::string lines = "BinaryData = True\n" + kPlaced;
  // Whatever begins with t is true: a short stream, padded, was taken for plain voxels.
  for (const char* const yes : {"True", "TRUE", "true", "T", "1"}) {
    const auto packed = [&](const std::string& stream) {
      return metaimage(fmt::format("{}CompressedData = {}\nCompressedDataSize = {}\n", lines, yes,
                                   stream.size()),
                       stream);
    };
    for (const std::string& stream :
         {zlib_stream(voxels.substr(0, 6)) + voxels, zlib_stream(voxels) + "xx"})
      EXPECT_EQ(code_of(folder, "a.mha", packed(stream)), ErrorCode::kFileCorrupt) << yes;
    write_bytes(folder / "a.mha", packed(zlib_stream(voxels)));
    write_bytes(folder / "a.zraw", zlib_stream(voxels));
    const std::string no_size = fmt::format("{}CompressedData = {}\n", lines, yes);
    write_bytes(folder / "a.mhd", metaimage(no_size, "", "a.zraw"));
    for (const char* const name : {"a.mha", "a.mhd"}) {
      const auto found = read_volume(folder / name);
      ASSERT_TRUE(found) << yes << ": " << found.error().message;
      EXPECT_EQ(found->ct.values, kEightVoxels) << name;
    }
    EXPECT_EQ(code_of(folder, "a.mha", metaimage(no_size, zlib_stream(voxels))),
              ErrorCode::kFileUnsupported);
  }
  EXPECT_EQ(
      code_of(folder, "a.mha", metaimage("BinaryData = False\n" + kPlaced, "1 2 3 4 5 6 7 8")),
      ErrorCode::kFileUnsupported);
  EXPECT_EQ(code_of(folder, "a.mha", metaimage(lines + "HeaderSize = -1\n", voxels)),
            ErrorCode::kFileUnsupported);
  EXPECT_EQ(code_of(folder, "a.mha", metaimage(lines + "HeaderSize = 4\n", voxels)),
            ErrorCode::kFileUnsupported);
}

TEST(VolumeFiles, TheHeaderSizeOfDetachedVoxelsIsPassedOver) {
  const TemporaryFolder folder;
  const std::string header =
      metaimage("BinaryData = True\nHeaderSize = 5\n" + kPlaced, "", "a.raw");
  write_bytes(folder / "a.raw", "12345" + raw_bytes(kEightVoxels));
  write_bytes(folder / "a.mhd", header);
  const auto found = read_volume(folder / "a.mhd");
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->ct.values, kEightVoxels);
  write_bytes(folder / "a.raw", "12345" + raw_bytes(kEightVoxels).substr(1));
  EXPECT_EQ(code_of(folder, "a.mhd", header), ErrorCode::kFileCorrupt);
}

TEST(VolumeFiles, RefusesTwoAndFourDimensionsAndVectors) {
  const TemporaryFolder folder;
  const auto complaint = [&](const char* name, const std::string& bytes) {
    write_bytes(folder / name, bytes);
    const auto result = read_volume(folder / name);
    if (result) return std::string("read");
    EXPECT_EQ(result.error().code, ErrorCode::kFileUnsupported) << result.error().message;
    test::expect_one_sentence(result.error().message);
    return result.error().message;
  };
  const std::string head = "NRRD0004\ntype: short\nendian: little\nencoding: raw\n";
  const std::string voxels(64, '\1');
  EXPECT_NE(
      complaint("flat.nrrd", head + "dimension: 2\nsizes: 4 8\n\n" + voxels).find("2 dimensions"),
      std::string::npos);
  EXPECT_NE(complaint("film.nrrd", head + "dimension: 4\nsizes: 2 2 2 4\n\n" + voxels)
                .find("4 dimensions"),
            std::string::npos);
  EXPECT_NE(complaint("vectors.nrrd",
                      head +
                          "dimension: 4\nsizes: 4 2 2 2\nkinds: vector domain domain domain\n"
                          "space: left-posterior-superior\n"
                          "space directions: none (1,0,0) (0,1,0) (0,0,1)\n\n" +
                          voxels)
                .find("4 values"),
            std::string::npos);
}

TEST(VolumeFiles, RefusesGridsThatCannotBe) {
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

TEST(VolumeFiles, AHugePromiseIsRefusedWithoutAllocating) {
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

/// Headers that say where their voxels are.
std::vector<std::pair<const char*, std::string>> headers_with_voxels_in(const std::string& where) {
  const std::string fields =
      "space: left-posterior-superior\nspace directions: (2,0,0) (0,3,0) (0,0,4)\n"
      "space origin: (10,20,30)\n";
  const std::string nhdr =
      "NRRD0004\ntype: short\ndimension: 3\nsizes: 2 2 2\nendian: little\nencoding: raw\n" + fields;
  return {{"a.nhdr", nhdr + "data file: " + where + "\n"},
          {"b.nhdr", nhdr + "datafile: " + where + "\n"},
          {"c.nrrd", nhdr + "Data File: " + where + "\n\n"},
          {"a.mhd", metaimage("BinaryData = True\n" + kPlaced, "", where)},
          {"b.mha", metaimage("BinaryData = True\n" + kPlaced, "", where)}};
}

TEST(VolumeFiles, VoxelsMayOnlyBeInARegularFileBesideTheHeader) {
  const TemporaryFolder folder;
  const std::string voxels = raw_bytes(kEightVoxels);
  std::filesystem::create_directory(folder / "sub");
  write_bytes(folder / "a.raw", voxels);
  write_bytes(folder / "sub/a.raw", voxels);
  std::filesystem::create_symlink(folder / "a.raw", folder / "link.raw");
  std::filesystem::create_directory(folder / "folder.raw");
  ASSERT_EQ(::mkfifo((folder / "pipe.raw").c_str(), 0600), 0);  // Opening it would wait forever.
  for (const auto& [name, bytes] : headers_with_voxels_in("a.raw"))
    EXPECT_EQ(code_of(folder, name, bytes), ErrorCode::kNotConverged) << name;
  for (const std::string& where :
       {std::string("/etc/passwd"), (folder / "a.raw").string(), std::string("sub/a.raw"),
        std::string("../a.raw"), std::string(".."), std::string("LIST"),
        std::string("%d.raw 1 1 1")})
    for (const auto& [name, bytes] : headers_with_voxels_in(where))
      EXPECT_EQ(code_of(folder, name, bytes), ErrorCode::kFileUnsupported) << name << where;
  for (const char* const where : {"pipe.raw", "link.raw", "folder.raw", "none.raw"})
    for (const auto& [name, bytes] : headers_with_voxels_in(where))
      EXPECT_EQ(code_of(folder, name, bytes), ErrorCode::kFileCorrupt) << name << where;
  write_bytes(folder / "a.raw", voxels.substr(1));
  for (const auto& [name, bytes] : headers_with_voxels_in("a.raw"))
    EXPECT_EQ(code_of(folder, name, bytes), ErrorCode::kFileCorrupt) << name;
}

TEST(VolumeFiles, RefusesOtherEndingsAndMissingFiles) {
  const TemporaryFolder folder;
  EXPECT_EQ(write_volume(folder / "a.png", sample_scan()).error().code,
            ErrorCode::kInvalidArgument);
  EXPECT_EQ(write_volume(folder / "a.nhdr", sample_scan()).error().code,
            ErrorCode::kInvalidArgument);
  EXPECT_EQ(folder.entry_count(), 0);
  EXPECT_EQ(read_volume(folder / "a.nrrd").error().code, ErrorCode::kFileNotFound);
  EXPECT_EQ(read_volume(folder / "a.png").error().code, ErrorCode::kFileUnsupported);
  EXPECT_TRUE(is_volume_file("A.NII.GZ"));
  EXPECT_FALSE(is_volume_file("a.gz"));
}

TEST(VolumeFiles, RefusesToWriteAGridThatCannotBe) {
  const TemporaryFolder folder;
  auto ct = sample_scan();
  ct.grid.direction.col(0) *= -1.0;
  EXPECT_EQ(write_volume(folder / "a.nrrd", ct).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(folder.entry_count(), 0);
}

}  // namespace
}  // namespace lefort::io
