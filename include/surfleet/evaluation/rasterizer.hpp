// SPDX-License-Identifier: MIT
/// @file
/// @brief A small software renderer: shaded meshes with shadows, paths and points, as pictures.
///
/// @code
/// Rasterizer picture(frame_points(mesh.vertices, radians(35), radians(25), 1600, 1000));
/// picture.draw(mesh);
/// picture.draw_polyline(path, categorical_color(0));
/// write_png("view.png", picture.image());
/// @endcode
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/parallel.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/evaluation/color_map.hpp>
#include <surfleet/evaluation/detail/render_frame.hpp>
#include <surfleet/evaluation/detail/shadow_map.hpp>
#include <surfleet/evaluation/image.hpp>
#include <surfleet/evaluation/render_view.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>

namespace surfleet {
struct MeshStyle {
  Rgb color{196, 200, 206};  ///< Where the mesh has no colours of its own.
  bool use_vertex_colors = true;
  bool smooth = true;  ///< Vertex normals where the mesh has them.
  double light = 1.0;  ///< Strength of the shading: 0 shows plain colours.
};

struct RenderStyle {
  Rgb background_top{236, 240, 245}, background_bottom{250, 251, 252};
  Eigen::Vector3d to_light{0.45, -0.6, 1.0};  ///< World frame; need not be of unit length.
  bool shadows = true;
  double occlusion = 0.9;        ///< Strength of the darkening of corners and edges.
  double hidden_opacity = 0.28;  ///< Of lines and points behind a surface.
  int supersampling = 2;         ///< Samples a pixel in each direction, 1 to 4.
  int threads = 1;               ///< For `image()`; the picture is the same for any number.
};

/// Draws into a z-buffer; `image()` shades it. Order of drawing does not matter.
///
/// Surfaces are lit by a sun with a shadow map, by the sky, and darkened near creases by the depth
/// around them. Lines and points lie above the surfaces they touch; behind surfaces they show
/// faintly. O(triangles + covered pixels).
class Rasterizer {
 public:
  explicit Rasterizer(const RenderView& view, const RenderStyle& style = {})
      : view_(view), style_(style), scale_(std::clamp(style.supersampling, 1, 4)) {
    require(view.width > 0 && view.height > 0 && view.width <= 8192 && view.height <= 8192,
            "picture size: expected 1 to 8192 pixels a side");
    camera_ = detail::RenderFrame(view, view.width * scale_, view.height * scale_);
    const std::size_t n = camera_.pixels();
    depth_.assign(n, kFar);
    surface_.assign(n, Fragment{});
    overlay_depth_.assign(n, kFar);
    overlay_.assign(n, Rgb{});
  }

  void draw(const TriangleMesh& mesh, const MeshStyle& style = {}) {
    const bool colored = style.use_vertex_colors && mesh.colors.size() == mesh.vertices.size();
    const bool smooth = style.smooth && mesh.normals.size() == mesh.vertices.size();
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const Eigen::Vector3d doubled = mesh.area_vector(t);
      if (!(doubled.squaredNorm() > 0.0)) continue;
      const Eigen::Vector3f flat = doubled.normalized().cast<float>();
      std::array<detail::RenderCorner, 3> corners;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto v = static_cast<std::size_t>(mesh.triangles[t][k]);
        corners[k].world = mesh.vertices[v];
        const Rgb c = colored ? mesh.colors[v] : style.color;
        corners[k].color = Eigen::Vector3f(c[0], c[1], c[2]);
        corners[k].normal =
            smooth && mesh.normals[v].squaredNorm() > 0.25F ? mesh.normals[v] : flat;
      }
      world_.extend(corners[0].world).extend(corners[1].world).extend(corners[2].world);
      if (style_.shadows)
        shadow_casters_.push_back({corners[0].world, corners[1].world, corners[2].world});
      detail::fill_triangle(camera_, corners, [&](std::size_t i, double z, const auto& weights) {
        if (z >= depth_[i]) return;
        depth_[i] = static_cast<float>(z);
        const Eigen::Vector3d w = weights();
        Eigen::Vector3f color = Eigen::Vector3f::Zero(), normal = Eigen::Vector3f::Zero();
        for (std::size_t k = 0; k < 3; ++k) {
          color += static_cast<float>(w[static_cast<int>(k)]) * corners[k].color;
          normal += static_cast<float>(w[static_cast<int>(k)]) * corners[k].normal;
        }
        surface_[i] = {
            normal.normalized(),
            {detail::to_byte(color[0] / 255.0), detail::to_byte(color[1] / 255.0),
             detail::to_byte(color[2] / 255.0)},
            static_cast<std::uint8_t>(std::lround(200.0 * std::clamp(style.light, 0.0, 1.0)))};
      });
    }
  }

  /// A line through `points`, `width_px` pixels wide.
  void draw_polyline(std::span<const Point3> points, Rgb color, double width_px = 3.0) {
    for (std::size_t i = 1; i < points.size(); ++i) {
      Point3 a = camera_.to_camera(points[i - 1]), b = camera_.to_camera(points[i]);
      if (!camera_.clip_near(a, b)) continue;
      stamp(camera_.project(a), camera_.project(b), 0.5 * width_px * scale_, color);
    }
  }
  /// Discs, `diameter_px` pixels wide.
  void draw_points(std::span<const Point3> points, Rgb color, double diameter_px = 8.0) {
    for (const Point3& p : points) {
      const Point3 c = camera_.to_camera(p);
      if (camera_.in_front(c)) {
        const Point3 px = camera_.project(c);
        stamp(px, px, 0.5 * diameter_px * scale_, color);
      }
    }
  }

  Image image() const {
    const int w = camera_.width, h = camera_.height;
    const detail::ShadowMap shadow =
        style_.shadows ? detail::make_shadow_map(shadow_casters_, world_, style_.to_light)
                       : detail::ShadowMap{};
    const std::vector<float> corners = corner_darkness();
    const Eigen::Vector3d to_light = style_.to_light.normalized();
    std::vector<Eigen::Vector3f> linear(static_cast<std::size_t>(w) * static_cast<std::size_t>(h));
    std::array<float, 256> decode{};
    for (std::size_t i = 0; i < 256; ++i)
      decode[i] = static_cast<float>(srgb_to_linear(static_cast<double>(i) / 255.0));
    const auto to_linear = [&](Rgb c) {
      return Eigen::Vector3f(decode[c[0]], decode[c[1]], decode[c[2]]);
    };
    const auto shade_row = [&](std::size_t row) {
      const int y = static_cast<int>(row);
      for (int x = 0; x < w; ++x) {
        const std::size_t i = camera_.index(x, y);
        const float f = static_cast<float>(y) / static_cast<float>(std::max(h - 1, 1));
        Eigen::Vector3f color =
            (1.0F - f) * to_linear(style_.background_top) + f * to_linear(style_.background_bottom);
        if (depth_[i] < kFar) {
          const Fragment& s = surface_[i];
          const Point3 world = camera_.to_world(x, y, depth_[i]);
          Eigen::Vector3d n = s.normal.cast<double>();
          const Eigen::Vector3d to_eye =
              camera_.orthographic ? (-camera_.forward).eval() : (camera_.eye - world).eval();
          if (n.dot(to_eye) < 0.0) n = -n;
          const double lit = std::max(0.0, n.dot(to_light)) * shadow.light_at(world, n);
          const double sky = 0.5 + 0.5 * n.z();
          const Eigen::Vector3d light = 1.0 * lit * Eigen::Vector3d(1.0, 0.97, 0.91) +
                                        (0.22 + 0.30 * sky) * Eigen::Vector3d(0.90, 0.96, 1.06);
          const double strength = s.light / 200.0;
          const Eigen::Vector3d shaded =
              light * (1.0 - style_.occlusion * static_cast<double>(corners[output_index(x, y)]));
          color = to_linear(s.color).cwiseProduct(
              (shaded * strength + Eigen::Vector3d::Constant(1.0 - strength)).cast<float>());
        }
        if (overlay_depth_[i] < kFar) {
          const float bias = 0.004F * overlay_depth_[i] + 0.02F;
          const float opacity = overlay_depth_[i] <= depth_[i] + bias
                                    ? 1.0F
                                    : static_cast<float>(style_.hidden_opacity);
          color = (1.0F - opacity) * color + opacity * to_linear(overlay_[i]);
        }
        linear[i] = color;
      }
    };
    parallel_for(static_cast<std::size_t>(h), style_.threads, shade_row, 8);
    Image picture(view_.width, view_.height);
    constexpr std::size_t kCodes = 1 << 14;  // steps of light, finer than the steps of sRGB
    std::vector<std::uint8_t> code(kCodes);
    for (std::size_t i = 0; i < kCodes; ++i)
      code[i] = detail::to_byte(linear_to_srgb(static_cast<double>(i) / (kCodes - 1)));
    const float share = 1.0F / static_cast<float>(scale_ * scale_);
    for (int y = 0; y < view_.height; ++y)
      for (int x = 0; x < view_.width; ++x) {
        Eigen::Vector3f sum = Eigen::Vector3f::Zero();
        for (int v = 0; v < scale_; ++v)
          for (int u = 0; u < scale_; ++u)
            sum += linear[camera_.index(x * scale_ + u, y * scale_ + v)].cwiseMin(1.0F);
        sum *= share * (kCodes - 1);
        picture.set(x, y,
                    {code[static_cast<std::size_t>(sum[0] + 0.5F)],
                     code[static_cast<std::size_t>(sum[1] + 0.5F)],
                     code[static_cast<std::size_t>(sum[2] + 0.5F)]});
      }
    return picture;
  }

 private:
  static constexpr float kFar = std::numeric_limits<float>::infinity();

  struct Fragment {
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();
    Rgb color{};
    std::uint8_t light = 0;
  };

  /// A stroke with round ends from `a` to `b` (pixels, depth).
  void stamp(const Point3& a, const Point3& b, double radius, Rgb color) {
    const auto whole = [](double v, double high) {
      return static_cast<int>(std::clamp(v, -1.0, high));
    };
    const int x0 = std::max(0, whole(std::min(a.x(), b.x()) - radius, camera_.width));
    const int x1 = whole(std::max(a.x(), b.x()) + radius, camera_.width - 1);
    const int y0 = std::max(0, whole(std::min(a.y(), b.y()) - radius, camera_.height));
    const int y1 = whole(std::max(a.y(), b.y()) + radius, camera_.height - 1);
    const Eigen::Vector2d d = (b - a).head<2>();
    const double length2 = d.squaredNorm();
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        const Eigen::Vector2d p(x - a.x(), y - a.y());
        const double f = length2 > 1e-12 ? std::clamp(p.dot(d) / length2, 0.0, 1.0) : 0.0;
        if ((p - f * d).squaredNorm() > radius * radius) continue;
        const double z = camera_.orthographic ? std::lerp(a.z(), b.z(), f)
                                              : 1.0 / std::lerp(1.0 / a.z(), 1.0 / b.z(), f);
        const std::size_t i = camera_.index(x, y);
        if (z >= overlay_depth_[i]) continue;
        overlay_depth_[i] = static_cast<float>(z);
        overlay_[i] = color;
      }
    }
  }

  std::size_t output_index(int x, int y) const {
    return static_cast<std::size_t>(y / scale_) * static_cast<std::size_t>(view_.width) +
           static_cast<std::size_t>(x / scale_);
  }

  /// How deep in a corner each output pixel lies, in [0, 1]: the share of its surroundings on the
  /// screen that rise above its own plane near it.
  std::vector<float> corner_darkness() const {
    const int w = camera_.width, h = camera_.height;
    std::vector<float> darkness(
        static_cast<std::size_t>(view_.width) * static_cast<std::size_t>(view_.height), 0.0F);
    if (!(style_.occlusion > 0.0)) return darkness;
    // A spiral of neighbours, turned from pixel to pixel so that its pattern averages out.
    constexpr int kTaps = 12, kTurns = 16;
    std::array<std::array<Eigen::Vector2i, kTaps>, kTurns> turns;
    std::array<double, kTaps> radius{};
    for (std::size_t k = 0; k < kTaps; ++k) {
      const double place = static_cast<double>(k) + 0.5;
      radius[k] = 0.035 * h * std::sqrt(place / kTaps);
      for (std::size_t t = 0; t < kTurns; ++t) {
        const double angle = 2.39996323 * place + 2.0 * kPi * static_cast<double>(t) / kTurns;
        turns[t][k] = Eigen::Vector2i(static_cast<int>(std::lround(radius[k] * std::cos(angle))),
                                      static_cast<int>(std::lround(radius[k] * std::sin(angle))));
      }
    }
    const auto darken = [&](int x, int y) {
      const std::size_t i = camera_.index(x, y);
      if (!(depth_[i] < kFar)) return;
      const Point3 p = camera_.to_world(x, y, depth_[i]);
      Eigen::Vector3d n = surface_[i].normal.cast<double>();
      const Eigen::Vector3d to_eye =
          camera_.orthographic ? (-camera_.forward).eval() : (camera_.eye - p).eval();
      if (n.dot(to_eye) < 0.0) n = -n;
      const auto& taps = turns[(static_cast<std::size_t>(x / scale_) * 5 +
                                static_cast<std::size_t>(y / scale_) * 3) %
                               kTurns];
      double sum = 0.0;
      int count = 0;
      for (int k = 0; k < kTaps; ++k) {
        const int u = x + taps[static_cast<std::size_t>(k)].x();
        const int v = y + taps[static_cast<std::size_t>(k)].y();
        if (u < 0 || v < 0 || u >= w || v >= h) continue;
        ++count;
        const std::size_t j = camera_.index(u, v);
        if (!(depth_[j] < kFar)) continue;
        const Eigen::Vector3d d = camera_.to_world(u, v, depth_[j]) - p;
        const double size = radius[static_cast<std::size_t>(k)] *
                            (camera_.orthographic ? 1.0 : static_cast<double>(depth_[i])) /
                            camera_.focal;
        const double distance = d.norm();
        const double above = d.dot(n) / std::max(distance, 1e-9);
        // What is much nearer to the camera is another thing and does not shade.
        const double fade = std::clamp(2.0 - distance / (2.5 * size), 0.0, 1.0);
        sum += std::max(0.0, above - 0.08) * fade;
      }
      if (count > 0)
        darkness[output_index(x, y)] = static_cast<float>(std::min(1.0, 1.1 * sum / count));
    };
    parallel_for(
        static_cast<std::size_t>(view_.height), style_.threads,
        [&](std::size_t y) {
          for (int x = 0; x < view_.width; ++x) darken(x * scale_, static_cast<int>(y) * scale_);
        },
        8);
    return darkness;
  }

  RenderView view_;
  RenderStyle style_;
  int scale_ = 1;
  detail::RenderFrame camera_;
  Box3 world_;
  std::vector<std::array<Point3, 3>> shadow_casters_;
  std::vector<float> depth_, overlay_depth_;
  std::vector<Fragment> surface_;
  std::vector<Rgb> overlay_;
};
}  // namespace surfleet
