#include <lefort/io/landmarks_file.h>
#include <lefort/io/write_atomically.h>

#include <gtest/gtest.h>

#include <array>

#include "support/run_python.h"
#include "support/temporary_folder.h"

namespace lefort::io::test_landmarks_file {
namespace {

const plan::Landmarks kSome{
    {"N", {0.1, -20.3, 1e-3}}, {"Or-R", {-30, 1.0 / 3.0, 2}}, {"screw, \"third\"", {1, 2, 3}}};

TEST(LandmarksFile, PreservesEveryBit) {
  const test::TemporaryFolder folder;
  for (const char* name : {"l.csv", "l.mrk.json"}) {
    ASSERT_TRUE(write_landmarks(folder / name, kSome)) << name;
    const auto read = read_landmarks(folder / name);
    ASSERT_TRUE(read) << read.error().message;
    ASSERT_EQ(read->size(), kSome.size());
    for (std::size_t i = 0; i < kSome.size(); ++i) {
      EXPECT_EQ((*read)[i].name, kSome[i].name);
      EXPECT_EQ((*read)[i].point_L, kSome[i].point_L);
    }
  }
}

TEST(LandmarksFile, PythonsCsvReadsTheTable) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_landmarks(folder / "l.csv", kSome));
  const auto [ran, out] = test::run_python(
      "import csv,sys\n"
      "r = list(csv.DictReader(open(sys.argv[1], newline=\"\")))\n"
      "assert r[0][\"name\"] == \"N\" and float(r[0][\"y_mm\"]) == -20.3, r\n"
      "assert r[1][\"meaning\"] == \"right orbitale\" and float(r[1][\"y_mm\"]) == 1/3, r\n"
      "assert r[2][\"name\"] == \"screw, \\\"third\\\"\", r",
      (folder / "l.csv").string());
  EXPECT_TRUE(ran) << out;
}

TEST(LandmarksFile, ReadsSlicerTablesInLpsAndRas) {
  const auto lps = parse_landmark_table(
      "label,l,p,s,defined,selected,visible,locked,description\nN,1,2,3,1,1,1,0,\nA,0,0,0,0,1,1,0,"
      "\n");
  ASSERT_TRUE(lps) << lps.error().message;
  ASSERT_EQ(lps->size(), 1U);
  EXPECT_EQ((*lps)[0].point_L, Vec3(1, 2, 3));
  const auto ras = parse_landmark_table("label,r,a,s,defined\r\nN,1,2,3,1\r\n");
  ASSERT_TRUE(ras) << ras.error().message;
  EXPECT_EQ((*ras)[0].point_L, Vec3(-1, -2, 3));
}

TEST(LandmarksFile, RejectsInvalidTablesAndNamesTheLine) {
  struct Case {
    const char* text;
    const char* words;
  };
  for (const Case& c : std::array<Case, 9>{
           {{"", "no landmark"},
            {"N,1,2,3\n", "line 1 must name the columns"},
            {"name,x_mm,y_mm,z_mm\nN\a,1,2,3\n", "landmark 1 has a name with control characters"},
            {"name,x_mm,y_mm\nN,1,2\n", "line 1 must name the columns"},
            {"name,x_mm,y_mm,z_mm\nN,1,2\n", "line 2 has 3 fields, expected 4"},
            {"name,x_mm,y_mm,z_mm\nN,1,nan,2\n", "line 2: 'nan' is not a finite number"},
            {"name,x_mm,y_mm,z_mm\n\"N,1,1,2\n", "line 2: a quote is not closed"},
            {"name,x_mm,y_mm,z_mm\nN,1,1,2\nN,1,1,2\n", "landmark N is repeated"},
            {"name,x_mm,y_mm,z_mm\nN,1,1,2e9\n", "landmark N is beyond"}}}) {
    const auto read = parse_landmark_table(c.text);
    ASSERT_FALSE(read) << c.words;
    EXPECT_EQ(read.error().code, ErrorCode::kFileCorrupt);
    EXPECT_NE(read.error().message.find(c.words), std::string::npos) << read.error().message;
  }
}

TEST(LandmarksFile, RejectsAnotherEndingAndWritesNothing) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(write_landmarks(folder / "l.fcsv", kSome).error().code, ErrorCode::kFileUnsupported);
  EXPECT_EQ(read_landmarks(folder / "l.json").error().code, ErrorCode::kFileUnsupported);
  EXPECT_EQ(read_landmarks(folder / "l.csv").error().code, ErrorCode::kFileNotFound);
  EXPECT_EQ(folder.entry_count(), 0);
}

TEST(CephalometricCsv, ReportsBeforeAfterAndChange) {
  const std::array<plan::Measurement, 2> before{
      {{"SNA", "a, b", "deg", 80.0}, {"SNB", "", "deg", {}}}};
  std::array<plan::Measurement, 2> after = before;
  after[0].value = 82.5;
  EXPECT_EQ(cephalometric_csv(before),
            "measurement,meaning,unit,before\n"
            "SNA,\"a, b\",deg,80.000\nSNB,,deg,\n");
  EXPECT_EQ(cephalometric_csv(before, after),
            "measurement,meaning,unit,before,after,change\n"
            "SNA,\"a, b\",deg,80.000,82.500,2.500\nSNB,,deg,,,\n");
}

}  // namespace
}  // namespace lefort::io::test_landmarks_file
