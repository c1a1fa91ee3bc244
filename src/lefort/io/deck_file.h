/// \file
/// The deck on disk: JSON, validated against contract/deck.schema.json and checked for consistency.
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
  field::DistanceFieldOptions options;  ///< Used if the file is a surface.
};

/// When the mesh is written.
enum class WriteEvery { kIncrement, kRequestedTime, kLast };

/// Which fields are written with the mesh.
struct WrittenFields {
  bool displacement = true;
  bool stress = true;
  bool volume_ratio = true;
  bool stretches = true;
  bool energy = true;
  bool contact = true;
};

/// The input of `lefort solve`. Relative paths of the deck are joined to its folder; read_deck()
/// makes them absolute.
struct DeckFile {
  std::string title;
  std::filesystem::path mesh;
  std::string regions;  ///< Cell array with the regions; empty: the default of read_volume_mesh().
  double mm_per_unit = 1.0;  ///< One unit of length of the mesh file [mm].
  solve::Deck deck;
  std::vector<ObstacleFile> obstacles;  ///< In the order of solve::Deck::obstacles.
  WriteEvery every = WriteEvery::kIncrement;
  WrittenFields fields;
  std::vector<std::string> warnings;  ///< One for each deprecated key.
};

/// A deck and its text; the file is read only once, so that both agree.
struct DeckText {
  DeckFile file;
  std::string json;
};

/// Reads and checks a deck.
///
/// \returns the deck; kFileNotFound; kFileCorrupt if the file is larger than 64 MiB; or
///   kPlanInvalid with the key and the error, for example `materials[0]: there is no law 'rubber',
///   ...`. A key that occurs twice in an object is an error.
[[nodiscard]] Result<DeckText> read_deck(const std::filesystem::path& file);

/// As read_deck() from text; relative paths are taken from `folder`.
[[nodiscard]] Result<DeckFile> parse_deck(std::string_view json,
                                          const std::filesystem::path& folder);

}  // namespace lefort::io
