// SPDX-License-Identifier: MIT
/// @file
/// @brief A scan of points as pinhole images on the faces of a cube around the sensor.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <surfleet/core/parallel.hpp>
#include <surfleet/mapping/detail/plane_fit.hpp>
#include <surfleet/mapping/detail/projective_view.hpp>
#include <surfleet/mapping/detail/vector_code.hpp>

namespace surfleet::detail {
/// Sorts the points of a scan into six square images whose resolution follows the points' density,
/// then resamples each image at its pixel centres.
///
/// A pixel keeps one of its points: the one nearest to its centre, or, where they disagree by more
/// than the slope limit, the one nearest to the sensor, so that thin things are not carved away.
/// Resampling fits a plane (inverse depth affine in pixel coordinates) to the kept points of the
/// 3 × 3 pixels around, robustly, which bridges the gaps between scan lines; a gap wider than two
/// pixels stays without measurement.
class ScanProjection {
 public:
  static constexpr int kFaces = 6;

  void project(const ScanObservation& o, const TsdfOptions& options) {
    T_world_sensor_ = o.T_world_sensor;
    max_range_ = o.max_range;
    located_.resize(o.points.size());
    const double near2 = o.min_range * o.min_range, far2 = o.max_range * o.max_range;
    const bool beyond = options.carve_beyond_range && options.carve_free_space;
    parts_.resize((o.points.size() + kPart - 1) / kPart);
    for_each_part(options.threads, [&](Part& part, std::size_t begin, std::size_t end) {
      part.coarse.fill(0);
      for (std::size_t i = begin; i < end; ++i) {
        const Located& p = located_[i] = locate(o.points[i], near2, far2, beyond);
        if (p.face < 0) continue;
        const auto cell = [](float x) {
          return std::clamp(static_cast<int>((x + 1.0F) * 0.5F * kCoarse), 0, kCoarse - 1);
        };
        ++part.coarse[at((p.face * kCoarse + cell(p.y)) * kCoarse + cell(p.x))];
      }
    });

    // Density: points a cell over the cells of a coarse cube that hold any, in cells of equal
    // solid angle to within the cube's distortion, which is divided out.
    double count = 0.0, solid_angle = 0.0;
    for (std::size_t i = 0; i < kCoarseCells; ++i) {
      std::uint32_t points = 0;
      for (const Part& part : parts_) points += part.coarse[i];
      if (points == 0) continue;
      const double x = (static_cast<double>(i % kCoarse) + 0.5) * 2.0 / kCoarse - 1.0;
      const double y = (static_cast<double>(i / kCoarse % kCoarse) + 0.5) * 2.0 / kCoarse - 1.0;
      count += points;
      solid_angle += 4.0 / (kCoarse * kCoarse) / std::pow(1.0 + x * x + y * y, 1.5);
    }
    const double per_pixel = kPointsPerPixel * solid_angle / std::max(count, 1.0);
    const double per_face = 2.0 * kPi / 3.0 / std::max(per_pixel, 1e-9);
    side_ = std::clamp(static_cast<int>(std::lround(std::sqrt(per_face))), 8, 2048);
    sort_by_face(options.threads);
    bin(options);
  }

  /// Makes `view` the given face; false if it holds no measurement.
  bool resample(int face, const TsdfOptions& options, ProjectiveView& view) {
    const auto f = static_cast<std::size_t>(face);
    if (faces_[f].count == 0) return false;
    const int n = side_with_margin();
    view.width = view.height = n;
    view.margin = kMargin;
    view.cube_axis = face / 2;
    view.fx = view.fy = focal();
    view.cx = view.cy = center();
    view.z_limit = static_cast<float>(max_range_);
    view.range_limit = static_cast<float>(max_range_);
    view.set_slope_limit(options.max_slope);
    view.T_world_camera = T_world_sensor_ * Pose(axes(face));
    view.planes.resize(view.pixels() + 1);
    view.fill(options.threads, [&](int v, float* out) {
      SurfacePlane* planes = view.planes.data() + static_cast<std::ptrdiff_t>(v) * n;
      for (int first = 0; first < n; first += kLanes) {
        const InversePlanes<kLanes> fitted = fit_row(faces_[f], first, v, view.max_step_u);
        const int lanes = std::min(kLanes, n - first);
        for (int i = 0; i < lanes; ++i) {
          const int u = first + i;
          const float inverse = fitted.inverse[at(i)];
          const float slope_u = fitted.slope_u[at(i)], slope_v = fitted.slope_v[at(i)];
          out[u] = 1.0F / inverse;
          const float x = slope_u * view.fx, y = slope_v * view.fy;
          const float z = inverse - slope_u * (static_cast<float>(u) - view.cx) -
                          slope_v * (static_cast<float>(v) - view.cy);
          const float scale = 1.0F / std::sqrt(x * x + y * y + z * z);
          planes[u] = {x * scale, y * scale, z * scale, scale};
        }
      }
    });
    return true;
  }

 private:
  static constexpr int kMargin = 2;
  static constexpr int kPad = 2;  ///< How far around a pixel points are sought.
  static constexpr double kPointsPerPixel = 1.5;
  static constexpr float kFewest = 3.0F;  ///< Points that stand in for a pixel without its own.
  static constexpr InversePlanes<1> kNothing{{1.0F / kNoDepth}, {}, {}};
  static constexpr int kLanes = 16;  ///< Pixels of a row that planes are fitted to at a time.
  /// A point on its face: x and y at unit depth, in [−1, 1], and 1 / depth.
  struct Located {
    std::int32_t face;
    float x, y, inverse;
  };
  struct Sample {
    float du = 0.0F, dv = 0.0F;  ///< From the pixel's centre [px].
    float inverse = 0.0F;        ///< 1 / depth; 0 for none.
  };

  /// One of the six images, with `kPad` pixels around it that hold no point, to the right at least.
  struct Face {
    std::vector<Sample> samples;
    std::vector<char> any;  ///< Whether a run of `kLanes` pixels holds a point.
    std::size_t count = 0;
  };

  static constexpr int kCoarse = 24;
  static constexpr std::size_t kCoarseCells = std::size_t{kFaces} * kCoarse * kCoarse;
  static constexpr std::size_t kPart = 8192;
  /// So many points of the scan: how many are in each coarse cell, and which may be in a face, in
  /// the order of the scan.
  struct Part {
    std::array<std::uint32_t, kCoarseCells> coarse;
    std::array<std::vector<std::uint32_t>, kFaces> points;
  };

  static constexpr std::size_t at(int i) { return static_cast<std::size_t>(i); }

  /// Columns: the face's x, y, z axes in the sensor frame.
  static Eigen::Matrix3d axes(int face) {
    const int axis = face / 2;
    const double sign = face % 2 == 0 ? 1.0 : -1.0;
    Eigen::Matrix3d R = Eigen::Matrix3d::Zero();
    R(axis, 2) = sign;
    R((axis + 1) % 3, 0) = 1.0;
    R((axis + 2) % 3, 1) = sign;
    return R;
  }
  float focal() const { return 0.5F * static_cast<float>(side_); }
  float center() const { return 0.5F * static_cast<float>(side_with_margin() - 1); }

  static Located locate(const Point3& p, double near2, double far2, bool beyond) {
    const double r2 = p.squaredNorm();
    if (!(r2 >= near2 && r2 > 0.0 && r2 < 1e14)) return {-1, 0, 0, 0};
    if (r2 > far2 && !beyond) return {-1, 0, 0, 0};
    int axis = 0;
    p.cwiseAbs().maxCoeff(&axis);
    const int face = 2 * axis + (p[axis] < 0.0 ? 1 : 0);
    const double z = std::abs(p[axis]), sign = p[axis] < 0.0 ? -1.0 : 1.0;
    return {face, static_cast<float>(p[(axis + 1) % 3] / z),
            static_cast<float>(sign * p[(axis + 2) % 3] / z), static_cast<float>(1.0 / z)};
  }

  int side_with_margin() const { return side_ + 2 * kMargin; }
  int runs() const { return (side_with_margin() + kLanes - 1) / kLanes; }
  int stride() const { return runs() * kLanes + 2 * kPad; }
  /// How far from its centre a face's margin reaches, as a multiple of the face itself.
  float reach() const { return 1.0F + 2.0F * kMargin / static_cast<float>(side_); }

  /// Calls `fn(part, begin, end)` with every part and its points' range in the scan.
  template <typename Fn>
  void for_each_part(int threads, Fn&& fn) {
    parallel_for(parts_.size(), threads, [&](std::size_t k) {
      fn(parts_[k], k * kPart, std::min(located_.size(), (k + 1) * kPart));
    });
  }

  void sort_by_face(int threads) {
    const float to_margin = reach();
    for_each_part(threads, [&](Part& part, std::size_t begin, std::size_t end) {
      for (auto& points : part.points) points.clear();
      for (std::size_t i = begin; i < end; ++i) {
        const Located& p = located_[i];
        if (p.face < 0) continue;
        const auto index = static_cast<std::uint32_t>(i);
        if (std::max(std::abs(p.x), std::abs(p.y)) * to_margin < 1.0F)
          part.points[at(p.face)].push_back(index);
        else  // points just beyond a face's border fill its margin
          for (auto& points : part.points) points.push_back(index);
      }
    });
  }

  void bin(const TsdfOptions& options) {
    const int n = side_with_margin();
    parallel_for(kFaces, options.threads, [&](std::size_t f) {
      Face& face = faces_[f];
      face.samples.assign(at(stride()) * at(n + 2 * kPad), Sample{});
      face.any.assign(at(runs() + 2) * at(n + 2 * kPad), 0);
      face.count = 0;
      const float step = static_cast<float>(options.max_slope) / focal(), to_margin = reach();
      const Eigen::Matrix3f to_face = axes(static_cast<int>(f)).transpose().cast<float>();
      const auto add = [&](std::uint32_t i) {
        const Located& p = located_[i];
        float x = p.x, y = p.y, inverse = p.inverse;
        if (p.face != static_cast<int>(f)) {
          const Eigen::Vector3f q =
              to_face * (axes(p.face).cast<float>() * Eigen::Vector3f(x, y, 1.0F));
          if (q.z() < 0.5F || std::max(std::abs(q.x()), std::abs(q.y())) > q.z() * to_margin)
            return;
          x = q.x() / q.z();
          y = q.y() / q.z();
          inverse /= q.z();
        }
        const float u = x * focal() + center(), v = y * focal() + center();
        const int iu = static_cast<int>(u + 0.5F), iv = static_cast<int>(v + 0.5F);
        if (iu < 0 || iv < 0 || iu >= n || iv >= n) return;
        const Sample s{u - static_cast<float>(iu), v - static_cast<float>(iv), inverse};
        Sample& kept = face.samples[pixel(iu, iv)];
        ++face.count;
        face.any[run(iu, iv)] = 1;
        const float limit = step * std::max(s.inverse, kept.inverse);
        const bool nearer = s.inverse - kept.inverse > limit;
        const bool similar = std::abs(s.inverse - kept.inverse) <= limit;
        const bool central = s.du * s.du + s.dv * s.dv < kept.du * kept.du + kept.dv * kept.dv;
        if (nearer || (similar && central)) kept = s;
      };
      for (const Part& part : parts_)
        for (const std::uint32_t i : part.points[f]) add(i);
    });
  }

  std::size_t pixel(int u, int v) const { return at(v + kPad) * at(stride()) + at(u + kPad); }
  std::size_t run(int u, int v) const { return at(v + kPad) * at(runs() + 2) + at(u / kLanes + 1); }

  /// Whether a point is within `kPad` pixels of the pixels (u … u + kLanes − 1, v).
  bool any_near(const Face& face, int u, int v) const {
    for (int y = v - kPad; y <= v + kPad; ++y) {
      const char* any = &face.any[run(u, y)];
      if ((any[-1] | any[0] | any[1]) != 0) return true;
    }
    return false;
  }

  /// The surfaces at the pixels (u … u + kLanes − 1, v), u a multiple of kLanes; of depth
  /// `kNoDepth` where nothing is known.
  InversePlanes<kLanes> fit_row(const Face& face, int u, int v, float step) const {
    InversePlanes<kLanes> planes;
    planes.inverse.fill(kNothing.inverse[0]);
    if (!any_near(face, u, v)) return planes;
    std::array<char, kLanes> unclear;
    planes = fit_near(face, u, v, step, unclear);
    for (int i = 0; i < kLanes; ++i) {
      if (unclear[at(i)] == 0) continue;
      const InversePlanes<1> p = fit_far(face, u + i, v, step);
      planes.inverse[at(i)] = p.inverse[0];
      planes.slope_u[at(i)] = p.slope_u[0];
      planes.slope_v[at(i)] = p.slope_v[0];
    }
    return planes;
  }

  /// The same from the 3 × 3 pixels around each; `unclear` where these hold too few points.
  InversePlanes<kLanes> fit_near(const Face& face, int u, int v, float step,
                                 std::array<char, kLanes>& unclear) const {
    constexpr std::size_t kOwn = 4;
    PixelPoints<kLanes, 9> p;
    p.count = 9;
    std::array<float, kLanes> found{}, nearest{};
    for (std::size_t k = 0; k < p.count; ++k) {
      const int du = static_cast<int>(k % 3) - 1, dv = static_cast<int>(k / 3) - 1;
      const Sample* row = &face.samples[pixel(u + du, v + dv)];
      for (std::size_t i = 0; i < kLanes; ++i) {
        p.u[k][i] = static_cast<float>(du) + row[i].du;
        p.v[k][i] = static_cast<float>(dv) + row[i].dv;
        p.inverse[k][i] = row[i].inverse;
      }
      for (std::size_t i = 0; i < kLanes; ++i) {
        found[i] += one_if(p.inverse[k][i] > 0.0F);
        nearest[i] = larger(nearest[i], p.inverse[k][i]);
      }
    }
    for (std::size_t i = 0; i < kLanes; ++i) {
      const float missing = one_if(p.inverse[kOwn][i] == 0.0F);
      p.own[i] = p.inverse[kOwn][i] + missing * nearest[i];
      p.own_u[i] = p.u[kOwn][i];
      p.own_v[i] = p.v[kOwn][i];
      unclear[i] = missing * one_if(found[i] < kFewest) > 0.0F ? 1 : 0;
    }
    return fit_planes(p, 2.0F * step, 2.0F * step);
  }

  /// The surface at one pixel without a point of its own, from the 5 × 5 around it.
  InversePlanes<1> fit_far(const Face& face, int u, int v, float step) const {
    PixelPoints<1, 25> p;
    for (int dv = -kPad; dv <= kPad; ++dv)
      for (int du = -kPad; du <= kPad; ++du) {
        const Sample& s = face.samples[pixel(u + du, v + dv)];
        if (s.inverse == 0.0F) continue;
        p.u[p.count][0] = static_cast<float>(du) + s.du;
        p.v[p.count][0] = static_cast<float>(dv) + s.dv;
        p.inverse[p.count][0] = s.inverse;
        p.own[0] = std::max(p.own[0], s.inverse);
        ++p.count;
      }
    if (static_cast<float>(p.count) < kFewest) return kNothing;
    return fit_planes(p, 3.0F * step, 2.0F * step);
  }

  Pose T_world_sensor_ = Pose::Identity();
  double max_range_ = 0.0;
  int side_ = 8;
  std::vector<Located> located_;
  std::vector<Part> parts_;
  std::array<Face, kFaces> faces_;
};
}  // namespace surfleet::detail
