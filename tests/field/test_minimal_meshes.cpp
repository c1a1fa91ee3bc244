/// \file
/// Two thousand of the smallest surfaces, with every method, at every sample: degenerate cases are
/// frequent in them.
#include <lefort/field/build/build_distance_field.h>
#include <lefort/field/query/lattice_samples.h>
#include <lefort/geometry/winding_number.h>

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "field/brute_force.h"
#include "support/small_meshes.h"

namespace lefort::field::test_minimal_meshes {
namespace {

using geometry::TriangleMesh;
using test::SmallMesh;

constexpr int kResolution = 16;
constexpr FieldMethod kMethods[] = {FieldMethod::kBricks, FieldMethod::kHybrid,
                                    FieldMethod::kAdaptive, FieldMethod::kUniform};

/// Position of a mesh with edges of 1 or 2 in a field.
struct Placement {
  double scale_mm;
  Vec3 at_mm;
  double side_mm;  ///< Edge of the field in units of the mesh; 0 fits the cube to the mesh.
  double turn_rad;
};

/// Vertices on samples with others exactly at the edge of the band; very small, very large, far
/// away, and rotated.
Placement placement(std::size_t n) {
  switch (n % 5) {
    case 0:
      return {1.0, Vec3::Zero(), 8.0, 0.0};
    case 1:
      return {2e-3, Vec3(0.3, -0.2, 0.1), 0.0, 0.0};
    case 2:
      return {3000.0, Vec3(1e3, 2e3, -3e3), 0.0, 0.3};
    case 3:
      return {1.0, Vec3(9e5, -9e5, 9e5), 8.0, 0.0};
    default:
      return {10.0, Vec3::Zero(), 0.0, 1.0};
  }
}

RigidTransform turn_of(const Placement& placement) {
  return RigidTransform(Eigen::AngleAxisd(placement.turn_rad, Vec3(1, 2, 3).normalized()));
}

/// The expected samples of a field: unsigned distances, and zones.
class Truth {
 public:
  Truth(const TriangleMesh& surface, const FieldFrame& frame) {
    for (int k = 0; k <= kResolution; ++k)
      for (int j = 0; j <= kResolution; ++j)
        for (int i = 0; i <= kResolution; ++i)
          distances_.push_back(test::brute_distance(surface, test::position_of(frame, i, j, k)));
  }
  [[nodiscard]] double distance(const LatticePoint& p) const {
    return distances_[std::size_t((p[2] * (kResolution + 1) + p[1]) * (kResolution + 1) + p[0])];
  }

 private:
  std::vector<double> distances_;
};

struct Case {
  const SmallMesh& small;
  Placement placement;
  PreparedSurface prepared;
  double size_mm;  ///< Errors are relative to this.

  /// In the coordinates of the original mesh.
  [[nodiscard]] Vec3 unplaced(const Vec3& p) const {
    return turn_of(placement).inverse() * Vec3((p - placement.at_mm) / placement.scale_mm);
  }
};

void expect_samples_right(const DistanceField& field, const Case& of, const Truth& truth,
                          double tolerance_mm) {
  const FieldFrame& frame = field.frame();
  const double rounding_mm = 2e-6 * of.size_mm;
  const bool is_octree = std::holds_alternative<Octree>(field.samples());
  // Samples that no leaf of an octree uses are not stored.
  const double kept_mm = is_octree ? field.guaranteed_mm() : field.band_mm();
  const LatticeWindow all = window_of(frame, std::nullopt, 1).value();
  // Null if the sample is right; otherwise what is wrong.
  const auto fault = [&](const LatticePoint& p, float sample) -> const char* {
    const double exact = truth.distance(p);
    const Vec3 place = test::position_of(frame, p[0], p[1], p[2]);
    if (std::isfinite(sample)) {
      if (!(std::abs(double(std::abs(sample)) - exact) <= tolerance_mm + rounding_mm))
        return "is not the distance";
      if (exact >= field.band_mm() + rounding_mm) return "is beyond the band";
    } else if (exact < kept_mm - rounding_mm && !(std::isnan(sample) && !of.small.is_inside)) {
      return "is missing";  // Only samples in conflict may be missing; solids have none.
    }
    if (!of.prepared.closed && std::isinf(sample)) return "has a zone although the surface is open";
    if (of.small.is_inside && exact > tolerance_mm + rounding_mm &&
        (sample < 0.0F) != of.small.is_inside(of.unplaced(place)))
      return "has the wrong sign for the solid";
    if (of.prepared.closed && std::isinf(sample) && exact > frame.cell_mm + rounding_mm &&
        (sample < 0.0F) != (geometry::winding_number(of.prepared.mesh_B, place) > 0.5))
      return "has the wrong sign";
    return nullptr;
  };
  ASSERT_TRUE(for_each_block(field, all, Progress::none(), [&](const SampleBlock& block) {
    for (int place = 0; place < SparseLattice::kBrickPoints; ++place) {
      const LatticePoint p = {block.first[0] + place % 8, block.first[1] + place / 8 % 8,
                              block.first[2] + place / 64};
      if (!all.find(p)) continue;
      const char* const found = fault(p, block.at(p));
      ASSERT_EQ(found, nullptr) << "sample " << p[0] << ' ' << p[1] << ' ' << p[2] << ", "
                                << block.at(p) << ", " << found << "; the distance is "
                                << truth.distance(p);
    }
  }));
}

void expect_queries_harmless(const DistanceField& field, std::mt19937& random) {
  std::uniform_real_distribution<double> in(-0.05, 1.05);
  const Box3 box = field.box_B();
  std::vector<Vec3> points;
  for (int n = 0; n < 30; ++n)
    points.push_back(box.min() +
                     box.sizes().cwiseProduct(Vec3(in(random), in(random), in(random))));
  std::vector<FieldSample> samples(points.size());
  field.sample(points, samples);
  for (const FieldSample& sample : samples) {
    ASSERT_LE(int(sample.zone), int(Zone::kUnknown));
    ASSERT_TRUE(std::isfinite(sample.distance_mm) && sample.gradient_B.allFinite());
    ASSERT_LE(std::abs(sample.distance_mm), field.band_mm() * (1 + 1e-6));
  }
}

/// \returns false if no field can be built.
bool check(const SmallMesh& small, std::size_t number) {
  const Placement placed = placement(number);
  TriangleMesh mesh = small.mesh;
  for (Vec3& v : mesh.vertices) v = placed.at_mm + placed.scale_mm * (turn_of(placed) * v);
  DistanceFieldOptions options{.resolution = kResolution};
  if (placed.side_mm > 0.0) {
    options.side_mm = placed.side_mm * placed.scale_mm;
    options.band_mm = 2.0 * options.side_mm / kResolution;
  }
  options.tolerance_mm = number % 2 == 0 ? 0.0 : 0.01 * placed.scale_mm;
  auto prepared = prepare_surface(mesh);
  if (!prepared) {
    EXPECT_EQ(prepared.error().code, ErrorCode::kMeshInvalid);
    return false;
  }
  if (small.is_inside) {
    EXPECT_TRUE(prepared->closed);
  }
  std::mt19937 random{unsigned(number)};
  std::optional<Truth> truth;
  for (const FieldMethod method : kMethods) {
    SCOPED_TRACE(testing::Message() << "method " << int(method));
    options.method = method;
    const auto field = build_distance_field(mesh, options);
    if (!field) {  // Nearly all of it is at one point.
      EXPECT_EQ(field.error().code, ErrorCode::kMeshInvalid) << field.error().message;
      return false;
    }
    if (!truth) truth.emplace(prepared->mesh_B, field->frame());
    const Case of{small, placed, *prepared, field->box_B().sizes().maxCoeff()};
    const bool is_octree = method == FieldMethod::kHybrid || method == FieldMethod::kAdaptive;
    expect_samples_right(*field, of, *truth, is_octree ? options.tolerance_mm : 0.0);
    expect_queries_harmless(*field, random);
    if (testing::Test::HasFatalFailure()) return true;
  }
  return true;
}

int check_all(const std::vector<SmallMesh>& meshes) {
  int built = 0;
  for (std::size_t n = 0; n < meshes.size(); ++n) {
    SCOPED_TRACE(testing::Message() << "mesh " << n << ", " << meshes[n].name);
    built += check(meshes[n], n) ? 1 : 0;
    if (testing::Test::HasFailure()) break;
  }
  return built;
}

std::vector<SmallMesh> meshes_of(const std::vector<test::Soup>& soups) {
  std::vector<SmallMesh> meshes;
  for (std::size_t n = 0; n < soups.size(); ++n)
    meshes.push_back({"soup", test::mesh_of(soups[n], n % 3 != 0)});
  return meshes;
}

TEST(MinimalMeshes, EverySoupOfOneOrTwoTriangles) {
  const std::vector<test::Soup> soups = test::soups_of_two();
  // Combinations: one triangle is a point, a line of one of three lengths, or has one of three
  // shapes; that with three different edges is a mirror image of another.
  EXPECT_EQ(std::count_if(soups.begin(), soups.end(), [](const auto& s) { return s.size() == 1; }),
            8);
  EXPECT_GT(check_all(meshes_of(soups)), 100);
}

TEST(MinimalMeshes, SoupsOfThreeToSixTriangles) {
  const std::vector<test::Soup> soups = test::soups_of_six();
  EXPECT_GT(soups.size(), 500U);
  EXPECT_GT(check_all(meshes_of(soups)), 500);
}

TEST(MinimalMeshes, SolidsHaveTheirInsideAfterAnyRepair) {
  EXPECT_EQ(check_all(test::small_solids(400)), 400);
}

}  // namespace
}  // namespace lefort::field::test_minimal_meshes
