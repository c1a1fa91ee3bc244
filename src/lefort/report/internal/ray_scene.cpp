#include <lefort/core/parallel.h>
#include <lefort/report/internal/ray_scene.h>

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>

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

constexpr std::size_t kPacket = 8;  ///< Rays that Embree traces together.

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
    // With one thread the tree is always the same.
    const ThreadLimit one_thread(1);
    rtcCommitScene(rtc(scene));
  }
  const RTCError error = rtcGetDeviceError(device);
  if (!allocated || error != RTC_ERROR_NONE)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("surfaces do not fit into memory: Embree error {}", int(error)));
  return RayScene(scene);
}

int RayScene::count_open(const Vec3& origin_L, std::span<const Vec3> directions_L,
                         double max_distance_mm) const {
  int open = 0;
  for (std::size_t begin = 0; begin < directions_L.size(); begin += kPacket) {
    const std::size_t count = std::min(kPacket, directions_L.size() - begin);
    alignas(32) std::array<int, kPacket> valid{};
    RTCRay8 rays{};
    for (std::size_t i = 0; i < kPacket; ++i) {
      valid[i] = i < count ? -1 : 0;
      const Vec3& direction_L = directions_L[begin + std::min(i, count - 1)];
      rays.org_x[i] = float(origin_L.x());
      rays.org_y[i] = float(origin_L.y());
      rays.org_z[i] = float(origin_L.z());
      rays.dir_x[i] = float(direction_L.x());
      rays.dir_y[i] = float(direction_L.y());
      rays.dir_z[i] = float(direction_L.z());
      rays.tfar[i] = float(max_distance_mm);
      rays.mask[i] = ~0U;
    }
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded8(valid.data(), rtc(scene_), &context, &rays);
    for (std::size_t i = 0; i < count; ++i) open += rays.tfar[i] < 0.0F ? 0 : 1;
  }
  return open;
}

}  // namespace lefort::report
