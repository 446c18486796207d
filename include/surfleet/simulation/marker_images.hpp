// SPDX-License-Identifier: MIT
/// @file
/// @brief Pictures of a target of spherical markers as a camera would take them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <surfleet/core/random.hpp>
#include <surfleet/geometry/camera_models.hpp>
#include <surfleet/geometry/grey_image.hpp>
#include <surfleet/localization/marker_target.hpp>

namespace surfleet {
struct MarkerImageOptions {
  double background = 30.0;   ///< [grey levels]
  double brightness = 190.0;  ///< Of markers above the background; below it if negative.
  double blur = 0.6;          ///< Standard deviation of the lens's Gaussian blur [px].
  double noise = 2.0;         ///< Standard deviation of each pixel [grey levels].
  /// Light leaves a marker within this angle of the direction from the markers' middle [rad].
  double emission_angle = kPi;
};
/// A disc in the image: clutter as bright as a marker, or something dark that hides what it covers.
struct ImageDisc {
  Eigen::Vector2d center = Eigen::Vector2d::Zero();  ///< [px]
  double radius = 3.0;                               ///< [px]
  bool hides = false;
};

/// Draws targets. Keeps a store of noise, so that a frame costs little more than its pixels.
class MarkerImages {
 public:
  explicit MarkerImages(MarkerImageOptions options = {}, std::uint64_t seed = 1)
      : options_(options), random_(seed), noise_(1U << 16) {
    for (float& n : noise_) n = static_cast<float>(options_.noise * random_.normal());
  }

  /// The target at `T_camera_target`, without the markers that are `hidden` (none if empty).
  /// O(pixels).
  template <CameraModel Camera>
  GreyImage operator()(const Camera& camera, const MarkerTarget& target,
                       const Pose& T_camera_target, std::span<const ImageDisc> discs = {},
                       const std::vector<bool>& hidden = {}) {
    light_.assign(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height),
                  0.0F);
    Point3 middle = Point3::Zero();
    for (const Point3& m : target.markers) middle += m / static_cast<double>(target.markers.size());
    for (std::size_t i = 0; i < target.markers.size(); ++i) {
      if (!hidden.empty() && hidden[i]) continue;
      const Point3 at = T_camera_target * target.markers[i];
      const auto px = camera.project(at);
      if (!px) continue;
      const Eigen::Vector3d axis =
          (T_camera_target.linear() * (target.markers[i] - middle)).normalized();
      if (axis.dot(-at.normalized()) < std::cos(options_.emission_angle)) continue;
      // Sub-pixels whose rays meet the sphere.
      const double distance = at.norm(), sine = std::min(1.0, target.marker_radius / distance);
      const double least = std::sqrt(1.0 - sine * sine);
      const Eigen::Vector3d n = at / distance;
      // A bound of the outline: the image of a few rays of its rim.
      double reach = 1.0;
      const Eigen::Vector3d u = n.unitOrthogonal(), w = n.cross(u);
      for (int k = 0; k < 8; ++k) {
        const double a = 0.25 * kPi * k;
        if (const auto rim = camera.project(least * n + sine * (std::cos(a) * u + std::sin(a) * w)))
          reach = std::max(reach, 1.2 * (*rim - *px).norm());
      }
      draw(camera.width, camera.height, *px, reach, 1.0F, [&](double x, double y) {
        return bearing(camera, {x, y}).dot(n) >= least;
      });
    }
    for (const bool hides : {false, true})
      for (const ImageDisc& d : discs)
        if (d.hides == hides)
          draw(camera.width, camera.height, d.center, d.radius, hides ? 0.0F : 1.0F,
               [&](double x, double y) {
                 return (Eigen::Vector2d(x, y) - d.center).squaredNorm() <= d.radius * d.radius;
               });
    return develop(camera.width, camera.height);
  }

 private:
  template <typename Inside>
  void draw(int width, int height, const Eigen::Vector2d& center, double reach, float value,
            const Inside& inside) {
    constexpr int kSub = 6;
    const int left = std::max(0, static_cast<int>(std::floor(center.x() - reach)) - 1);
    const int right = std::min(width - 1, static_cast<int>(std::ceil(center.x() + reach)) + 1);
    const int top = std::max(0, static_cast<int>(std::floor(center.y() - reach)) - 1);
    const int bottom = std::min(height - 1, static_cast<int>(std::ceil(center.y() + reach)) + 1);
    if (left > right || top > bottom) return;
    windows_.push_back({left, top, right + 1, bottom + 1});
    for (int v = top; v <= bottom; ++v)
      for (int u = left; u <= right; ++u) {
        int count = 0;
        for (int a = 0; a < kSub; ++a)
          for (int b = 0; b < kSub; ++b)
            count += inside(u + (a + 0.5) / kSub - 0.5, v + (b + 0.5) / kSub - 0.5) ? 1 : 0;
        const float share = static_cast<float>(count) / (kSub * kSub);
        float& l = light_[index(u, v, width)];
        l = value > 0.0F ? std::max(l, share) : l * (1.0F - share);
      }
  }
  /// Blur, brightness, noise.
  GreyImage develop(int width, int height) {
    const int reach = static_cast<int>(std::ceil(3.0 * options_.blur));
    std::vector<float> kernel(static_cast<std::size_t>(2 * reach + 1), 1.0F);
    float sum = 0.0F;
    for (int k = -reach; k <= reach; ++k) {
      // The part of the Gaussian that falls on this pixel.
      const double s = std::max(options_.blur, 1e-6) * std::sqrt(2.0);
      const float w = static_cast<float>(std::erf((k + 0.5) / s) - std::erf((k - 0.5) / s));
      kernel[static_cast<std::size_t>(k + reach)] = w;
      sum += w;
    }
    for (float& w : kernel) w /= sum;
    blurred_.assign(light_.size(), 0.0F);
    GreyImage image(width, height);
    // Only about what was drawn is there anything to blur; a pixel is blurred once.
    done_.assign(light_.size(), 0);
    for (const Window& drawn : windows_) {
      const Window w{std::max(0, drawn.left - reach), std::max(0, drawn.top - reach),
                     std::min(width, drawn.right + reach), std::min(height, drawn.bottom + reach)};
      for (int v = w.top; v < w.bottom; ++v)
        for (int u = w.left; u < w.right; ++u) {
          const std::size_t at = index(u, v, width);
          if (done_[at] != 0) continue;
          done_[at] = 1;
          float value = 0.0F;
          for (int b = -reach; b <= reach; ++b) {
            const int y = std::clamp(v + b, 0, height - 1);
            float row = 0.0F;
            for (int a = -reach; a <= reach; ++a)
              row += kernel[static_cast<std::size_t>(a + reach)] *
                     light_[index(std::clamp(u + a, 0, width - 1), y, width)];
            value += kernel[static_cast<std::size_t>(b + reach)] * row;
          }
          blurred_[at] = value;
        }
    }
    windows_.clear();
    const auto brightness = static_cast<float>(options_.brightness);
    const auto background = static_cast<float>(options_.background) + 0.5F;
    for (int v = 0; v < height; ++v) {
      std::size_t n = random_.below(noise_.size());
      for (int u = 0; u < width; ++u) {
        const std::size_t at = index(u, v, width);
        n = (n + 1) & (noise_.size() - 1);
        const float g = background + brightness * blurred_[at] + noise_[n];
        image.pixels[at] = static_cast<std::uint8_t>(std::clamp(g, 0.0F, 255.0F));
      }
    }
    return image;
  }
  static std::size_t index(int u, int v, int width) {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(u);
  }

  struct Window {
    int left, top, right, bottom;
  };
  MarkerImageOptions options_;
  Random random_;
  std::vector<float> noise_, light_, blurred_;
  std::vector<std::uint8_t> done_;
  std::vector<Window> windows_;
};
}  // namespace surfleet
