#include <lefort/app/commands/profile.h>
#include <lefort/core/trace.h>
#include <lefort/io/write_atomically.h>

#include <nlohmann/json.hpp>

#include <utility>

namespace lefort::app {

void StageTrace::begin_stage(std::string_view name) {
  end_stage();
  stage_ = std::string(name);
  begin_us_ = trace_time_us();
  inner_.begin_stage(name);
}

void StageTrace::end_stage() {
  if (!stage_.empty()) record_event(std::exchange(stage_, ""), begin_us_);
}

Result<void> write_profile(const std::filesystem::path& file) {
  nlohmann::json events = nlohmann::json::array();
  for (const TraceEvent& event : stop_trace())
    events.push_back({{"name", event.name},
                      {"ph", "X"},
                      {"ts", event.begin_us},
                      {"dur", event.duration_us},
                      {"pid", 1},
                      {"tid", event.thread}});
  const nlohmann::json document{{"displayTimeUnit", "ms"}, {"traceEvents", std::move(events)}};
  return io::write_text(
      file, document.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

}  // namespace lefort::app
