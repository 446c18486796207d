// SPDX-License-Identifier: MIT
/// @file
/// @brief Which blocks of a map a view concerns.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <surfleet/mapping/detail/projective_view.hpp>
#include <surfleet/mapping/tsdf_map.hpp>

namespace surfleet::detail {
enum class Visibility : std::uint8_t { none, mixed, free };

/// A block a view may concern; `free` if all its voxels lie before every surface.
struct ViewedBlock {
  BlockIndex index;
  std::uint32_t slot;
  bool free;
};

/// Finds the blocks of a view by halving cubes of blocks: cubes outside the view or wholly hidden
/// are dropped at once, cubes wholly before every surface taken at once.
class ViewedBlockSearch {
 public:
  ViewedBlockSearch(const ProjectiveView& view, const TsdfMap& map, double truncation, bool carve)
      : view_(view), map_(map), truncation_(truncation), carve_(carve) {
    const Pose T = view.T_world_camera.inverse(Eigen::Isometry);
    const double block = map.voxel_size() * TsdfMap::kBlockSide;
    axes_ = T.linear() * block;
    shift_ = T.translation();
    rotation_ = T.linear();
    // Voxel centres lie half a voxel inside the faces of a cube of blocks.
    inset_ = map.voxel_size() * 0.5;
    const double half = 0.5 - view.margin;
    const double left = (-half - view.cx) / view.fx, top = (-half - view.cy) / view.fy;
    const double right = (view.width - 1 + half - view.cx) / view.fx;
    const double bottom = (view.height - 1 + half - view.cy) / view.fy;
    sides_ = {Eigen::Vector3d(1, 0, -left), Eigen::Vector3d(-1, 0, right),
              Eigen::Vector3d(0, 1, -top), Eigen::Vector3d(0, -1, bottom)};
    const auto deepest = view.pyramid.extremes(0, 0, view.width - 1, view.height - 1).second;
    far_ = std::min<double>({view.z_limit, view.range_limit, std::max(0.0F, deepest)}) + truncation;
    bounds_.extend(view.T_world_camera.translation());
    for (const double x : {left, right})
      for (const double y : {top, bottom})
        bounds_.extend(view.T_world_camera * Point3(x * far_, y * far_, far_));
    nothing_ = deepest <= 0.0F;
  }

  /// In an order that depends on the view alone.
  void run(std::vector<ViewedBlock>& found) {
    found.clear();
    if (nothing_) return;
    low_ = TsdfMap::block_of(map_.index_of(bounds_.min()));
    high_ = TsdfMap::block_of(map_.index_of(bounds_.max()));
    int level = 0;
    while ((1 << level) <= (high_ - low_).maxCoeff()) ++level;
    visit(low_, level, found);
  }

 private:
  void visit(const BlockIndex& at, int level, std::vector<ViewedBlock>& found) {
    if ((at.array() > high_.array()).any()) return;
    const Visibility v = classify(at, 1 << level);
    if (v == Visibility::none) return;
    if (v == Visibility::free || level == 0) {
      const int n = 1 << level;
      for (int z = 0; z < n; ++z)
        for (int y = 0; y < n; ++y)
          for (int x = 0; x < n; ++x) {
            const BlockIndex b = at + BlockIndex(x, y, z);
            found.push_back({b, map_.find_slot(b), v == Visibility::free});
          }
      return;
    }
    const int half = 1 << (level - 1);
    for (int child = 0; child < 8; ++child)
      visit(at + half * BlockIndex(child & 1, (child >> 1) & 1, child >> 2), level - 1, found);
  }

  Visibility classify(const BlockIndex& at, int side) const {
    const Eigen::Vector3d corner =
        axes_ * at.cast<double>() + shift_ + rotation_ * Eigen::Vector3d::Constant(inset_);
    const Eigen::Matrix3d edges = axes_ * side - rotation_ * (2.0 * inset_);
    const Eigen::Vector3d low = corner + edges.cwiseMin(0.0).rowwise().sum();
    const Eigen::Vector3d high = corner + edges.cwiseMax(0.0).rowwise().sum();
    if (high.z() <= kNearPlane || low.z() > far_) return Visibility::none;
    for (const Eigen::Vector3d& n : sides_)
      if (n.dot(corner) + (n.transpose() * edges).cwiseMax(0.0).sum() < 0.0)
        return Visibility::none;
    const Eigen::Vector3d nearest = low.cwiseMax(0.0) + high.cwiseMin(0.0);
    if (nearest.norm() > view_.range_limit + truncation_) return Visibility::none;
    if (low.z() <= kNearPlane) return Visibility::mixed;

    double u0 = 1e30, u1 = -1e30, v0 = 1e30, v1 = -1e30;
    for (int c = 0; c < 8; ++c) {
      Eigen::Vector3d p = corner;
      for (int i = 0; i < 3; ++i)
        if ((c >> i & 1) != 0) p += edges.col(i);
      const double u = view_.fx * p.x() / p.z() + view_.cx;
      const double v = view_.fy * p.y() / p.z() + view_.cy;
      u0 = std::min(u0, u), u1 = std::max(u1, u);
      v0 = std::min(v0, v), v1 = std::max(v1, v);
    }
    // The pixels whose centre is nearest to any point of the rectangle, with room for rounding.
    const auto pixel = [](double x, double round, int n) {
      return static_cast<int>(std::floor(std::clamp(x + round, -1.0, n + 1.0)));
    };
    const int a = pixel(u0, 0.49, view_.width), b = pixel(v0, 0.49, view_.height);
    const int c = pixel(u1, 0.51, view_.width), d = pixel(v1, 0.51, view_.height);
    const int m = view_.margin;
    const bool inside = a >= m && b >= m && c < view_.width - m && d < view_.height - m;
    const int ua = std::max(a, 0), va = std::max(b, 0);
    const int ub = std::min(c, view_.width - 1), vb = std::min(d, view_.height - 1);
    if (ua > ub || va > vb) return Visibility::none;
    const auto [shallowest, deepest] = view_.pyramid.extremes(ua, va, ub, vb);
    if (deepest < low.z() - truncation_) return Visibility::none;
    const double limit = std::max<double>(view_.z_limit, 0.0);
    if (inside && shallowest >= high.z() + kSlantReach * truncation_ && high.z() <= limit) {
      const Eigen::Vector3d farthest = low.cwiseAbs().cwiseMax(high.cwiseAbs());
      if (farthest.norm() <= view_.range_limit) return carve_ ? Visibility::free : Visibility::none;
    }
    return Visibility::mixed;
  }

  const ProjectiveView& view_;
  const TsdfMap& map_;
  double truncation_, inset_ = 0.0, far_ = 0.0;
  bool carve_, nothing_ = false;
  Eigen::Matrix3d axes_, rotation_;
  Eigen::Vector3d shift_;
  std::array<Eigen::Vector3d, 4> sides_;
  Box3 bounds_;
  BlockIndex low_, high_;
};
}  // namespace surfleet::detail
