// SPDX-License-Identifier: MIT
/// @file
/// @brief Ray casting by Embree 3, as a `BundleRayCaster`. Link with the `embree3` library.
#pragma once

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/geometry/ray_caster.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>

namespace surfleet {
/// First hits of rays against a mesh, in single precision about the mesh's centre: positions hold
/// to about 1e-6 of the mesh's size. The mesh need not live on. Safe from many threads at once.
class EmbreeRayCaster {
 public:
  /// Throws `Error` if Embree cannot make its device.
  explicit EmbreeRayCaster(const TriangleMesh& mesh)
      : device_(rtcNewDevice("threads=1,set_affinity=0")) {
    require(device_ != nullptr, "Embree: no device; expected a processor that Embree 3 supports");
    scene_.reset(rtcNewScene(device_.get()));
    rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
    const Box3 box = mesh.bounds();
    if (!box.isEmpty()) center_ = box.center();
    if (!mesh.triangles.empty()) {
      const RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
      auto* vertices = static_cast<float*>(
          rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                  3 * sizeof(float), mesh.vertices.size()));
      auto* indices = static_cast<std::uint32_t*>(
          rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                  3 * sizeof(std::uint32_t), mesh.triangles.size()));
      if (vertices == nullptr || indices == nullptr) {
        rtcReleaseGeometry(geometry);
        throw Error("Embree: no memory for the mesh");
      }
      for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
        for (int k = 0; k < 3; ++k)
          *vertices++ = static_cast<float>(mesh.vertices[i][k] - center_[k]);
      for (const Triangle& t : mesh.triangles)
        for (const std::int32_t v : t) *indices++ = static_cast<std::uint32_t>(v);
      rtcCommitGeometry(geometry);
      rtcAttachGeometry(scene_.get(), geometry);
      rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(scene_.get());
  }

  std::optional<RayHit> cast(const Point3& origin, const Eigen::Vector3d& direction,
                             double t_max = std::numeric_limits<double>::infinity()) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit ray{};
    const Eigen::Vector3f o = (origin - center_).cast<float>(), d = direction.cast<float>();
    ray.ray.org_x = o.x();
    ray.ray.org_y = o.y();
    ray.ray.org_z = o.z();
    ray.ray.dir_x = d.x();
    ray.ray.dir_y = d.y();
    ray.ray.dir_z = d.z();
    ray.ray.tfar = limit(t_max);
    ray.ray.mask = 0xFFFFFFFFU;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_.get(), &context, &ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    return RayHit{static_cast<double>(ray.ray.tfar), static_cast<std::int32_t>(ray.hit.primID)};
  }

  /// Rays from one origin, sixteen at a time; neighbours in the list should be neighbours in space.
  void cast_bundle(const Point3& origin, std::span<const Eigen::Vector3d> directions, double t_max,
                   std::span<double> t) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    const Eigen::Vector3f o = (origin - center_).cast<float>();
    constexpr std::size_t kPacket = 16;
    for (std::size_t first = 0; first < directions.size(); first += kPacket) {
      const std::size_t count = std::min(kPacket, directions.size() - first);
      alignas(64) std::array<int, kPacket> valid{};
      RTCRayHit16 packet{};
      for (std::size_t i = 0; i < count; ++i) {
        valid[i] = -1;
        packet.ray.org_x[i] = o.x();
        packet.ray.org_y[i] = o.y();
        packet.ray.org_z[i] = o.z();
        packet.ray.dir_x[i] = static_cast<float>(directions[first + i].x());
        packet.ray.dir_y[i] = static_cast<float>(directions[first + i].y());
        packet.ray.dir_z[i] = static_cast<float>(directions[first + i].z());
        packet.ray.tfar[i] = limit(t_max);
        packet.ray.mask[i] = 0xFFFFFFFFU;
        packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      }
      rtcIntersect16(valid.data(), scene_.get(), &context, &packet);
      for (std::size_t i = 0; i < count; ++i)
        t[first + i] = packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID
                           ? std::numeric_limits<double>::infinity()
                           : static_cast<double>(packet.ray.tfar[i]);
    }
  }

 private:
  struct Release {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  };
  static float limit(double t_max) {
    return t_max < static_cast<double>(std::numeric_limits<float>::max())
               ? static_cast<float>(t_max)
               : std::numeric_limits<float>::infinity();
  }

  std::unique_ptr<std::remove_pointer_t<RTCDevice>, Release> device_;
  std::unique_ptr<std::remove_pointer_t<RTCScene>, Release> scene_;
  Point3 center_ = Point3::Zero();
};
static_assert(BundleRayCaster<EmbreeRayCaster>);
}  // namespace surfleet
