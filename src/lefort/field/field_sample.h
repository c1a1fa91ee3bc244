/// \file
/// Results of distance field queries.
#pragma once

#include <lefort/core/types.h>
#include <lefort/field/field_frame.h>
#include <lefort/field/zone.h>

namespace lefort::field {

/// Distance, interpolated between the samples around a point.
///
///   zone      distance        gradient     meaning
///   kBand     interpolated    interpolated within the narrow band
///   kOutside  +band_mm        0            beyond the band, outside
///   kInside   -band_mm        0            beyond the band, inside
///   kUnknown  +band_mm        0            sign not known, or the point is not finite
struct FieldSample {
  Zone zone;
  double distance_mm;  ///< Negative inside.
  Vec3 gradient_B;     ///< Derivative of distance_mm, in frame B; its length is about 1.
};

/// Distance with continuous first derivatives; second derivatives may jump at cell faces. Zones as
/// in FieldSample.
struct SmoothSample {
  Zone zone;
  double distance_mm;  ///< Negative inside.
  Vec3 gradient_B;     ///< As in FieldSample.
  Mat3 hessian_B;      ///< [1/mm], symmetric.
};

/// The result where there is no distance.
[[nodiscard]] inline FieldSample beyond_band(Zone zone, double band_mm) {
  return {zone, zone == Zone::kInside ? -band_mm : band_mm, Vec3::Zero()};
}

/// Zone of a point outside the cube of a field.
[[nodiscard]] inline Zone zone_beyond_box(const FieldFrame& frame, const Vec3& p_B) {
  return frame.closed && p_B.allFinite() ? Zone::kOutside : Zone::kUnknown;
}

}  // namespace lefort::field
