// Files written for 3D Slicer, read back by Python's standard library according to the format.
#include <lefort/io/segmentation_file.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <string>

#include "io/sample_labels.h"
#include "io/sample_scan.h"
#include "support/run_python.h"
#include "support/temporary_folder.h"

namespace lefort::io::test_slicer_files {
namespace {

using anatomy::LabelMap;
using anatomy::Tissue;
using test::sample_labels;
using test::TemporaryFolder;

/// Checks a NRRD file line by line, without a library of the format.
constexpr const char* kReadNrrd = R"py(
import gzip, re, sys
head, voxels = open(sys.argv[1], "rb").read().split(b"\n\n", 1)
lines = head.decode("utf-8").split("\n")
assert re.fullmatch("NRRD000[1-5]", lines[0]), lines[0]
fields, pairs = {}, {}
for line in lines[1:]:
    if line.startswith("#"): continue
    (pairs if ":=" in line else fields).update([line.split(":=" if ":=" in line else ": ", 1)])
sizes = [int(n) for n in fields["sizes"].split()]
assert len(sizes) == int(fields["dimension"]) == 3
assert fields["space"] == "left-posterior-superior" and fields["encoding"] in ("gzip", "gz")
vectors = [[float(x) for x in v.split(",")] for v in re.findall(r"\(([^)]*)\)", fields["space directions"])]
lengths = [sum(x * x for x in v) ** 0.5 for v in vectors]
assert all(abs(a - b) < 1e-9 for a, b in zip(lengths, (0.4, 0.5, 1.25))), lengths
assert len(re.findall(r"[^(), ]+", fields["space origin"])) == 3
voxels = gzip.decompress(voxels)
assert len(voxels) == sizes[0] * sizes[1] * sizes[2], len(voxels)
names, n = {}, 0
while f"Segment{n}_ID" in pairs:
    value = int(pairs[f"Segment{n}_LabelValue"])
    assert pairs[f"Segment{n}_Layer"] == "0" and value not in names
    assert pairs[f"Segment{n}_Extent"] == " ".join(f"0 {s - 1}" for s in sizes)
    assert all(0 <= float(c) <= 1 for c in pairs[f"Segment{n}_Color"].split())
    names[value] = pairs[f"Segment{n}_Name"]
    n += 1
for value in sorted(names): print(names[value], voxels.count(bytes([value])))
)py";

TEST(SlicerFiles, PythonReadsLabelsByTheDefinitionOfTheFormat) {
  const TemporaryFolder folder;
  const LabelMap labels = sample_labels();
  ASSERT_TRUE(write_segmentation(folder / "a.seg.nrrd", labels));
  const auto [ran, out] = test::run_python(kReadNrrd, (folder / "a.seg.nrrd").string());
  ASSERT_TRUE(ran) << out;
  std::string wanted;
  for (const auto& [tissue, name] :
       std::initializer_list<std::pair<Tissue, const char*>>{{Tissue::kBone, "bone"},
                                                             {Tissue::kSoftTissue, "soft tissue"},
                                                             {Tissue::kAirway, "airway"},
                                                             {Tissue::kBrain, "brain"},
                                                             {Tissue::kSinus, "sinus"},
                                                             {Tissue::kMandible, "mandible"},
                                                             {Tissue::kMuscle, "muscle"}})
    wanted += std::string(name) + " " +
              std::to_string(std::count(labels.values.begin(), labels.values.end(), tissue)) + "\n";
  EXPECT_EQ(out, wanted);
}

TEST(SlicerFiles, ReadsLabelsEditedByAnotherProgram) {
  const TemporaryFolder folder;
  LabelMap labels = sample_labels();
  for (Tissue& label : labels.values)
    if (label == Tissue::kMuscle) label = Tissue::kSoftTissue;
  ASSERT_TRUE(write_segmentation(folder / "a.seg.nrrd", labels));
  const Vec3 center_L = labels.grid.point_L(Vec3(3.0, 2.0, 2.0));
  constexpr double kRadius_mm = 1.5;
  const auto paint = [&](const std::string& source, const std::string& target,
                         const std::string& how) {
    const std::string command = std::string("python3 " LEFORT_SCRIPTS "/paint_segment '") +
                                (folder / source).string() + "' '" + (folder / target).string() +
                                "' " + how + " >/dev/null 2>&1";
    return std::system(command.c_str()) == 0;
  };
  const std::string ball =
      fmt::format(" --ball {} {} {} {}", center_L.x(), center_L.y(), center_L.z(), kRadius_mm);
  ASSERT_TRUE(paint("a.seg.nrrd", "b.seg.nrrd", "muscle --only \"soft tissue\"" + ball));
  const auto found = read_segmentation(folder / "b.seg.nrrd", labels.grid);
  ASSERT_TRUE(found) << found.error().message;
  Index painted = 0;
  for (Index v = 0; v < labels.grid.voxel_count(); ++v) {
    const auto [nx, ny, nz] = labels.grid.size;
    const Vec3 p_L =
        labels.grid.point_L(Vec3(double(v % nx), double(v / nx % ny), double(v / (nx * ny))));
    const bool is_in = (p_L - center_L).norm() <= kRadius_mm;
    const Tissue before = labels.values[std::size_t(v)], after = found->values[std::size_t(v)];
    EXPECT_EQ(after, is_in && before == Tissue::kSoftTissue ? Tissue::kMuscle : before) << v;
    painted += after == Tissue::kMuscle;
  }
  EXPECT_GT(painted, 2);
  EXPECT_FALSE(paint("a.seg.nrrd", "c.seg.nrrd", "muscle --only fat" + ball));

  // A boundary of two labels, on the grid of the labels.
  ASSERT_TRUE(paint("a.seg.nrrd", "c.seg.nrrd", "fixed --empty" + ball));
  ASSERT_TRUE(paint("c.seg.nrrd", "c.seg.nrrd",
                    fmt::format("\"with segment\" --ball {} {} {} 0.1", center_L.x(), center_L.y(),
                                center_L.z())));
  const auto boundary = read_boundary_labels(folder / "c.seg.nrrd", labels.grid);
  ASSERT_TRUE(boundary) << boundary.error().message;
  EXPECT_EQ(boundary->at(3, 2, 2), predict::BoundaryLabel::kWithSegment);
  EXPECT_EQ(boundary->at(2, 2, 2), predict::BoundaryLabel::kFixed);
  EXPECT_EQ(boundary->at(0, 0, 0), predict::BoundaryLabel::kNone);
}

}  // namespace
}  // namespace lefort::io::test_slicer_files
