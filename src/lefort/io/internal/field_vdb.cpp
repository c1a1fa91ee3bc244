#include <lefort/io/internal/field_formats.h>
#include <lefort/io/write_atomically.h>

#include <fmt/format.h>
#include <openvdb/io/Archive.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Prune.h>

#include <array>
#include <cmath>
#include <fstream>
#include <new>

namespace lefort::io {

namespace {

using field::LatticePoint;
using field::LatticeWindow;
using field::SampleBlock;
using field::SampleCount;
using field::SparseLattice;
using field::Zone;

constexpr int kSide = SparseLattice::kSide;
static_assert(openvdb::FloatTree::LeafNodeType::DIM == kSide, "a block is a leaf of OpenVDB");

/// Index (i, j, k) of the grid is sample `every` * (i, j, k) of the field.
openvdb::FloatGrid::Ptr empty_grid(const field::DistanceField& field, const LatticeWindow& window) {
  const field::FieldFrame& frame = field.frame();
  auto grid = openvdb::FloatGrid::create(float(frame.band_mm));
  grid->setName("distance_mm");
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  const auto to_world =
      openvdb::math::Transform::createLinearTransform(frame.cell_mm * window.every);
  to_world->postTranslate(
      openvdb::Vec3d(frame.origin_B.x(), frame.origin_B.y(), frame.origin_B.z()));
  grid->setTransform(to_world);
  for (const auto& [key, text] : describe_export(field, window))
    grid->insertMeta(key, openvdb::StringMetadata(text));
  grid->insertMeta("lefort_unknown", openvdb::StringMetadata("inactive, lefort_band_mm"));
  return grid;
}

/// Whether all points of a block are in the window, so that it is one tile or leaf.
bool holds_all(const LatticeWindow& window, const LatticePoint& first) {
  const LatticePoint last = {first[0] + kSide - 1, first[1] + kSide - 1, first[2] + kSide - 1};
  return window.every == 1 && window.find(first) && window.find(last);
}

class GridFiller {
 public:
  GridFiller(openvdb::FloatGrid& grid, const LatticeWindow& window)
      : grid_(grid), accessor_(grid.getAccessor()), window_(window), band_mm_(grid.background()) {}

  void add(const SampleBlock& block) {
    if (block.zone && holds_all(window_, block.first)) {
      count_.add(zone_value(*block.zone), SparseLattice::kBrickPoints);
      if (*block.zone == Zone::kInside)
        grid_.tree().addTile(1, openvdb::Coord(block.first.data()), -band_mm_, false);
      return;
    }
    if (block.zone == Zone::kInside) prune_now_and_then();
    for (int place = 0; place < SparseLattice::kBrickPoints; ++place) {
      const LatticePoint p = {block.first[0] + place % kSide,
                              block.first[1] + place / kSide % kSide,
                              block.first[2] + place / (kSide * kSide)};
      if (!window_.find(p)) continue;
      const float sample = block.zone ? zone_value(*block.zone) : block.values[std::size_t(place)];
      count_.add(sample);
      const openvdb::Coord at(p[0] / window_.every, p[1] / window_.every, p[2] / window_.every);
      if (std::isfinite(sample)) accessor_.setValueOn(at, within_band(sample, band_mm_));
      if (std::isinf(sample) && sample < 0.0F) accessor_.setValueOff(at, -band_mm_);
    }
  }

  [[nodiscard]] const SampleCount& count() const { return count_; }

 private:
  /// Voxels inside that are set one by one need 2 KB per 512 until pruning merges them.
  void prune_now_and_then() {
    constexpr int kBlocksBetween = 1 << 16;  // 130 MB.
    if (++blocks_since_pruned_ < kBlocksBetween) return;
    blocks_since_pruned_ = 0;
    accessor_.clear();
    openvdb::tools::prune(grid_.tree());
  }

  openvdb::FloatGrid& grid_;
  openvdb::FloatGrid::Accessor accessor_;
  const LatticeWindow& window_;
  float band_mm_;
  SampleCount count_;
  int blocks_since_pruned_ = 0;
};

/// Writes the same as openvdb::io::File, but detects write errors.
class Archive : public openvdb::io::Archive {
 public:
  void write_to(std::ostream& stream, const openvdb::GridCPtrVec& grids) const {
    openvdb::io::Archive::write(stream, grids, /*seekable=*/true);
  }
};

Result<SampleCount> write_level_set(const std::filesystem::path& target,
                                    const field::DistanceField& field, const LatticeWindow& window,
                                    Progress& progress) {
  constexpr double kMinVoxels = 2.0;  // On each side, otherwise the surface has holes.
  const double voxel_mm = field.cell_mm() * window.every;
  if (field.band_mm() < kMinVoxels * voxel_mm * (1.0 - 1e-12))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("every is {}: the band of {:.4g} mm is {:.3g} voxels wide on each "
                            "side, a level set needs {}",
                            window.every, field.band_mm(), field.band_mm() / voxel_mm, kMinVoxels));
  openvdb::initialize();
  const openvdb::FloatGrid::Ptr grid = empty_grid(field, window);
  GridFiller filler(*grid, window);
  LEFORT_TRY_VOID(for_each_block(field, window, progress,
                                 [&](const SampleBlock& block) { filler.add(block); }));
  openvdb::tools::prune(grid->tree());  // Merges equal inside tiles.
  LEFORT_TRY_VOID(
      write_atomically(target, [&](const std::filesystem::path& temporary) -> Result<void> {
        std::ofstream file(temporary, std::ios::binary);
        Archive archive;
        // Not Blosc, which some builds of OpenVDB lack.
        archive.setCompression(openvdb::io::COMPRESS_ZIP | openvdb::io::COMPRESS_ACTIVE_MASK);
        archive.write_to(file, {grid});
        file.close();
        if (!file)
          return fail(
              ErrorCode::kFileUnwritable,
              fmt::format("{} cannot be written: the disk is full or failing", target.string()));
        return {};
      }));
  return filler.count();
}

}  // namespace

Result<SampleCount> write_vdb(const std::filesystem::path& target,
                              const field::DistanceField& field, const LatticeWindow& window,
                              Progress& progress) {
  try {
    return write_level_set(target, field, window, progress);
  } catch (const openvdb::ArithmeticError&) {  // Its transforms reject voxels below about 1e-5.
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("voxels are {:.3g} mm wide, too small for OpenVDB; build the field "
                            "from a surface in smaller units",
                            field.cell_mm() * window.every));
  } catch (const std::bad_alloc&) {
    return fail(
        ErrorCode::kOutOfMemory,
        fmt::format("{} needs more memory than available; a larger every or a region needs less",
                    target.string()));
  }
}

}  // namespace lefort::io
