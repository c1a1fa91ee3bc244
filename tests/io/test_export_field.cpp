#include <lefort/field/build/build_distance_field.h>
#include <lefort/io/export_field.h>
#include <lefort/io/internal/raw_volume.h>

#include <gtest/gtest.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Diagnostics.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace lefort::io::test_export_field {
namespace {

using field::DistanceField;
using field::FieldMethod;
using field::LatticePoint;
using geometry::TriangleMesh;
using test::TemporaryFolder;

constexpr FieldMethod kMethods[] = {FieldMethod::kBricks, FieldMethod::kHybrid,
                                    FieldMethod::kAdaptive, FieldMethod::kUniform};

/// A ball with a cavity: inside and outside beyond the band, and a band on both sides.
TriangleMesh hollow_ball() {
  return test::join(test::make_icosphere(20, 3, Vec3(5, -3, 2)),
                    test::turn_inside_out(test::make_icosphere(9, 3, Vec3(5, -3, 2))));
}

DistanceField build(const TriangleMesh& mesh, FieldMethod method, bool smooth = false) {
  return field::build_distance_field(
             mesh, {.method = method, .resolution = 64, .band_mm = 3.0, .smooth = smooth})
      .value();
}

openvdb::FloatGrid::Ptr read_vdb(const std::filesystem::path& path) {
  openvdb::initialize();
  openvdb::io::File file(path.string());
  file.open();
  const auto grids = file.getGrids();
  EXPECT_EQ(grids->size(), 1U);
  return openvdb::gridPtrCast<openvdb::FloatGrid>(grids->front());
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Returns the field's value at a lattice point.
class Samples {
 public:
  explicit Samples(const DistanceField& field) : field_(field) {}
  float at(const LatticePoint& p) {
    const LatticePoint first = {p[0] / 8 * 8, p[1] / 8 * 8, p[2] / 8 * 8};
    auto [block, fresh] = blocks_.try_emplace(first);
    if (fresh) read_block(field_, first, block->second);
    return block->second.at(p);
  }

 private:
  const DistanceField& field_;
  std::map<LatticePoint, field::SampleBlock> blocks_;
};

/// Returns the exported value of a sample in both formats, except for unknown samples.
float exported(float sample, double band_mm) {
  const auto band = float(band_mm);
  if (std::isinf(sample)) return std::copysign(band, sample);
  const float maximum = std::nextafter(band, 0.0F);
  return std::clamp(sample, -maximum, maximum);
}

TEST(ExportField, OpenVdbReadsBackEverySampleBitForBit) {
  const TemporaryFolder folder;
  for (const FieldMethod method : kMethods)
    for (const bool smooth : {false, true}) {
      const DistanceField field = build(hollow_ball(), method, smooth);
      const auto done = export_field(folder / "a.vdb", field);
      ASSERT_TRUE(done) << done.error().message;
      EXPECT_EQ(done->count, count_samples(field).value());
      EXPECT_EQ(done->count.unknown, 0);
      const auto grid = read_vdb(folder / "a.vdb");
      EXPECT_EQ(Index(grid->activeVoxelCount()), done->count.known);
      Samples samples(field);
      const auto accessor = grid->getConstAccessor();
      for (int k = 0; k <= 64; ++k)
        for (int j = 0; j <= 64; ++j)
          for (int i = 0; i <= 64; ++i) {
            const float sample = samples.at({i, j, k});
            const openvdb::Coord at(i, j, k);
            ASSERT_EQ(accessor.getValue(at), exported(sample, field.band_mm()));
            ASSERT_EQ(accessor.isValueOn(at), std::isfinite(sample));
          }
      if (method == FieldMethod::kBricks && !smooth) break;
    }
}

TEST(ExportField, OpenVdbReadsAValidLevelSetAtItsPosition) {
  const TemporaryFolder folder;
  const DistanceField field = build(hollow_ball(), FieldMethod::kBricks);
  ASSERT_TRUE(export_field(folder / "a.vdb", field));
  const auto grid = read_vdb(folder / "a.vdb");
  EXPECT_EQ(grid->getName(), "distance_mm");
  EXPECT_EQ(grid->getGridClass(), openvdb::GRID_LEVEL_SET);
  EXPECT_EQ(grid->background(), float(field.band_mm()));
  // All checks except that of the gradient, which fails at the center of the ball and at the
  // boundary of the band.
  EXPECT_EQ(openvdb::tools::checkLevelSet(*grid, 8), "");
  const openvdb::Vec3d first = grid->indexToWorld(openvdb::Coord(0, 0, 0)),
                       next = grid->indexToWorld(openvdb::Coord(1, 2, 3));
  for (int k = 0; k < 3; ++k) {
    EXPECT_DOUBLE_EQ(first[k], field.frame().origin_B[k]);
    EXPECT_DOUBLE_EQ(next[k], field.frame().origin_B[k] + (k + 1) * field.cell_mm());
  }
  EXPECT_EQ(grid->getMetadata<openvdb::StringMetadata>("lefort_space")->value(), "LPS");
  EXPECT_EQ(grid->getMetadata<openvdb::StringMetadata>("lefort_closed")->value(), "yes");

  // Sampling in world coordinates, as other programs do, near the surface and far from it.
  const auto sample = [&](double x) {
    return double(
        openvdb::tools::GridSampler<openvdb::FloatGrid, openvdb::tools::BoxSampler>(*grid).wsSample(
            openvdb::Vec3d(5 + x, -3, 2)));
  };
  EXPECT_NEAR(sample(20.5), 0.5, 0.15);
  EXPECT_NEAR(sample(19.0), -1.0, 0.15);
  EXPECT_NEAR(sample(9.7), -0.7, 0.15);
  EXPECT_NEAR(sample(8.0), 1.0, 0.15);
  EXPECT_EQ(sample(14.5), -3.0);  // In the wall, beyond the band.
  EXPECT_EQ(sample(0.0), 3.0);    // In the cavity.
  EXPECT_EQ(sample(500.0), 3.0);  // Beyond the field.
}

TEST(ExportField, OpenVdbReconstructsTheSurface) {
  const TemporaryFolder folder;
  ASSERT_TRUE(export_field(folder / "a.vdb", build(hollow_ball(), FieldMethod::kHybrid)));
  const auto grid = read_vdb(folder / "a.vdb");
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*grid, points, quads);
  ASSERT_GT(points.size(), 1000U);
  for (const openvdb::Vec3s& p : points) {
    const double r = (Vec3(double(p.x()), double(p.y()), double(p.z())) - Vec3(5, -3, 2)).norm();
    ASSERT_LT(std::min(std::abs(r - 20.0), std::abs(r - 9.0)), 0.3);
  }
}

TEST(ExportField, StoresTheInteriorAsTiles) {
  const TemporaryFolder folder;
  const auto solid =
      field::build_distance_field(test::make_icosphere(20, 3), {.resolution = 128, .band_mm = 1.5})
          .value();
  ASSERT_TRUE(export_field(folder / "a.vdb", solid));
  const auto grid = read_vdb(folder / "a.vdb");
  EXPECT_LT(grid->tree().leafCount(), 16U * 16U * 16U / 2U);
  EXPECT_EQ(grid->tree().getValue(openvdb::Coord(64, 64, 64)), -1.5F);
  EXPECT_FALSE(grid->tree().probeConstLeaf(openvdb::Coord(64, 64, 64)));
  EXPECT_FALSE(grid->tree().probeConstLeaf(openvdb::Coord(0, 0, 0)));
}

TEST(ExportField, UnknownSamplesAreInactiveInOpenVdbAndNaNInNrrd) {
  const TemporaryFolder folder;
  const DistanceField field = build(test::make_sheet(20, 4), FieldMethod::kBricks);
  const auto done = export_field(folder / "a.vdb", field);
  ASSERT_TRUE(done);
  EXPECT_GT(done->count.unknown, 0);
  ASSERT_TRUE(export_field(folder / "a.nrrd", field));
  const auto grid = read_vdb(folder / "a.vdb");
  const RawVolume raw = read_raw_volume(folder / "a.nrrd").value();
  EXPECT_EQ(raw.fields.at("lefort_closed"), "no");
  Samples samples(field);
  with_values(raw, [&](const auto values) {
    for (int k = 0; k <= 64; ++k)
      for (int j = 0; j <= 64; ++j)
        for (int i = 0; i <= 64; ++i) {
          const bool known = std::isfinite(samples.at({i, j, k}));
          const openvdb::Coord at(i, j, k);
          ASSERT_EQ(grid->tree().isValueOn(at), known);
          if (!known) {
            ASSERT_EQ(grid->tree().getValue(at), 3.0F);
          }
          ASSERT_EQ(std::isnan(double(values[std::size_t(raw.grid.offset(i, j, k))])), !known);
        }
  });
}

TEST(ExportField, NrrdReadsBackEverySampleBitForBit) {
  const TemporaryFolder folder;
  for (const FieldMethod method : kMethods) {
    const DistanceField field = build(hollow_ball(), method);
    const auto done = export_field(folder / "a.nrrd", field);
    ASSERT_TRUE(done) << done.error().message;
    EXPECT_EQ(done->count, count_samples(field).value());
    const RawVolume raw = read_raw_volume(folder / "a.nrrd").value();
    EXPECT_EQ(raw.type, ScalarType::kFloat);
    EXPECT_EQ(raw.grid.size, (std::array<Index, 3>{65, 65, 65}));
    EXPECT_EQ(raw.grid.direction, Mat3(Mat3::Identity()));
    EXPECT_LT((raw.grid.origin_L - field.frame().origin_B).norm(), 1e-12);
    EXPECT_LT((raw.grid.spacing_mm - Vec3::Constant(field.cell_mm())).norm(), 1e-12);
    EXPECT_EQ(raw.fields.at("lefort_unknown"), "NaN");
    EXPECT_EQ(std::stod(raw.fields.at("lefort_band_mm")), 3.0);
    EXPECT_EQ(raw.fields.at("lefort_beyond_band"),
              "lefort_band_mm outside, -lefort_band_mm inside");
    Samples samples(field);
    with_values(raw, [&](const auto values) {
      for (int k = 0; k <= 64; ++k)
        for (int j = 0; j <= 64; ++j)
          for (int i = 0; i <= 64; ++i)
            ASSERT_EQ(float(values[std::size_t(raw.grid.offset(i, j, k))]),
                      exported(samples.at({i, j, k}), field.band_mm()));
    });
  }
}

TEST(ExportField, EqualFieldsGiveEqualNrrdFiles) {
  const TemporaryFolder folder;
  const DistanceField field = build(hollow_ball(), FieldMethod::kBricks);
  ASSERT_TRUE(export_field(folder / "a.nrrd", field));
  ASSERT_TRUE(export_field(folder / "b.nrrd", field));
  EXPECT_EQ(bytes_of(folder / "a.nrrd"), bytes_of(folder / "b.nrrd"));
}

TEST(ExportField, ExportsARegionOfTheField) {
  const TemporaryFolder folder;
  for (const FieldMethod method : kMethods) {
    const DistanceField field = build(hollow_ball(), method);
    const Box3 region(Vec3(-3.3, -11, 2), Vec3(27, 8, 19.7));
    for (const int every : {1, 2}) {
      const FieldExportOptions options{.region_B = region, .every = every};
      const auto vdb = export_field(folder / "a.vdb", field, options),
                 nrrd = export_field(folder / "a.nrrd", field, options);
      ASSERT_TRUE(vdb && nrrd) << vdb.error().message;
      EXPECT_EQ(vdb->count, nrrd->count);
      EXPECT_EQ(nrrd->count.total(), nrrd->window.size());
      EXPECT_GT(vdb->count.inside, 0);
      const auto grid = read_vdb(folder / "a.vdb");
      const RawVolume raw = read_raw_volume(folder / "a.nrrd").value();
      Samples samples(field);
      with_values(raw, [&](const auto values) {
        for (int k = 0; k < int(raw.grid.size[2]); ++k)
          for (int j = 0; j < int(raw.grid.size[1]); ++j)
            for (int i = 0; i < int(raw.grid.size[0]); ++i) {
              const Vec3 place = raw.grid.point_L(Vec3(i, j, k));
              ASSERT_TRUE(region.contains(place));
              const Vec3 u = (place - field.frame().origin_B) / field.cell_mm();
              const LatticePoint p = {int(std::lround(u.x())), int(std::lround(u.y())),
                                      int(std::lround(u.z()))};
              const float wanted = exported(samples.at(p), field.band_mm());
              ASSERT_EQ(float(values[std::size_t(raw.grid.offset(i, j, k))]), wanted);
              // The same position by OpenVDB's transform.
              const openvdb::Coord at = grid->transform().worldToIndexCellCentered(
                  openvdb::Vec3d(place.x(), place.y(), place.z()));
              ASSERT_EQ(grid->tree().getValue(at), wanted);
            }
      });
      EXPECT_EQ(grid->tree().getValue(openvdb::Coord(0, 0, 0)), 3.0F);  // Not in the region.
    }
  }
}

TEST(ExportField, RejectsADenseVolumeBeyondTheMemoryLimit) {
  const TemporaryFolder folder;
  const DistanceField field = build(hollow_ball(), FieldMethod::kBricks);
  // 65^3 floats, and room for their file.
  const std::uint64_t needed = 2 * 4 * 65 * 65 * 65;
  const auto rejected = export_field(folder / "a.nrrd", field, {.max_bytes = needed - 1});
  ASSERT_FALSE(rejected);
  EXPECT_EQ(rejected.error().code, ErrorCode::kOutOfMemory);
  for (const char* part : {"1098500 bytes", "65 x 65 x 65", "--region", "--stride", ".vdb"})
    EXPECT_NE(rejected.error().message.find(part), std::string::npos) << rejected.error().message;
  EXPECT_EQ(folder.entry_count(), 0);
  EXPECT_TRUE(export_field(folder / "a.nrrd", field, {.max_bytes = needed}));
  EXPECT_TRUE(export_field(folder / "b.nrrd", field, {.every = 2, .max_bytes = needed / 7}));
  EXPECT_TRUE(export_field(folder / "a.vdb", field, {.max_bytes = 1}));  // Not dense.
}

TEST(ExportField, RejectsInvalidTargetsAndRegions) {
  const TemporaryFolder folder;
  const DistanceField field = build(hollow_ball(), FieldMethod::kBricks);
  EXPECT_EQ(export_field(folder / "a.vti", field).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(export_field(folder / "a.vdb", field, {.every = 0}).error().code,
            ErrorCode::kInvalidArgument);
  // 3 mm is less than two voxels of three cells.
  const auto coarse = export_field(folder / "a.vdb", field, {.every = 3});
  ASSERT_FALSE(coarse);
  EXPECT_EQ(coarse.error().code, ErrorCode::kInvalidArgument);
  EXPECT_NE(coarse.error().message.find("level set"), std::string::npos);
  const Box3 elsewhere(Vec3(500, 0, 0), Vec3(600, 9, 9));
  for (const char* name : {"a.vdb", "a.nrrd"}) {
    EXPECT_EQ(export_field(folder / name, field, {.region_B = elsewhere}).error().code,
              ErrorCode::kInvalidArgument);
    EXPECT_EQ(export_field(std::filesystem::path("/nonexistent") / name, field).error().code,
              ErrorCode::kFileUnwritable);
  }
  EXPECT_EQ(folder.entry_count(), 0);
}

TEST(ExportField, RejectsVoxelsTooSmallForOpenVdb) {
  const TemporaryFolder folder;
  const auto tiny = field::build_distance_field(test::make_icosphere(6e-4, 2), {.resolution = 128});
  ASSERT_TRUE(tiny) << tiny.error().message;
  const auto rejected = export_field(folder / "a.vdb", *tiny);
  ASSERT_FALSE(rejected);
  EXPECT_EQ(rejected.error().code, ErrorCode::kInvalidArgument);
  EXPECT_NE(rejected.error().message.find("too small for OpenVDB"), std::string::npos);
  EXPECT_EQ(folder.entry_count(), 0);
}

/// Requests a stop from the beginning.
struct Impatient : Progress {
  [[nodiscard]] bool stop_requested() const override { return true; }
};

TEST(ExportField, LeavesNoFileWhenStopped) {
  const TemporaryFolder folder;
  Impatient impatient;
  for (const char* name : {"a.vdb", "a.nrrd"})
    EXPECT_EQ(export_field(folder / name, build(hollow_ball(), FieldMethod::kBricks), {}, impatient)
                  .error()
                  .code,
              ErrorCode::kCancelled);
  EXPECT_EQ(folder.entry_count(), 0);
}

}  // namespace
}  // namespace lefort::io::test_export_field
