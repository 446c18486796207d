// SPDX-License-Identifier: MIT
/// @file
/// @brief What a robot's sensor gives, whichever it carries.
#pragma once

#include <utility>
#include <variant>

#include <surfleet/core/error.hpp>
#include <surfleet/geometry/lidar_model.hpp>
#include <surfleet/geometry/pinhole_camera.hpp>

namespace surfleet {
/// What a robot sees with: the camera's frame has z forward, the LiDAR's z up.
using SensorModel = std::variant<PinholeCamera, LidarModel>;
/// What it saw from one place.
using SensorReading = std::variant<DepthImage, LidarScan>;

/// `fn(image, camera)` or `fn(scan, lidar)`. Throws `Error` if the sensor gives no such thing.
template <typename Seen, typename Fn>
decltype(auto) visit_reading(Seen& seen, const SensorModel& sensor, Fn&& fn) {
  require(seen.index() == sensor.index(),
          "reading: expected an image of a camera or a scan of a LiDAR");
  if (const auto* camera = std::get_if<PinholeCamera>(&sensor))
    return fn(std::get<DepthImage>(seen), *camera);
  return fn(std::get<LidarScan>(seen), std::get<LidarModel>(sensor));
}
}  // namespace surfleet
