// SPDX-License-Identifier: MIT
/// @file
/// @brief Environmental feature maps of a cloud: surface and edge saliencies with their directions
/// at the cells of a grid [004 §8.2.2].
#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/random.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/geometry/kd_tree.hpp>
#include <surfleet/surface/cloud_tokens.hpp>
#include <surfleet/surface/tensor_voting.hpp>

namespace surfleet {
struct FeatureMapOptions {
  double voxel = 0.035;    ///< Side of a cell [m].
  double band = 1.5;       ///< Cells whose centre lies so near a token are held [voxels].
  double inflation = 0.0;  ///< Cells so near an edge are edge cells; √6 voxels at least [m].
  int threads = 1;
};

/// What is known at a cell's centre.
struct FeatureCell {
  Eigen::Vector3i index = Eigen::Vector3i::Zero();     ///< Of the cell in the grid.
  Point3 position = Point3::Zero();                    ///< Its centre [m].
  double surface = 0.0;                                ///< Surface saliency λ₁ − λ₂.
  double plate = 0.0;                                  ///< Edge saliency λ₂ − λ₃.
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();   ///< Of either sign.
  Eigen::Vector3d tangent = Eigen::Vector3d::UnitX();  ///< Of the edges nearby where `edge`.
  bool edge = false;                                   ///< Binary edge map, inflated.

  /// By which a planner tells surface from space. At an edge λ₁ + λ₂ − 2 λ₃: the votes of two
  /// sheets are as many there as those of one elsewhere, but their normals differ, and λ₁ − λ₂
  /// vanishes in the fold.
  double saliency() const { return edge ? surface + 2.0 * plate : surface; }
};

/// The cells of a grid that lie near tokens, after dense voting by the tokens' sticks and plates.
///
/// Cells ascend by (z, y, x). Build O(cells · tokens in reach), memory O(cells); a block grid of
/// voxels would hold the empty ones too.
class FeatureMaps {
 public:
  /// The same for any number of threads. Throws `Error` for settings out of range.
  FeatureMaps(const CloudTokens& cloud, double scale, const FeatureMapOptions& options = {})
      : voxel_(options.voxel) {
    require(options.voxel > 0.0 && options.band > 0.0 && options.band <= 8.0 &&
                options.inflation >= 0.0 && std::isfinite(options.inflation),
            "feature maps: expected a positive voxel, a band of up to 8 voxels and an inflation of "
            "0 m or more");
    require(cloud.edge.size() == cloud.tokens.size(), "feature maps: expected a mark a token");
    collect(cloud, options);
    std::vector<Point3> places;
    for (const FeatureCell& c : cells_) places.push_back(c.position);
    const TensorVoting<> vote{{scale, 0.5, options.threads}, {}};
    const std::vector<Token> dense = vote.sticks_and_plates(cloud.tokens, places);
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      cells_[i].surface = dense[i].stick;
      cells_[i].plate = dense[i].plate;
      cells_[i].normal = dense[i].normal;
      cells_[i].tangent = dense[i].tangent;
      greatest_ = std::max(greatest_, dense[i].stick);
    }
    mark_edges(cloud, options);
    tree_ = KdTree(places);
  }

  /// Edge points make edge cells of those nearer than this, or than the inflation: √6 [voxels].
  static constexpr double kEdgeVoxels = 2.449489742783178;

  double voxel() const { return voxel_; }
  const std::vector<FeatureCell>& cells() const { return cells_; }
  const FeatureCell& operator[](std::int32_t cell) const {
    return cells_[static_cast<std::size_t>(cell)];
  }
  /// s_max of eq. 8.2.
  double greatest_saliency() const { return greatest_; }
  /// The cell with this index; −1 if it is not held.
  std::int32_t find(const Eigen::Vector3i& index) const {
    const auto at = index_.find(key(index));
    return at == index_.end() ? -1 : at->second;
  }
  /// Held cells by the distance of their centres from a point, nearest first, up to `reach` [m].
  std::vector<Neighbor> near(const Point3& p, double reach) const { return tree_.within(p, reach); }

 private:
  static constexpr std::int32_t kLimit = 1 << 20;
  static std::uint64_t key(const Eigen::Vector3i& i) {
    std::uint64_t k = 0;
    for (int a = 2; a >= 0; --a) k = (k << 21) | static_cast<std::uint64_t>(i[a] + kLimit);
    return k;
  }
  struct Hash {
    std::size_t operator()(std::uint64_t k) const { return static_cast<std::size_t>(mix64(k)); }
  };
  Eigen::Vector3i cell_of(const Point3& p) const {
    Eigen::Vector3i i;
    for (int a = 0; a < 3; ++a) {
      const double at = std::floor(p[a] / voxel_);
      require(std::abs(at) < kLimit - 16,
              "feature maps: the cloud is too large or too far from the origin for its voxel; "
              "expected coordinates below a million voxels");
      i[a] = static_cast<int>(at);
    }
    return i;
  }
  Point3 centre(const Eigen::Vector3i& i) const {
    return voxel_ * (i.cast<double>() + Point3::Constant(0.5));
  }

  void collect(const CloudTokens& cloud, const FeatureMapOptions& options) {
    const double reach = options.band * voxel_;
    const int around = static_cast<int>(std::ceil(options.band));
    std::vector<std::pair<std::uint64_t, Eigen::Vector3i>> held;
    for (const Token& t : cloud.tokens) {
      if (!(t.stick + t.plate > 0.0)) continue;  // no others in reach: no surface
      const Eigen::Vector3i at = cell_of(t.position);
      for (int z = -around; z <= around; ++z)
        for (int y = -around; y <= around; ++y)
          for (int x = -around; x <= around; ++x) {
            const Eigen::Vector3i i = at + Eigen::Vector3i(x, y, z);
            if ((centre(i) - t.position).squaredNorm() <= reach * reach)
              held.emplace_back(key(i), i);
          }
    }
    std::sort(held.begin(), held.end(),
              [](const auto& a, const auto& b) { return a.first < b.first; });
    held.erase(std::unique(held.begin(), held.end(),
                           [](const auto& a, const auto& b) { return a.first == b.first; }),
               held.end());
    require(held.size() < static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()) / 128,
            "feature maps: too many cells; expected a larger voxel");
    index_.reserve(held.size());
    for (const auto& [k, i] : held) {
      index_.emplace(k, static_cast<std::int32_t>(cells_.size()));
      FeatureCell cell;
      cell.index = i;
      cell.position = centre(i);
      cells_.push_back(cell);
    }
  }

  /// A cell is an edge where an edge point lies within the inflation, at least √6 voxels: so no
  /// step of two cells, up to 2 √3 voxels long, leaps over an edge of 90°. Its tangent is the mean
  /// of those of all edge points so near, which may be of either sign.
  void mark_edges(const CloudTokens& cloud, const FeatureMapOptions& options) {
    std::vector<Point3> at;
    std::vector<Eigen::Vector3d> along;
    for (const EdgePoint& e : cloud.edge_points) {
      at.push_back(e.position);
      along.push_back(e.tangent);
    }
    const KdTree tree(at);
    const double reach = std::max(options.inflation, kEdgeVoxels * voxel_);
    for (FeatureCell& cell : cells_) {
      Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
      int count = 0;
      tree.for_each_within(cell.position, reach, [&](const Neighbor& n) {
        const Eigen::Vector3d& t = along[static_cast<std::size_t>(n.index)];
        sum += t * t.transpose();
        ++count;
      });
      if (count == 0) continue;
      cell.edge = true;
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(sum);
      cell.tangent = solver.eigenvectors().col(2);
    }
  }

  double voxel_;
  double greatest_ = 0.0;
  std::vector<FeatureCell> cells_;
  std::unordered_map<std::uint64_t, std::int32_t, Hash> index_;
  KdTree tree_;
};
}  // namespace surfleet
