#include <lefort/io/internal/plist.h>
#include <lefort/io/inv3.h>

#include <gtest/gtest.h>

#include "io/inv3_writer.h"
#include "io/sample_scan.h"
#include "support/real_scan.h"
#include "support/temporary_folder.h"

namespace lefort::io::test_inv3 {
namespace {

using test::Inv3Plist;
using test::TemporaryFolder;

std::string inv3_error(const Inv3Plist& plist, ErrorCode code,
                       const std::string& matrix = test::inv3_matrix()) {
  const TemporaryFolder folder;
  test::write_gzip(folder / "a.inv3", test::inv3_archive(test::to_xml(plist), matrix));
  const auto result = read_inv3(folder / "a.inv3");
  if (result) {
    ADD_FAILURE() << "no error";
    return "";
  }
  EXPECT_EQ(result.error().code, code) << result.error().message;
  test::expect_one_sentence(result.error().message);
  return result.error().message;
}

TEST(Laterality, Inv3RowsAreReversedAndColumnsAreNot) {
  const TemporaryFolder folder;
  test::write_gzip(folder / "a.inv3", test::inv3_archive(test::to_xml({}), test::inv3_matrix()));
  const auto found = read_inv3(folder / "a.inv3");
  ASSERT_TRUE(found) << found.error().message;
  const image::CtVolume& ct = found->ct;
  EXPECT_EQ(ct.grid.size, (std::array<Index, 3>{4, 3, 2}));
  EXPECT_EQ(ct.grid.spacing_mm, Vec3(0.5, 0.75, 2.0));
  EXPECT_EQ(ct.grid.origin_L, Vec3(0.0, 0.0, 0.0));
  EXPECT_EQ(ct.grid.direction, Mat3::Identity());
  for (Index k = 0; k < 2; ++k)
    for (Index j = 0; j < 3; ++j)
      for (Index i = 0; i < 4; ++i) EXPECT_EQ(ct.at(i, j, k), 100 * k + 10 * (2 - j) + i - 1000);
  EXPECT_EQ(found->source_kind, "InVesalius project");
  EXPECT_TRUE(found->warnings.empty());
}

/// A public scan of a patient: bone of the forehead is missing on the right.
TEST(Laterality, TheFrontalDefectOfCraniumIsOnThePatientsRight) {
  const std::filesystem::path& file = test::real_scan();
  const auto found = read_inv3(file);
  ASSERT_TRUE(found) << found.error().message;
  const image::CtVolume& ct = found->ct;
  ASSERT_EQ(ct.grid.size, (std::array<Index, 3>{256, 256, 108}));
  constexpr std::int16_t kBone = 226;
  Index right = 0, left = 0;
  for (Index k = 56; k < 80; ++k)   // From the brows to the upper forehead,
    for (Index j = 0; j < 80; ++j)  // in the anterior third:
      for (Index i = 0; i < 256; ++i)
        if (ct.at(i, j, k) > kBone) ++(i < 128 ? right : left);
  EXPECT_GT(left, 6000);
  EXPECT_LT(static_cast<double>(right), 0.65 * static_cast<double>(left));
}

TEST(Inv3, ReadsAnArchiveThatIsNotGzipped) {
  const TemporaryFolder folder;
  test::write_bytes(folder / "a.inv3", test::inv3_archive(test::to_xml({}), test::inv3_matrix()));
  ASSERT_TRUE(read_inv3(folder / "a.inv3"));
}

TEST(Inv3, IgnoresEntriesThatOnlyResembleTheProject) {
  const TemporaryFolder folder;
  test::write_gzip(folder / "a.inv3",
                   test::tar_member("tmpabc/main.plist/", "", '5') +
                       test::tar_member("main.plist", "a long name", 'x') +
                       test::inv3_archive(test::to_xml({}), test::inv3_matrix()));
  const auto found = read_inv3(folder / "a.inv3");
  ASSERT_TRUE(found) << found.error().message;
}

TEST(Inv3, WarnsOfSlicesThatAreNotAxial) {
  const TemporaryFolder folder;
  test::write_gzip(folder / "a.inv3",
                   test::inv3_archive(test::to_xml({.orientation = "2"}), test::inv3_matrix()));
  const auto found = read_inv3(folder / "a.inv3");
  ASSERT_EQ(found->warnings.size(), 1U);
  EXPECT_NE(found->warnings[0].find("left and right"), std::string::npos);
}

TEST(Inv3, RejectsAnInvalidPlist) {
  const auto corrupt = ErrorCode::kFileCorrupt;
  inv3_error({.shape = {"2", "3"}}, corrupt);
  inv3_error({.shape = {"2", "x", "4"}}, corrupt);
  inv3_error({.shape = {"0", "3", "4"}}, corrupt);
  inv3_error({.shape = {"-2", "-3", "4"}}, corrupt);
  inv3_error({.shape = {"99999999999", "99999999999", "99999999999"}}, corrupt);
  inv3_error({.shape = {"2", "3", "5"}}, corrupt);           // More than matrix.dat contains.
  inv3_error({.shape = {"2", "3", "3"}}, corrupt);           // Less.
  inv3_error({.shape = {"1000", "1000", "1000"}}, corrupt);  // Far more.
  inv3_error({.spacing = {"0.5", "nan", "1"}}, corrupt);
  inv3_error({.spacing = {"0.5", "0", "1"}}, corrupt);
  inv3_error({.filename = ""}, corrupt);
  inv3_error({.filename = "../../etc/passwd"}, corrupt);
  inv3_error({.filename = "other.dat"}, corrupt);
  inv3_error({.dtype = "float64"}, ErrorCode::kFileUnsupported);
  inv3_error({.modality = "MRI"}, ErrorCode::kFileUnsupported);
}

TEST(Inv3, RejectsFilesThatAreNotProjects) {
  const TemporaryFolder folder;
  EXPECT_EQ(read_inv3(folder / "none").error().code, ErrorCode::kFileNotFound);
  for (const std::string& bytes :
       {std::string(), std::string("garbage"), std::string(2000, 'x'), std::string(2048, '\0')}) {
    test::write_gzip(folder / "a.inv3", bytes);
    const auto result = read_inv3(folder / "a.inv3");
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, ErrorCode::kFileCorrupt) << result.error().message;
    test::expect_one_sentence(result.error().message);
  }
}

TEST(Inv3, AllocatesNothingForAFalseEntrySize) {
  const TemporaryFolder folder;
  const auto entry_error = [&](const std::string& name, std::uint64_t claimed_bytes) {
    test::write_gzip(folder / "a.inv3",
                     test::tar_member("main.plist", test::to_xml({})) +
                         test::tar_member(name, test::inv3_matrix(), '0', claimed_bytes));
    const auto result = read_inv3(folder / "a.inv3");
    return result ? std::string("read") : result.error().message;
  };
  constexpr std::uint64_t kGib = std::uint64_t{1} << 30;
  // Entries of voxels may be as large as the shape requires, all others at most 8 GiB.
  EXPECT_EQ(entry_error("matrix.dat", 8 * kGib - 1),
            "matrix.dat in the archive has 8589934591 bytes, expected at most 48");
  EXPECT_EQ(entry_error("matrix.dat", 49),
            "matrix.dat in the archive has 49 bytes, expected at most 48");
  EXPECT_EQ(entry_error("mask.dat", 8 * kGib - 1), "the archive is truncated or damaged");
  std::string wrong = test::tar_member("matrix.dat", test::inv3_matrix());
  wrong.replace(124, 11, "00000000061");  // The checksum is now wrong.
  test::write_gzip(folder / "a.inv3", test::tar_member("main.plist", test::to_xml({})) + wrong);
  EXPECT_NE(read_inv3(folder / "a.inv3").error().message.find("is damaged"), std::string::npos);
  const std::string entry = test::tar_member("main.plist", std::string(2 << 20, ' '));
  test::write_gzip(folder / "a.inv3", entry);
  EXPECT_NE(read_inv3(folder / "a.inv3").error().message.find("2097152 bytes"), std::string::npos);
}

TEST(Plist, ReturnsLeavesByPath) {
  const auto leaves = read_plist(
      "<plist><dict><key>a</key><integer>7</integer><key>b</key><array><string>x</string>"
      "<dict><key>c</key><real>1.5</real></dict></array><key>t</key><true/></dict></plist>");
  ASSERT_TRUE(leaves);
  EXPECT_EQ(*leaves, (FlatPlist{{"a", "7"}, {"b/0", "x"}, {"b/1/c", "1.5"}, {"t", ""}}));
}

TEST(Plist, RejectsEntitiesDepthSizeAndDamage) {
  std::string deep, many = "<plist><array>";
  for (int n = 0; n < 100'000; ++n) deep += "<array>";
  for (int n = 0; n < 20'000; ++n) many += "<integer>1</integer>";
  for (const std::string& xml :
       {std::string("<!DOCTYPE p [<!ENTITY a \"aaaa\"><!ENTITY b \"&a;&a;\">]><p>&b;</p>"),
        std::string("<!DOCTYPE p [<!ENTITY a SYSTEM \"file:///etc/passwd\">]><p>&a;</p>"), deep,
        many + "</array></plist>", std::string(2 << 20, ' '), std::string(),
        std::string("<plist><dict>"), std::string("<plist></dict></plist>"),
        std::string("<dict/><dict/>"), std::string("\0\1\2", 3)}) {
    const auto result = read_plist(xml);
    ASSERT_FALSE(result) << xml.substr(0, 60);
    EXPECT_EQ(result.error().code, ErrorCode::kFileCorrupt);
    test::expect_one_sentence(result.error().message);
  }
}

}  // namespace
}  // namespace lefort::io::test_inv3
