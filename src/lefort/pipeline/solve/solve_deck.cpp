#include <lefort/contact/distance_query.h>
#include <lefort/core/units.h>
#include <lefort/field/build/build_distance_field.h>
#include <lefort/io/deck_file.h>
#include <lefort/io/deprecated_keys.h>
#include <lefort/io/field_file.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/sha256.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/volume_mesh_files.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/solve.h>
#include <lefort/pipeline/solve/write_solve.h>
#include <lefort/pipeline/timing/peak_memory.h>
#include <lefort/pipeline/timing/phase_clock.h>
#include <lefort/solve/check_obstacles.h>
#include <lefort/solve/run_deck.h>

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

const char* name_of(fem::SolvePhase phase) {
  switch (phase) {
    case fem::SolvePhase::kAssembly:
      return "assembly";
    case fem::SolvePhase::kFactorization:
      return "factorization";
    case fem::SolvePhase::kSolve:
      return "solve";
    case fem::SolvePhase::kNone:
      break;
  }
  return "evaluation";
}

Result<mesh::VolumeMesh> read_mesh(const io::DeckFile& file) {
  LEFORT_TRY(mesh::VolumeMesh mesh, io::read_volume_mesh(file.mesh, file.regions));
  for (Vec3& p_L : mesh.nodes_L) p_L *= file.mm_per_unit;
  return mesh;
}

Result<SolveInputs> fingerprints(const SolveJob& job, const io::DeckFile& file) {
  SolveInputs inputs;
  LEFORT_TRY(inputs.deck_sha256, io::sha256_of_file(job.deck));
  LEFORT_TRY(inputs.mesh_sha256, io::sha256_of_file(file.mesh));
  for (const io::ObstacleFile& obstacle : file.obstacles) {
    LEFORT_TRY(inputs.obstacle_sha256.emplace_back(), io::sha256_of_file(obstacle.file));
  }
  return inputs;
}

Result<void> check_obstacle_files(const io::DeckFile& file) {
  for (std::size_t i = 0; i < file.obstacles.size(); ++i) {
    std::error_code error;
    if (!fs::is_regular_file(file.obstacles[i].file, error))
      return fail(ErrorCode::kFileNotFound, fmt::format("obstacles[{}]: file {} does not exist", i,
                                                        file.obstacles[i].file.string()));
  }
  return {};
}

/// The deck and all files that it names.
std::vector<fs::path> input_files(const SolveJob& job, const io::DeckFile& file) {
  std::vector<fs::path> files{job.deck, file.mesh};
  for (const io::ObstacleFile& obstacle : file.obstacles) files.push_back(obstacle.file);
  return files;
}

/// Unless the deck has a band, queries by BVH have no largest distance.
constexpr double kUnlimited_mm = std::numeric_limits<double>::infinity();

using DistanceQueryPtr = std::shared_ptr<const contact::DistanceQuery>;

Result<DistanceQueryPtr> detect_obstacle(const io::ObstacleFile& file,
                                         contact::DetectionMethod detection, Progress& progress) {
  const bool is_field = file.file.extension() == ".field";
  if (detection == contact::DetectionMethod::kBvh) {
    if (is_field)
      return fail(ErrorCode::kInvalidArgument,
                  "detection bvh requires the surface, not its distance field");
    LEFORT_TRY(const geometry::TriangleMesh surface, io::read_surface(file.file, progress));
    LEFORT_TRY(field::PreparedSurface prepared, field::prepare_surface(surface));
    return contact::bvh_distance_query(
        std::make_shared<const geometry::Bvh>(std::move(prepared.mesh_B)),
        file.options.band_mm > 0.0 ? file.options.band_mm : kUnlimited_mm);
  }
  const auto shared = [&](field::DistanceField field,
                          std::shared_ptr<const geometry::TriangleMesh> surface) {
    return contact::field_distance_query(
        std::make_shared<const field::DistanceField>(std::move(field)), detection,
        std::move(surface));
  };
  if (is_field) {
    LEFORT_TRY(field::DistanceField read, io::read_field(file.file));
    return shared(std::move(read), nullptr);
  }
  LEFORT_TRY(geometry::TriangleMesh surface, io::read_surface(file.file));
  LEFORT_TRY(field::DistanceField built,
             field::build_distance_field(surface, file.options, progress));
  return shared(std::move(built),
                std::make_shared<const geometry::TriangleMesh>(std::move(surface)));
}

Result<solve::ObstacleDistanceQueries> detect_obstacles(const io::DeckFile& file,
                                                        Progress& progress) {
  solve::ObstacleDistanceQueries distance_queries;
  for (std::size_t i = 0; i < file.obstacles.size(); ++i) {
    const solve::Obstacle& obstacle = file.deck.obstacles[i];
    auto distance_query = detect_obstacle(file.obstacles[i], obstacle.detection, progress);
    if (!distance_query)
      return fail(distance_query.error().code,
                  fmt::format("obstacle {}: {}", obstacle.name, distance_query.error().message));
    distance_queries.push_back(*std::move(distance_query));
  }
  return distance_queries;
}

std::string described(const solve::Increment& increment) {
  std::string line = fmt::format(
      "  time {:.4f}: {} Newton iterations in {} increments tried, relative residual {:.1e}, moved "
      "up to {:.3f} mm",
      increment.time, increment.newton_iterations(), increment.attempts.size(),
      increment.relative_residual, increment.max_displacement_mm);
  for (std::size_t i = 0; i < increment.contacts.size(); ++i) {
    const contact::ContactStatistics& contact = increment.contacts[i];
    line += fmt::format(", {} nodes in contact", contact.nodes);
  }
  return line;
}

/// The error of a run that ended early, whose results are written.
tl::unexpected<Error> ended_early(const SolveJob& job, const solve::DeckRun& run,
                                  const SolveWriter& writer) {
  const Error& failure = *run.failure;
  const std::string kept =
      run.last ? fmt::format("{} increments converged, to time {:.6g}, the last is kept in {}",
                             run.last->number, run.last->time, writer.last_step().string())
               : std::string("no increment converged");
  const std::string json = (job.output / "solve.json").string();
  if (failure.code == ErrorCode::kCancelled)
    return fail(failure.code, fmt::format("stopped on request; {}; see {}", kept, json));
  return fail(failure.code,
              fmt::format("{}; {}; the solver's history is in {}", failure.message, kept, json));
}

Summary summary_of_check(const SolveJob& job, const solve::PreparedDeck& prepared) {
  Summary summary;
  summary.text = fmt::format(
      "{}: {} nodes, {} elements, {} prescribed components; the deck is valid", job.deck.string(),
      prepared.mesh.node_count(), prepared.mesh.element_count(), prepared.prescribed.size());
  summary.json = {{"deck", job.deck.string()},
                  {"nodes", prepared.mesh.node_count()},
                  {"elements", prepared.mesh.element_count()},
                  {"held_components", prepared.prescribed.size()},
                  {"warnings", prepared.warnings}};
  return summary;
}

Error in_deck(const SolveJob& job, const Error& error) {
  return {error.code, fmt::format("deck {}: {}", job.deck.string(), error.message)};
}

Result<solve::PreparedDeck> read_and_prepare(const SolveJob& job, const io::DeckFile& file) {
  LEFORT_TRY_VOID(check_obstacle_files(file));
  LEFORT_TRY_VOID(check_inputs_are_kept(job.output, input_files(job, file)));
  LEFORT_TRY(mesh::VolumeMesh mesh, read_mesh(file));
  Result<solve::PreparedDeck> prepared = solve::prepare_deck(std::move(mesh), file.deck);
  if (!prepared) return tl::unexpected(in_deck(job, prepared.error()));
  return prepared;
}

/// Adds warnings on the obstacles to those of the deck, and reports all.
Result<solve::ObstacleDistanceQueries> prepare_obstacles(const SolveJob& job,
                                                         const io::DeckFile& file,
                                                         solve::PreparedDeck& prepared,
                                                         Progress& progress) {
  if (!file.obstacles.empty()) progress.begin_stage("build the obstacles' fields");
  LEFORT_TRY(solve::ObstacleDistanceQueries queries, detect_obstacles(file, progress));
  const auto overlaps = solve::check_obstacles(prepared, queries);
  if (!overlaps) return tl::unexpected(in_deck(job, overlaps.error()));
  prepared.warnings.insert(prepared.warnings.end(), overlaps->begin(), overlaps->end());
  for (const std::string& warning : prepared.warnings) progress.note("warning: " + warning);
  if (job.quiet) return queries;
  for (std::size_t i = 0; i < queries.size(); ++i)
    progress.note(fmt::format("obstacle {}: {} detection, k_c = {:.4g} kPa/mm",
                              prepared.deck.obstacles[i].name,
                              contact::name_of(prepared.deck.obstacles[i].detection),
                              kpa_from_mpa(prepared.obstacle_stiffness_mpa_per_mm[i])));
  return queries;
}

/// Solves the deck and writes its results as they are computed.
Result<Summary> solve_and_write(const SolveJob& job, const io::DeckFile& file,
                                const solve::PreparedDeck& prepared,
                                const solve::ObstacleDistanceQueries& queries, PhaseClock& clock,
                                Progress& progress) {
  LEFORT_TRY(const SolveInputs inputs, fingerprints(job, file));
  const io::EmptyFolderCleanup cleanup(job.output);
  LEFORT_TRY_VOID(io::make_output_folder(job.output));
  LEFORT_TRY_VOID(remove_solve_results(job.output));
  SolveWriter writer(job.output, file, prepared);
  LEFORT_TRY_VOID(writer.begin());

  progress.begin_stage("solve");
  clock.begin(name_of(fem::SolvePhase::kNone));
  solve::DeckWatch watch;
  watch.on_phase = [&](fem::SolvePhase phase) { clock.begin(name_of(phase)); };
  watch.on_increment = [&](const solve::Increment& increment) {
    clock.begin("output");
    if (!job.quiet) progress.note(described(increment));
    Result<void> added = writer.add(increment);
    clock.begin(name_of(fem::SolvePhase::kNone));
    return added;
  };
  watch.on_failure = [&](const solve::DeckRun& run) -> Result<void> {
    clock.begin("output");
    LEFORT_TRY_VOID(writer.finish(inputs, run, clock));
    clock.begin("diagnosis");
    return {};
  };
  LEFORT_TRY(const solve::DeckRun run, solve::run_deck(prepared, queries, watch, progress));
  clock.begin("output");
  LEFORT_TRY(const auto json, writer.finish(inputs, run, clock));
  if (!run.completed()) return ended_early(job, run, writer);

  Summary summary;
  summary.text = fmt::format(
      "{}: {} increments, largest displacement {:.4f} mm, {} elements, {:.0f} MB at most",
      job.output.string(), run.last->number, run.last->max_displacement_mm,
      prepared.mesh.element_count(), peak_memory_mb());
  summary.json = json;
  return summary;
}

}  // namespace

Result<Summary> solve_deck(const SolveJob& job, Progress& progress) {
  PhaseClock clock;
  clock.begin("read");
  progress.begin_stage("read");
  LEFORT_TRY(const io::DeckText text, io::read_deck(job.deck));
  io::note_warnings(text.file.warnings, progress);
  LEFORT_TRY(solve::PreparedDeck prepared, read_and_prepare(job, text.file));

  clock.begin("obstacles");
  LEFORT_TRY(const solve::ObstacleDistanceQueries queries,
             prepare_obstacles(job, text.file, prepared, progress));
  if (job.check_only) return summary_of_check(job, prepared);

  clock.begin("read");
  return solve_and_write(job, text.file, prepared, queries, clock, progress);
}

}  // namespace lefort::pipeline
