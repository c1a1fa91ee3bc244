#include <lefort/report/internal/three_point_lighting.h>

#include <algorithm>
#include <cmath>

namespace lefort::report {

namespace {

double saturate(double x) { return std::clamp(x, 0.0, 1.0); }

double smooth_step(double from, double to, double x) {
  const double t = saturate((x - from) / (to - from));
  return t * t * (3.0 - 2.0 * t);
}

/// Lambert's cosine, extended beyond 90 degrees as in translucent tissue (wrap lighting).
double wrapped(double cosine) {
  constexpr double kWrap = 0.25;
  return saturate((cosine + kWrap) / (1.0 + kWrap));
}

/// Interreflections in concave regions have the color of the surface: red in the folds of skin
/// (Jimenez et al. 2016, Practical realtime strategies for accurate indirect occlusion).
Light with_bounces(double sky, const Light& albedo) { return sky / (1.0 - albedo * (1.0 - sky)); }

double highlight(const Vec3& normal, const Vec3& lamp, const Vec3& towards, double exponent) {
  const Vec3 half = (lamp + towards).normalized();
  return std::pow(saturate(normal.dot(half)), exponent);
}

/// Compresses bright tones to values below 1; dark and middle tones do not change.
double soft_limit(double light) {
  constexpr double kKnee = 0.7;
  if (light <= kKnee) return light;
  const double over = (light - kKnee) / (1.0 - kKnee);
  return kKnee + (1.0 - kKnee) * over / (1.0 + over);
}

}  // namespace

Light light_of(const Rgb& color) {
  const auto decode = [](double c) {
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  };
  return {decode(color[0]), decode(color[1]), decode(color[2])};
}

double srgb_of(double light) {
  const double l = saturate(light);
  return l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1.0 / 2.4) - 0.055;
}

Vec3 towards_key_light(const ViewAxes& camera) {
  return (0.62 * camera.up_L + 0.78 * camera.towards_L).normalized();
}

Light shade(const SurfacePoint& point, const ViewAxes& camera) {
  static const Light main_light = Light(1.0, 0.975, 0.94) * 0.95;
  static const Light side_light = Light(0.92, 0.96, 1.0) * 0.13;
  static const Light ambient_light = Light(0.97, 0.985, 1.0) * 0.20;
  static const Light ground_light = Light(1.0, 0.95, 0.9) * 0.08;

  const Vec3& normal = point.normal_L;
  const Vec3 main_lamp = towards_key_light(camera);
  Light received = main_light * wrapped(normal.dot(main_lamp)) * point.lamp;
  for (const double side : {-1.0, 1.0}) {
    const Vec3 lamp =
        (side * camera.right_L + 0.15 * camera.up_L + 0.25 * camera.towards_L).normalized();
    received += side_light * wrapped(normal.dot(lamp)) * point.sky;
  }
  const double upward = 0.5 + 0.5 * normal.dot(camera.up_L);
  received += (ground_light + (ambient_light - ground_light) * upward) *
              with_bounces(point.sky, point.albedo);
  Light sent = point.albedo * received;

  const double facing = saturate(normal.dot(camera.towards_L));
  const double sheen = 0.05 * highlight(normal, main_lamp, camera.towards_L, 22.0) * point.lamp;
  sent += sheen;
  // Darkens the silhouette, so that it is visible on the light background.
  sent *= 1.0 - 0.45 * (1.0 - smooth_step(0.0, 0.42, facing));
  if (point.back) sent *= 0.45;
  return sent.unaryExpr(&soft_limit);
}

Light backdrop(double height_fraction) {
  static const Light top = light_of({0.975, 0.98, 0.985});
  static const Light bottom = light_of({0.90, 0.91, 0.92});
  return bottom + (top - bottom) * smooth_step(0.0, 0.9, height_fraction);
}

}  // namespace lefort::report
