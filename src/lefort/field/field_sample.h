/// \file
/// What a query of a distance field answers.
#pragma once

#include <lefort/core/types.h>
#include <lefort/field/field_frame.h>
#include <lefort/field/zone.h>

namespace lefort::field {

/// Distance as interpolated between the samples around a point. Beyond the band the distance is
/// +band_mm (kOutside, kUnknown) or -band_mm (kInside) and the gradient zero.
struct FieldSample {
  Zone zone;
  double distance_mm;
  Vec3 gradient_B;  ///< Derivative of distance_mm; about, not exactly, of unit length.
};

/// Distance with continuous first derivatives; the second may jump at faces of cells. Beyond the
/// band as in FieldSample.
struct SmoothSample {
  Zone zone;
  double distance_mm;
  Vec3 gradient_B;
  Mat3 hessian_B;  ///< [1/mm], symmetric.
};

/// The answer where there is no distance.
[[nodiscard]] inline FieldSample beyond_band(Zone zone, double band_mm) {
  return {zone, zone == Zone::kInside ? -band_mm : band_mm, Vec3::Zero()};
}

/// Where a point outside the cube of a field lies.
[[nodiscard]] inline Zone zone_beyond_box(const FieldFrame& frame, const Vec3& p_B) {
  return frame.closed && p_B.allFinite() ? Zone::kOutside : Zone::kUnknown;
}

}  // namespace lefort::field
