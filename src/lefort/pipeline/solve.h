/// \file
/// Solution of a deck.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/summary.h>

#include <filesystem>

namespace lefort::pipeline {

struct SolveJob {
  bool quiet = false;  ///< Do not report each increment.
  std::filesystem::path deck;
  std::filesystem::path output;  ///< A folder; made if missing.
  bool check_only = false;       ///< Only read and check the deck.
};

/// Solves a deck; writes displacement, stress and reactions over time. If the solve ends early, the
/// converged increments and solve.json are kept.
///
/// \returns the summary, or
///   - kFileNotFound     the deck, its mesh or the file of an obstacle does not exist;
///   - kPlanInvalid      a key or name of the deck is invalid, conditions contradict each other, or
///     a part of the body can move as a rigid body;
///   - kFileUnsupported, kFileCorrupt  from reading mesh and obstacles;
///   - kMeshInvalid, kElementInverted  from solve::prepare_deck(), or an obstacle is open;
///   - kInvalidArgument  a constant of a law or field is out of range, an obstacle overlaps its
///     faces too deeply, or `detection: bvh` is used with a .field;
///   - kNotConverged, kOutOfMemory  the solve ended before time 1;
///   - kFileUnwritable   a result would overwrite an input or a file of another program, or cannot
///     be written;
///   - kCancelled        `progress` requested a stop.
[[nodiscard]] Result<Summary> solve_deck(const SolveJob& job, Progress& progress);

}  // namespace lefort::pipeline
