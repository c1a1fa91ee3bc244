#include <lefort/io/internal/csv.h>

#include <algorithm>

namespace lefort::io::internal {
namespace {

/// Removes a quoted field from the front of `line`, which starts after the first quote.
std::optional<std::string> take_quoted(std::string_view& line) {
  std::string field;
  while (!line.empty()) {
    const char c = line.front();
    line.remove_prefix(1);
    if (c != '"') {
      field += c;
    } else if (line.starts_with('"')) {
      field += '"';
      line.remove_prefix(1);
    } else {
      return field;
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::vector<std::string>> split_csv(std::string_view line) {
  std::vector<std::string> fields;
  while (true) {
    if (line.starts_with('"')) {
      line.remove_prefix(1);
      auto field = take_quoted(line);
      if (!field || (!line.empty() && line.front() != ',')) return std::nullopt;
      fields.push_back(*std::move(field));
    } else {
      const std::size_t end = std::min(line.find(','), line.size());
      fields.emplace_back(line.substr(0, end));
      line.remove_prefix(end);
    }
    if (line.empty()) return fields;
    line.remove_prefix(1);  // The comma.
  }
}

std::string csv_field(std::string_view text) {
  if (text.find_first_of(",\"\r\n#") == std::string_view::npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

}  // namespace lefort::io::internal
