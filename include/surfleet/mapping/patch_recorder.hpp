// SPDX-License-Identifier: MIT
/// @file
/// @brief Cuts what a robot sees into map patches [000 §4.4.1].
///
/// ```cpp
/// PatchRecorder recorder({.robot = 2, .voxel_size = 0.3}, TsdfIntegrator({.truncation = 0.9}));
/// recorder.integrate(image, camera, T_world_camera);
/// if (recorder.due()) publish(recorder.close());
/// ```
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <surfleet/mapping/any_integrator.hpp>
#include <surfleet/mapping/map_patch.hpp>
#include <surfleet/mapping/patch_limits.hpp>

namespace surfleet {
struct PatchRecorderOptions {
  RobotId robot = 0;
  std::uint32_t incarnation = 0;          ///< How often the robot was started before.
  double voxel_size = 0.3;                ///< [m]
  std::uint32_t images = 5;               ///< A patch is due after so many, or scans,
  std::optional<double> distance{};       ///< or, if said, once the sensor has come so far [m],
  std::optional<std::uint32_t> blocks{};  ///< or once it has as many blocks as this.
};

/// The open patch, an image at a time. It is a map of its own, so what one patch holds depends on
/// its images alone.
class PatchRecorder {
 public:
  AnyIntegrator integrator;

  /// Throws `Error` on options out of range.
  explicit PatchRecorder(PatchRecorderOptions options, AnyIntegrator integrate = TsdfIntegrator())
      : integrator(std::move(integrate)),
        options_(options),
        map_({.voxel_size = options.voxel_size}) {
    require(options.images > 0, "patch: expected at least one image");
    require(!options.distance || *options.distance > 0.0,
            "patch: expected a positive distance or none");
  }

  /// Folds an image or a scan, or whichever of them a sensor has given, into the open patch;
  /// returns the number of changed blocks.
  template <typename Seen, typename Sensor>
  std::size_t integrate(const Seen& seen, const Sensor& sensor, const Pose& T_frame_sensor) {
    const std::size_t changed = integrator(seen, sensor, T_frame_sensor, map_);
    if (images_ == 0)
      anchor_ = T_frame_sensor;
    else
      travelled_ += (T_frame_sensor.translation() - last_).norm();
    last_ = T_frame_sensor.translation();
    ++images_;
    return changed;
  }
  /// Whether the patch has all it is to have.
  bool due() const {
    return images_ >= options_.images ||
           (images_ > 0 && options_.distance && travelled_ >= *options_.distance) ||
           (images_ > 0 && options_.blocks && map_.block_count() >= *options_.blocks);
  }
  /// The patch, as whole numbers; the next one is open and empty. Its hash is set when it is
  /// encoded. O(patch).
  MapPatch close() {
    MapPatch patch = make_patch(map_, integrator.options.truncation);
    patch.id.key = {options_.robot, options_.incarnation, number_++};
    patch.anchor = anchor_;
    patch.images = images_;
    map_ = TsdfMap({.voxel_size = options_.voxel_size});
    images_ = 0;
    travelled_ = 0.0;
    return patch;
  }

  /// The same with notes, in as many patches as it takes to be within the limits.
  std::vector<MapPatch> close(ViewNotes notes, const PatchLimits& limits) {
    MapPatch patch = close();
    patch.notes = std::move(notes);
    std::vector<MapPatch> parts = parts_within(std::move(patch), limits);
    number_ = parts.back().id.key.number + 1;
    return parts;
  }

  const TsdfMap& open() const { return map_; }      ///< What the open patch holds so far.
  std::uint32_t number() const { return number_; }  ///< Of the open patch.
  std::uint32_t images() const { return images_; }  ///< In the open patch.

 private:
  PatchRecorderOptions options_;
  TsdfMap map_;
  Pose anchor_ = Pose::Identity();
  Point3 last_ = Point3::Zero();
  double travelled_ = 0.0;
  std::uint32_t images_ = 0, number_ = 0;
};
}  // namespace surfleet
