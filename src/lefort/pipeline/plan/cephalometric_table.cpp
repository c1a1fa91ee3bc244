#include <lefort/pipeline/plan/cephalometric_table.h>

#include <fmt/format.h>

#include <optional>
#include <utility>

namespace lefort::pipeline {

nlohmann::json cephalometric_json(std::span<const plan::Measurement> before,
                                  std::span<const plan::Measurement> after) {
  const auto number = [](const std::optional<double>& value) {
    return value ? nlohmann::json(*value) : nlohmann::json();
  };
  nlohmann::json lines = nlohmann::json::array();
  for (std::size_t i = 0; i < before.size(); ++i) {
    nlohmann::json line{{"measurement", before[i].name},
                        {"meaning", before[i].meaning},
                        {"unit", before[i].unit},
                        {"before", number(before[i].value)}};
    if (!after.empty()) line["after"] = number(after[i].value);
    lines.push_back(std::move(line));
  }
  return lines;
}

std::string cephalometric_text(std::span<const plan::Measurement> before,
                               std::span<const plan::Measurement> after) {
  std::string text;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const plan::Measurement& line = before[i];
    if (!line.value) continue;
    text += fmt::format("\n  {:<10} {:8.1f}", line.name, *line.value);
    if (!after.empty() && after[i].value)
      text += fmt::format(" -> {:8.1f} ({:+.1f})", *after[i].value, *after[i].value - *line.value);
    text += fmt::format(" {:<3}  {}", line.unit, line.meaning);
  }
  return text;
}

}  // namespace lefort::pipeline
