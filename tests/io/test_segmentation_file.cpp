#include <lefort/io/read_text.h>
#include <lefort/io/segmentation_file.h>

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>

#include "io/sample_labels.h"
#include "io/sample_scan.h"
#include "support/temporary_folder.h"

namespace lefort::io::test_segmentation_file {
namespace {

using anatomy::LabelMap;
using anatomy::Tissue;
using test::bytes_of;
using test::sample_labels;
using test::TemporaryFolder;
using test::write_bytes;

TEST(SegmentationFile, ReadsBackEveryLabel) {
  const TemporaryFolder folder;
  const LabelMap labels = sample_labels();
  ASSERT_TRUE(write_segmentation(folder / "a.seg.nrrd", labels));
  EXPECT_EQ(folder.entry_count(), 1);
  const auto found = read_segmentation(folder / "a.seg.nrrd");
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->values, labels.values);
  test::expect_same_grid(found->grid, labels.grid, 1e-12);
  const auto on_scan = read_segmentation(folder / "a.seg.nrrd", labels.grid);
  ASSERT_TRUE(on_scan) << on_scan.error().message;
  EXPECT_EQ(on_scan->grid, labels.grid);
  EXPECT_EQ(on_scan->values, labels.values);
}

TEST(SegmentationFile, ReadsBackTeethOfJawsAndNumberedTeeth) {
  const TemporaryFolder folder;
  const image::Grid grid = sample_labels().grid;
  anatomy::ToothMap jaws{grid, {}};
  image::Volume<std::uint8_t> numbers{grid, {}};
  for (Index v = 0; v < grid.voxel_count(); ++v) {
    jaws.values.push_back(anatomy::Tooth(v % 3));
    numbers.values.push_back(std::uint8_t(v % 3 == 0 ? 0 : v % 3 == 1 ? 18 : 41));
  }
  ASSERT_TRUE(write_teeth(folder / "jaws.seg.nrrd", jaws));
  ASSERT_TRUE(write_numbered_teeth(folder / "numbers.seg.nrrd", numbers));
  const auto read_jaws = read_teeth(folder / "jaws.seg.nrrd", grid);
  ASSERT_TRUE(read_jaws) << read_jaws.error().message;
  for (std::size_t v = 0; v < jaws.values.size(); ++v)
    EXPECT_EQ(read_jaws->values[v], std::uint8_t(jaws.values[v]));
  const auto read_numbers = read_teeth(folder / "numbers.seg.nrrd", grid);
  ASSERT_TRUE(read_numbers) << read_numbers.error().message;
  EXPECT_EQ(read_numbers->values, numbers.values);
}

TEST(SegmentationFile, EqualLabelsGiveEqualBytes) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_segmentation(folder / "a.seg.nrrd", sample_labels()));
  ASSERT_TRUE(write_segmentation(folder / "b.seg.nrrd", sample_labels()));
  EXPECT_EQ(bytes_of(folder / "a.seg.nrrd"), bytes_of(folder / "b.seg.nrrd"));
}

TEST(SegmentationFile, WritesTheHeaderThatSlicerReads) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_segmentation(folder / "a.seg.nrrd", sample_labels()));
  const std::string bytes = bytes_of(folder / "a.seg.nrrd");
  const std::string header = bytes.substr(0, bytes.find("\n\n") + 1);
  for (const char* const line : {"\ntype: unsigned char\n",
                                 "\ndimension: 3\n",
                                 "\nspace: left-posterior-superior\n",
                                 "\nsizes: 7 5 6\n",
                                 "\nencoding: gzip\n",
                                 "\nkinds: domain domain domain\n",
                                 "\nSegmentation_ContainedRepresentationNames:=Binary labelmap|",
                                 "\nSegmentation_MasterRepresentation:=Binary labelmap",
                                 "\nSegmentation_SourceRepresentation:=Binary labelmap",
                                 "\nSegmentation_ReferenceImageExtentOffset:=0 0 0",
                                 "\nSegment0_ID:=bone",
                                 "\nSegment0_Name:=bone",
                                 "\nSegment0_Color:=0.95 0.84 0.57",
                                 "\nSegment0_LabelValue:=1",
                                 "\nSegment0_Layer:=0",
                                 "\nSegment0_Extent:=0 6 0 4 0 5",
                                 "\nSegment1_ID:=soft_tissue",
                                 "\nSegment1_Name:=soft tissue",
                                 "\nSegment4_Name:=sinus",
                                 "\nSegment4_LabelValue:=5",
                                 "\nSegment5_Name:=mandible",
                                 "\nSegment5_LabelValue:=6",
                                 "\nSegment6_Name:=muscle",
                                 "\nSegment6_LabelValue:=7"})
    EXPECT_NE(header.find(line), std::string::npos) << line << header;
  EXPECT_EQ(header.find("Segment7"), std::string::npos);
}

/// A file of Slicer: layers first in the list, its own label values, cropped.
std::string slicer_file(const std::string& more, const std::string& voxels) {
  return "NRRD0004\n# Complete NRRD file format specification at:\ntype: unsigned char\n"
         "dimension: 4\nspace: left-posterior-superior\nsizes: 2 2 2 1\n"
         "space directions: none (0.5,0,0) (0,0.5,0) (0,0,2)\nkinds: list domain domain domain\n"
         "encoding: raw\nspace origin: (11,20.5,34)\n" +
         more + "\n" + voxels;
}

const std::string kSlicerSegments =
    "Segment0_ID:=Segment_1\nSegment0_Name:=Bone\nSegment0_LabelValue:=3\nSegment0_Layer:=1\n"
    "Segment1_ID:=Segment_2\nSegment1_Name:=Soft_Tissue\nSegment1_LabelValue:=1\n"
    "Segment1_Layer:=0\nSegment2_ID:=Segment_3\nSegment2_Name:=tumour\n"
    "Segment2_LabelValue:=2\nSegment2_Layer:=0\n"
    "Segmentation_ReferenceImageExtentOffset:=2 1 2\n";

TEST(SegmentationFile, ReadsSlicerFilesByNameLayerAndCrop) {
  const TemporaryFolder folder;
  // Voxel by voxel, layer 0 and layer 1: soft tissue; tumour; bone over soft tissue; nothing.
  write_bytes(folder / "a.seg.nrrd",
              slicer_file(kSlicerSegments, std::string("\1\0\2\0\1\3\0\0", 8)));
  const auto part = read_segmentation(folder / "a.seg.nrrd");
  ASSERT_TRUE(part) << part.error().message;
  EXPECT_EQ(part->grid.size, (std::array<Index, 3>{2, 2, 1}));
  EXPECT_EQ(part->grid.origin_L, Vec3(11, 20.5, 34));
  const std::vector<Tissue> wanted{Tissue::kSoftTissue, Tissue::kBackground, Tissue::kBone,
                                   Tissue::kBackground};
  EXPECT_EQ(part->values, wanted);

  const image::Grid scan{.size = {5, 4, 3}, .spacing_mm = {0.5, 0.5, 2}, .origin_L = {10, 20, 30}};
  const auto whole = read_segmentation(folder / "a.seg.nrrd", scan);
  ASSERT_TRUE(whole) << whole.error().message;
  EXPECT_EQ(whole->grid, scan);
  EXPECT_EQ(whole->at(2, 1, 2), Tissue::kSoftTissue);
  EXPECT_EQ(whole->at(2, 2, 2), Tissue::kBone);
  EXPECT_EQ(std::count(whole->values.begin(), whole->values.end(), Tissue::kBackground), 58);
}

TEST(SegmentationFile, ReadsTheOldFormatWithOneLayerPerSegment) {
  const TemporaryFolder folder;
  write_bytes(folder / "a.seg.nrrd", slicer_file("Segment0_ID:=a\nSegment0_Name:=airway\n"
                                                 "Segment1_ID:=b\nSegment1_Name:=bone\n",
                                                 std::string("\1\0\0\1\1\1\0\0", 8)));
  const auto part = read_segmentation(folder / "a.seg.nrrd");
  ASSERT_TRUE(part) << part.error().message;
  const std::vector<Tissue> wanted{Tissue::kAirway, Tissue::kBone, Tissue::kBone,
                                   Tissue::kBackground};
  EXPECT_EQ(part->values, wanted);
}

/// One segment per layer, one in each of the four voxels.
std::vector<Tissue> tissues_of(const std::string& first, const std::string& second,
                               const std::string& voxels = std::string("\1\0\0\1\1\1\0\0", 8)) {
  const TemporaryFolder folder;
  write_bytes(folder / "a.seg.nrrd",
              slicer_file("Segment0_ID:=a\n" + first + "Segment1_ID:=b\n" + second, voxels));
  const auto part = read_segmentation(folder / "a.seg.nrrd");
  EXPECT_TRUE(part) << part.error().message;
  return part ? part->values : std::vector<Tissue>();
}

TEST(SegmentationFile, RecognizesMuscleByNameOrTerminology) {
  const std::string soft = "Segment1_Name:=soft tissue\n";
  const auto tags = [](const std::string& type) {
    return "Segment0_Tags:=Segmentation.Status:inprogress|TerminologyEntry:Segmentation category "
           "and "
           "type - 3D Slicer General Anatomy list~SCT^85756007^Tissue~" +
           type + "~^^~Anatomic codes - DICOM master list~^^~^^|\n";
  };
  const std::vector<Tissue> muscle{Tissue::kMuscle, Tissue::kSoftTissue, Tissue::kMuscle,
                                   Tissue::kBackground};
  for (const std::string& name : {std::string("Segment0_Name:=Muscle\n"),
                                  std::string("Segment0_Name:=left_masseter_muscle\n"),
                                  "Segment0_Name:=Segment_1\n" + tags("SCT^71616004^Muscle"),
                                  "Segment0_Name:=masseter\n" + tags("SCT^1^Masseter muscle")})
    EXPECT_EQ(tissues_of(name, soft), muscle) << name;
  const std::vector<Tissue> none{Tissue::kBackground, Tissue::kSoftTissue, Tissue::kSoftTissue,
                                 Tissue::kBackground};
  for (const std::string& name :
       {std::string("Segment0_Name:=musclelike\n"),
        "Segment0_Name:=a\n" + tags("SCT^85756007^Tissue"),
        std::string("Segment0_Name:=a\nSegment0_Tags:=TerminologyEntry:muscle\n")})
    EXPECT_EQ(tissues_of(name, soft), none) << name;
  // A known name takes precedence over the terminology.
  EXPECT_EQ(tissues_of("Segment0_Name:=airway\n" + tags("SCT^71616004^Muscle"), soft)[0],
            Tissue::kAirway);
}

TEST(SegmentationFile, MuscleTakesPrecedenceOverSoftTissueOnly) {
  const auto both = [](const std::string& other, Tissue tissue) {
    const std::string a = "Segment0_Name:=", b = "Segment1_Name:=";
    const Tissue above = tissues_of(a + other + "\n", b + "muscle\n")[2];
    const Tissue below = tissues_of(a + "muscle\n", b + other + "\n")[2];
    EXPECT_EQ(above, tissue) << other;
    EXPECT_EQ(below, tissue) << other;
  };
  both("soft tissue", Tissue::kMuscle);
  both("bone", Tissue::kBone);
  both("mandible", Tissue::kMandible);
  both("airway", Tissue::kAirway);
  both("sinus", Tissue::kSinus);
  both("brain", Tissue::kBrain);
}

TEST(SegmentationFile, ReportsSegmentsWithoutTissueName) {
  const TemporaryFolder folder;
  class Notes : public Progress {
   public:
    void note(std::string_view sentence) override { sentences.emplace_back(sentence); }
    std::vector<std::string> sentences;
  } notes;
  write_bytes(folder / "a.seg.nrrd",
              slicer_file(kSlicerSegments, std::string("\1\0\2\0\1\3\0\0", 8)));
  const image::Grid scan{.size = {5, 4, 3}, .spacing_mm = {0.5, 0.5, 2}, .origin_L = {10, 20, 30}};
  ASSERT_TRUE(read_segmentation(folder / "a.seg.nrrd", scan, notes));
  EXPECT_EQ(notes.sentences,
            std::vector<std::string>{"warning: segmentation: no tissue is named \"tumour\": its "
                                     "voxels count as unpainted"});
}

TEST(SegmentationFile, RejectsLabelsBetweenTheVoxelsOfTheScan) {
  const TemporaryFolder folder;
  write_bytes(folder / "a.seg.nrrd", slicer_file(kSlicerSegments, std::string(8, '\1')));
  const image::Grid scan{.size = {5, 4, 3}, .spacing_mm = {0.5, 0.5, 2}, .origin_L = {10, 20, 30}};
  image::Grid shifted = scan;
  shifted.origin_L.x() += 0.2;
  image::Grid finer = scan;
  finer.spacing_mm.x() = 0.4;
  image::Grid turned = scan;
  turned.direction = test::oblique();
  for (const image::Grid& grid : {shifted, finer, turned}) {
    const auto result = read_segmentation(folder / "a.seg.nrrd", grid);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, ErrorCode::kFileCorrupt);
  }
}

TEST(SegmentationFile, RejectsLabelsOutsideTheScanAndReportsPartialOverlap) {
  const TemporaryFolder folder;
  const image::Grid scan{.size = {5, 4, 3}, .spacing_mm = {0.5, 0.5, 2}, .origin_L = {10, 20, 30}};
  class Notes : public Progress {
   public:
    void note(std::string_view sentence) override { sentences.emplace_back(sentence); }
    std::vector<std::string> sentences;
  } notes;
  const auto code = [&](const image::Grid& grid) {
    const auto result = read_segmentation(folder / "a.seg.nrrd", grid, notes);
    return result ? ErrorCode::kNotConverged : result.error().code;
  };
  // Soft tissue in all four voxels, (2, 1, 2) to (3, 2, 2) of the scan.
  write_bytes(folder / "a.seg.nrrd",
              slicer_file(kSlicerSegments, std::string("\1\0\1\0\1\0\1\0", 8)));
  EXPECT_EQ(code(scan), ErrorCode::kNotConverged);
  EXPECT_TRUE(notes.sentences.empty());
  image::Grid narrow = scan;
  narrow.size[0] = 3;
  EXPECT_EQ(code(narrow), ErrorCode::kNotConverged);
  EXPECT_EQ(
      notes.sentences,
      std::vector<std::string>{"50 % of the labeled voxels are outside the scan and are omitted"});
  image::Grid beside = scan;
  beside.origin_L.x() += 5.0;
  EXPECT_EQ(code(beside), ErrorCode::kFileCorrupt);
  // Only background inside.
  write_bytes(folder / "a.seg.nrrd", slicer_file(kSlicerSegments, std::string(8, '\0')));
  EXPECT_EQ(code(scan), ErrorCode::kFileCorrupt);
}

/// A grid in which the four voxels of slicer_file() are (2, 1, 2) to (3, 2, 2).
const image::Grid kScan{.size = {5, 4, 3}, .spacing_mm = {0.5, 0.5, 2}, .origin_L = {10, 20, 30}};

TEST(SegmentationFile, ReadsBoundaryLabelsByNameOnTheScan) {
  using predict::BoundaryLabel;
  const TemporaryFolder folder;
  write_bytes(folder / "a.seg.nrrd",
              slicer_file("Segment0_ID:=a\nSegment0_Name:=Fixed\nSegment0_LabelValue:=1\n"
                          "Segment0_Layer:=0\n"
                          "Segment1_ID:=free\nSegment1_LabelValue:=2\nSegment1_Layer:=0\n"
                          "Segment2_ID:=c\nSegment2_Name:=with_segment\nSegment2_LabelValue:=1\n"
                          "Segment2_Layer:=1\n",
                          std::string("\1\0\2\0\1\1\0\0", 8)));
  const auto painted = read_boundary_labels(folder / "a.seg.nrrd", kScan);
  ASSERT_TRUE(painted) << painted.error().message;
  EXPECT_EQ(painted->grid, kScan);
  EXPECT_EQ(painted->at(2, 1, 2), BoundaryLabel::kFixed);
  EXPECT_EQ(painted->at(3, 1, 2), BoundaryLabel::kFree);
  EXPECT_EQ(painted->at(2, 2, 2), BoundaryLabel::kWithSegment);  // Over fixed.
  EXPECT_EQ(std::count(painted->values.begin(), painted->values.end(), BoundaryLabel::kNone), 57);
}

TEST(SegmentationFile, ReadsEachBoundaryLabelAndTheFormerNameOfContact) {
  using predict::BoundaryLabel;
  const TemporaryFolder folder;
  const auto label_named = [&](const std::string& name) {
    write_bytes(folder / "a.seg.nrrd",
                slicer_file("Segment0_ID:=a\nSegment0_Name:=" + name +
                                "\nSegment0_LabelValue:=1\nSegment0_Layer:=0\n",
                            std::string("\1\0\0\0\0\0\0\0", 8)));
    return read_boundary_labels(folder / "a.seg.nrrd", kScan).value().at(2, 1, 2);
  };
  for (const predict::BoundaryLabelStyle& style : predict::kBoundaryLabelStyles)
    EXPECT_EQ(label_named(style.name), style.label) << style.name;
  EXPECT_EQ(label_named("slides"), BoundaryLabel::kContact);
  EXPECT_EQ(label_named("Slides"), BoundaryLabel::kContact);
}

TEST(SegmentationFile, ReadsBoundaryLabelsOfAPartOfTheScan) {
  using predict::BoundaryLabel;
  const TemporaryFolder folder;
  predict::BoundaryLabelMap part{kScan, {}};
  part.grid.size = {2, 1, 2};
  part.grid.origin_L = kScan.point_L(Vec3(1, 2, 1));
  part.values = {BoundaryLabel::kFixed, BoundaryLabel::kNone, BoundaryLabel::kFree,
                 BoundaryLabel::kWithSegment};
  ASSERT_TRUE(write_boundary_labels(folder / "a.seg.nrrd", part));
  const auto painted = read_boundary_labels(folder / "a.seg.nrrd", kScan);
  ASSERT_TRUE(painted) << painted.error().message;
  EXPECT_EQ(painted->at(1, 2, 1), BoundaryLabel::kFixed);
  EXPECT_EQ(painted->at(1, 2, 2), BoundaryLabel::kFree);
  EXPECT_EQ(painted->at(2, 2, 2), BoundaryLabel::kWithSegment);
  EXPECT_EQ(std::count(painted->values.begin(), painted->values.end(), BoundaryLabel::kNone),
            kScan.voxel_count() - 3);
  ASSERT_TRUE(write_boundary_labels(folder / "b.seg.nrrd", part));
  EXPECT_EQ(read_text(folder / "a.seg.nrrd", 1 << 20).value(),
            read_text(folder / "b.seg.nrrd", 1 << 20).value());
  EXPECT_FALSE(write_boundary_labels(folder / "a.nrrd", part));
}

TEST(SegmentationFile, RejectsUnknownBoundaryLabelsAndThoseOfAnotherScan) {
  const TemporaryFolder folder;
  const auto error_message = [&](const std::string& segments, const image::Grid& grid = kScan,
                                 char voxel = '\1') {
    write_bytes(folder / "a.seg.nrrd", slicer_file(segments, std::string(8, voxel)));
    const auto result = read_boundary_labels(folder / "a.seg.nrrd", grid);
    if (result) return std::string("read");
    test::expect_one_sentence(result.error().message);
    return result.error().message;
  };
  const std::string fixed = "Segment0_ID:=a\nSegment0_Name:=fixed\n";
  EXPECT_EQ(error_message(fixed), "read");
  EXPECT_EQ(error_message(fixed + "Segment1_ID:=b\nSegment1_Name:=Slippery\n"),
            "boundary.labels: segment 1 is named \"Slippery\", expected fixed, free, with segment, "
            "contact, bonded, elevated or sliding");
  EXPECT_NE(error_message("Segment0_ID:=a\\nb" + std::string(5000, 'c') + "\n").find("bccc"),
            std::string::npos);
  EXPECT_NE(error_message("Segment0_ID:=Segment_1\n").find("\"Segment_1\""), std::string::npos);
  EXPECT_NE(error_message("").find("no segment has the name of a boundary label"),
            std::string::npos);
  EXPECT_NE(error_message(fixed + "Segment0_Layer:=2\n").find("no label value"), std::string::npos);
  EXPECT_NE(error_message(fixed, kScan, '\0').find("none of its 0"), std::string::npos);
  image::Grid shifted = kScan;
  shifted.origin_L.x() += 0.2;
  EXPECT_NE(error_message(fixed, shifted).find("do not coincide with those of the scan"),
            std::string::npos);
  image::Grid beside = kScan;
  beside.origin_L.x() += 5.0;
  EXPECT_NE(error_message(fixed, beside).find("is inside the scan"), std::string::npos);
  write_bytes(folder / "a.seg.nrrd", "NRRD0004\n");
  EXPECT_FALSE(read_boundary_labels(folder / "a.seg.nrrd", kScan));
  EXPECT_EQ(read_boundary_labels(folder / "none.seg.nrrd", kScan).error().code,
            ErrorCode::kFileNotFound);
  EXPECT_EQ(read_boundary_labels(folder / "a.nrrd", kScan).error().code,
            ErrorCode::kFileUnsupported);
}

TEST(SegmentationFile, RejectsFilesWithoutTissuesOrWithInvalidSegments) {
  const TemporaryFolder folder;
  const auto code = [&](const std::string& segments) {
    write_bytes(folder / "a.seg.nrrd", slicer_file(segments, std::string(8, '\1')));
    const auto result = read_segmentation(folder / "a.seg.nrrd");
    if (result) return ErrorCode::kNotConverged;
    test::expect_one_sentence(result.error().message);
    return result.error().code;
  };
  const std::string bone = "Segment0_ID:=a\nSegment0_Name:=bone\n";
  EXPECT_EQ(code(""), ErrorCode::kFileUnsupported);
  EXPECT_EQ(code("Segment0_ID:=a\nSegment0_Name:=tumour\n"), ErrorCode::kFileUnsupported);
  EXPECT_EQ(code(bone + "Segment0_Layer:=2\n"), ErrorCode::kFileCorrupt);
  EXPECT_EQ(code(bone + "Segment0_Layer:=-1\n"), ErrorCode::kFileCorrupt);
  EXPECT_EQ(code(bone + "Segment0_LabelValue:=x\n"), ErrorCode::kFileCorrupt);
  EXPECT_EQ(read_segmentation(folder / "none.seg.nrrd").error().code, ErrorCode::kFileNotFound);
  EXPECT_EQ(read_segmentation(folder / "a.nrrd").error().code, ErrorCode::kFileUnsupported);
  EXPECT_EQ(write_segmentation(folder / "a.nrrd", sample_labels()).error().code,
            ErrorCode::kInvalidArgument);
  EXPECT_EQ(write_segmentation("/nonexistent/a.seg.nrrd", sample_labels()).error().code,
            ErrorCode::kFileUnwritable);
}

}  // namespace
}  // namespace lefort::io::test_segmentation_file
