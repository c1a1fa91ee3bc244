#include <lefort/app/commands/slicer_progress.h>
#include <lefort/core/escape_markup.h>
#include <lefort/core/printable.h>

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

namespace lefort::app {

SlicerProgress::~SlicerProgress() { end_stage(); }

void SlicerProgress::begin_stage(std::string_view name) {
  end_stage();
  stage_ = escape_markup(printable(name));
  in_stage_ = true;
  shown_percent_ = -1;
  begun_ = std::chrono::steady_clock::now();
  fmt::print(
      "<filter-start>\n<filter-name>{0}</filter-name>\n<filter-comment>{0}</filter-comment>\n"
      "</filter-start>\n",
      stage_);
  report(0.0);
}

void SlicerProgress::report(double fraction) {
  if (!in_stage_) return;
  const int percent = int(std::clamp(fraction, 0.0, 1.0) * 100.0);
  if (percent == shown_percent_) return;
  shown_percent_ = percent;
  fmt::print("<filter-progress>{:.2f}</filter-progress>\n", percent / 100.0);
  std::fflush(stdout);
}

void SlicerProgress::note(std::string_view sentence) { terminal_.note(sentence); }

bool SlicerProgress::stop_requested() const { return terminal_.stop_requested(); }

void SlicerProgress::end_stage() {
  if (!in_stage_) return;
  in_stage_ = false;
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begun_).count();
  fmt::print(
      "<filter-end>\n<filter-name>{}</filter-name>\n<filter-time>{:.1f}</filter-time>\n"
      "</filter-end>\n",
      stage_, seconds);
  std::fflush(stdout);
}

}  // namespace lefort::app
