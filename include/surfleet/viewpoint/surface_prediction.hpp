// SPDX-License-Identifier: MIT
/// @file
/// @brief Where the surface is likely to go on behind the border of what is known of it.
///
///     for (const PredictedPatch& p : predict_surface(incomplete.elements(), states)) …
#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/random.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/mapping/voxel_grid.hpp>
#include <surfleet/mapping/voxel_state_map.hpp>
#include <surfleet/viewpoint/incomplete_surface.hpp>

namespace surfleet {
/// The known surface beside an incomplete element.
struct SurfaceFrame {
  Point3 point;             ///< On the surface, nearest to the element [m].
  Eigen::Vector3d normal;   ///< Unit, towards empty space.
  Eigen::Vector3d tangent;  ///< Unit, along the surface from the known towards the unknown.
};

struct PredictionOptions {
  double reach = 5.0;            ///< How far the surface is continued [m].
  std::optional<double> step{};  ///< Edge of the patches [m]; nothing: two voxels.
  int window = 2;  ///< Half the side of the cube of voxels that frames are fitted to [voxels].
  double spread =
      radians(30.0);  ///< Lanes also leave the tangent by this angle to both sides [rad].
  Box3 region = {};   ///< Patches are kept inside it [m]; an empty box means everywhere.
};

/// A piece of surface that is expected, not seen.
struct PredictedPatch {
  Point3 position;         ///< [m]
  Eigen::Vector3d normal;  ///< Unit, towards where empty space is expected.
  double area;             ///< [m²]
};

/// The frame of the surface at an element, from the states within `window` voxels.
///
/// The surface is sampled by the faces between occupied and empty voxels; their least-squares plane
/// gives the normal, on the empty side. The tangent points to the unknown voxels of the window
/// that lie within a voxel of that plane. Nothing if there are fewer than three faces or no
/// unknown voxels to one side. O(window³).
inline std::optional<SurfaceFrame> surface_frame(VoxelStateMap::Accessor& state, double voxel_size,
                                                 const VoxelIndex& element, int window = 2) {
  require(window >= 1 && window <= 4, "surface window: expected 1 to 4 voxels");
  const int side = 2 * window + 1;
  std::array<VoxelState, 9 * 9 * 9> local;  // offsets in the window, x fastest
  const auto at = [&](int dx, int dy, int dz) -> VoxelState& {
    return local[static_cast<std::size_t>((dx + window) +
                                          side * ((dy + window) + side * (dz + window)))];
  };
  for (int dz = -window; dz <= window; ++dz)
    for (int dy = -window; dy <= window; ++dy)
      for (int dx = -window; dx <= window; ++dx)
        at(dx, dy, dz) = state(element + VoxelIndex(dx, dy, dz));

  // All in voxels, relative to the element's centre.
  Eigen::Vector3d facing = Eigen::Vector3d::Zero(), sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  int faces = 0;
  for (int dz = -window; dz <= window; ++dz) {
    for (int dy = -window; dy <= window; ++dy) {
      for (int dx = -window; dx <= window; ++dx) {
        if (at(dx, dy, dz) == VoxelState::unknown) continue;
        for (int axis = 0; axis < 3; ++axis) {
          VoxelIndex next(dx, dy, dz);
          if (++next[axis] > window) continue;
          const VoxelState a = at(dx, dy, dz), b = at(next.x(), next.y(), next.z());
          if (b == VoxelState::unknown || a == b) continue;
          Eigen::Vector3d center = Eigen::Vector3d(dx, dy, dz);
          center[axis] += 0.5;
          const double outward = a == VoxelState::occupied ? 1.0 : -1.0;
          if (outward * center[axis] > 1.0) continue;  // the far side of something thin
          facing[axis] += outward;
          sum += center;
          squares += center * center.transpose();
          ++faces;
        }
      }
    }
  }
  if (faces < 3 || facing.squaredNorm() < 1e-9) return std::nullopt;
  const Eigen::Vector3d centroid = sum / faces;
  const Eigen::Matrix3d covariance = squares / faces - centroid * centroid.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance);
  const Eigen::Vector3d spread = solver.eigenvalues();
  // A plane needs two wide directions and a narrow one; else the faces' own mean has to do.
  Eigen::Vector3d normal = facing.normalized();
  if (spread[1] > 2.0 * spread[0] + 0.02) {
    Eigen::Vector3d fitted = solver.eigenvectors().col(0);
    if (fitted.dot(normal) < 0.0) fitted = -fitted;
    if (fitted.dot(normal) > 0.5) normal = fitted;
  }
  const Eigen::Vector3d point = normal * normal.dot(centroid);

  Eigen::Vector3d outward = Eigen::Vector3d::Zero();
  for (int dz = -window; dz <= window; ++dz)
    for (int dy = -window; dy <= window; ++dy)
      for (int dx = -window; dx <= window; ++dx) {
        const Eigen::Vector3d offset = Eigen::Vector3d(dx, dy, dz) - point;
        if (at(dx, dy, dz) != VoxelState::unknown || std::abs(offset.dot(normal)) > 1.0) continue;
        const Eigen::Vector3d along = offset - offset.dot(normal) * normal;
        const double length = along.norm();
        if (length > 0.3) outward += along / length;
      }
  if (outward.norm() < 0.5) return std::nullopt;
  const Point3 center = (element.cast<double>() + Eigen::Vector3d::Constant(0.5)) * voxel_size;
  return SurfaceFrame{center + voxel_size * point, normal, outward.normalized()};
}
inline std::optional<SurfaceFrame> surface_frame(const VoxelStateMap& map,
                                                 const IncompleteElement& element, int window = 2) {
  VoxelStateMap::Accessor state(map);
  return surface_frame(state, map.voxel_size(), element.voxel, window);
}

/// The frames of elements, fitted anew where the map has changed beside them.
class SurfaceFrameMemory {
 public:
  /// As `surface_frame`, always of the same map. O(1) where nothing has changed.
  std::optional<SurfaceFrame> operator()(const VoxelStateMap& map, VoxelStateMap::Accessor& state,
                                         const VoxelIndex& element, int window) {
    const auto [it, fresh] = frames_.try_emplace(key_of(element));
    Known& known = it->second;
    if (fresh || known.window != window || latest_change(map.grid(), element, window) > known.at)
      known = {surface_frame(state, map.voxel_size(), element, window), map.grid().revision(),
               window};
    known.used = turn_;
    return known.frame;
  }
  /// Call when all elements there are have been asked for: the others are forgotten in time.
  void end_turn(std::size_t elements) {
    if (frames_.size() > 2 * elements + 64)
      std::erase_if(frames_, [&](const auto& f) { return f.second.used != turn_; });
    ++turn_;
  }

 private:
  struct Known {
    std::optional<SurfaceFrame> frame;
    std::uint64_t at = 0;  // revision of the map
    int window = 0;
    std::uint64_t used = 0;  // turn
  };
  static std::uint64_t latest_change(const VoxelStateMap::Grid& grid, const VoxelIndex& element,
                                     int window) {
    std::uint64_t latest = 0;
    const VoxelIndex w = VoxelIndex::Constant(window);
    for_each_index(VoxelStateMap::Grid::block_of(element - w),
                   VoxelStateMap::Grid::block_of(element + w), [&](const VoxelIndex& b) {
                     const std::uint32_t slot = grid.find_slot(b);
                     if (slot != VoxelStateMap::Grid::kNone)
                       latest = std::max(latest, grid.block(slot).changed);
                   });
    return latest;
  }

  std::map<VoxelKey, Known> frames_;
  std::uint64_t turn_ = 0;
};

/// Continues the surface beyond its border: from every element's frame, lanes run in the tangent
/// plane through unknown voxels for up to `reach`, and end where the map is known again. For one
/// map, which may change from call to call.
///
/// Lanes leave along the tangent and `spread` to both sides of it. Patches that fall into the same
/// cell of a lattice of `step`, facing alike, are one, averaged. A patch's area is what a plane of
/// its slope takes of a cell on average. In the order of the elements that first led there.
/// O(elements × reach / step) at first; then states are read and frames fitted for elements within
/// some reaches of a change alone.
class SurfacePredictor {
 public:
  std::vector<PredictedPatch> operator()(std::span<const IncompleteElement> elements,
                                         const VoxelStateMap& map,
                                         const PredictionOptions& options) {
    begin(map, options);
    VoxelStateMap::Accessor state(map);
    std::vector<std::int32_t> patch_of(cells_, -1);  // by cell and side
    std::vector<Sum> sums;
    for (const IncompleteElement& e : elements) {
      Known& known = known_[key_of(e.voxel)];
      if (known.turn == 0 || known.turn + 1 != turn_ || has_changed_around(e.voxel)) {
        walk(map, state, e.voxel, known);
        patch_of.resize(cells_, -1);
      }
      known.turn = turn_;
      if (!known.frame) continue;
      const SurfaceFrame& frame = *known.frame;
      std::size_t next = 0;
      for (std::size_t lane = 0; lane < lanes(); ++lane) {
        const Eigen::Vector3d along = direction(frame, lane);
        for (std::size_t k = known.first[lane]; k < known.last[lane]; ++k) {
          const Point3 p = frame.point + steps_[k] * along;
          std::int32_t& id = patch_of[known.cells[next++]];
          if (id < 0) {
            id = static_cast<std::int32_t>(sums.size());
            sums.push_back({p, frame.normal, 1.0});
          } else {
            Sum& sum = sums[static_cast<std::size_t>(id)];
            sum.position += p;
            sum.normal += frame.normal;
            sum.count += 1.0;
          }
        }
      }
    }
    end(map, elements.size());
    std::vector<PredictedPatch> patches;
    patches.reserve(sums.size());
    for (const Sum& sum : sums) {
      const Eigen::Vector3d normal = sum.normal.normalized();
      patches.push_back({sum.position / sum.count, normal, step_ * step_ / normal.lpNorm<1>()});
    }
    return patches;
  }

 private:
  struct Cell {
    std::array<std::int32_t, 6> number{-1, -1, -1,
                                       -1, -1, -1};  ///< By the normal's main direction.
  };
  struct Sum {
    Eigen::Vector3d position, normal;
    double count;
  };
  /// An element's frame and the cells that its lanes lead through, step by step.
  struct Known {
    std::optional<SurfaceFrame> frame;
    std::array<std::uint32_t, 3> first{}, last{};  // steps in unknown space, by lane
    std::vector<std::uint32_t> cells;              // of all lanes, one after the other
    std::uint64_t turn = 0;                        // it was last asked for; 0: never
  };
  struct KeyHash {
    std::size_t operator()(const VoxelKey& k) const {
      const auto u = [](int i) {
        return static_cast<std::uint64_t>(static_cast<std::uint32_t>(i));
      };
      return static_cast<std::size_t>(mix64(mix64(u(k[0]) << 32 | u(k[1])) ^ u(k[2])));
    }
  };

  void begin(const VoxelStateMap& map, const PredictionOptions& o) {
    const double voxel = map.voxel_size();
    const double step = o.step.value_or(2.0 * voxel);
    require(o.reach > 0.0 && std::isfinite(o.reach) && o.reach <= 1e4 * step,
            "surface prediction: expected a reach of more than 0 and at most 10 000 steps");
    const bool other = map_ != &map || step != step_ || o.reach != options_.reach ||
                       o.window != options_.window || o.spread != options_.spread ||
                       o.region.min() != options_.region.min() ||
                       o.region.max() != options_.region.max();
    if (other || cells_ > kMostCells * cells_at_first_ + 4096) {
      *this = SurfacePredictor();
      map_ = &map;
      options_ = o;
      step_ = step;
      lattice_ = Lattice({.voxel_size = step});
      for (double s = 0.0; s <= o.reach; s += 0.5 * step) steps_.push_back(s);
      // Whatever a lane depends on is no farther off than this, in blocks.
      const double far = o.reach + (o.window + 2) * voxel;
      wide_ = static_cast<int>(std::ceil(far / (voxel * VoxelStateMap::Grid::kBlockSide)));
    }
    ++turn_;
    changed_.clear();
    near_change_.clear();
    for (const std::uint32_t slot : map.grid().changed_since(cursor_))
      changed_.insert(coarse(map.grid().block(slot).index));
  }
  void end(const VoxelStateMap& map, std::size_t elements) {
    cursor_ = map.grid().revision();
    if (cells_at_first_ == 0) cells_at_first_ = cells_;
    if (known_.size() > 2 * elements + 64)
      std::erase_if(known_, [&](const auto& k) { return k.second.turn != turn_; });
    frames_.end_turn(elements);
  }
  VoxelKey coarse(const BlockIndex& b) const {
    return {cell_of_width(b.x(), wide_), cell_of_width(b.y(), wide_), cell_of_width(b.z(), wide_)};
  }
  /// Since the last call.
  bool has_changed_around(const VoxelIndex& element) {
    const VoxelKey c = coarse(VoxelStateMap::Grid::block_of(element));
    if (c == last_asked_ && !near_change_.empty()) return last_answer_;
    const auto [it, fresh] = near_change_.try_emplace(c, false);
    if (fresh)
      for_each_index(VoxelIndex(c[0] - 1, c[1] - 1, c[2] - 1),
                     VoxelIndex(c[0] + 1, c[1] + 1, c[2] + 1),
                     [&, &changed = it->second](const VoxelIndex& beside) {
                       changed = changed || changed_.contains(key_of(beside));
                     });
    last_asked_ = c;
    return last_answer_ = it->second;
  }
  std::size_t lanes() const { return options_.spread > 0.0 ? 3 : 1; }
  Eigen::Vector3d direction(const SurfaceFrame& frame, std::size_t lane) const {
    const std::array<double, 3> angles = {0.0, options_.spread, -options_.spread};
    const Eigen::Vector3d across = frame.normal.cross(frame.tangent);
    return std::cos(angles[lane]) * frame.tangent + std::sin(angles[lane]) * across;
  }
  void walk(const VoxelStateMap& map, VoxelStateMap::Accessor& state, const VoxelIndex& element,
            Known& known) {
    known.cells.clear();
    known.frame = frames_(map, state, element, options_.window);
    if (!known.frame) return;
    const SurfaceFrame& frame = *known.frame;
    int main_axis = 0;
    frame.normal.cwiseAbs().maxCoeff(&main_axis);
    const auto side =
        static_cast<std::size_t>(2 * main_axis + (frame.normal[main_axis] > 0.0 ? 0 : 1));
    typename Lattice::Writer cells(lattice_);
    for (std::size_t lane = 0; lane < lanes(); ++lane) {
      const Eigen::Vector3d along = direction(frame, lane);
      std::size_t k = 0;
      const std::size_t before = known.cells.size();
      for (; k < steps_.size(); ++k) {
        const Point3 p = frame.point + steps_[k] * along;
        const bool entered = known.cells.size() > before;
        if (state(map.grid().index_of(p)) != VoxelState::unknown) {
          if (entered || steps_[k] > (options_.window + 1) * map.voxel_size()) break;
          continue;
        }
        if (!options_.region.isEmpty() && !options_.region.contains(p)) break;
        std::int32_t& number = cells.ensure(lattice_.index_of(p)).number[side];
        if (number < 0) number = static_cast<std::int32_t>(cells_++);
        known.cells.push_back(static_cast<std::uint32_t>(number));
      }
      known.last[lane] = static_cast<std::uint32_t>(k);
      known.first[lane] = static_cast<std::uint32_t>(k - (known.cells.size() - before));
    }
  }

  using Lattice = VoxelGrid<Cell, 4>;
  static constexpr std::size_t kMostCells = 8;  ///< Times those at first, before all are forgotten.

  const VoxelStateMap* map_ = nullptr;
  PredictionOptions options_;
  double step_ = 0.0;          // [m]
  std::vector<double> steps_;  // along a lane [m]
  int wide_ = 1;               // a coarse cell, in blocks
  std::uint64_t cursor_ = 0, turn_ = 0;
  Lattice lattice_{{.voxel_size = 1.0}};
  std::size_t cells_ = 0, cells_at_first_ = 0;
  std::unordered_map<VoxelKey, Known, KeyHash> known_;
  SurfaceFrameMemory frames_;
  std::unordered_set<VoxelKey, KeyHash> changed_;            // coarse cells, since the last call
  std::unordered_map<VoxelKey, bool, KeyHash> near_change_;  // of those asked about
  VoxelKey last_asked_{};
  bool last_answer_ = false;
};

/// What `SurfacePredictor` predicts of a map that does not change.
inline std::vector<PredictedPatch> predict_surface(std::span<const IncompleteElement> elements,
                                                   const VoxelStateMap& map,
                                                   const PredictionOptions& options = {}) {
  return SurfacePredictor()(elements, map, options);
}
template <NeighborhoodPolicy U, NeighborhoodPolicy O, NeighborhoodPolicy D>
std::vector<PredictedPatch> predict_surface(const BasicIncompleteSurface<U, O, D>& incomplete,
                                            const VoxelStateMap& map,
                                            const PredictionOptions& options = {}) {
  const std::vector<IncompleteElement> elements = incomplete.elements();
  return predict_surface(std::span<const IncompleteElement>(elements), map, options);
}
}  // namespace surfleet
