// SPDX-License-Identifier: MIT
/// @file
/// @brief From pictures to poses: blobs where the target is expected, or all over [004 Fig. 9.3].
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <surfleet/localization/blobs.hpp>
#include <surfleet/localization/target_tracker.hpp>

namespace surfleet {
/// What a picture gave.
struct ImageFrame {
  TrackedFrame tracked;
  std::vector<Blob> blobs;  ///< Those that were examined; fits point into them.
  bool whole = true;        ///< The whole picture was searched.
};

/// A tracker that is fed with grey images of its camera's size.
template <CameraModel Camera, MotionModel Motion = LinearRegression>
class ImageTracker {
 public:
  ImageTracker(Camera camera, const MarkerTarget& target, TrackerOptions settings = {},
               BlobOptions blob_settings = {}, Motion motion = {})
      : blob_options(blob_settings),
        tracker(camera, target, std::move(settings), std::move(motion)),
        camera_(std::move(camera)) {
    blob_options.markers = target.markers.size();
  }

  BlobOptions blob_options;
  TargetTracker<Camera, Motion> tracker;

  /// Throws `Error` on an image of another size and on times that do not increase.
  ImageFrame operator()(const GreyImage& image, double time) {
    if (image.width != camera_.width || image.height != camera_.height)
      throw Error("image of " + std::to_string(image.width) + " x " + std::to_string(image.height) +
                  " pixels; expected " + std::to_string(camera_.width) + " x " +
                  std::to_string(camera_.height) + ", as the camera has");
    ImageFrame frame;
    if (const auto window = tracker.roi(time); window && !window->empty()) {
      frame.blobs = detect(image, window);
      if (auto found = tracker.update(time, observed(frame.blobs), true)) {
        frame.tracked = std::move(*found);
        frame.whole = false;
        return frame;
      }
    }
    frame.blobs = detect(image, {});
    frame.tracked = *tracker.update(time, observed(frame.blobs));
    return frame;
  }

 private:
  std::vector<Blob> detect(const GreyImage& image, const std::optional<PixelWindow>& window) const {
    BlobOptions options = blob_options;
    options.keep_merged = window.has_value();  // without a prediction they are of no use
    auto blobs = extract_blobs(image, options, window);
    // What the border cuts has its centre elsewhere.
    std::erase_if(blobs, [](const Blob& b) { return b.at_border; });
    return nearest_blobs(std::move(blobs), tracker.options.identify.max_blobs);
  }
  std::vector<Observation> observed(const std::vector<Blob>& blobs) const {
    std::vector<Observation> all;
    all.reserve(blobs.size());
    for (const Blob& b : blobs) {
      all.push_back(observe(camera_, b.center, b.diameter));
      all.back().merged = b.merged;
      all.back().elongated = b.roundness < 0.85;
    }
    return all;
  }
  Camera camera_;
};
}  // namespace surfleet
