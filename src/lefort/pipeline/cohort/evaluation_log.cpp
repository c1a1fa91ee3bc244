#include <lefort/core/printable.h>
#include <lefort/io/read_text.h>
#include <lefort/pipeline/cohort/evaluation_log.h>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <sstream>

namespace lefort::pipeline {

Result<void> EvaluationLog::add(std::string_view line) const {
  const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  return lock_.append(fmt::format("{:%Y-%m-%dT%H:%M:%SZ} {} {}\n", fmt::gmtime(now), ::getpid(),
                                  printable(cleaned_(std::string(line)))));
}

void EvaluationLog::begin_stage(std::string_view name) {
  static_cast<void>(add(fmt::format("stage: {}", name)));  // add() at the end reports a full disk.
  inner_.begin_stage(fmt::format("{}: {}", name_, name));
}

void EvaluationLog::note(std::string_view sentence) {
  static_cast<void>(add(sentence));  // As above.
  inner_.note(fmt::format("{}: {}", name_, sentence));
}

int attempts_in(const std::filesystem::path& log) {
  constexpr std::uintmax_t kMaxBytes = 64 << 20;
  const auto text = io::read_text(log, kMaxBytes);
  if (!text) return 0;
  std::istringstream lines(*text);
  int attempts = 0;
  std::string time, process, word, rest;
  while (lines >> time >> process >> word && std::getline(lines, rest))
    if (word == kLogStarted) ++attempts;
  return attempts;
}

}  // namespace lefort::pipeline
