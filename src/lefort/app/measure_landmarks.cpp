#include <lefort/app/cephalometric_table.h>
#include <lefort/app/pipeline.h>
#include <lefort/io/landmarks_file.h>
#include <lefort/io/write_atomically.h>

#include <fmt/format.h>

namespace lefort::app {

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

Result<Summary> measure_landmarks(const LandmarksJob& job, Progress&) {
  if (job.output && job.output->extension() != ".csv")
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("output file {} must end in .csv", job.output->string()));
  if (job.save) LEFORT_TRY_VOID(io::check_landmarks_ending(*job.save));
  LEFORT_TRY(const plan::Landmarks before, io::read_landmarks(job.before));
  plan::Landmarks last = before;
  std::vector<plan::Measurement> after;
  if (job.after) {
    LEFORT_TRY(last, io::read_landmarks(*job.after));
    LEFORT_TRY(after, plan::measure(last));
  }
  LEFORT_TRY(const std::vector<plan::Measurement> table, plan::measure(before));
  if (job.output) LEFORT_TRY_VOID(io::write_text(*job.output, io::cephalometric_csv(table, after)));
  if (job.save) LEFORT_TRY_VOID(io::write_landmarks(*job.save, last));

  Summary summary;
  summary.text = fmt::format("{} landmarks", before.size()) + cephalometric_text(table, after);
  summary.json = {{"landmarks", before.size()}, {"measurements", cephalometric_json(table, after)}};
  return summary;
}

}  // namespace lefort::app
