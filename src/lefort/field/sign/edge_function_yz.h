/// \file
/// Edge function in the plane of y and z (Pineda 1988): on which side of an edge a line along x
/// passes.
#pragma once

#include <lefort/core/types.h>

#include <utility>

namespace lefort::field {

/// The edge from a to b, projected along x.
class EdgeFunctionYz {
 public:
  EdgeFunctionYz(const Vec3& a, const Vec3& b)
      : swapped_(std::pair(a.y(), a.z()) > std::pair(b.y(), b.z())),
        from_y_(swapped_ ? b.y() : a.y()),
        from_z_(swapped_ ? b.z() : a.z()),
        along_y_((swapped_ ? a.y() : b.y()) - from_y_),
        along_z_((swapped_ ? a.z() : b.z()) - from_z_) {}

  /// Twice the signed area of (a, b, p) in the plane of y and z, positive if counter-clockwise,
  /// never zero. Exactly the negative value for the reversed edge, so both triangles of an edge
  /// agree, and a line along x through p crosses a closed surface equally often in both directions,
  /// even if it touches an edge.
  [[nodiscard]] double evaluate(double y, double z) const {
    const double area = along_y_ * (z - from_z_) - along_z_ * (y - from_y_);
    const double sided = area == 0.0 ? 1e-300 : area;
    return swapped_ ? -sided : sided;
  }

 private:
  bool swapped_;
  double from_y_, from_z_, along_y_, along_z_;
};

}  // namespace lefort::field
