#include "simulation/ray_scene.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <cstring>

#include "core/error.h"

namespace rigmap {

struct RayScene::Impl {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  void Check(const char* deed) const {
    if (const RTCError error = rtcGetDeviceError(device); error != RTC_ERROR_NONE) {
      throw ToolError(
          fmt::format("Embree: {} failed with error {}", deed, static_cast<int>(error)));
    }
  }
  void* Buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, std::size_t item_bytes,
               std::size_t count) const {
    void* buffer = rtcSetNewGeometryBuffer(geometry, type, 0, format, item_bytes, count);
    Check("making a buffer");
    return buffer;
  }
  void SetVertices(RTCGeometry geometry, const std::vector<Eigen::Vector3f>& vertices) const {
    constexpr std::size_t kBytes = 3 * sizeof(float);
    static_assert(sizeof(Eigen::Vector3f) == kBytes);
    std::memcpy(
        Buffer(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, kBytes, vertices.size()),
        vertices.data(), kBytes * vertices.size());
  }
  std::uint32_t Attach(RTCGeometry geometry) const {
    rtcCommitGeometry(geometry);
    const std::uint32_t id = rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    Check("adding a geometry");
    return id;
  }
};

RayScene::RayScene() : impl_(std::make_unique<Impl>()) {
  impl_->device = rtcNewDevice("set_affinity=0");
  if (!impl_->device) throw ToolError("Embree: expected a device, found none");
  impl_->scene = rtcNewScene(impl_->device);
  rtcSetSceneFlags(impl_->scene, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_COMPACT);
}

RayScene::~RayScene() {
  rtcReleaseScene(impl_->scene);
  rtcReleaseDevice(impl_->device);
}

std::uint32_t RayScene::AddMesh(const Mesh& mesh) {
  const RTCGeometry geometry = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  impl_->SetVertices(geometry, mesh.vertices);
  constexpr std::size_t kBytes = sizeof(mesh.triangles[0]);
  std::memcpy(impl_->Buffer(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, kBytes,
                            mesh.triangles.size()),
              mesh.triangles.data(), kBytes * mesh.triangles.size());
  return impl_->Attach(geometry);
}

std::uint32_t RayScene::AddGrids(const std::vector<Eigen::Vector3f>& vertices,
                                 const std::vector<VertexGrid>& grids) {
  const RTCGeometry geometry = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_GRID);
  impl_->SetVertices(geometry, vertices);
  auto* buffer = static_cast<RTCGrid*>(impl_->Buffer(
      geometry, RTC_BUFFER_TYPE_GRID, RTC_FORMAT_GRID, sizeof(RTCGrid), grids.size()));
  for (const VertexGrid& grid : grids) {
    *buffer++ = {grid.first, grid.columns, grid.columns, grid.rows};
  }
  return impl_->Attach(geometry);
}

void RayScene::Commit() {
  // Embree's own setting for threads would bind the whole process.
  tbb::task_arena one_thread(1);
  one_thread.execute([&] { rtcJoinCommitScene(impl_->scene); });
  impl_->Check("building the tree");
}

std::optional<RayHit> RayScene::Cast(const Ray& ray) const {
  RTCRayHit query{};
  query.ray.org_x = ray.origin.x();
  query.ray.org_y = ray.origin.y();
  query.ray.org_z = ray.origin.z();
  query.ray.dir_x = ray.direction.x();
  query.ray.dir_y = ray.direction.y();
  query.ray.dir_z = ray.direction.z();
  query.ray.tnear = ray.first;
  query.ray.tfar = ray.last;
  query.ray.mask = 0xFFFFFFFFu;
  query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect1(impl_->scene, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return RayHit{query.ray.tfar,   {query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z},
                query.hit.geomID, query.hit.primID,
                query.hit.u,      query.hit.v};
}

std::array<std::optional<RayHit>, 8> RayScene::Cast(const Eigen::Vector3f& origin,
                                                    const Directions& directions) const {
  alignas(32) RTCRayHit8 query{};
  alignas(32) std::array<int, 8> valid{};
  valid.fill(-1);
  for (int i = 0; i < 8; ++i) {
    query.ray.org_x[i] = origin.x();
    query.ray.org_y[i] = origin.y();
    query.ray.org_z[i] = origin.z();
    query.ray.dir_x[i] = directions[i].x();
    query.ray.dir_y[i] = directions[i].y();
    query.ray.dir_z[i] = directions[i].z();
    query.ray.tfar[i] = std::numeric_limits<float>::infinity();
    query.ray.mask[i] = 0xFFFFFFFFu;
    query.hit.geomID[i] = query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  }
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect8(valid.data(), impl_->scene, &context, &query);
  std::array<std::optional<RayHit>, 8> hits;
  for (int i = 0; i < 8; ++i) {
    if (query.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
    hits[i] = {query.ray.tfar[i],   {query.hit.Ng_x[i], query.hit.Ng_y[i], query.hit.Ng_z[i]},
               query.hit.geomID[i], query.hit.primID[i],
               query.hit.u[i],      query.hit.v[i]};
  }
  return hits;
}

bool RayScene::IsOccluded(const Ray& ray) const {
  RTCRay query{};
  query.org_x = ray.origin.x();
  query.org_y = ray.origin.y();
  query.org_z = ray.origin.z();
  query.dir_x = ray.direction.x();
  query.dir_y = ray.direction.y();
  query.dir_z = ray.direction.z();
  query.tnear = ray.first;
  query.tfar = ray.last;
  query.mask = 0xFFFFFFFFu;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(impl_->scene, &context, &query);
  return query.tfar < 0.0f;  // Embree marks a hit with minus infinity
}

}  // namespace rigmap
