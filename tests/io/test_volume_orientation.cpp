#include <lefort/io/volume_files.h>

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "io/sample_scan.h"
#include "io/volume_bytes.h"
#include "support/temporary_folder.h"

namespace lefort::io::test_volume_orientation {
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

/// Returns the position of the brightest voxel of a 2 x 2 x 2 volume.
Vec3 brightest_L(const image::CtVolume& ct) {
  for (Index n = 0; n < 8; ++n)
    if (ct.values[std::size_t(n)] == 1000)
      return ct.grid.point_L(Vec3(double(n & 1), double((n >> 1) & 1), double(n >> 2)));
  return Vec3::Constant(std::nan(""));
}

TEST(Laterality, ReadsNrrdInLpsAndRas) {
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

TEST(Laterality, RejectsNrrdSpacesThatItkMirrors) {
  const TemporaryFolder folder;
  for (const char* const space :
       {"left-anterior-superior", "LAS", "scanner-xyz", "3D-left-handed"}) {
    write_bytes(folder / "a.nrrd",
                nrrd(std::string("space: ") + space +
                     "\nspace directions: (2,0,0) (0,3,0) (0,0,4)\nspace origin: (10,20,30)"));
    const auto rejected = read_volume(folder / "a.nrrd");
    ASSERT_FALSE(rejected) << space;
    EXPECT_EQ(rejected.error().code, ErrorCode::kFileUnsupported);
  }
}

TEST(Laterality, ConvertsNiftiFromRas) {
  const TemporaryFolder folder;
  write_bytes(folder / "a.nii", nifti(1, {2, 0, 0, 10, 0, 3, 0, 20, 0, 0, 4, 30}));
  const auto found = read_volume(folder / "a.nii");
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(brightest_L(found->ct), Vec3(-10, -20, 30));
  EXPECT_EQ(found->ct.grid.direction.col(0), Vec3(-1, 0, 0));
}

TEST(Laterality, ConvertsLeftHandedNiftiToRightHanded) {
  const TemporaryFolder folder;
  write_bytes(folder / "a.nii", nifti(1, {-2, 0, 0, 10, 0, 3, 0, 20, 0, 0, 4, 30}));
  const auto found = read_volume(folder / "a.nii");
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(brightest_L(found->ct), Vec3(-10, -20, 30));
  EXPECT_NEAR(found->ct.grid.direction.determinant(), 1.0, 1e-6);
}

TEST(Laterality, ReadsMetaImageInLps) {
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
  write_bytes(folder / "a.mha",
              header("0 1 0 1 0 0 0 0 1"));  // Rows point to posterior: left-handed.
  const auto mirrored = read_volume(folder / "a.mha");
  ASSERT_TRUE(mirrored) << mirrored.error().message;
  EXPECT_EQ(brightest_L(mirrored->ct), Vec3(10, 20, 30));
  EXPECT_NEAR(mirrored->ct.grid.direction.determinant(), 1.0, 1e-12);
}

TEST(Laterality, RejectsFilesWithoutOrientation) {
  const TemporaryFolder folder;
  write_bytes(folder / "a.nrrd", nrrd("spacings: 2 3 4"));
  EXPECT_EQ(read_volume(folder / "a.nrrd").error().code, ErrorCode::kFileUnsupported);
  write_bytes(folder / "a.nii", nifti(0, {}));
  const auto without_orientation = read_volume(folder / "a.nii");
  ASSERT_FALSE(without_orientation);
  EXPECT_EQ(without_orientation.error().code, ErrorCode::kFileUnsupported);
  EXPECT_NE(without_orientation.error().message.find("left"), std::string::npos);
}

/// nifti() with an additional qform without rotation, at the same position except for the sign
/// `qfac`.
std::string with_qform(std::string bytes, float qfac, float x_mm) {
  put_float(bytes, 76, qfac);
  bytes[252] = 1;
  put_float(bytes, 268, x_mm), put_float(bytes, 272, 20.0F), put_float(bytes, 276, 30.0F);
  return bytes;
}

TEST(Laterality, RejectsNiftiWithContradictoryQformAndSform) {
  const TemporaryFolder folder;
  const std::string upright = nifti(1, {2, 0, 0, 10, 0, 3, 0, 20, 0, 0, 4, 30});
  EXPECT_EQ(volume_error_code(folder, "a.nii", with_qform(upright, 1.0F, 10.0F)),
            ErrorCode::kNotConverged);
  EXPECT_EQ(volume_error_code(folder, "a.nii", with_qform(upright, 1.0F, 12.0F)),
            ErrorCode::kFileCorrupt);
  EXPECT_EQ(volume_error_code(folder, "a.nii", with_qform(upright, -1.0F, 10.0F)),
            ErrorCode::kFileCorrupt);
  const std::string mirrored = nifti(1, {-2, 0, 0, 10, 0, 3, 0, 20, 0, 0, 4, 30});
  EXPECT_EQ(volume_error_code(folder, "a.nii", with_qform(mirrored, 1.0F, 10.0F)),
            ErrorCode::kFileCorrupt);
}

TEST(Laterality, RejectsMetaImageWithMissingOrContradictoryOrientation) {
  const TemporaryFolder folder;
  const std::string binary = "BinaryData = True\n", voxels = raw_bytes(kEightVoxels);
  const auto read = [&](const std::string& lines) {
    return volume_error_code(folder, "a.mha", metaimage(binary + lines, voxels));
  };
  EXPECT_EQ(read(kPlacement), ErrorCode::kNotConverged);
  EXPECT_EQ(read("ElementSpacing = 2 3 4\n"), ErrorCode::kFileUnsupported);
  EXPECT_EQ(read("AnatomicalOrientation = RAS\nElementSpacing = 2 3 4\n"),
            ErrorCode::kFileUnsupported);
  EXPECT_EQ(read("TransformMatrix = 1 0 0 0 1 0 0 0 1\n"), ErrorCode::kFileUnsupported);
  EXPECT_EQ(read(kPlacement + "DistanceUnits = cm\n"), ErrorCode::kFileUnsupported);
  EXPECT_EQ(read(kPlacement + "AnatomicalOrientation = RAI\n"), ErrorCode::kNotConverged);
  EXPECT_EQ(read(kPlacement + "AnatomicalOrientation = LPS\n"), ErrorCode::kNotConverged);
  EXPECT_EQ(read(kPlacement + "AnatomicalOrientation = ???\n"), ErrorCode::kNotConverged);
  EXPECT_EQ(read(kPlacement + "AnatomicalOrientation = RAS\n"), ErrorCode::kFileCorrupt);
}

}  // namespace
}  // namespace lefort::io::test_volume_orientation
