/// \file
/// The deck on disk: JSON, checked against contract/deck.schema.json and for sense.
#pragma once

#include <lefort/core/error.h>
#include <lefort/field/build/build_distance_field.h>
#include <lefort/solve/deck.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace lefort::io {

/// Where an obstacle's shape comes from.
struct ObstacleFile {
  std::filesystem::path file;           ///< A surface, or a field (.field).
  field::DistanceFieldOptions options;  ///< For a surface.
};

/// When the mesh is written.
enum class WriteEvery { kIncrement, kRequestedTime, kLast };

/// Which fields are written with it.
struct WrittenFields {
  bool displacement = true;
  bool stress = true;
  bool volume_ratio = true;
  bool stretches = true;
  bool energy = true;
  bool contact = true;
};

/// The input of `lefort solve`. Paths are made absolute by the deck's folder.
struct DeckFile {
  std::string title;
  std::filesystem::path mesh;
  std::string regions;  ///< Cell array of the mesh; empty as read_volume_mesh() takes it.
  double mm_per_unit = 1.0;
  solve::Deck deck;
  std::vector<ObstacleFile> obstacles;  ///< Like solve::Deck::obstacles.
  WriteEvery every = WriteEvery::kIncrement;
  WrittenFields fields;
  std::vector<std::string> warnings;  ///< One for each deprecated key.
};

/// A deck and the text it was read from, which is read once.
struct DeckText {
  DeckFile file;
  std::string json;
};

/// Reads and checks a deck.
///
/// \returns kFileNotFound; kPlanInvalid with the key and what is wrong with it, as
///   `materials[0]: there is no law 'rubber', ...`. A key that stands twice in an object is wrong.
[[nodiscard]] Result<DeckText> read_deck(const std::filesystem::path& file);

/// The same from text; relative paths are taken from `folder`.
[[nodiscard]] Result<DeckFile> parse_deck(std::string_view json,
                                          const std::filesystem::path& folder);

}  // namespace lefort::io
