#include <lefort/io/landmarks_file.h>
#include <lefort/io/point_table.h>
#include <lefort/pipeline/prepare/find_head_landmarks.h>
#include <lefort/pipeline/prepare/oriented_head.h>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace lefort::pipeline {
namespace {

Result<void> find_missing(OrientedHead& head, Progress& progress) {
  LEFORT_TRY(const plan::LandmarkSearch search,
             find_head_landmarks(head.scanned.scan.ct, head.scanned.labels, head.scanned.levels,
                                 progress));
  for (const plan::Landmark& found : search.landmarks())
    if (!plan::find_landmark(head.landmarks, found.name)) head.landmarks.push_back(found);
  return {};
}

}  // namespace

Result<OrientedHead> oriented_head(const HeadFiles& files, std::span<const std::string> needed,
                                   Progress& progress) {
  OrientedHead head;
  if (files.landmarks) {
    LEFORT_TRY(head.landmarks, io::read_landmarks(*files.landmarks));
  }
  io::PlanFile options;
  options.labels = files.labels;
  LEFORT_TRY(head.scanned, scan_labels(options, files.ct, nullptr, progress));
  const bool has_all = std::all_of(needed.begin(), needed.end(), [&](const std::string& name) {
    return plan::pair_midpoint(head.landmarks, name).has_value();
  });
  if (!has_all) LEFORT_TRY_VOID(find_missing(head, progress));
  LEFORT_TRY(head.directions, plan::head_directions(head.landmarks));
  return head;
}

Result<Vec3> needed_landmark(std::span<const plan::Landmark> landmarks, const std::string& name) {
  if (const auto found = plan::find_landmark(landmarks, name)) return *found;
  return fail(ErrorCode::kAnatomyMissing,
              fmt::format("the landmark {} ({}) is not found in the scan: give it in a file "
                          "(--landmarks)",
                          name, plan::full_name(name)));
}

Result<Vec3> named_point(std::span<const plan::Landmark> landmarks, const std::string& text) {
  if (const auto found = plan::find_landmark(landmarks, text)) return *found;
  if (const auto points = io::parse_points(text); points && points->size() == 1)
    return points->front();
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("'{}' is neither a landmark of this head nor a point x,y,z", text));
}

}  // namespace lefort::pipeline
