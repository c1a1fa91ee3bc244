// What we write for 3D Slicer, read back by others: ITK, which Slicer itself reads with, and Python's
// standard library, by the letter of the formats.
#include <lefort/io/markups_file.h>
#include <lefort/io/segmentation_file.h>
#include <lefort/io/volume_files.h>

#include <gtest/gtest.h>
#include <itkImage.h>
#include <itkImageFileReader.h>
#include <itkMetaDataObject.h>
#include <itkNrrdImageIO.h>

#include "io/sample_scan.h"
#include "support/run_python.h"
#include "support/temporary_folder.h"

namespace lefort::io {
namespace {

using anatomy::LabelMap;
using anatomy::Tissue;
using test::TemporaryFolder;

LabelMap sample_labels() {
  LabelMap labels{test::sample_scan(test::oblique()).grid, {}};
  for (Index n = 0; n < labels.grid.voxel_count(); ++n)
    labels.values.push_back(static_cast<Tissue>((n * n / 7) % 7));
  return labels;
}

/// ITK is LPS, as we are.
template <class Pixel>
typename itk::Image<Pixel, 3>::Pointer read_by_itk(const std::filesystem::path& file) {
  auto reader = itk::ImageFileReader<itk::Image<Pixel, 3>>::New();
  reader->SetImageIO(itk::NrrdImageIO::New());
  reader->SetFileName(file.string());
  reader->Update();
  return reader->GetOutput();
}

template <class Pixel, class Volume>
void expect_same(const itk::Image<Pixel, 3>& image, const Volume& volume) {
  const image::Grid& grid = volume.grid;
  for (Index k = 0; k < grid.size[2]; ++k)
    for (Index j = 0; j < grid.size[1]; ++j)
      for (Index i = 0; i < grid.size[0]; ++i) {
        const itk::Index<3> index{{i, j, k}};
        ASSERT_EQ(image.GetPixel(index), static_cast<Pixel>(volume.at(i, j, k)));
        itk::Point<double, 3> point;
        image.TransformIndexToPhysicalPoint(index, point);
        const Vec3 p_L = grid.point_L({double(i), double(j), double(k)});
        ASSERT_LT((Vec3(point[0], point[1], point[2]) - p_L).norm(), 1e-6);
      }
}

TEST(SlicerFiles, ItkReadsLabelsWhereTheyLieInThePatient) {
  const TemporaryFolder folder;
  const LabelMap labels = sample_labels();
  ASSERT_TRUE(write_segmentation(folder / "a.seg.nrrd", labels));
  const auto image = read_by_itk<std::uint8_t>(folder / "a.seg.nrrd");
  expect_same(*image, labels);
  std::string name;
  itk::ExposeMetaData(image->GetMetaDataDictionary(), "Segment5_Name", name);
  EXPECT_EQ(name, "mandible");
}

TEST(SlicerFiles, ItkReadsTheScanWhereItLiesInThePatient) {
  const TemporaryFolder folder;
  const image::CtVolume ct = test::sample_scan(test::oblique());
  ASSERT_TRUE(write_volume(folder / "ct.nrrd", ct));
  expect_same(*read_by_itk<std::int16_t>(folder / "ct.nrrd"), ct);
}

/// Checks a NRRD file line by line, without any library that knows the format.
constexpr const char* kReadNrrd = R"(
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
)";

TEST(SlicerFiles, PythonReadsLabelsByTheLetterOfTheFormat) {
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
                                                             {Tissue::kMandible, "mandible"}})
    wanted += std::string(name) + " " +
              std::to_string(std::count(labels.values.begin(), labels.values.end(), tissue)) + "\n";
  EXPECT_EQ(out, wanted);
}

}  // namespace
}  // namespace lefort::io
