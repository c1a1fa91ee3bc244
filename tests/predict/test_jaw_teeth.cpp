/// \file
/// Teeth as objects on two jaws behind a wall of tissue:
///
///        y = -12      y = 0
///           |  tissue  |  upper jaw, z >= 1: teeth 16 (right) and 11 (left), a gap between them
///           |          |  mandible, z <= -1: no teeth
#include <lefort/predict/interface_map.h>
#include <lefort/predict/jaw_edges.h>
#include <lefort/predict/jaw_teeth.h>
#include <lefort/predict/mesh_tissue.h>
#include <lefort/predict/oral_vestibule.h>
#include <lefort/predict/tissue_boundary.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "support/shapes.h"

namespace lefort::predict::test_jaw_teeth {
namespace {

using Condition = InterfaceCondition;
using Rule = InterfaceRule;
using anatomy::Tissue;
using Numbers = image::Volume<std::uint8_t>;

constexpr double kEdge_mm = 1.0, kDepth_mm = 5.0, kLength_mm = 22.0;

/// Crowns of teeth that are longer and shorter than the mean, 7.5 + 13 and 10.5 + 13 mm.
constexpr double kMolar_mm = 7.5 * kLength_mm / 20.5, kIncisor_mm = 10.5 * kLength_mm / 23.5;

image::Grid grid() {
  image::Grid grid;
  grid.size = {51, 41, 91};
  grid.origin_L = {-25.0, -20.0, -45.0};
  return grid;
}

/// Calls visit(i, j, k, point) for all voxels.
void visit_voxels(const std::function<void(Index, Index, Index, const Vec3&)>& visit) {
  const image::Grid all = grid();
  for (Index k = 0; k < all.size[2]; ++k)
    for (Index j = 0; j < all.size[1]; ++j)
      for (Index i = 0; i < all.size[0]; ++i)
        visit(i, j, k, all.point_L({double(i), double(j), double(k)}));
}

anatomy::LabelMap labels() {
  anatomy::LabelMap made{grid(), {}};
  visit_voxels([&](Index, Index, Index, const Vec3& p) {
    Tissue tissue = p.y() > -12.0 ? Tissue::kSoftTissue : Tissue::kBackground;
    if (p.y() >= 0.0 && std::abs(p.x()) <= 20.0 && std::abs(p.z()) >= kEdge_mm)
      tissue = p.z() > 0.0 ? Tissue::kBone : Tissue::kMandible;
    made.values.push_back(tissue);
  });
  return made;
}

/// An upper tooth of kLength_mm.
struct Tooth {
  int fdi;
  double first_x, last_x, edge_z = kEdge_mm;
};
const std::vector<Tooth> kMolarAndIncisor{{16, -15.0, -5.0}, {11, 5.0, 14.0}};

Numbers numbers(const std::vector<Tooth>& teeth, double front_mm = 0.0) {
  Numbers made{grid(), {}};
  made.values.assign(std::size_t(made.grid.voxel_count()), 0);
  visit_voxels([&](Index i, Index j, Index k, const Vec3& p) {
    for (const Tooth& tooth : teeth)
      if (p.x() >= tooth.first_x && p.x() <= tooth.last_x && p.y() >= front_mm && p.y() <= 7.0 &&
          p.z() >= tooth.edge_z && p.z() <= tooth.edge_z + kLength_mm)
        made.at(i, j, k) = std::uint8_t(tooth.fdi);
  });
  return made;
}

TEST(JawTeeth, HaveAxisEdgeBorderAndPlaceInTheArch) {
  const JawTeeth found = find_jaw_teeth(numbers(kMolarAndIncisor));
  ASSERT_EQ(found.teeth.size(), 2U);
  const JawTooth &incisor = found.teeth[0], &molar = found.teeth[1];
  EXPECT_EQ(incisor.fdi, 11);
  EXPECT_EQ(molar.fdi, 16);
  for (const JawTooth* tooth : {&incisor, &molar}) {
    EXPECT_NEAR(tooth->axis_L.z(), -1.0, 1e-6);
    EXPECT_NEAR(std::abs(tooth->along_L.x()), 1.0, 1e-6);
    EXPECT_NEAR(tooth->edge_z_mm, kEdge_mm, 1e-9);
    EXPECT_NEAR(tooth->tip_L.z(), kEdge_mm, 1e-9);
  }
  EXPECT_NEAR(incisor.border_L.z(), kEdge_mm + kIncisor_mm, 1e-9);
  EXPECT_NEAR(molar.border_L.z(), kEdge_mm + kMolar_mm, 1e-9);
  EXPECT_NEAR(molar.half_width_mm, 5.0, 0.6);
  EXPECT_EQ(found.tooth_at({-10.0, 0.0, 30.0}, false), &molar);
  EXPECT_EQ(found.tooth_at({6.0, 0.0, 1.0}, false), &incisor);
  EXPECT_EQ(found.tooth_at({0.0, 0.0, 1.0}, false), nullptr);    // The gap.
  EXPECT_EQ(found.tooth_at({-10.0, 0.0, -5.0}, true), nullptr);  // The other jaw.
  EXPECT_EQ(found.tooth_at({-10.0, 30.0, 1.0}, false), nullptr);
  EXPECT_TRUE(found.is_on_crown({-10.0, -1.0, 8.0}));
  EXPECT_FALSE(found.is_on_crown({-10.0, -1.0, 10.0}));  // The root.
  EXPECT_FALSE(found.is_on_crown({-10.0, -4.0, 5.0}));
  EXPECT_FALSE(found.is_on_crown({0.0, -1.0, 5.0}));
}

TEST(JawTeeth, ACrownWithoutItsRootHasABorderOf70PercentOfTheMean) {
  Numbers crown = numbers({{16, -15.0, -5.0}});
  visit_voxels([&](Index i, Index j, Index k, const Vec3& p) {
    if (p.z() > 7.0) crown.at(i, j, k) = 0;
  });
  const JawTeeth found = find_jaw_teeth(crown);
  ASSERT_EQ(found.teeth.size(), 1U);
  EXPECT_NEAR(found.teeth[0].axis_L.z(), -1.0, 1e-6);
  EXPECT_NEAR(found.teeth[0].border_L.z(), kEdge_mm + 0.7 * 7.5, 1e-9);
}

TEST(JawTeeth, PartsWithoutANumberOfAPermanentToothAreNoTeeth) {
  EXPECT_TRUE(find_jaw_teeth(numbers({{19, -15.0, -5.0}, {1, 5.0, 14.0}})).teeth.empty());
  Numbers few = numbers({});
  few.at(20, 25, 60) = 11;
  EXPECT_TRUE(find_jaw_teeth(few).teeth.empty());
}

TEST(JawTeeth, IncisorsDetermineEdgeAndAnteriorSurfaceOfTheJawAndWithoutThemBoneDoes) {
  // Streaks reach 3 mm beyond the edges and 2 mm before the teeth.
  const std::vector<Tooth> incisors{{11, -9.0, -1.0, 4.0}, {21, 0.0, 8.0, 4.0}};
  const JawTeeth teeth = find_jaw_teeth(numbers(incisors, 2.0));
  const auto by_bone = find_jaw_edges(labels()), by_teeth = find_jaw_edges(labels(), &teeth);
  ASSERT_TRUE(by_bone && by_teeth);
  EXPECT_NEAR(by_bone->upper_z_mm, kEdge_mm, 1e-9);
  EXPECT_NEAR(by_teeth->upper_z_mm, 4.0, 1e-9);
  EXPECT_EQ(by_teeth->lower_z_mm, by_bone->lower_z_mm);
  const auto y_mm = anterior_surface_y_mm(labels(), -20.0, 41, {-1.0, 4.0}, &teeth);
  ASSERT_EQ(y_mm.size(), 41U);
  EXPECT_NEAR(y_mm[20], 2.0, 1e-9);
  EXPECT_NEAR(y_mm[2], 0.0, 1e-9);
  // One incisor is no edge.
  const JawTeeth one = find_jaw_teeth(numbers({{11, -9.0, -1.0, 4.0}}));
  EXPECT_EQ(find_jaw_edges(labels(), &one)->upper_z_mm, by_bone->upper_z_mm);
}

TEST(JawTeeth, TheVestibuleIsAsDeepFromEachCrownAndInAGapAsWithoutTeeth) {
  const JawTeeth teeth = find_jaw_teeth(numbers(kMolarAndIncisor));
  const auto without = find_oral_vestibule(labels(), kDepth_mm);
  const auto with = find_oral_vestibule(labels(), kDepth_mm, &teeth);
  ASSERT_TRUE(with && without);
  const auto fold_z_mm = [](const OralVestibule& vestibule, double x_mm) {
    double z_mm = 2.0;
    while (vestibule.contains({x_mm, 0.0, z_mm}, false)) z_mm += 0.1;
    return z_mm;
  };
  EXPECT_NEAR(fold_z_mm(*with, -10.0), kEdge_mm + kMolar_mm + kDepth_mm, 0.2);
  EXPECT_NEAR(fold_z_mm(*with, 10.0), kEdge_mm + kIncisor_mm + kDepth_mm, 0.2);
  EXPECT_EQ(fold_z_mm(*with, 0.0), fold_z_mm(*without, 0.0));
  EXPECT_EQ(fold_z_mm(*with, -18.0), fold_z_mm(*without, -18.0));
  EXPECT_TRUE(with->contains({-10.0, 0.0, kEdge_mm - 7.9}, false));
  EXPECT_FALSE(with->contains({-10.0, 0.0, kEdge_mm - 8.1}, false));
  for (const double z_mm : {-2.0, -14.0, -17.0, -30.0})
    EXPECT_EQ(with->contains({-10.0, 0.0, z_mm}, true),
              without->contains({-10.0, 0.0, z_mm}, true));
}

/// The mesh before the wall, with its boundary.
struct Wall {
  geometry::TriangleMesh mandible_L = test::make_box({-20, 0, -40}, {20, 20, -kEdge_mm});
  geometry::TriangleMesh upper_L = test::make_box({-20, 0, kEdge_mm}, {20, 20, 40});
  geometry::TriangleMesh skin_L = test::make_box({-25, -12, -45}, {25, 20, 45});
  TissueOptions options{.element_size_mm = 3.0, .far_element_size_mm = 3.0, .margin_mm = 35.0};
  TissueDomain domain = make_tissue_domain(level(), grid(), mandible_L, options);
  mesh::VolumeMesh mesh = mesh_tissue(domain, mandible_L, options).value();

  static image::ScalarVolume level() {
    image::ScalarVolume made{grid(), {}};
    visit_voxels([&](Index, Index, Index, const Vec3& p) {
      made.values.push_back(float(std::clamp(std::min(p.y() + 12.0, -p.y()), -0.8, 0.8)));
    });
    return made;
  }
  [[nodiscard]] InterfaceMap map(const JawTeeth* teeth,
                                 const std::vector<plan::ElevationZone>& zones = {}) const {
    BoundaryOptions boundary;
    boundary.vestibule_mm = kDepth_mm;
    return find_tissue_boundary(mesh, domain, labels(), skin_L,
                                {.segments_L = {&mandible_L, 1},
                                 .remainder_L = upper_L,
                                 .elevation = zones,
                                 .teeth = teeth},
                                boundary, nullptr)
        .interface;
  }
};

const Wall& wall() {
  static const Wall the_wall;
  return the_wall;
}

/// Calls `check` for the nodes on the wall, except close to the borders of its parts.
void visit_wall(const InterfaceMap& map,
                const std::function<void(const NodeInterface&, const Vec3&)>& check) {
  int visited = 0;
  for (const NodeInterface& one : map.nodes) {
    const Vec3& p_L = wall().mesh.nodes_L[std::size_t(one.node)];
    if (p_L.y() < -0.3 || std::abs(p_L.x()) > 18.0 || std::abs(p_L.z()) < 2.0) continue;
    if (one.condition == Condition::kRoller) continue;
    check(one, p_L);
    ++visited;
  }
  EXPECT_GT(visited, 60);
}

TEST(InterfaceWithTeeth, TissueSlidesOnCrownsAndGingivaOfEachToothAndElsewhereByTheEdges) {
  const JawTeeth teeth = find_jaw_teeth(numbers(kMolarAndIncisor));
  const InterfaceMap without = wall().map(nullptr), with = wall().map(&teeth);
  int crowns = 0, gingiva = 0, bonded = 0, same = 0;
  std::size_t n = 0;
  for (const NodeInterface& one : with.nodes) {
    const NodeInterface& before = without.nodes[n++];
    const Vec3& p_L = wall().mesh.nodes_L[std::size_t(one.node)];
    const bool is_at_tooth = std::abs(std::abs(p_L.x()) - 10.0) < 8.5;
    if (p_L.z() > 0.0 && is_at_tooth) continue;
    EXPECT_EQ(one.condition, before.condition) << p_L.transpose();  // Gap and mandible.
    EXPECT_EQ(one.rule, before.rule) << p_L.transpose();
    ++same;
  }
  visit_wall(with, [&](const NodeInterface& one, const Vec3& p_L) {
    if (p_L.z() < 0.0 || std::abs(std::abs(p_L.x()) - 10.0) > 4.0) return;
    const double border_mm = kEdge_mm + (p_L.x() < 0.0 ? kMolar_mm : kIncisor_mm);
    const double beyond_mm = p_L.z() - border_mm;
    if (beyond_mm < -0.2) {
      EXPECT_EQ(one.rule, Rule::kCrown) << p_L.transpose();
      EXPECT_EQ(one.condition, Condition::kSliding);
      EXPECT_FALSE(one.may_separate);
      ++crowns;
    } else if (beyond_mm > 0.2 && beyond_mm < kDepth_mm - 0.2) {
      EXPECT_EQ(one.rule, Rule::kVestibule) << p_L.transpose();
      EXPECT_EQ(one.condition, Condition::kSliding);
      ++gingiva;
    } else if (beyond_mm > kDepth_mm + 3.0) {
      EXPECT_EQ(one.rule, Rule::kStationary) << p_L.transpose();
      EXPECT_EQ(one.condition, Condition::kBonded);
      ++bonded;
    }
  });
  EXPECT_GT(crowns, 5);
  EXPECT_GT(gingiva, 5);
  EXPECT_GT(bonded, 5);
  EXPECT_GT(same, 100);
  for (const NodeInterface& one : without.nodes) EXPECT_NE(one.rule, Rule::kCrown);
}

/// A cut through the roots, 3 mm above the crowns, elevates gingiva, but nothing on crowns.
TEST(InterfaceWithTeeth, CrownsHaveNoPeriosteumToElevate) {
  const JawTeeth teeth = find_jaw_teeth(numbers(kMolarAndIncisor));
  geometry::TriangleMesh cut;
  cut.vertices = {{-20, 0, 12}, {20, 0, 12}, {20, 20, 12}, {-20, 20, 12}};
  cut.triangles = {{0, 1, 2}, {0, 2, 3}};
  int crowns = 0, elevated = 0;
  visit_wall(wall().map(&teeth, {{cut, {.segment_mm = 9.0, .other_side_mm = 9.0}}}),
             [&](const NodeInterface& one, const Vec3& p_L) {
               if (p_L.z() < 4.0 || p_L.z() > 16.0) return;
               if (std::abs(p_L.x() + 10.0) < 4.0 && p_L.z() < 8.3) {
                 EXPECT_EQ(one.rule, Rule::kCrown) << p_L.transpose();
                 ++crowns;
               } else if (p_L.z() > 12.0) {
                 EXPECT_EQ(one.condition, Condition::kElevated) << p_L.transpose();
                 ++elevated;
               }
             });
  EXPECT_GT(crowns, 2);
  EXPECT_GT(elevated, 5);
}

}  // namespace
}  // namespace lefort::predict::test_jaw_teeth
