#include <lefort/geometry/rigid_motion.h>
#include <lefort/io/transform_file.h>
#include <lefort/io/write_atomically.h>

#include <gtest/gtest.h>

#include <array>

#include "io/itk_transforms.h"
#include "support/temporary_folder.h"

namespace lefort::io::test_transform_file {
namespace {

std::string tfm(const std::string& type, const std::string& parameters,
                const std::string& fixed = "0 0 0") {
  return "#Insight Transform File V1.0\n#Transform 0\nTransform: " + type +
         "\nParameters: " + parameters + "\nFixedParameters: " + fixed + "\n";
}

/// A model that is moved 10 mm to anterior in Slicer ("to parent" 0, 10, 0 in RAS) is saved with
/// these numbers: RAS becomes LPS (0, -10, 0), and the resampling direction is its inverse.
TEST(TransformFile, MovesForwardAsInSlicer) {
  const auto motion =
      parse_transform(tfm("AffineTransform_double_3_3", "1 0 0 0 1 0 0 0 1 0 10 0"));
  ASSERT_TRUE(motion) << motion.error().message;
  EXPECT_LT((*motion * Vec3(1, 2, 3) - Vec3(1, -8, 3)).norm(), 1e-14);
}

/// Rotated by +90 degrees about S in Slicer, R becomes A: in LPS, x becomes y, which is also +90
/// degrees about z; the file contains -90.
TEST(TransformFile, RotatesAsInSlicer) {
  const auto motion =
      parse_transform(tfm("AffineTransform_double_3_3", "0 1 0 -1 0 0 0 0 1 0 0 0"));
  ASSERT_TRUE(motion) << motion.error().message;
  EXPECT_LT((*motion * Vec3(1, 0, 0) - Vec3(0, 1, 0)).norm(), 1e-14);
}

TEST(TransformFile, ItkReadsTheInverseOfTheMotion) {
  const test::TemporaryFolder folder;
  const RigidTransform X = geometry::rigid_motion({1, -12, 5}, {0.1, 0.2, -0.3}, {100, 40, 30});
  ASSERT_TRUE(write_transform(folder / "move.tfm", X));
  const Vec3 p_B(80, 60, 20), p_L = X * p_B;
  const test::ItkPoint back =
      test::apply_itk_transform((folder / "move.tfm").string(), {p_L.x(), p_L.y(), p_L.z()});
  EXPECT_LT((Vec3(back[0], back[1], back[2]) - p_B).norm(), 1e-12);
  const auto ours = read_transform(folder / "move.tfm");
  ASSERT_TRUE(ours) << ours.error().message;
  EXPECT_LT((ours->matrix() - X.matrix()).norm(), 1e-12);
}

TEST(TransformFile, ReadsItkTransformsWithACenter) {
  const test::TemporaryFolder folder;
  const std::string file = (folder / "itk.tfm").string();
  for (const test::ItkKind kind : {test::ItkKind::kVersor, test::ItkKind::kAffine}) {
    test::write_itk_transform(file, kind, {0.6, 0.0, 0.8}, 0.4, {100, 50, 20}, {3, -4, 5});
    const auto motion = read_transform(file);
    ASSERT_TRUE(motion) << motion.error().message;
    const test::ItkPoint from = test::apply_itk_transform(file, {90, 10, 70});
    EXPECT_LT((*motion * Vec3(from[0], from[1], from[2]) - Vec3(90, 10, 70)).norm(), 1e-9);
  }
}

TEST(TransformFile, RejectsNonRigidTransforms) {
  struct Case {
    std::string text;
    ErrorCode code;
    const char* words;
  };
  const std::string affine = "AffineTransform_double_3_3";
  const std::string good = "1 0 0 0 1 0 0 0 1 0 10 0";
  const std::array<Case, 14> cases{{
      {"", ErrorCode::kFileCorrupt, "names no Transform"},
      {"Transform: x\n", ErrorCode::kFileCorrupt, "line 1 must be"},
      {"#Insight Transform File V1.0\n", ErrorCode::kFileCorrupt, "names no Transform"},
      {"#Insight Transform File V1.0\nTransform: " + affine + "\n", ErrorCode::kFileCorrupt,
       "no Parameters"},
      {tfm(affine, "1 0 0"), ErrorCode::kFileCorrupt, "3 Parameters, must be 12"},
      {tfm(affine, "1 0 0 0 1 0 0 0 1 0 nan 0"), ErrorCode::kFileCorrupt, "line 4"},
      {tfm(affine, good, "0 0"), ErrorCode::kFileCorrupt, "2 FixedParameters"},
      {tfm(affine, good) + "Parameters: 1\n", ErrorCode::kFileCorrupt, "is repeated"},
      {tfm(affine, "1.01 0 0 0 1.01 0 0 0 1.01 0 0 0"), ErrorCode::kFileUnsupported,
       "scales or shears by 0.01"},
      {tfm(affine, "1e200 1e200 0 -1e200 1e200 0 0 0 1 0 0 0"), ErrorCode::kFileUnsupported,
       "too large"},
      {tfm(affine, "-1 0 0 0 1 0 0 0 1 0 0 0"), ErrorCode::kFileUnsupported, "mirrors"},
      {tfm("BSplineTransform_double_3_3", good), ErrorCode::kFileUnsupported, "BSplineTransform"},
      {tfm(affine, good) + "#Transform 1\nTransform: " + affine + "\n", ErrorCode::kFileUnsupported,
       "several transforms"},
      {tfm(affine, "1 0 0 0 1 0 0 0 1 0 1e7 0"), ErrorCode::kFileUnsupported, "translates by more"},
  }};
  for (const Case& c : cases) {
    const auto motion = parse_transform(c.text);
    ASSERT_FALSE(motion) << c.words;
    EXPECT_EQ(motion.error().code, c.code) << motion.error().message;
    EXPECT_NE(motion.error().message.find(c.words), std::string::npos) << motion.error().message;
  }
  const test::TemporaryFolder folder;
  EXPECT_EQ(read_transform(folder / "none.tfm").error().code, ErrorCode::kFileNotFound);
}

}  // namespace
}  // namespace lefort::io::test_transform_file
