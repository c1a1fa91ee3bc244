/// \file
/// The synthetic cases of a phantom cohort: shapes, movements and parameters drawn from a seed.
/// Reads no file.
#pragma once

#include <lefort/anatomy/head_from_surfaces.h>
#include <lefort/core/types.h>
#include <lefort/pipeline/validate.h>
#include <lefort/plan/landmarks.h>

#include <nlohmann/json.hpp>

#include <cstdint>
#include <string>

namespace lefort::pipeline {

/// Parameters that all faces of a cohort are made with, and that its plans do not state.
struct PhantomTruth {
  double skin_ratio;  ///< Calibration parameter of this name.
  double poisson;     ///< Calibration parameter of this name.
};

/// \param seed  of the cohort.
/// \returns a ratio from 2 to 12 and a Poisson's ratio from 0.36 to 0.48.
[[nodiscard]] PhantomTruth draw_truth(std::uint64_t seed);

struct PhantomCase {
  std::string name;  ///< "case_01".
  std::uint64_t seed;
  std::string procedure;        ///< "mandible setback", ...
  Vec3 scale;                   ///< Of the synthetic head along x, y, z.
  nlohmann::ordered_json plan;  ///< With default parameters.
};

/// File of the labels, which the plan of each case names.
inline constexpr const char* kPhantomLabels = "labels.seg.nrrd";

/// Draws the size of the head (0.95 to 1.05 along each axis) and the movement: in turn a setback of
/// the mandible, an advancement of the mandible, an advancement of the mid-face, and a setback of
/// the mandible with an advancement of the mid-face. Every moved mandible also rotates about its
/// condyles, by up to 2 degrees.
///
/// \param job      voxel and element size, seed.
/// \param number   of the case, from 0.
/// \param attempt  from 0; each has other random numbers.
[[nodiscard]] PhantomCase draw_case(const PhantomCohortJob& job, int number, int attempt = 0);

/// The scan of a case and its true labels: the synthetic head, stretched by its scale.
[[nodiscard]] anatomy::LabeledScan phantom_scan(const PhantomCohortJob& job,
                                                const PhantomCase& one);

/// Landmarks of the skin of the stretched synthetic head that define the regions of a face. It has
/// no eyes and no mouth: heights and widths are mean proportions of adult faces \cite farkas1994
/// between its nose and its chin, heuristic.
[[nodiscard]] plan::Landmarks phantom_landmarks(const PhantomCase& one);

/// Distance over which the error of a measured skin changes. Errors of neighboring vertices are
/// equal in part: they come from voxels and from the filter of the segmentation.
inline constexpr double kSkinNoiseLength_mm = 10.0;

/// A continuous random field: at each place a number with the standard normal distribution,
/// independent of numbers more than two kSkinNoiseLength_mm away along an axis. It is a trilinear
/// interpolation of independent numbers on a lattice, divided by its standard deviation. With
/// noise that is independent at each vertex, vertices would be peaks, because noise is averaged
/// inside a triangle. Closest points would then lie mostly between the peaks, and a fit to them
/// would be biased.
///
/// \param point_mm  finite.
/// \param seed      of the field.
[[nodiscard]] double random_field(const Vec3& point_mm, std::uint64_t seed);

}  // namespace lefort::pipeline
