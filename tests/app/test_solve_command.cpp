/// \file
/// `lefort solve` on blocks of a few tetrahedra, as a user would run it.
#include <lefort/io/read_text.h>
#include <lefort/io/read_vtu.h>
#include <lefort/io/sha256.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/vtu.h>
#include <lefort/io/write_atomically.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "support/box_mesh.h"
#include "support/result_file.h"
#include "support/run_program.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace lefort::app::test_solve_command {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string quoted(const fs::path& path) { return "'" + path.string() + "'"; }

/// The sides of the block as sets of the deck, so that its mesh needs none.
json sides() {
  json sets;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      Vec3 point = Vec3::Zero(), normal = Vec3::Zero();
      point[axis] = side * (axis == 2 ? 20.0 : 10.0);
      normal[axis] = 1.0;
      sets[{"XYZ"[axis], "01"[side]}]["plane"] = {{"point_mm", {point.x(), point.y(), point.z()}},
                                                  {"normal", {normal.x(), normal.y(), normal.z()}}};
    }
  return sets;
}

/// A block of 10 x 10 x 20 mm between three planes of symmetry, drawn out by 8 mm.
json stretch() {
  json deck = json::parse(R"({
    "lefort_deck": 1,
    "mesh": "block.vtu",
    "materials": [{"law": "neo-hookean", "mu_kpa": 10, "lambda_kpa": 40, "density_kg_m3": 1000}],
    "displacements": [{"set": "X0", "x_mm": 0}, {"set": "Y0", "y_mm": 0},
                      {"set": "Z0", "z_mm": 0}, {"set": "Z1", "z_mm": 8}],
    "steps": {"initial_increment": 0.5, "max_increment": 0.5},
    "probes": [{"name": "corner", "node": 44}, {"name": "middle", "point_mm": [5, 5, 10]}]
  })");
  deck["sets"] = sides();
  return deck;
}

/// The same block, clamped below.
json clamped() {
  json deck = stretch();
  deck["displacements"] = {{{"set", "Z0"}, {"x_mm", 0}, {"y_mm", 0}, {"z_mm", 0}}};
  return deck;
}

class SolveCommand : public testing::Test {
 protected:
  void SetUp() override { write_mesh(test::box_mesh(box_)); }
  void write_mesh(mesh::VolumeMesh mesh) {
    mesh.node_sets.clear();
    ASSERT_TRUE(io::write_vtu(folder_ / "block.vtu", mesh));
  }
  test::ProgramRun solve(const json& deck, const std::string& out = "out",
                         const std::string& more = "", const std::string& setup = "") {
    EXPECT_TRUE(io::write_text(folder_ / "deck.json", deck.dump(1)));
    return test::run_lefort(
        "solve " + quoted(folder_ / "deck.json") + " -o " + quoted(folder_ / out) + " " + more,
        setup);
  }
  json read_json(const fs::path& file) {
    if (file.filename() == "solve.json") return test::read_result(folder_ / file, "solve");
    const auto text = io::read_text(folder_ / file, 1 << 28);
    EXPECT_TRUE(text) << file;
    return text ? json::parse(*text) : json();
  }
  std::string text_of(const fs::path& file) {
    return io::read_text(folder_ / file, 1 << 28).value_or("");
  }
  [[nodiscard]] bool there_is(const fs::path& file) const { return fs::exists(folder_ / file); }

  /// One line that says `what`, exit code 1, and no folder of results.
  void expect_refusal(const json& deck, const std::string& what) {
    const auto run = solve(deck, "refused");
    EXPECT_EQ(run.exit_code, 1) << what;
    EXPECT_EQ(run.message_lines(), 1) << run.error;
    EXPECT_NE(run.error.find(what), std::string::npos) << run.error;
    EXPECT_FALSE(there_is("refused")) << what;
  }

  const test::BoxMeshOptions box_{.cells = {2, 2, 4}, .size_mm = {10, 10, 20}, .distortion = 0.1};
  test::TemporaryFolder folder_;
};

/// A block of the compressible neo-Hookean law, drawn out to `axial` times its length.
struct UniaxialStretch {
  double across = 1.0;
  double axial_mpa = 0.0;  ///< First Piola-Kirchhoff.
};
UniaxialStretch uniaxial_stretch(double mu_mpa, double lambda_mpa, double axial) {
  // P = mu (s - 1/s) + lambda ln J / s for each stretch s; it vanishes across.
  const auto stress_mpa = [&](double s, double J) {
    return mu_mpa * (s - 1.0 / s) + lambda_mpa * std::log(J) / s;
  };
  double low = 0.5, high = 1.5;
  for (int n = 0; n < 100; ++n) {
    const double s = 0.5 * (low + high);
    (stress_mpa(s, s * s * axial) < 0.0 ? low : high) = s;
  }
  return {low, stress_mpa(axial, low * low * axial)};
}

/// The rows of probes.csv as numbers; the first row is the heading.
std::vector<std::vector<double>> numbers_of(const std::string& csv, std::string& heading) {
  std::istringstream lines(csv);
  std::getline(lines, heading);
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(std::stod(cell));
  }
  return rows;
}

/// The raw doubles of an appended array of a VTU that we wrote.
std::vector<double> array_of(const std::string& vtu, const std::string& name) {
  std::smatch found;
  const std::regex pattern("Name=\"" + name +
                           "\" NumberOfComponents=\"\\d\" format=\"appended\" "
                           "offset=\"(\\d+)\"");
  const std::string head = vtu.substr(0, vtu.find("<AppendedData"));
  EXPECT_TRUE(std::regex_search(head, found, pattern)) << name;
  if (found.empty()) return {};
  const std::size_t begin = vtu.find("raw\">\n_") + 7 + std::stoul(found[1]);
  std::uint64_t bytes = 0;
  std::memcpy(&bytes, vtu.data() + begin, sizeof bytes);
  std::vector<double> values(bytes / sizeof(double));
  std::memcpy(values.data(), vtu.data() + begin + sizeof bytes, bytes);
  return values;
}

TEST_F(SolveCommand, WritesStepsProbesAndAllThatDocumentsThem) {
  const auto run = solve(stretch(), "out", "--json --quiet");
  ASSERT_EQ(run.exit_code, 0) << run.error;
  for (const char* file :
       {"step_0000.vtu", "step_0001.vtu", "step_0002.vtu", "solve.pvd", "solve.json", "probes.csv"})
    EXPECT_TRUE(there_is(fs::path("out") / file)) << file;
  EXPECT_FALSE(there_is("out/step_0003.vtu"));
  EXPECT_FALSE(there_is("out/solve_incomplete.pvd"));
  const json result = read_json("out/solve.json");
  EXPECT_EQ(result, json::parse(run.out));
  EXPECT_EQ(result["completed"], true);
  EXPECT_EQ(result["converged"], true);
  EXPECT_EQ(result["time_reached"], 1.0);
  EXPECT_EQ(result["last_converged"], json::parse(R"({"increment": 2, "time": 1.0,
                                                      "file": "step_0002.vtu", "is_final": true})"));
  const auto notice = result["notice"].get<std::string>();
  EXPECT_NE(notice.find("Research software"), std::string::npos);
  EXPECT_NE(notice.find("not for clinical use"), std::string::npos);
  EXPECT_EQ(result["inputs"]["deck_sha256"].get<std::string>().size(), 64U);
  EXPECT_EQ(result["linear_solver"],
            json::parse(R"({"requested": "automatic", "used": "direct"})"));
  EXPECT_EQ(run.error, "");  // Quiet.
  EXPECT_EQ(result["increments"].size(), 2U);
  const json& newton = result["increments"][0]["attempts"][0]["newton"];
  EXPECT_GE(newton.size(), 2U);
  for (const char* key :
       {"residual_n", "relative_residual", "energy_mj", "step_length", "contact_points"})
    EXPECT_TRUE(newton[0].contains(key)) << key;
  for (const char* phase : {"read", "assembly", "factorization", "solve", "output"})
    EXPECT_TRUE(result["timing"]["phase_seconds"].contains(phase)) << phase;
  EXPECT_GT(result["timing"]["peak_memory_mb"], 1.0);
}

TEST_F(SolveCommand, AStretchedBlockPullsWithTheClosedForm) {
  ASSERT_EQ(solve(stretch()).exit_code, 0);
  const json last = read_json("out/solve.json")["increments"].back();
  const auto [across, axial_mpa] = uniaxial_stretch(0.01, 0.04, 1.4);
  const json& reactions = last["reactions_n"];
  EXPECT_NEAR(reactions["displacements[3] (set Z1)"][2].get<double>(), 100.0 * axial_mpa, 1e-7);
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(last["reaction_sum_n"][std::size_t(axis)].get<double>(), 0.0, 1e-9);
  EXPECT_NEAR(last["min_volume_ratio"].get<double>(), 1.4 * across * across, 1e-7);
}

TEST_F(SolveCommand, ReactionsSumToTheAppliedLoads) {
  json deck = clamped();
  deck["tractions"] = {{{"faces", "Z1"}, {"traction_kpa", {0.2, 0, 0.1}}}};
  deck["pressures"] = {{{"faces", "X0"}, {"pressure_kpa", 0.3}}};
  deck["body_forces"] = {{{"acceleration_m_s2", {0, 0, -9.81}}}};
  ASSERT_EQ(solve(deck).exit_code, 0);
  const json last = read_json("out/solve.json")["increments"].back();
  for (std::size_t axis = 0; axis < 3; ++axis)  // Within Newton's tolerance.
    EXPECT_NEAR(last["reaction_sum_n"][axis].get<double>(), -last["load_sum_n"][axis].get<double>(),
                1e-8);
  EXPECT_NEAR(last["loads_n"]["tractions[0] (faces Z1)"][0].get<double>(), 0.02, 1e-12);
  EXPECT_NEAR(last["loads_n"]["body_forces[0]"][2].get<double>(), -0.01962, 1e-12);
}

TEST_F(SolveCommand, AProbeAtANodeIsWhatTheMeshSays) {
  ASSERT_EQ(solve(stretch()).exit_code, 0);
  std::string heading;
  const auto rows = numbers_of(text_of("out/probes.csv"), heading);
  EXPECT_EQ(heading,
            "time,corner_x_mm,corner_y_mm,corner_z_mm,middle_x_mm,middle_y_mm,middle_z_mm");
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0], std::vector<double>(7, 0.0));
  const auto displacement = array_of(text_of("out/step_0002.vtu"), "displacement_mm");
  ASSERT_EQ(displacement.size(), 135U);
  for (std::size_t axis = 0; axis < 3; ++axis)
    EXPECT_EQ(rows[2][1 + axis], displacement[3 * 44 + axis]);  // Bit for bit.
  EXPECT_NEAR(rows[2][6], 4.0, 1e-6);
}

TEST_F(SolveCommand, FieldsAreThoseOfTheUniformState) {
  ASSERT_EQ(solve(stretch()).exit_code, 0);
  const std::string vtu = text_of("out/step_0002.vtu");
  const json last = read_json("out/solve.json")["increments"].back();
  const double force_n = last["reactions_n"]["displacements[3] (set Z1)"][2].get<double>();
  const auto stretches = array_of(vtu, "principal_stretches");
  const auto stress = array_of(vtu, "cauchy_stress_kpa");
  const auto mises = array_of(vtu, "von_mises_kpa");
  const auto ratio = array_of(vtu, "volume_ratio");
  ASSERT_EQ(mises.size(), 96U);
  for (std::size_t e = 0; e < 96; ++e) {
    EXPECT_NEAR(stretches[3 * e], 1.4, 1e-6);
    const double area_mm2 = 100.0 * stretches[3 * e + 1] * stretches[3 * e + 2];
    EXPECT_NEAR(stress[9 * e + 8], 1e3 * force_n / area_mm2, 1e-4);
    EXPECT_NEAR(mises[e], stress[9 * e + 8], 1e-4);
    EXPECT_NEAR(ratio[e], last["min_volume_ratio"].get<double>(), 1e-7);
  }
}

TEST_F(SolveCommand, OnlyTheFieldsAndTimesThatAreRequestedAreWritten) {
  json deck = stretch();
  deck["output"] = {{"every", "last"}, {"fields", {"displacement"}}};
  ASSERT_EQ(solve(deck).exit_code, 0);
  EXPECT_FALSE(there_is("out/step_0001.vtu"));
  const std::string vtu = text_of("out/step_0002.vtu");
  EXPECT_NE(vtu.find("displacement_mm"), std::string::npos);
  EXPECT_EQ(vtu.find("cauchy_stress_kpa"), std::string::npos);
  deck["output"]["every"] = "times";
  deck["steps"]["times"] = {0.25};
  ASSERT_EQ(solve(deck).exit_code, 0);
  const std::string series = text_of("out/solve.pvd");
  EXPECT_NE(series.find("timestep=\"0.25\""), std::string::npos) << series;
  EXPECT_EQ(series.find("timestep=\"0.75\""), std::string::npos) << series;
  EXPECT_NE(series.find("timestep=\"1\""), std::string::npos) << series;  // The end, anyway.
}

TEST_F(SolveCommand, GivesTheSameBytesForAnyNumberOfThreads) {
  json deck = stretch();
  deck["obstacles"] = {{{"name", "ball"}, {"file", "ball.stl"}, {"faces", "Z1"}}};
  ASSERT_TRUE(io::write_surface(folder_ / "ball.stl", test::make_icosphere(4, 2, {5, 5, 25})));
  deck["obstacles"][0]["resolution"] = 32;
  deck["obstacles"][0]["band_mm"] = 2;
  deck["displacements"][3]["z_mm"] = 1.5;
  deck["displacements"].erase(3);
  deck["obstacles"][0]["keyframes"] = {{{"translation_mm", {0, 0, -1.6}}}};
  const auto one = solve(deck, "one", "--threads 1");
  ASSERT_EQ(one.exit_code, 0) << one.error;
  ASSERT_EQ(solve(deck, "two", "--threads 2").exit_code, 0);
  for (const char* file : {"step_0001.vtu", "step_0002.vtu", "solve.pvd", "probes.csv"})
    EXPECT_TRUE(text_of(fs::path("one") / file) == text_of(fs::path("two") / file)) << file;
  json first = read_json("one/solve.json"), second = read_json("two/solve.json");
  first.erase("timing");
  second.erase("timing");
  EXPECT_EQ(first.dump(), second.dump());
  EXPECT_GT(first["increments"].back()["contacts"]["ball"]["points"], 0);
  EXPECT_EQ(first["inputs"]["obstacles_sha256"]["ball"],
            io::sha256_of_file(folder_ / "ball.stl").value());
  const auto pressure = array_of(text_of("one/step_0002.vtu"), "ball_pressure_kpa");
  EXPECT_GT(*std::max_element(pressure.begin(), pressure.end()), 0.0);
}

TEST_F(SolveCommand, ALoadWithoutEquilibriumKeepsTheLastStateAndReportsIt) {
  json deck = stretch();
  deck["displacements"][3]["z_mm"] = -25;
  deck["output"]["every"] = "last";
  const auto run = solve(deck);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(run.message_lines(), 1) << run.error;
  EXPECT_NE(run.error.find("no equilibrium from load level"), std::string::npos) << run.error;
  EXPECT_NE(run.error.find("solve.json"), std::string::npos) << run.error;
  const json result = read_json("out/solve.json");
  EXPECT_EQ(result["completed"], false);
  EXPECT_EQ(result["converged"], false);
  EXPECT_GT(result["time_reached"], 0.5);
  EXPECT_FALSE(result["failed_attempts"].empty());
  const int last = result["increments"].back()["increment"].get<int>();
  const std::string step =
      "step_" + std::string(4 - std::to_string(last).size(), '0') + std::to_string(last) + ".vtu";
  EXPECT_TRUE(there_is(fs::path("out") / step)) << step;
  EXPECT_EQ(result["last_converged"]["file"], step);
  EXPECT_EQ(result["last_converged"]["is_final"], false);
  EXPECT_FALSE(there_is("out/solve.pvd"));
  EXPECT_NE(text_of("out/solve_incomplete.pvd").find(step), std::string::npos);

  ASSERT_EQ(solve(stretch()).exit_code, 0);  // A later run leaves nothing of this one.
  EXPECT_FALSE(there_is(fs::path("out") / step));
  EXPECT_FALSE(there_is("out/solve_incomplete.pvd"));
}

TEST_F(SolveCommand, ALoadBeyondALimitPointReportsTheWeakestModeAndKeepsTheLastState) {
  // In uniaxial strain s the law bears mu (s^3 - s), which is least at 1 / sqrt 3.
  const double max_kpa = 2.0 * 10.0 / (3.0 * std::sqrt(3.0));
  json deck = clamped();
  deck["sets"]["all"]["region"] = 0;
  deck["materials"] = {{{"law", "st-venant-kirchhoff"}, {"mu_kpa", 10}, {"lambda_kpa", 0}}};
  deck["displacements"] = {{{"set", "all"}, {"x_mm", 0}, {"y_mm", 0}},
                           {{"set", "Z0"}, {"z_mm", 0}}};
  deck["tractions"] = {{{"faces", "Z1"}, {"traction_kpa", {0, 0, -2.0 * max_kpa}}}};
  const auto run = solve(deck);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(run.message_lines(), 1) << run.error;
  EXPECT_TRUE(std::regex_search(
      run.error, std::regex("weakest mode: at node \\d+ of element \\d+ at \\(.* limit point")))
      << run.error;
  EXPECT_NE(run.error.find("the last is kept in "), std::string::npos) << run.error;
  const json result = read_json("out/solve.json");
  EXPECT_EQ(result["converged"], false);
  EXPECT_EQ(result["last_converged"]["is_final"], false);
  EXPECT_GT(result["last_converged"]["time"].get<double>(), 0.49);
  EXPECT_LE(result["last_converged"]["time"].get<double>(), 0.5);
  EXPECT_TRUE(there_is(fs::path("out") / result["last_converged"]["file"].get<std::string>()));
}

TEST_F(SolveCommand, APartConnectedByAnEdgeIsReportedAsSingular) {
  // A second block on the edge of the first, turned about it by its weight.
  mesh::VolumeMesh hinged = test::box_mesh({.cells = {1, 1, 1}, .size_mm = {10, 10, 20}});
  const mesh::VolumeMesh one = hinged;
  std::vector<std::int32_t> number;
  for (const Vec3& p : one.nodes_L) {
    const Vec3 beyond = p + Vec3(10, 0, 20);
    const auto same = std::find_if(one.nodes_L.begin(), one.nodes_L.end(),
                                   [&](const Vec3& q) { return (q - beyond).norm() < 1e-9; });
    number.push_back(std::int32_t(same != one.nodes_L.end()
                                      ? same - one.nodes_L.begin()
                                      : std::ptrdiff_t(hinged.nodes_L.size())));
    if (same == one.nodes_L.end()) hinged.nodes_L.push_back(beyond);
  }
  for (const std::int32_t node : one.blocks[0].nodes)
    hinged.blocks[0].nodes.push_back(number[std::size_t(node)]);
  hinged.blocks[0].region.resize(12, 0);
  write_mesh(hinged);
  json deck = clamped();
  deck.erase("probes");
  deck["body_forces"] = {{{"acceleration_m_s2", {0, 0, -9.81}}}};
  const auto run = solve(deck);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(run.message_lines(), 1) << run.error;
  EXPECT_TRUE(std::regex_search(
      run.error, std::regex("the tangent is singular: .* its motion is largest at node "
                            "\\d+ of element \\d+ at \\(")))
      << run.error;
  const json result = read_json("out/solve.json");
  EXPECT_EQ(result["completed"], false);
  EXPECT_TRUE(result["last_converged"].is_null());
  EXPECT_FALSE(there_is("out/solve.pvd"));
}

TEST_F(SolveCommand, AnInterruptedRunKeepsWhatConverged) {
  json deck = stretch();
  deck["steps"] = {{"max_increment", 0.0001}, {"max_attempts", 1000000}};  // Many seconds of work.
  const auto run = solve(deck, "out", "& pid=\\$!; sleep 2; kill -INT \\$pid; wait \\$pid");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.error.find("stopped on request"), std::string::npos) << run.error;
  EXPECT_EQ(run.message_lines(), 1) << run.error;
  const json result = read_json("out/solve.json");
  EXPECT_EQ(result["completed"], false);
  EXPECT_EQ(result["converged"], true);
  EXPECT_EQ(result["last_converged"]["is_final"], false);
  EXPECT_FALSE(there_is("out/solve.pvd"));
  EXPECT_LT(result["time_reached"], 1.0);
  for (const auto& entry : fs::directory_iterator(folder_ / "out"))
    EXPECT_EQ(entry.path().filename().string().find(".partial"), std::string::npos);
}

TEST_F(SolveCommand, EveryExampleHasTheDocumentedResult) {
  std::map<std::string, json> results;
  for (const auto& entry : fs::directory_iterator(fs::path(LEFORT_EXAMPLES) / "solve")) {
    if (entry.path().extension() != ".json") continue;
    const std::string name = entry.path().stem().string();
    const auto run =
        test::run_lefort("solve " + quoted(entry.path()) + " -o " + quoted(folder_ / name));
    EXPECT_EQ(run.exit_code, 0) << name << run.error;
    results[name] = read_json(fs::path(name) / "solve.json");
  }
  ASSERT_EQ(results.size(), 3U);
  const auto at = [&](const char* name, double time) {
    for (const json& increment : results[name]["increments"])
      if (increment["time"] == time) return increment;
    ADD_FAILURE() << name << " at " << time;
    return json();
  };
  const auto probe = [&](const char* name, double time, std::size_t column) {
    std::string heading;
    for (const auto& row : numbers_of(text_of(fs::path(name) / "probes.csv"), heading))
      if (row[0] == time) return row[column];
    ADD_FAILURE() << name << " at " << time;
    return 0.0;
  };

  const double young_mpa = 0.015, nu = 0.45;
  const auto [across, axial_mpa] = uniaxial_stretch(
      young_mpa / (2.0 + 2.0 * nu), young_mpa * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), 1.5);
  const json drawn = at("stretch", 0.5)["reactions_n"]["displacements[3] (set z1)"];
  EXPECT_NEAR(drawn[2].get<double>(), 400.0 * axial_mpa, 1e-6);
  EXPECT_NEAR(drawn[2].get<double>(), 2.152, 5e-4);
  EXPECT_NEAR(probe("stretch", 0.5, 1), 20.0 * (across - 1.0), 1e-6);
  EXPECT_NEAR(probe("stretch", 0.5, 2), -3.386, 5e-4);
  EXPECT_NEAR(probe("stretch", 1.0, 1), 0.0, 1e-9);

  const json ball = at("indent", 1.0)["contacts"]["ball"];
  EXPECT_NEAR(ball["force_n"][2].get<double>(), -0.271, 5e-4);
  EXPECT_NEAR(ball["max_penetration_mm"].get<double>(), 0.295, 5e-4);
  EXPECT_NEAR(at("indent", 1.0)["reaction_sum_n"][2].get<double>(), 0.271, 5e-4);

  EXPECT_NEAR(at("loads", 0.4)["reaction_sum_n"][2].get<double>(), 0.0379, 5e-5);
  EXPECT_NEAR(at("loads", 0.7)["reaction_sum_n"][1].get<double>(), -0.06, 1e-8);
  EXPECT_NEAR(probe("loads", 0.4, 3), -0.835, 5e-4);
  EXPECT_NEAR(probe("loads", 0.7, 2), 1.380, 5e-4);
  EXPECT_NEAR(probe("loads", 1.0, 3), 2.081, 5e-4);
  EXPECT_TRUE(there_is("loads/step_0005.vtu"));
  EXPECT_FALSE(there_is("loads/step_0002.vtu"));
}

TEST_F(SolveCommand, AGmshMeshOfTwoShapesAndLawsBearsItsLoads) {
  const fs::path deck = fs::path(LEFORT_EXAMPLES) / "solve" / "loads.json";
  const auto run = test::run_lefort("solve " + quoted(deck) + " -o " + quoted(folder_ / "out"));
  ASSERT_EQ(run.exit_code, 0) << run.error;
  const json result = read_json("out/solve.json");
  EXPECT_EQ(result["mesh"]["regions"], json({1, 2}));
  EXPECT_EQ(result["mesh"]["face_sets"], json::parse(R"({"held": 16, "tip": 16, "under": 24})"));
  const json last = result["increments"].back();
  for (std::size_t axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(last["reaction_sum_n"][axis].get<double>(), -last["load_sum_n"][axis].get<double>(),
                1e-8);
  // 3000 mm^3 of 920 kg/m^3 and 1000 mm^3 of 1100.
  EXPECT_NEAR(last["loads_n"]["body_forces[0]"][2].get<double>(), -9810 * (2.76e-6 + 1.1e-6),
              1e-12);
  EXPECT_NEAR(last["loads_n"]["tractions[0] (faces tip)"][1].get<double>(), 200 * 3e-4, 1e-12);
}

TEST_F(SolveCommand, EveryLinearSolverGivesTheSameShape) {
  json deck = stretch();
  ASSERT_EQ(solve(deck, "automatic").exit_code, 0);
  std::string heading;
  const auto expected = numbers_of(text_of("automatic/probes.csv"), heading).back();
  for (const char* kind : {"direct", "lagged", "multigrid"}) {
    deck["linear_solver"] = kind;
    ASSERT_EQ(solve(deck, kind).exit_code, 0) << kind;
    const auto row = numbers_of(text_of(fs::path(kind) / "probes.csv"), heading).back();
    ASSERT_EQ(row.size(), expected.size());
    for (std::size_t i = 0; i < row.size(); ++i) EXPECT_NEAR(row[i], expected[i], 1e-6) << kind;
  }
}

TEST_F(SolveCommand, AFieldFileIsTheObstacleItWasBuiltOf) {
  json deck = clamped();
  deck["obstacles"] = {{{"name", "ball"}, {"file", "ball.stl"}, {"faces", "Z1"}}};
  deck["obstacles"][0]["resolution"] = 32;
  deck["obstacles"][0]["band_mm"] = 2;
  deck["obstacles"][0]["keyframes"] = {{{"translation_mm", {0, 0, -1.5}}}};
  ASSERT_TRUE(io::write_surface(folder_ / "ball.stl", test::make_icosphere(4, 2, {5, 5, 24})));
  const auto of_surface = solve(deck, "surface");
  ASSERT_EQ(of_surface.exit_code, 0) << of_surface.error;
  const auto built =
      test::run_lefort("field build " + quoted(folder_ / "ball.stl") + " -o " +
                       quoted(folder_ / "ball.field") + " --resolution 32 --band 2 --smooth");
  ASSERT_EQ(built.exit_code, 0) << built.error;
  deck["obstacles"][0]["file"] = "ball.field";
  ASSERT_EQ(solve(deck, "field").exit_code, 0);
  EXPECT_GT(read_json("field/solve.json")["increments"].back()["contacts"]["ball"]["points"], 0);
  EXPECT_TRUE(text_of("surface/probes.csv") == text_of("field/probes.csv"));
}

TEST_F(SolveCommand, AnObstacleInsideTheBodyIsFoundBeforeEarlierResultsAreRemoved) {
  ASSERT_EQ(solve(stretch()).exit_code, 0);
  const auto with_ball = [&](double overlap_mm) {
    const Vec3 center(5, 5, 24.0 - overlap_mm);
    EXPECT_TRUE(io::write_surface(folder_ / "ball.stl", test::make_icosphere(4.0, 3, center)));
    json deck = clamped();
    deck["obstacles"] = {
        {{"name", "ball"},
         {"file", "ball.stl"},
         {"faces", "Z1"},
         {"resolution", 32},
         {"band_mm", 1.0},
         {"keyframes", json::parse(R"([{"time": 1.0, "translation_mm": [0, 0, -0.1]}])")}}};
    return deck;
  };
  for (const char* more : {"", "--check"}) {
    const auto run = solve(with_ball(2.5), "out", more);
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_EQ(run.message_lines(), 1) << run.error;
    EXPECT_TRUE(std::regex_search(
        run.error, std::regex("obstacles\\[0\\]: overlaps its faces by [0-9.]+ mm at rest; the "
                              "maximum distance of its distance query is [0-9.]+ mm")))
        << run.error;
    EXPECT_TRUE(there_is("out/solve.json"));
    EXPECT_TRUE(there_is("out/step_0002.vtu"));
  }
  const auto warned = solve(with_ball(0.5), "out", "--check --json");
  ASSERT_EQ(warned.exit_code, 0) << warned.error;
  const json warnings = json::parse(warned.out)["warnings"];
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].get<std::string>().find("obstacles[0]: overlaps its faces by 0."),
            std::string::npos);
  EXPECT_EQ(json::parse(solve(with_ball(0.0), "out", "--check --json").out)["warnings"],
            json::array());
}

TEST_F(SolveCommand, ChecksADeckWithoutSolvingIt) {
  const auto run = solve(stretch(), "out", "--check --json");
  EXPECT_EQ(run.exit_code, 0) << run.error;
  EXPECT_EQ(json::parse(run.out)["elements"], 96);
  EXPECT_FALSE(there_is("out"));
}

TEST_F(SolveCommand, BadDecksAreOneLineAndLeaveNothing) {
  const auto spoilt = [](const std::function<void(json&)>& spoil) {
    json deck = stretch();
    spoil(deck);
    return deck;
  };
  expect_refusal(spoilt([](json& d) { d["hue"] = "red"; }), "unknown key 'hue'");
  expect_refusal(spoilt([](json& d) { d["materials"][0]["law"] = "rubber"; }),
                 "there is no law 'rubber'");
  expect_refusal(spoilt([](json& d) { d["materials"][0]["mu_kpa"] = -1; }),
                 "materials[0]: neo-hookean: mu is -0.001 MPa");
  expect_refusal(spoilt([](json& d) {
                   d["materials"] = {{{"law", "neo-hookean"}, {"young_kpa", 15}, {"poisson", 0.5}}};
                 }),
                 "materials[0]: neo-hookean: poisson's ratio is 0.5, must be < 0.5");
  expect_refusal(spoilt([](json& d) { d["mesh"] = "lost.vtu"; }), "lost.vtu is not a file");
  expect_refusal(spoilt([](json& d) { d["mesh"] = "deck.json"; }),
                 "deck.json must end in .vtu or .msh");
  expect_refusal(spoilt([](json& d) { d["displacements"][0]["set"] = "base"; }),
                 "displacements[0]: there is no set base; the sets are: X0, X1, Y0, Y1, Z0, Z1");
  expect_refusal(spoilt([](json& d) { d["materials"][0]["region"] = "bone"; }),
                 "there is no region bone; the regions are: 0");
  expect_refusal(spoilt([](json& d) { d["displacements"].erase(0); }), "it is not fixed");
  expect_refusal(spoilt([](json& d) {
                   d["obstacles"] = {{{"name", "b"}, {"file", "none.stl"}, {"faces", "Z1"}}};
                 }),
                 "none.stl");
}

TEST_F(SolveCommand, BadMeshesAreOneLineAndLeaveNothing) {
  mesh::VolumeMesh turned = test::box_mesh(box_);
  std::swap(turned.blocks[0].nodes[4], turned.blocks[0].nodes[5]);
  write_mesh(turned);
  expect_refusal(stretch(), "element 1 at (");

  mesh::VolumeMesh nan = test::box_mesh(box_);
  nan.nodes_L[7].x() = std::nan("");
  write_mesh(nan);
  expect_refusal(stretch(), "node 7 is not finite");

  mesh::VolumeMesh separate = test::box_mesh(box_);
  const Index count = separate.node_count();
  for (Index n = 0; n < count; ++n)
    separate.nodes_L.emplace_back(separate.nodes_L[std::size_t(n)] + Vec3(0, 0, 50));
  for (std::size_t n = 0; n < 4 * 96; ++n)
    separate.blocks[0].nodes.push_back(separate.blocks[0].nodes[n] + std::int32_t(count));
  separate.blocks[0].region.resize(192, 0);
  write_mesh(separate);
  expect_refusal(stretch(), "the part of 96 elements around element 96 at (");

  mesh::VolumeMesh flat = test::box_mesh(box_);
  flat.blocks[0].nodes[4 * 5 + 1] = flat.blocks[0].nodes[4 * 5];
  write_mesh(flat);
  expect_refusal(stretch(), "element 5 at (");

  const auto with_mesh = [&](const char* file, const std::string& text) {
    EXPECT_TRUE(io::write_text(folder_ / file, text));
    json deck = stretch();
    deck["mesh"] = file;
    return deck;
  };
  const auto example = [](const char* file) {
    return io::read_text(fs::path(LEFORT_EXAMPLES) / "solve" / file, 1 << 20).value();
  };
  const auto replaced = [](std::string text, const std::string& what, const std::string& by) {
    const std::size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return text.replace(at, what.size(), by);
  };
  expect_refusal(
      with_mesh("lost.vtu", replaced(example("block.vtu"), "\n0 1 6 5 ", "\n0 1 6 4711 ")),
      "lost.vtu: element 0 refers to node 4711");
  const std::string gmsh = example("layers.msh");
  expect_refusal(with_mesh("lost.msh", replaced(gmsh, "\n57 1 2 7 6 ", "\n57 1 2 7 4711 ")),
                 "lost.msh: element 57 refers to node 4711, which is missing");
  expect_refusal(with_mesh("nan.msh", replaced(gmsh, "\n20 20 10\n", "\n20 nan 10\n")),
                 "nan.msh: node 125 has a coordinate that is not finite");

  std::string text = text_of("block.vtu");
  ASSERT_TRUE(io::write_text(folder_ / "block.vtu", text.substr(0, text.size() / 2)));
  expect_refusal(stretch(), "block.vtu");
}

TEST_F(SolveCommand, AnOutputThatCannotBeWrittenIsOneLine) {
  ASSERT_TRUE(io::write_text(folder_ / "deck.json", stretch().dump()));
  for (const char* out : {"/proc/nothing/here", "/dev/null"}) {
    const auto run = test::run_lefort("solve " + quoted(folder_ / "deck.json") + " -o " + out);
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_EQ(run.message_lines(), 1) << run.error;
    EXPECT_NE(run.error.find(out), std::string::npos) << run.error;
  }
}

TEST_F(SolveCommand, WhatARunIsMadeFromIsNeverOverwritten) {
  const auto spared = [&](const fs::path& deck_file, const json& deck, const fs::path& input) {
    EXPECT_TRUE(io::write_text(folder_ / deck_file, deck.dump()));
    const std::string before = text_of(input);
    const auto run =
        test::run_lefort("solve " + quoted(folder_ / deck_file) + " -o " + quoted(folder_.path()));
    EXPECT_EQ(run.exit_code, 1) << input;
    EXPECT_EQ(run.message_lines(), 1) << run.error;
    EXPECT_NE(run.error.find(input.string() + " is read by this run"), std::string::npos)
        << run.error;
    EXPECT_EQ(text_of(input), before);
    EXPECT_FALSE(there_is("solve.pvd"));
  };
  spared("solve.json", stretch(), "solve.json");
  fs::remove(folder_ / "solve.json");
  json deck = stretch();
  fs::copy_file(folder_ / "block.vtu", folder_ / "step_0007.vtu");
  deck["mesh"] = "step_0007.vtu";
  spared("deck.json", deck, "step_0007.vtu");
  fs::create_hard_link(folder_ / "block.vtu", folder_ / "step_12345.vtu");
  spared("deck.json", stretch(), "step_12345.vtu");
}

TEST_F(SolveCommand, OnlyStepsOfAnEarlierRunAreRemoved) {
  fs::create_directory(folder_ / "out");
  for (const char* name : {"step_by_step.vtu", "step_012.vtu", "step_0009a.vtu"})
    ASSERT_TRUE(io::write_text(folder_ / "out" / name, "mine"));
  ASSERT_EQ(solve(stretch()).exit_code, 0);
  const std::string series = text_of("out/solve.pvd");
  const std::string more = "<DataSet timestep=\"2\" part=\"0\" file=\"step_0009.vtu\"/>\n</Coll";
  ASSERT_TRUE(io::write_text(folder_ / "out/solve.pvd",
                             std::string(series).replace(series.find("</Coll"), 6, more)));
  ASSERT_TRUE(io::write_text(folder_ / "out/step_0009.vtu", "of an earlier, longer run"));
  ASSERT_EQ(solve(stretch()).exit_code, 0);
  EXPECT_FALSE(there_is("out/step_0009.vtu"));
  for (const char* name : {"step_by_step.vtu", "step_012.vtu", "step_0009a.vtu"})
    EXPECT_EQ(text_of(fs::path("out") / name), "mine");
}

TEST_F(SolveCommand, AFileOfAResultsNameThatNoRunWroteIsNotTouched) {
  for (const char* name : {"step_0009.vtu", "probes.csv", "solve.json", "solve.pvd"}) {
    const std::string out = std::string("out_") + name;
    fs::create_directory(folder_ / out);
    ASSERT_TRUE(io::write_text(folder_ / out / name, "mine"));
    const auto run = solve(stretch(), out);
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_EQ(run.message_lines(), 1) << run.error;
    EXPECT_NE(run.error.find(std::string(name) + " exists"), std::string::npos) << run.error;
    EXPECT_EQ(text_of(fs::path(out) / name), "mine");
  }
  ASSERT_EQ(solve(stretch()).exit_code, 0);
  ASSERT_TRUE(io::write_text(folder_ / "out/step_0077.vtu", "mine"));
  EXPECT_EQ(solve(stretch()).exit_code, 1);
  EXPECT_EQ(text_of("out/step_0077.vtu"), "mine");
  EXPECT_TRUE(there_is("out/solve.json"));
}

TEST_F(SolveCommand, AFullDiskIsOneLine) {
  // Enough for the mesh that is read (the limit holds for it, too), not for the results.
  const auto run = solve(stretch(), "out", "", "trap '' XFSZ; ulimit -f 8;");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(run.message_lines(), 1) << run.error;
  EXPECT_NE(run.error.find("cannot be written"), std::string::npos) << run.error;
  EXPECT_NE(run.error.find("out/"), std::string::npos) << run.error;
}

TEST_F(SolveCommand, WrongUsageIsTwo) {
  EXPECT_EQ(test::run_lefort("solve").exit_code, 2);
  EXPECT_EQ(test::run_lefort("solve deck.json").exit_code, 2);
  EXPECT_EQ(test::run_lefort("solve deck.json -o out --hue").exit_code, 2);
  const auto help = test::run_lefort("solve --help");
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_NE(help.out.find("lefort solve examples/solve/"), std::string::npos);
}

}  // namespace
}  // namespace lefort::app::test_solve_command
