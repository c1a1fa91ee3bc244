/// \file
/// Minimal paths between voxels: the course of least travel time of a front whose speed is given.
#pragma once

#include <lefort/image/volume.h>

#include <span>
#include <vector>

namespace lefort::anatomy {

/// Time of voxels that no front reaches.
inline constexpr float kNeverReached = 1e30F;

/// A voxel at which a front starts.
struct FrontSource {
  Index voxel;        ///< Offset; sources outside of the grid are ignored.
  float time = 0.0F;  ///< >= 0.
};

/// Arrival times of a front that starts at the sources: the viscosity solution of
/// |grad T| F = 1, by fast marching with first-order upwind differences \cite sethian1996.
///
/// \param speed    F of each voxel [mm per unit of time]; the front does not enter voxels with a
///   speed of 0 or less, or NaN.
/// \param sources  where and when the front starts.
/// \param target   the front stops there; -1: nowhere.
/// \returns T of each voxel; kNeverReached where there is none.
[[nodiscard]] image::ScalarVolume arrival_times(const image::ScalarVolume& speed,
                                                std::span<const FrontSource> sources,
                                                Index target = -1);

/// The minimal path \cite deschamps2001, from voxel to neighboring voxel (26) of the steepest
/// descent of the arrival times.
///
/// \param times  of arrival_times().
/// \param from   offset of the end of the path.
/// \returns the centers of its voxels, the source first [mm]; empty if `from` was not reached.
[[nodiscard]] std::vector<Vec3> minimal_path(const image::ScalarVolume& times, Index from);

/// Resamples a path at equal distances and convolves it with a Gaussian along its length. Both ends
/// stay.
///
/// \param path_L      two or more points.
/// \param sigma_mm    of the Gaussian, >= 0.
/// \param spacing_mm  of the points of the result, > 0; the last interval may be shorter.
/// \returns the points; `path_L` itself if it has no length.
[[nodiscard]] std::vector<Vec3> smoothed_path(std::span<const Vec3> path_L, double sigma_mm,
                                              double spacing_mm);

/// Length of a polyline.
[[nodiscard]] double length_mm(std::span<const Vec3> path_L);

}  // namespace lefort::anatomy
