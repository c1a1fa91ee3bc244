#include <lefort/core/parallel.h>
#include <lefort/report/internal/ray_scene.h>

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <limits>

namespace lefort::report {

namespace {

RTCScene rtc(const std::shared_ptr<void>& scene) { return static_cast<RTCScene>(scene.get()); }

/// \returns false if memory is exhausted.
bool attach(RTCDevice device, RTCScene scene, const geometry::TriangleMesh& mesh) {
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* const vertices = static_cast<float*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                              3 * sizeof(float), mesh.vertices.size()));
  auto* const corners = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              3 * sizeof(std::uint32_t), mesh.triangles.size()));
  const bool allocated = vertices != nullptr && corners != nullptr;
  if (allocated) {
    float* coordinate = vertices;
    for (const Vec3& vertex : mesh.vertices)
      for (int axis = 0; axis < 3; ++axis) *coordinate++ = float(vertex[axis]);
    std::uint32_t* corner = corners;
    for (const geometry::Triangle& triangle : mesh.triangles)
      for (const std::int32_t index : triangle) *corner++ = std::uint32_t(index);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
  }
  rtcReleaseGeometry(geometry);
  return allocated;
}

RTCRay ray_of(const Vec3& origin_L, const Vec3& direction_L, double max_distance_mm) {
  RTCRay ray{};
  ray.org_x = float(origin_L.x());
  ray.org_y = float(origin_L.y());
  ray.org_z = float(origin_L.z());
  ray.dir_x = float(direction_L.x());
  ray.dir_y = float(direction_L.y());
  ray.dir_z = float(direction_L.z());
  ray.tfar = float(max_distance_mm);
  ray.mask = ~0U;
  return ray;
}

}  // namespace

Result<RayScene> RayScene::build(std::span<const geometry::TriangleMesh* const> meshes) {
  const RTCDevice device = rtcNewDevice(nullptr);
  if (device == nullptr)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("the ray caster cannot start: Embree error {}",
                            int(rtcGetDeviceError(nullptr))));
  const std::shared_ptr<void> scene(rtcNewScene(device), [device](void* handle) {
    rtcReleaseScene(static_cast<RTCScene>(handle));
    rtcReleaseDevice(device);
  });
  rtcSetSceneFlags(rtc(scene), RTC_SCENE_FLAG_ROBUST);  // No light leaks along edges.
  bool allocated = true;
  for (const geometry::TriangleMesh* mesh : meshes)
    if (!mesh->triangles.empty()) allocated = allocated && attach(device, rtc(scene), *mesh);
  {
    // The order of the tree decides which of two triangles a ray through their common edge hits;
    // with one thread this order is deterministic.
    const ThreadLimit one_thread(1);
    rtcCommitScene(rtc(scene));
  }
  const RTCError error = rtcGetDeviceError(device);
  if (!allocated || error != RTC_ERROR_NONE)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("surfaces do not fit into memory: Embree error {}", int(error)));
  return RayScene(scene);
}

std::optional<RayHit> RayScene::closest(const Vec3& origin_L, const Vec3& direction_L) const {
  RTCRayHit query{};
  query.ray = ray_of(origin_L, direction_L, std::numeric_limits<double>::infinity());
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(rtc(scene_), &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  const Vec3 normal_L(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z);
  return RayHit{query.ray.tfar, normal_L.normalized(), query.hit.primID, query.hit.u, query.hit.v};
}

bool RayScene::blocked(const Vec3& origin_L, const Vec3& direction_L,
                       double max_distance_mm) const {
  RTCRay ray = ray_of(origin_L, direction_L, max_distance_mm);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(rtc(scene_), &context, &ray);
  return ray.tfar < 0.0F;
}

}  // namespace lefort::report
