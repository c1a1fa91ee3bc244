/// \file
/// A scan with labels, landmarks and the directions of the head.
#pragma once

#include <lefort/pipeline/prepare/load_head.h>
#include <lefort/plan/head_directions.h>
#include <lefort/plan/landmarks.h>

#include <filesystem>
#include <optional>
#include <span>
#include <string>

namespace lefort::pipeline {

struct OrientedHead {
  ScannedLabels scanned;
  plan::Landmarks landmarks;
  plan::HeadDirections directions;
};

/// Where a head comes from.
struct HeadFiles {
  std::filesystem::path ct;                        ///< Anything `lefort import` reads.
  std::optional<std::filesystem::path> labels;     ///< .seg.nrrd; segmented unless given.
  std::optional<std::filesystem::path> landmarks;  ///< Others are found in the scan.
};

/// Reads a scan, its labels and landmarks, and finds the landmarks that the file does not have.
///
/// \param files   of the head.
/// \param needed  names of landmarks (a pair without its side); if the file has all of them, no
///   landmark is found automatically.
/// \returns the head; or the errors of scan_labels(), io::read_landmarks(), find_head_landmarks()
///   and plan::head_directions().
[[nodiscard]] Result<OrientedHead> oriented_head(const HeadFiles& files,
                                                 std::span<const std::string> needed,
                                                 Progress& progress);

/// A landmark that a measurement needs.
/// \returns its position; or kAnatomyMissing, with the name and how to give it.
[[nodiscard]] Result<Vec3> needed_landmark(std::span<const plan::Landmark> landmarks,
                                           const std::string& name);

/// A point given on the command line: the name of a landmark, or "x,y,z" [mm, LPS].
/// \returns its position; or kInvalidArgument.
[[nodiscard]] Result<Vec3> named_point(std::span<const plan::Landmark> landmarks,
                                       const std::string& text);

}  // namespace lefort::pipeline
