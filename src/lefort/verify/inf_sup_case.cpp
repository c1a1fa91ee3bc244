#include <lefort/mesh/box_grid.h>
#include <lefort/verify/cases.h>
#include <lefort/verify/inf_sup.h>
#include <lefort/verify/shapes.h>

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace lefort::verify {
namespace {

/// Largest relative change of the number from the third mesh to the fourth of a stable pair.
constexpr double kMaxChange = 0.1;

/// Displacement of interior corner nodes of the irregular meshes, over the cell size.
constexpr double kMaxShift = 0.15;

struct Pair {
  mesh::ElementShape shape;
  PressureSpace pressure;
  const char* pressure_name;
  bool is_offered;          ///< Used by the solver; `lefort verify` checks it.
  const char* instability;  ///< Why an offered pair is known to fail; or empty.
};

constexpr std::array kPairs{
    Pair{mesh::ElementShape::kTet10, PressureSpace::kContinuous, "continuous", true, ""},
    Pair{mesh::ElementShape::kWedge15, PressureSpace::kContinuous, "continuous", true, ""},
    Pair{mesh::ElementShape::kHex20, PressureSpace::kContinuous, "continuous", true, ""},
    Pair{mesh::ElementShape::kHex8, PressureSpace::kElementConstant, "constant", true,
         "Q1/P0 is not stable; its number decreases with the element size"},
    Pair{mesh::ElementShape::kTet10, PressureSpace::kElementConstant, "constant", false, ""},
    Pair{mesh::ElementShape::kWedge15, PressureSpace::kElementConstant, "constant", false, ""},
    Pair{mesh::ElementShape::kHex20, PressureSpace::kElementConstant, "constant", false, ""},
    Pair{mesh::ElementShape::kHex20, PressureSpace::kElementLinear, "linear", false, ""},
};

enum class Grid { kRegular, kIrregular };

mesh::VolumeMesh cube(mesh::ElementShape shape, int cells, Grid grid) {
  mesh::VolumeMesh mesh = mesh::make_box(shape, {cells, cells, cells}, Vec3::Ones());
  std::mt19937 random(1);
  if (grid == Grid::kIrregular)
    mesh = mesh::with_inner_nodes_moved(std::move(mesh), Vec3::Constant(kMaxShift / cells), random);
  return mesh;
}

void check_pair(const Pair& pair, const std::string& grid, const std::vector<double>& numbers,
                Index spurious, Section& section) {
  const std::string name =
      fmt::format("{}, {} pressure, {}", text_of(pair.shape), pair.pressure_name, grid);
  section.checks.push_back(
      {.name = fmt::format("{}: change of the number from the third to the fourth mesh", name),
       .measured = std::abs(numbers[3] / numbers[2] - 1.0),
       .comparison = Comparison::kAtMost,
       .tolerance = kMaxChange,
       .reason = "the number of a stable pair has a lower bound",
       .known_failure = pair.instability});
  section.checks.push_back({.name = fmt::format("{}: spurious pressure modes", name),
                            .measured = double(spurious),
                            .comparison = Comparison::kAtMost,
                            .reason = "only the constant pressure may have no effect if the whole "
                                      "boundary is held",
                            .known_failure = pair.instability});
}

Section inf_sup_section() {
  return {.name = "inf-sup",
          .title = "Stability of displacement and pressure: the numerical inf-sup test",
          .text =
              "The test of Chapelle and Bathe (The inf-sup test, Comput. Struct. 1993; Bathe, "
              "The inf-sup condition and its evaluation for mixed finite element methods, "
              "Comput. Struct. 2001) on a cube: G q = lambda M q with G = B A^-1 B^T. The "
              "number is the square root of the min nonzero eigenvalue, with one side of the "
              "cube held. It must not decrease with the element size. Spurious modes are zero "
              "eigenvalues with the whole boundary held, besides that of the constant "
              "pressure, on the finest mesh. Interior nodes of irregular meshes are moved by "
              "up to 0.15 of a cell. Pairs that the solver does not use are listed for "
              "comparison and not checked."};
}

}  // namespace

Section verify_inf_sup(Extent extent, Progress& progress) {
  const bool full = extent == Extent::kFull;
  Section section = inf_sup_section();
  Table table{.title = "Inf-sup number, by cells per side; spurious modes on the finest mesh",
              .header = {"shape", "pressure", "used", "mesh"}};
  const std::array cells = full ? std::array{3, 4, 5, 6} : std::array{2, 3, 4, 5};
  for (const int n : cells) table.header.push_back(fmt::format("{}", n));
  table.header.emplace_back("spurious modes");
  double done = 0.0;
  for (const Pair& pair : kPairs) {
    for (const Grid grid : {Grid::kRegular, Grid::kIrregular}) {
      const std::string name = grid == Grid::kRegular ? "regular" : "irregular";
      if (!full && !pair.is_offered) continue;
      std::vector<std::string> row{text_of(pair.shape), pair.pressure_name,
                                   pair.is_offered ? "yes" : "no", name};
      std::vector<double> numbers;
      for (const int n : cells) {
        numbers.push_back(inf_sup_number(cube(pair.shape, n, grid), pair.pressure, "x0").number);
        row.push_back(fmt::format("{:.3f}", numbers.back()));
      }
      const Index spurious =
          inf_sup_number(cube(pair.shape, cells.back(), grid), pair.pressure, "boundary")
              .zero_modes -
          1;
      row.push_back(fmt::format("{}", spurious));
      table.rows.push_back(std::move(row));
      if (pair.is_offered) check_pair(pair, name, numbers, spurious, section);
      if (progress.stop_requested()) return section;
    }
    progress.report(++done / double(kPairs.size()));
  }
  section.tables.push_back(std::move(table));
  return section;
}

}  // namespace lefort::verify
