// SPDX-License-Identifier: MIT
/// @file  A scan of points as pinhole images on the faces of a cube around the sensor.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <surfleet/core/parallel.hpp>
#include <surfleet/mapping/detail/projective_view.hpp>

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
    parallel_for(
        o.points.size(), options.threads,
        [&](std::size_t i) { located_[i] = locate(o.points[i], near2, far2, beyond); }, 2048);

    // Density: points a cell over the cells of a coarse cube that hold any, in cells of equal
    // solid angle to within the cube's distortion, which is divided out.
    constexpr int kCoarse = 24;
    std::array<std::vector<float>, kFaces> coarse;
    for (auto& c : coarse) c.assign(kCoarse * kCoarse, 0.0F);
    for (const Located& p : located_) {
      if (p.face < 0) continue;
      const auto cell = [](float x) {
        return std::clamp(static_cast<int>((x + 1.0F) * 0.5F * kCoarse), 0, kCoarse - 1);
      };
      coarse[static_cast<std::size_t>(p.face)]
            [static_cast<std::size_t>(cell(p.y) * kCoarse + cell(p.x))] += 1.0F;
    }
    double count = 0.0, solid_angle = 0.0;
    for (const auto& face : coarse)
      for (std::size_t i = 0; i < face.size(); ++i) {
        if (face[i] == 0.0F) continue;
        const double x = (static_cast<double>(i % kCoarse) + 0.5) * 2.0 / kCoarse - 1.0;
        const double y = (static_cast<double>(i / kCoarse) + 0.5) * 2.0 / kCoarse - 1.0;
        count += static_cast<double>(face[i]);
        solid_angle += 4.0 / (kCoarse * kCoarse) / std::pow(1.0 + x * x + y * y, 1.5);
      }
    const double per_pixel = kPointsPerPixel * solid_angle / std::max(count, 1.0);
    const double per_face = 2.0 * kPi / 3.0 / std::max(per_pixel, 1e-9);
    side_ = std::clamp(static_cast<int>(std::lround(std::sqrt(per_face))), 8, 2048);
    bin(options);
  }

  /// Makes `view` the given face; false if it holds no measurement.
  bool resample(int face, const TsdfOptions& options, ProjectiveView& view) {
    const auto f = static_cast<std::size_t>(face);
    if (counts_[f] == 0) return false;
    const int n = side_ + 2 * kMargin;
    view.width = view.height = n;
    view.margin = kMargin;
    view.fx = view.fy = focal();
    view.cx = view.cy = center();
    view.z_limit = static_cast<float>(max_range_);
    view.range_limit = static_cast<float>(max_range_);
    view.set_slope_limit(options.max_slope);
    view.T_world_camera = T_world_sensor_ * Pose(axes(face));
    const std::vector<Sample>& samples = samples_[f];
    view.planes.resize(view.pixels() + 1);
    view.fill(options.threads, [&](int v, float* out) {
      SurfacePlane* planes = view.planes.data() + static_cast<std::ptrdiff_t>(v) * n;
      InversePlanes fitted;
      for (int first = 0; first < n; first += kLanes) {
        const int lanes = std::min(kLanes, n - first);
        if (v > 0 && v + 1 < n && first > 0 && first + kLanes < n) {
          fit_lanes(samples, first, v, view.max_step_u, fitted);
        } else {
          for (int i = 0; i < lanes; ++i)
            fitted.set(i, fit(samples, first + i, v, view.max_step_u));
        }
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
  static constexpr double kPointsPerPixel = 1.5;
  static constexpr int kRounds = 3;             ///< Of fitting a plane.
  static constexpr float kLeastSpread = 0.05F;  ///< Of the points, or they are on one line.
  static constexpr float kGoodFit =
      1e-3F;                               ///< Error beside the inverse depth that ends the rounds.
  static constexpr float kTiny = 1e-20F;   ///< Least divisor.
  static constexpr float kOutlier = 4.0F;  ///< How much a bad fit costs in weight.
  /// A point on its face: x and y at unit depth, in [−1, 1], and 1 / depth.
  struct Located {
    std::int32_t face;
    float x, y, inverse;
  };
  struct Sample {
    float du = 0.0F, dv = 0.0F;  ///< From the pixel's centre [px].
    float inverse = 0.0F;        ///< 1 / depth; 0 for none.
  };

  /// Inverse depth at a pixel's centre and its change a pixel.
  struct InversePlane {
    float inverse, slope_u, slope_v;
  };
  /// The same of neighbouring pixels of a row.
  static constexpr int kLanes = 16;
  using Lanes = std::array<float, kLanes>;
  struct InversePlanes {
    Lanes inverse, slope_u, slope_v;
    void set(int i, const InversePlane& p) {
      inverse[at(i)] = p.inverse;
      slope_u[at(i)] = p.slope_u;
      slope_v[at(i)] = p.slope_v;
    }
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
  float center() const { return 0.5F * static_cast<float>(side_ + 2 * kMargin - 1); }

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

  void bin(const TsdfOptions& options) {
    const int n = side_ + 2 * kMargin;
    parallel_for(kFaces, options.threads, [&](std::size_t f) {
      std::vector<Sample>& samples = samples_[f];
      samples.assign(static_cast<std::size_t>(n) * static_cast<std::size_t>(n), Sample{});
      counts_[f] = 0;
      const float step = static_cast<float>(options.max_slope) / focal();
      const float reach = 1.0F + 2.0F * kMargin / static_cast<float>(side_);
      const Eigen::Matrix3f to_face = axes(static_cast<int>(f)).transpose().cast<float>();
      for (const Located& p : located_) {
        if (p.face < 0) continue;
        float x = p.x, y = p.y, inverse = p.inverse;
        if (p.face != static_cast<int>(f)) {
          // Points just beyond the face's border fill its margin.
          if (std::max(std::abs(x), std::abs(y)) * reach < 1.0F) continue;
          const Eigen::Vector3f q =
              to_face * (axes(p.face).cast<float>() * Eigen::Vector3f(x, y, 1.0F));
          if (q.z() < 0.5F || std::max(std::abs(q.x()), std::abs(q.y())) > q.z() * reach) continue;
          x = q.x() / q.z();
          y = q.y() / q.z();
          inverse /= q.z();
        }
        const float u = x * focal() + center(), v = y * focal() + center();
        const int iu = static_cast<int>(u + 0.5F), iv = static_cast<int>(v + 0.5F);
        if (iu < 0 || iv < 0 || iu >= n || iv >= n) continue;
        const Sample s{u - static_cast<float>(iu), v - static_cast<float>(iv), inverse};
        Sample& kept = samples[static_cast<std::size_t>(iv) * static_cast<std::size_t>(n) +
                               static_cast<std::size_t>(iu)];
        ++counts_[f];
        const float limit = step * std::max(s.inverse, kept.inverse);
        const bool nearer = s.inverse - kept.inverse > limit;
        const bool similar = std::abs(s.inverse - kept.inverse) <= limit;
        const bool central = s.du * s.du + s.dv * s.dv < kept.du * kept.du + kept.dv * kept.dv;
        if (nearer || (similar && central)) kept = s;
      }
    });
  }

  /// The surface at pixel (u, v); of depth `kNoDepth` where nothing is known.
  InversePlane fit(const std::vector<Sample>& samples, int u, int v, float step) const {
    constexpr InversePlane kNothing{1.0F / kNoDepth, 0.0F, 0.0F};
    const int n = side_ + 2 * kMargin;
    const auto sample = [&](int x, int y) -> const Sample& {
      return samples[at(y) * at(n) + at(x)];
    };
    // The pixel's own point, or the nearest to the sensor among its neighbours'.
    Sample own = sample(u, v);
    int radius = 1;
    if (own.inverse == 0.0F) {
      for (radius = 1; radius <= 2; ++radius) {
        int found = 0;
        for (int y = std::max(0, v - radius); y <= std::min(n - 1, v + radius); ++y)
          for (int x = std::max(0, u - radius); x <= std::min(n - 1, u + radius); ++x)
            if (sample(x, y).inverse > 0.0F) {
              ++found;
              own.inverse = std::max(own.inverse, sample(x, y).inverse);
            }
        if (found >= 3) break;
        own.inverse = 0.0F;
      }
      if (own.inverse == 0.0F) return kNothing;
    }
    std::array<float, 25> dx, dy, dz, weight;
    std::size_t count = 0;
    const float limit = step * static_cast<float>(radius + 1) * own.inverse;
    for (int y = std::max(0, v - radius); y <= std::min(n - 1, v + radius); ++y)
      for (int x = std::max(0, u - radius); x <= std::min(n - 1, u + radius); ++x) {
        const Sample& s = sample(x, y);
        const float rise = s.inverse - own.inverse;
        if (s.inverse == 0.0F || std::abs(rise) > limit) continue;
        dx[count] = static_cast<float>(x - u) + s.du - own.du;
        dy[count] = static_cast<float>(y - v) + s.dv - own.dv;
        dz[count] = rise;
        weight[count] = 1.0F / (0.25F + dx[count] * dx[count] + dy[count] * dy[count]);
        ++count;
      }
    InversePlane plane{own.inverse, 0.0F, 0.0F};
    // Most points around a pixel lie on its own surface: giving less weight to those that fit badly
    // finds it beside a crease.
    for (int round = 0; round < kRounds; ++round) {
      float sw = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0, sz = 0, sxz = 0, syz = 0;
      for (std::size_t i = 0; i < count; ++i) {
        const float w = weight[i], wx = w * dx[i], wy = w * dy[i];
        sw += w, sx += wx, sy += wy, sz += w * dz[i];
        sxx += wx * dx[i], sxy += wx * dy[i], syy += wy * dy[i];
        sxz += wx * dz[i], syz += wy * dz[i];
      }
      const float cxx = sxx - sx * sx / sw, cxy = sxy - sx * sy / sw, cyy = syy - sy * sy / sw;
      const float cxz = sxz - sx * sz / sw, cyz = syz - sy * sz / sw;
      const float det = cxx * cyy - cxy * cxy;
      if (!(det > kLeastSpread * (cxx + cyy) * (cxx + cyy))) break;  // on one line, or alone
      plane.slope_u = (cxz * cyy - cyz * cxy) / det;
      plane.slope_v = (cyz * cxx - cxz * cxy) / det;
      const float rise = (sz - plane.slope_u * sx - plane.slope_v * sy) / sw;
      plane.inverse = own.inverse + rise - plane.slope_u * own.du - plane.slope_v * own.dv;
      float error = 0.0F;
      for (std::size_t i = 0; i < count; ++i) {
        const float r = dz[i] - rise - plane.slope_u * dx[i] - plane.slope_v * dy[i];
        error = std::max(error, std::abs(r));
      }
      if (error < kGoodFit * own.inverse) break;
      const float scale = kOutlier / error;
      for (std::size_t i = 0; i < count; ++i) {
        const float r = dz[i] - rise - plane.slope_u * dx[i] - plane.slope_v * dy[i];
        weight[i] /= 1.0F + r * r * scale * scale;
      }
    }
    const float steepest = 2.0F * step * own.inverse;
    if (!(std::abs(plane.inverse - own.inverse) < steepest) || !(plane.inverse > 0.0F))
      return {own.inverse, 0.0F, 0.0F};
    return plane;
  }

  /// `fit` for the pixels (u … u + kLanes − 1, v), none of them at the image's border: the same
  /// sums over fixed neighbours, in which those that do not count have no weight. Conditions are
  /// factors of 0 or 1, so that the loops become vector code.
  void fit_lanes(const std::vector<Sample>& samples, int u, int v, float step,
                 InversePlanes& out) const {
    constexpr std::size_t kNeighbors = 9, kOwn = 4;
    const auto one_if = [](int condition) { return static_cast<float>(condition); };
    const std::size_t n = at(side_ + 2 * kMargin);
    std::array<Lanes, kNeighbors> dx, dy, dz, weight;
    for (std::size_t k = 0; k < kNeighbors; ++k) {
      const Sample* row = samples.data() + (at(v) + k / 3 - 1) * n + at(u) + k % 3 - 1;
      for (std::size_t i = 0; i < kLanes; ++i) {
        dx[k][i] = row[i].du;
        dy[k][i] = row[i].dv;
        dz[k][i] = row[i].inverse;
      }
    }
    Lanes own, own_u, own_v, missing, found{}, nearest{};
    for (std::size_t k = 0; k < kNeighbors; ++k)
      for (std::size_t i = 0; i < kLanes; ++i) {
        found[i] += one_if(dz[k][i] > 0.0F);
        nearest[i] = larger(nearest[i], dz[k][i]);
      }
    float unclear = 0.0F;
    for (std::size_t i = 0; i < kLanes; ++i) {
      missing[i] = one_if(dz[kOwn][i] == 0.0F);
      own[i] = dz[kOwn][i] + missing[i] * nearest[i];
      own_u[i] = dx[kOwn][i];
      own_v[i] = dy[kOwn][i];
      unclear += missing[i] * one_if(found[i] < 3.0F);
    }
    for (std::size_t k = 0; k < kNeighbors; ++k) {
      const float across = static_cast<float>(k % 3) - 1.0F;
      const float down = static_cast<float>(k / 3) - 1.0F;
      for (std::size_t i = 0; i < kLanes; ++i) {
        const float inverse = dz[k][i], rise = inverse - own[i];
        const float x = across + dx[k][i] - own_u[i], y = down + dy[k][i] - own_v[i];
        const int counts = int(inverse > 0.0F) & int(std::abs(rise) <= 2.0F * step * own[i]);
        dx[k][i] = x;
        dy[k][i] = y;
        dz[k][i] = rise;
        weight[k][i] = one_if(counts) / (0.25F + x * x + y * y);
      }
    }
    Lanes rise{}, slope_u{}, slope_v{}, active;
    active.fill(1.0F);
    for (int round = 0; round < kRounds; ++round) {
      Lanes sw{}, sx{}, sy{}, sxx{}, sxy{}, syy{}, sz{}, sxz{}, syz{}, error{};
      for (std::size_t k = 0; k < kNeighbors; ++k)
        for (std::size_t i = 0; i < kLanes; ++i) {
          const float w = weight[k][i], wx = w * dx[k][i], wy = w * dy[k][i];
          sw[i] += w, sx[i] += wx, sy[i] += wy, sz[i] += w * dz[k][i];
          sxx[i] += wx * dx[k][i], sxy[i] += wx * dy[k][i], syy[i] += wy * dy[k][i];
          sxz[i] += wx * dz[k][i], syz[i] += wy * dz[k][i];
        }
      for (std::size_t i = 0; i < kLanes; ++i) {
        const float per = 1.0F / (sw[i] + kTiny);
        const float cxx = sxx[i] - sx[i] * sx[i] * per, cxy = sxy[i] - sx[i] * sy[i] * per;
        const float cyy = syy[i] - sy[i] * sy[i] * per, cxz = sxz[i] - sx[i] * sz[i] * per;
        const float cyz = syz[i] - sy[i] * sz[i] * per;
        const float det = cxx * cyy - cxy * cxy, least = kLeastSpread * (cxx + cyy) * (cxx + cyy);
        active[i] *= one_if(det > least);
        const float per_det = 1.0F / (std::abs(det) + kTiny);
        const float to_u = (cxz * cyy - cyz * cxy) * per_det;
        const float to_v = (cyz * cxx - cxz * cxy) * per_det;
        const float to = (sz[i] - to_u * sx[i] - to_v * sy[i]) * per;
        slope_u[i] += active[i] * (to_u - slope_u[i]);
        slope_v[i] += active[i] * (to_v - slope_v[i]);
        rise[i] += active[i] * (to - rise[i]);
      }
      for (std::size_t k = 0; k < kNeighbors; ++k)
        for (std::size_t i = 0; i < kLanes; ++i) {
          const float r = dz[k][i] - rise[i] - slope_u[i] * dx[k][i] - slope_v[i] * dy[k][i];
          error[i] = larger(error[i], std::abs(r) * one_if(weight[k][i] > 0.0F));
        }
      float any = 0.0F;
      for (std::size_t i = 0; i < kLanes; ++i) {
        active[i] *= one_if(error[i] >= kGoodFit * own[i]);
        any += active[i];
      }
      if (any == 0.0F) break;
      for (std::size_t k = 0; k < kNeighbors; ++k)
        for (std::size_t i = 0; i < kLanes; ++i) {
          const float r = dz[k][i] - rise[i] - slope_u[i] * dx[k][i] - slope_v[i] * dy[k][i];
          const float off = r * kOutlier / larger(error[i], kTiny);
          weight[k][i] /= 1.0F + off * off;
        }
    }
    for (std::size_t i = 0; i < kLanes; ++i) {
      const float change = rise[i] - slope_u[i] * own_u[i] - slope_v[i] * own_v[i];
      const float sane =
          one_if(int(std::abs(change) < 2.0F * step * own[i]) & int(own[i] + change > 0.0F));
      out.inverse[i] = own[i] + sane * change;
      out.slope_u[i] = sane * slope_u[i];
      out.slope_v[i] = sane * slope_v[i];
    }
    if (unclear > 0.0F)
      for (int i = 0; i < kLanes; ++i)
        if (missing[at(i)] * one_if(found[at(i)] < 3.0F) > 0.0F)
          out.set(i, fit(samples, u + i, v, step));
  }

  Pose T_world_sensor_ = Pose::Identity();
  double max_range_ = 0.0;
  int side_ = 8;
  std::vector<Located> located_;
  std::array<std::vector<Sample>, kFaces> samples_;
  std::array<std::size_t, kFaces> counts_{};
};
}  // namespace surfleet::detail
