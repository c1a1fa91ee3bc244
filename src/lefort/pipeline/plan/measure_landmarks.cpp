#include <lefort/io/landmarks_file.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/plan.h>
#include <lefort/pipeline/plan/cephalometric_table.h>

#include <fmt/format.h>

namespace lefort::pipeline {

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

}  // namespace lefort::pipeline
