/// \file
/// Result files of commands, checked against their schemas in contract/.
#pragma once

#include <lefort/io/read_text.h>
#include <lefort/io/validate_json.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>

namespace lefort::test {

/// The test fails if `text` breaks the schema contract/KIND.schema.json.
inline void expect_schema(const std::string& text, const std::string& kind) {
  const auto schema =
      io::read_text(std::filesystem::path(LEFORT_CONTRACT) / (kind + ".schema.json"), 1 << 24);
  ASSERT_TRUE(schema) << kind;
  const auto checked = io::validate_json(text, *schema, kind);
  EXPECT_TRUE(checked) << checked.error().message;
}

/// A result as JSON. The test fails if the file is missing or breaks its schema.
///
/// \param kind  of the schema contract/KIND.schema.json.
inline nlohmann::json read_result(const std::filesystem::path& file, const std::string& kind) {
  const auto text = io::read_text(file, 1 << 28);
  EXPECT_TRUE(text) << file;
  if (!text) return {};
  SCOPED_TRACE(file);
  expect_schema(*text, kind);
  return nlohmann::json::parse(*text);
}

}  // namespace lefort::test
