#include <lefort/bench/ball_problem.h>
#include <lefort/bench/calculix_ball.h>
#include <lefort/bench/contact_bench.h>
#include <lefort/bench/stopwatch.h>
#include <lefort/core/parallel.h>
#include <lefort/core/version.h>
#include <lefort/field/build/build_distance_field.h>
#include <lefort/io/write_atomically.h>
#include <lefort/solve/prepare_deck.h>
#include <lefort/solve/run_deck.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

namespace lefort::bench {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using contact::Integration;

constexpr int kBallIncrements = BallProblem::kPressIncrements + BallProblem::kSlideIncrements;
constexpr double kBallTolerance = 1e-8;
constexpr int kBallHalvings = 4;

/// One run of lefort.
struct BallRun {
  double seconds = 0.0;        ///< With the field.
  double field_seconds = 0.0;  ///< Of the ball's distance field.
  Index iterations = 0;
  int increments = 0;
  double force_z_n = 0.0;  ///< On the block at the end.
  double stiffness_mpa_per_mm = 0.0;
};

solve::Deck deck_of(Integration integration) {
  solve::Deck deck;
  deck.laws.push_back({"",
                       fem::DecoupledLaw<fem::MooneyRivlin>{
                           .isochoric = {.c10_mpa = BallProblem::kC10_mpa, .c01_mpa = 0.0},
                           .volume = {.form = fem::VolumetricForm::kQuadratic,
                                      .kappa_mpa = BallProblem::kKappa_mpa}},
                       0.0});
  deck.displacements = {{.set = BallProblem::kBelow, .displacement_mm = {0.0, 0.0, 0.0}}};
  solve::Obstacle ball;
  ball.name = "ball";
  ball.faces = BallProblem::kAbove;
  ball.path = BallProblem::path();
  ball.integration = integration;
  deck.obstacles.push_back(std::move(ball));
  deck.steps.first_increment = deck.steps.max_increment = 1.0 / kBallIncrements;
  for (int n = 1; n < kBallIncrements; ++n) deck.times.push_back(double(n) / kBallIncrements);
  deck.newton.relative_tolerance = kBallTolerance;
  return deck;
}

Result<BallRun> run_lefort(Integration integration, Progress& progress) {
  constexpr int kBallResolution = 128;
  constexpr double kBallBand_mm = 3.0;
  Stopwatch watch;
  const auto ball =
      std::make_shared<const geometry::TriangleMesh>(BallProblem::ball(kBallHalvings));
  LEFORT_TRY(field::DistanceField field,
             field::build_distance_field(
                 *ball, {.resolution = kBallResolution, .band_mm = kBallBand_mm, .smooth = true},
                 progress));
  BallRun run{.field_seconds = watch.seconds()};
  LEFORT_TRY(auto query, contact::field_distance_query(
                             std::make_shared<const field::DistanceField>(std::move(field)),
                             contact::DetectionMethod::kSmooth, ball));
  LEFORT_TRY(const solve::PreparedDeck prepared,
             solve::prepare_deck(BallProblem::block(), deck_of(integration)));
  solve::DeckWatch on;
  on.on_increment = [&run](const solve::Increment& increment) -> Result<void> {
    run.iterations += increment.newton_iterations();
    ++run.increments;
    return {};
  };
  LEFORT_TRY(const solve::DeckRun done,
             solve::run_deck(prepared, {std::move(query)}, on, progress));
  if (done.failure) return tl::unexpected(*done.failure);
  run.seconds = watch.seconds();
  run.force_z_n = done.last->contacts.front().force_L_n.z();
  run.stiffness_mpa_per_mm = prepared.obstacle_stiffness_mpa_per_mm.front();
  return run;
}

/// The table and its figures.
struct ContactTable {
  std::string rows;
  Json json = Json::object();

  void add(const std::string& name, double seconds, Index iterations, int increments,
           double force_z_n) {
    rows += fmt::format("| {} | {:.2f} | {} | {} | {:.3f} |\n", name, seconds, increments,
                        iterations, force_z_n);
    json[name] = {{"seconds", seconds},
                  {"increments", increments},
                  {"iterations", iterations},
                  {"force_z_n", force_z_n}};
  }
};

Result<void> measure_lefort(const ContactBenchOptions& options, ContactTable& table,
                            Progress& progress) {
  for (const Integration integration : {Integration::kQuadrature, Integration::kWeighted}) {
    std::vector<double> seconds, field_seconds;
    BallRun last;
    for (int turn = 1; turn <= options.repeats; ++turn) {
      progress.begin_stage(
          fmt::format("lefort, {}, run {} of {}", name_of(integration), turn, options.repeats));
      LEFORT_TRY(last, run_lefort(integration, progress));
      seconds.push_back(last.seconds);
      field_seconds.push_back(last.field_seconds);
    }
    const std::string name = fmt::format("lefort, {}", name_of(integration));
    table.add(name, median(seconds), last.iterations, last.increments, last.force_z_n);
    table.json[name]["field_seconds"] = median(field_seconds);
    table.json[name]["stiffness_mpa_per_mm"] = last.stiffness_mpa_per_mm;
  }
  return {};
}

const char* folder_of(CalculixContact contact) {
  return contact == CalculixContact::kMortar ? "calculix-mortar" : "calculix-node-to-surface";
}

/// With the stiffness of lefort's contact by quadrature.
Result<void> measure_calculix(const ContactBenchOptions& options, ContactTable& table,
                              Progress& progress) {
  const double stiffness = table.json.at("lefort, quadrature").at("stiffness_mpa_per_mm");
  for (const CalculixContact contact :
       {CalculixContact::kNodeToSurface, CalculixContact::kMortar}) {
    const std::string name = fmt::format("CalculiX, {}", name_of(contact));
    progress.begin_stage(name);
    const auto run = run_calculix_ball({.contact = contact,
                                        .stiffness_mpa_per_mm = stiffness,
                                        .halvings = kBallHalvings,
                                        .threads = options.threads,
                                        .tolerance = kBallTolerance,
                                        .folder = options.output / folder_of(contact)},
                                       progress);
    if (run) {
      table.add(name, run->wall_seconds, run->iterations, run->increments, run->force_z_n);
      continue;
    }
    if (run.error().code != ErrorCode::kNotConverged || progress.stop_requested())
      return tl::unexpected(run.error());
    table.rows +=
        fmt::format("| {} | {} | | | |\n", name, "does not reach the end: " + run.error().message);
    table.json[name] = {{"failure", run.error().message}};
  }
  return {};
}

}  // namespace

Result<std::string> run_contact_bench(const ContactBenchOptions& options, Progress& progress) {
  std::error_code error;
  fs::create_directories(options.output, error);
  if (error)
    return fail(ErrorCode::kFileUnwritable,
                fmt::format("cannot create {}: {}", options.output.string(), error.message()));
  const ThreadLimit limit(options.threads);
  ContactTable table;
  LEFORT_TRY_VOID(measure_lefort(options, table, progress));
  if (options.with_peer) LEFORT_TRY_VOID(measure_calculix(options, table, progress));
  const std::string page = fmt::format(
      "# Contact\n\nlefort {}, `lefort bench contact`. A rigid ball of {} mm is pressed {} mm into "
      "a block of 40 x 40 x 20 mm and slid {} mm along it in {} + {} increments, without friction; "
      "16 x 16 x 8 hex8, c10 {} MPa, kappa {} MPa; relative residuals of {:.0e}, each by the "
      "program's own measure; {} threads. lefort: with the ball's distance field, median of {}; "
      "CalculiX: the whole process, once; its C3D8 integrates the volume term fully, which locks "
      "in "
      "nearly incompressible tissue and raises the force, lefort's hex8 has a mean dilatation.\n\n"
      "| program, contact | s | increments | iterations | vertical force N |\n"
      "|---|---|---|---|---|\n{}",
      kVersion, BallProblem::kRadius_mm, BallProblem::kPressed_mm, BallProblem::kSlid_mm,
      BallProblem::kPressIncrements, BallProblem::kSlideIncrements, BallProblem::kC10_mpa,
      BallProblem::kKappa_mpa, kBallTolerance, options.threads, options.repeats, table.rows);
  LEFORT_TRY_VOID(io::write_text(options.output / "contact.md", page));
  LEFORT_TRY_VOID(io::write_text(options.output / "contact.json", table.json.dump(1) + "\n"));
  return page;
}

}  // namespace lefort::bench
