// SPDX-License-Identifier: MIT
/// @file
/// @brief Bright or dark discs in an image, with centres finer than a pixel [004 §9.4.2].
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/localization/connected_components.hpp>
#include <surfleet/localization/hough_circles.hpp>
#include <surfleet/localization/image_thresholds.hpp>

namespace surfleet {
struct BlobOptions {
  bool dark = false;        ///< Markers are darker than what is around them.
  double deviations = 3.0;  ///< λ₂ is so many deviations of the background above its mean.
  int min_contrast = 12;    ///< Between λ₁ and the background's mean, at least [grey levels].
  int min_area = 3;         ///< [px]
  int max_area = 20000;     ///< [px]
  double min_convexity = 0.75;  ///< Area over that of the convex hull.
  double min_roundness = 0.55;  ///< Shorter over longer axis.
  bool keep_merged = false;     ///< Blobs that may be two discs are kept, last and marked so.
  std::size_t max_count = 200;  ///< Of more components, the largest are examined.
  std::size_t markers = 4;      ///< Fewer blobs than these make the search go on.
};

struct Blob {
  Point2 center = Point2::Zero();  ///< [px]
  double diameter = 0.0;           ///< Of the disc with as much light [px].
  int area = 0;                    ///< Above λ₂ [px].
  double convexity = 1.0, roundness = 1.0;
  bool merged = false;     ///< No disc, but perhaps two of them (`BlobOptions::keep_merged`).
  bool at_border = false;  ///< Cut by the image's border.
  double peak = 0.0;       ///< Above the background [grey levels].
};

namespace detail {
/// Area of the convex hull of a component, whose pixels are squares [px²].
inline double hull_area(const PixelComponent& c) {
  std::vector<Point2> left, right;  // chains from the top
  const auto turn = [](const Point2& a, const Point2& b, const Point2& p) {
    return (b.x() - a.x()) * (p.y() - a.y()) - (b.y() - a.y()) * (p.x() - a.x());
  };
  const auto push = [&](std::vector<Point2>& chain, const Point2& p, double sign) {
    while (chain.size() >= 2 && sign * turn(chain[chain.size() - 2], chain.back(), p) <= 0.0)
      chain.pop_back();
    chain.push_back(p);
  };
  std::size_t i = 0;
  while (i < c.runs.size()) {
    const int v = c.runs[i].v;
    int low = c.runs[i].begin, high = c.runs[i].end;
    for (; i < c.runs.size() && c.runs[i].v == v; ++i) {
      low = std::min(low, c.runs[i].begin);
      high = std::max(high, c.runs[i].end);
    }
    for (const double y : {static_cast<double>(v), v + 1.0}) {
      push(left, {static_cast<double>(low), y}, -1.0);
      push(right, {static_cast<double>(high), y}, 1.0);
    }
  }
  std::vector<Point2> ring = right;
  ring.insert(ring.end(), left.rbegin(), left.rend());
  double twice = 0.0;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Point2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
    twice += a.x() * b.y() - b.x() * a.y();
  }
  return 0.5 * std::abs(twice);
}

/// What a component looks like: light-weighted over its pixels and those beside them.
inline Blob measure_blob(const GreyImage& image, const PixelComponent& c, double background,
                         const PixelWindow& window) {
  Blob blob;
  blob.area = c.area;
  blob.at_border = c.box.left <= 0 || c.box.top <= 0 || c.box.right >= image.width ||
                   c.box.bottom >= image.height;
  double sum = 0.0, peak = 0.0;
  const Point2 from(c.box.left, c.box.top);
  Point2 first = Point2::Zero();
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
  const auto take = [&](int u, int v) {
    const double w = std::max(0.0, image(u, v) - background);
    const Point2 p = Point2(u, v) - from;
    sum += w;
    peak = std::max(peak, w);
    first += w * p;
    second += w * p * p.transpose();
  };
  // Row by row, the runs of this row and its neighbours, a pixel wider.
  std::array<std::size_t, 3> at{};
  std::vector<std::pair<int, int>> spans;
  const PixelWindow box = c.box.inflated(1).clipped(window);
  for (int v = box.top; v < box.bottom; ++v) {
    spans.clear();
    for (int k = -1; k <= 1; ++k) {
      std::size_t& i = at[static_cast<std::size_t>(k + 1)];
      while (i < c.runs.size() && c.runs[i].v < v + k) ++i;
      for (std::size_t j = i; j < c.runs.size() && c.runs[j].v == v + k; ++j)
        spans.emplace_back(std::max(box.left, c.runs[j].begin - 1),
                           std::min(box.right, c.runs[j].end + 1));
    }
    std::sort(spans.begin(), spans.end());
    int done = box.left;
    for (const auto& [begin, end] : spans)
      for (int u = std::max(begin, done); u < end; done = ++u) take(u, v);
  }
  blob.peak = peak;
  if (sum <= 0.0) return blob;
  const Point2 mean = first / sum;
  blob.center = from + mean;
  second = second / sum - mean * mean.transpose();
  const double half = 0.5 * second.trace();
  const double root = std::sqrt(std::max(0.0, half * half - second.determinant()));
  // A pixel is no point: its own extent keeps a line of them from having no width.
  blob.roundness = std::sqrt((std::max(0.0, half - root) + 1.0 / 12) / (half + root + 1.0 / 12));
  blob.convexity = c.area / std::max(hull_area(c), 1.0);
  blob.diameter = std::sqrt(4.0 / kPi * sum / peak);
  return blob;
}

/// The component without its outer pixels: what hangs together by a thread falls apart.
inline std::vector<PixelComponent> eroded(const PixelComponent& c) {
  GreyImage mask(c.box.right - c.box.left + 2, c.box.bottom - c.box.top + 2);
  for (const PixelRun& r : c.runs)
    std::fill_n(mask.row(r.v - c.box.top + 1) + (r.begin - c.box.left + 1), r.end - r.begin,
                std::uint8_t{1});
  GreyImage inner(mask.width, mask.height);
  for (int v = 1; v + 1 < mask.height; ++v)
    for (int u = 1; u + 1 < mask.width; ++u)
      inner(u, v) = mask(u, v) & mask(u - 1, v) & mask(u + 1, v) & mask(u, v - 1) & mask(u, v + 1);
  auto parts = connected_components(inner, PixelWindow::whole(inner), 0);
  for (PixelComponent& part : parts) {
    const int du = c.box.left - 1, dv = c.box.top - 1;
    part.box = {part.box.left + du, part.box.top + dv, part.box.right + du, part.box.bottom + dv};
    for (PixelRun& r : part.runs) r = {r.v + dv, r.begin + du, r.end + du};
  }
  return parts;
}
}  // namespace detail

/// Grey levels upside down, so that dark is bright.
inline GreyImage inverted(const GreyImage& image) {
  GreyImage out = image;
  for (std::uint8_t& p : out.pixels) p = static_cast<std::uint8_t>(255 - p);
  return out;
}

/// The blobs of an image, or of a window of it, brightest and roundest first.
///
/// λ₁ by Otsu finds where they are, λ₂, less restrictive, their whole shape, in a window about
/// each; what is too small, too large, not convex or not round is dropped each time. Where fewer
/// are left than `markers`, blobs whose outline is that of overlapping discs become those discs,
/// and others that are not convex are eroded until they fall apart. O(pixels) and the same for any
/// number of bright specks. Nothing in images without contrast.
inline std::vector<Blob> extract_blobs(const GreyImage& original, const BlobOptions& options = {},
                                       const std::optional<PixelWindow>& roi = {}) {
  require(original.width > 0 && original.height > 0, "blobs: expected an image with pixels");
  std::optional<GreyImage> flipped;
  if (options.dark) flipped = inverted(original);
  const GreyImage& image = flipped ? *flipped : original;
  const PixelWindow all = PixelWindow::whole(image);
  const PixelWindow window = roi ? roi->clipped(all) : all;
  std::vector<Blob> blobs;
  if (window.empty()) return blobs;
  const GreyHistogram histogram = grey_histogram(image, window);
  const GreyBackground background = fit_background(histogram);
  const int least = static_cast<int>(std::ceil(background.mean)) + options.min_contrast;
  const int lambda2 = static_cast<int>(
      std::ceil(background.mean + std::max(2.0, options.deviations * background.deviation)));
  const int lambda1 = std::max({otsu_threshold(histogram), least, lambda2});
  if (lambda1 >= 255) return blobs;

  auto seeds = connected_components(image, window, lambda1);
  std::erase_if(seeds, [&](const PixelComponent& c) { return c.area > options.max_area; });
  if (seeds.size() > options.max_count) {
    std::stable_sort(seeds.begin(), seeds.end(),
                     [](const auto& a, const auto& b) { return a.area > b.area; });
    seeds.resize(options.max_count);
  }
  const auto accepted = [&](const Blob& b) {
    // The outline of a few pixels says nothing of a shape.
    const double convexity = b.area < 12 ? 0.6 * options.min_convexity : options.min_convexity;
    return b.area >= options.min_area && b.area <= options.max_area && b.convexity >= convexity &&
           b.roundness >= options.min_roundness;
  };
  constexpr double kExplained = 0.95;  // share of an outline that circles must be all of
  constexpr int kLargestGroup = 120;   // in which circles are sought [px]
  std::vector<PixelComponent> refused;
  std::vector<std::pair<int, int>> starts;  // of components at λ₂, not to count one twice
  for (const PixelComponent& seed : seeds) {
    const int side = std::max(seed.box.right - seed.box.left, seed.box.bottom - seed.box.top);
    const int u0 = seed.runs[0].begin, v0 = seed.runs[0].v;
    std::optional<PixelComponent> whole;
    // A window that cuts it is enlarged, as where another blob touches.
    for (int margin = std::max(3, side / 2); margin <= 4 * side + 16; margin *= 2) {
      const PixelWindow around = seed.box.inflated(margin).clipped(window);
      for (PixelComponent& c : connected_components(image, around, lambda2))
        if (std::any_of(c.runs.begin(), c.runs.end(), [&](const PixelRun& r) {
              return r.v == v0 && r.begin <= u0 && u0 < r.end;
            }))
          whole = std::move(c);
      const auto cut = [](int edge, int inner, int outer) {
        return edge == inner && inner != outer;
      };
      if (!whole || !(cut(whole->box.left, around.left, window.left) ||
                      cut(whole->box.top, around.top, window.top) ||
                      cut(whole->box.right, around.right, window.right) ||
                      cut(whole->box.bottom, around.bottom, window.bottom)))
        break;
    }
    if (!whole) continue;
    const std::pair start(whole->runs[0].v, whole->runs[0].begin);
    if (std::find(starts.begin(), starts.end(), start) != starts.end()) continue;
    starts.push_back(start);
    Blob blob = detail::measure_blob(image, *whole, background.mean, window);
    if (accepted(blob))
      blobs.push_back(blob);
    else if (whole->area > options.min_area)
      refused.push_back(std::move(*whole));
  }
  const auto by_circles = [&](const PixelComponent& c) {
    if (std::max(c.box.right - c.box.left, c.box.bottom - c.box.top) > kLargestGroup) return false;
    Blob blob = detail::measure_blob(image, c, background.mean, window);
    const int side = std::min(c.box.right - c.box.left, c.box.bottom - c.box.top);
    const auto outline = outline_of(c);
    const auto circles = hough_circles(outline, std::max(0.35 * side, 3.0), 0.6 * side);
    if (circles.size() < 2 || explained(outline, circles) < kExplained) return false;
    blob.convexity = blob.roundness = 1.0;
    for (const Circle& circle : circles) {
      blob.center = circle.center;
      blob.diameter = 2.0 * circle.radius;
      blob.area = static_cast<int>(kPi * circle.radius * circle.radius);
      if (accepted(blob)) blobs.push_back(blob);
    }
    return true;
  };
  // Merged ones fall apart. Their parts keep the centres they had, near enough.
  if (blobs.size() < options.markers && !options.keep_merged) {
    for (const PixelComponent& c : refused) {
      if (by_circles(c)) continue;
      std::vector<PixelComponent> parts{c};
      for (int round = 0; round < 64 && parts.size() == 1; ++round) {
        parts = detail::eroded(parts[0]);
        std::erase_if(parts, [&](const PixelComponent& p) { return p.area < options.min_area; });
      }
      if (parts.size() < 2) continue;
      for (const PixelComponent& part : parts) {
        const Blob blob = detail::measure_blob(image, part, background.mean, window);
        if (accepted(blob)) blobs.push_back(blob);
      }
    }
  }
  if (options.keep_merged)
    for (const PixelComponent& c : refused) {
      Blob blob = detail::measure_blob(image, c, background.mean, window);
      blob.merged = true;
      if (blob.convexity >= 0.7 && blob.roundness >= 0.3) blobs.push_back(blob);
    }
  std::stable_sort(blobs.begin(), blobs.end(), [](const Blob& a, const Blob& b) {
    if (a.merged != b.merged) return b.merged;
    return a.peak * a.convexity * a.roundness > b.peak * b.convexity * b.roundness;
  });
  return blobs;
}

/// At most `count` of the blobs: those farthest from all others go first [004 §9.4.2]. O(n² log n).
inline std::vector<Blob> nearest_blobs(std::vector<Blob> blobs, std::size_t count) {
  while (blobs.size() > count) {
    std::size_t lonely = 0;
    double farthest = -1.0;
    for (std::size_t i = 0; i < blobs.size(); ++i) {
      double near = std::numeric_limits<double>::infinity();
      for (std::size_t k = 0; k < blobs.size(); ++k)
        if (k != i) near = std::min(near, (blobs[i].center - blobs[k].center).squaredNorm());
      if (near > farthest) {
        farthest = near;
        lonely = i;
      }
    }
    blobs.erase(blobs.begin() + static_cast<std::ptrdiff_t>(lonely));
  }
  return blobs;
}

/// Bounds of colours in YUV (BT.601, each 0 to 255), for markers of one colour.
struct YuvBox {
  std::array<double, 3> low{0.0, 0.0, 0.0}, high{255.0, 255.0, 255.0};
};
/// Brightness where the colour lies in the box, else black: what is left are bright markers. `rgb`
/// are three bytes a pixel. Throws `Error` if their number does not fit.
inline GreyImage select_color(std::span<const std::uint8_t> rgb, int width, int height,
                              const YuvBox& box) {
  GreyImage out(width, height);
  require(rgb.size() == 3 * out.pixels.size(), "colour image: expected three bytes a pixel");
  for (std::size_t i = 0; i < out.pixels.size(); ++i) {
    const double r = rgb[3 * i], g = rgb[3 * i + 1], b = rgb[3 * i + 2];
    const double y = 0.299 * r + 0.587 * g + 0.114 * b;
    const std::array<double, 3> yuv{y, 128.0 + 0.564 * (b - y), 128.0 + 0.713 * (r - y)};
    bool inside = true;
    for (std::size_t k = 0; k < 3; ++k)
      inside = inside && yuv[k] >= box.low[k] && yuv[k] <= box.high[k];
    if (inside) out.pixels[i] = static_cast<std::uint8_t>(std::clamp(y, 1.0, 255.0));
  }
  return out;
}
}  // namespace surfleet
