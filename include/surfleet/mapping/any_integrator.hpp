// SPDX-License-Identifier: MIT
/// @file
/// @brief A TSDF integrator whose weight and update are chosen at run time.
#pragma once

#include <concepts>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>

#include <surfleet/geometry/sensor_reading.hpp>
#include <surfleet/mapping/tsdf_integrator.hpp>

namespace surfleet {
/// Any `TsdfIntegrator`, for what is to be compiled once whatever the rules of the map are. Copies
/// are integrators of their own. One virtual call an observation.
///
/// ```cpp
/// AnyIntegrator integrate = TsdfIntegrator({.truncation = 0.9}, ConstantWeight{});
/// integrate(image, camera, T_world_camera, map);
/// integrate.weight(0.0, 5.0);  // of what is seen of surface 5 m away
/// ```
class AnyIntegrator {
 public:
  TsdfOptions options;

  template <WeightPolicy Weight, UpdatePolicy Update>
  requires std::copy_constructible<Update>
  AnyIntegrator(  // NOLINT(google-explicit-constructor): takes the place of any of them
      TsdfIntegrator<Weight, Update> integrator)
      : options(integrator.options),
        held_(std::make_unique<Held<Weight, Update>>(std::move(integrator))) {}
  AnyIntegrator(const AnyIntegrator& other) : options(other.options), held_(other.held_->copy()) {}
  AnyIntegrator(AnyIntegrator&&) noexcept = default;
  AnyIntegrator& operator=(AnyIntegrator other) noexcept {
    options = other.options;
    held_ = std::move(other.held_);
    return *this;
  }
  ~AnyIntegrator() = default;

  /// As those of `TsdfIntegrator`.
  std::size_t operator()(const DepthImage& image, const PinholeCamera& camera,
                         const Pose& T_world_camera, TsdfMap& map) {
    return held_->fold(options, image, camera, T_world_camera, map);
  }
  std::size_t operator()(std::span<const Point3> points_sensor, double min_range, double max_range,
                         const Pose& T_world_sensor, TsdfMap& map) {
    return held_->fold(options, points_sensor, min_range, max_range, T_world_sensor, map);
  }
  std::size_t operator()(const LidarScan& scan, const LidarModel& lidar, const Pose& T_world_lidar,
                         TsdfMap& map) {
    return (*this)(scan.points, lidar.min_range, lidar.max_range, T_world_lidar, map);
  }
  /// What the sensor has seen from a pose of its own. Throws `Error` if it gives no such thing.
  std::size_t operator()(const SensorReading& seen, const SensorModel& sensor,
                         const Pose& T_world_sensor, TsdfMap& map) {
    return visit_reading(seen, sensor, [&](const auto& s, const auto& model) {
      return (*this)(s, model, T_world_sensor, map);
    });
  }
  /// See `WeightPolicy`.
  double weight(double sdf, double range) const { return held_->weight(sdf, range); }

 private:
  struct Interface {
    virtual ~Interface() = default;
    virtual std::unique_ptr<Interface> copy() const = 0;
    virtual std::size_t fold(const TsdfOptions& o, const DepthImage& image,
                             const PinholeCamera& camera, const Pose& T_world_camera,
                             TsdfMap& map) = 0;
    virtual std::size_t fold(const TsdfOptions& o, std::span<const Point3> points, double min_range,
                             double max_range, const Pose& T_world_sensor, TsdfMap& map) = 0;
    virtual double weight(double sdf, double range) const = 0;
  };
  template <typename Weight, typename Update>
  struct Held final : Interface {
    TsdfIntegrator<Weight, Update> integrate;

    explicit Held(TsdfIntegrator<Weight, Update> i) : integrate(std::move(i)) {}
    std::unique_ptr<Interface> copy() const override { return std::make_unique<Held>(integrate); }
    std::size_t fold(const TsdfOptions& o, const DepthImage& image, const PinholeCamera& camera,
                     const Pose& T_world_camera, TsdfMap& map) override {
      integrate.options = o;
      return integrate(image, camera, T_world_camera, map);
    }
    std::size_t fold(const TsdfOptions& o, std::span<const Point3> points, double min_range,
                     double max_range, const Pose& T_world_sensor, TsdfMap& map) override {
      integrate.options = o;
      return integrate(points, min_range, max_range, T_world_sensor, map);
    }
    double weight(double sdf, double range) const override {
      return static_cast<double>(integrate.weight(sdf, range));
    }
  };

  std::unique_ptr<Interface> held_;
};
}  // namespace surfleet
