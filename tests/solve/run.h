/// \file
/// Prepares and runs a deck in a test.
#pragma once

#include <lefort/solve/run_deck.h>

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace lefort::test {

/// Expects that the deck can be prepared and run.
inline solve::DeckRun run(mesh::VolumeMesh mesh, solve::Deck deck,
                          const solve::ObstacleDistanceQueries& distance_queries = {},
                          const solve::DeckWatch& watch = {},
                          Progress& progress = Progress::none()) {
  const auto prepared = solve::prepare_deck(std::move(mesh), std::move(deck));
  EXPECT_TRUE(prepared) << prepared.error().message;
  auto done = solve::run_deck(*prepared, distance_queries, watch, progress);
  EXPECT_TRUE(done) << done.error().message;
  return *std::move(done);
}

/// Sum of all vectors.
inline Vec3 sum(const std::vector<Vec3>& vectors) {
  Vec3 total = Vec3::Zero();
  for (const Vec3& vector : vectors) total += vector;
  return total;
}

}  // namespace lefort::test
