#include <lefort/bench/competitors.h>
#include <lefort/core/check.h>

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace lefort::bench {

struct EmbreePoints::Scene {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::vector<std::array<float, 3>> vertices;
  std::vector<geometry::Triangle> triangles;
};

namespace {

using Float3 = std::array<float, 3>;

Float3 minus(const Float3& a, const Float3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
float dot(const Float3& a, const Float3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// C. Ericson, Real-Time Collision Detection, section 5.1.5, in single precision, as in Embree's
/// example of point queries.
float squared_distance(const Float3& p, const Float3& a, const Float3& b, const Float3& c) {
  const Float3 ab = minus(b, a), ac = minus(c, a), ap = minus(p, a);
  const auto at = [&](float v, float w) {
    Float3 off{};
    for (std::size_t k = 0; k < 3; ++k) off[k] = ap[k] - v * ab[k] - w * ac[k];
    return dot(off, off);
  };
  const float d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0.0F && d2 <= 0.0F) return at(0.0F, 0.0F);
  const Float3 bp = minus(p, b);
  const float d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0.0F && d4 <= d3) return at(1.0F, 0.0F);
  const float vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0F && d1 >= 0.0F && d3 <= 0.0F) return at(d1 / (d1 - d3), 0.0F);
  const Float3 cp = minus(p, c);
  const float d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0.0F && d5 <= d6) return at(0.0F, 1.0F);
  const float vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0F && d2 >= 0.0F && d6 <= 0.0F) return at(0.0F, d2 / (d2 - d6));
  const float va = d3 * d6 - d5 * d4;
  if (va <= 0.0F && d4 - d3 >= 0.0F && d5 - d6 >= 0.0F) {
    const float w = (d4 - d3) / (d4 - d3 + d5 - d6);
    return at(1.0F - w, w);
  }
  const float scale = 1.0F / (va + vb + vc);
  return at(vb * scale, vc * scale);
}

/// User data of a query.
struct Search {
  const std::vector<Float3>* vertices;
  const std::vector<geometry::Triangle>* triangles;
  float squared;
};

bool visit(RTCPointQueryFunctionArguments* arguments) {
  auto& search = *static_cast<Search*>(arguments->userPtr);
  const geometry::Triangle& t = (*search.triangles)[arguments->primID];
  const Float3 p = {arguments->query->x, arguments->query->y, arguments->query->z};
  const float squared = squared_distance(p, (*search.vertices)[std::size_t(t[0])],
                                         (*search.vertices)[std::size_t(t[1])],
                                         (*search.vertices)[std::size_t(t[2])]);
  if (squared >= search.squared) return false;
  search.squared = squared;
  arguments->query->radius = std::sqrt(squared);
  return true;
}

}  // namespace

EmbreePoints::EmbreePoints(const geometry::TriangleMesh& mesh) : scene_(std::make_unique<Scene>()) {
  scene_->device = rtcNewDevice("threads=1,user_threads=1");
  LEFORT_CHECK(scene_->device != nullptr);
  for (const Vec3& v : mesh.vertices)
    scene_->vertices.push_back({float(v.x()), float(v.y()), float(v.z())});
  scene_->triangles = mesh.triangles;
  scene_->scene = rtcNewScene(scene_->device);
  RTCGeometry geometry = rtcNewGeometry(scene_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* const vertices = static_cast<Float3*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                              sizeof(Float3), scene_->vertices.size()));
  std::copy(scene_->vertices.begin(), scene_->vertices.end(), vertices);
  auto* const triangles = static_cast<geometry::Triangle*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              sizeof(geometry::Triangle), scene_->triangles.size()));
  std::copy(scene_->triangles.begin(), scene_->triangles.end(), triangles);
  rtcSetGeometryPointQueryFunction(geometry, visit);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene_->scene);
}

EmbreePoints::~EmbreePoints() {
  rtcReleaseScene(scene_->scene);
  rtcReleaseDevice(scene_->device);
}

void EmbreePoints::distances(std::span<const Vec3> points, double max_distance_mm,
                             std::span<double> distances_mm) const {
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  const auto radius = float(max_distance_mm);
  const float squared_radius =
      std::isfinite(radius) ? radius * radius : std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < points.size(); ++i) {
    RTCPointQuery query{};
    query.x = float(points[i].x());
    query.y = float(points[i].y());
    query.z = float(points[i].z());
    query.radius = radius;
    Search search{&scene_->vertices, &scene_->triangles, squared_radius};
    rtcPointQuery(scene_->scene, &query, &context, nullptr, &search);
    distances_mm[i] = double(std::sqrt(search.squared));
  }
}

}  // namespace lefort::bench
