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
#include <vector>

#include <surfleet/core/error.hpp>
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
  double reach = 5.0;  ///< How far the surface is continued [m].
  double step = 0.0;   ///< Edge of the patches [m]; 0: two voxels.
  int window = 2;      ///< Half the side of the cube of voxels that frames are fitted to [voxels].
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
/// plane through unknown voxels for up to `reach`, and end where the map is known again.
///
/// Lanes leave along the tangent and `spread` to both sides of it. Patches that fall into the same
/// cell of a lattice of `step`, facing alike, are one, averaged. A patch's area is what a plane of
/// its slope takes of a cell on average. In the order of the elements that first led there.
/// O(elements × reach / step). `frames` serves later calls for the same map.
inline std::vector<PredictedPatch> predict_surface(std::span<const IncompleteElement> elements,
                                                   const VoxelStateMap& map,
                                                   const PredictionOptions& options,
                                                   SurfaceFrameMemory& frames) {
  const double voxel = map.voxel_size();
  const double step = options.step > 0.0 ? options.step : 2.0 * voxel;
  require(options.reach > 0.0 && std::isfinite(options.reach) && options.reach <= 1e4 * step,
          "surface prediction: expected a reach of more than 0 and at most 10 000 steps");
  struct Cell {
    std::array<std::int32_t, 6> patch{-1, -1, -1, -1, -1, -1};  ///< By the normal's main direction.
  };
  struct Sum {
    Eigen::Vector3d position, normal;
    double count;
  };
  using Lattice = VoxelGrid<Cell, 4>;
  Lattice lattice({.voxel_size = step});
  Lattice::Writer cells(lattice);
  std::vector<Sum> sums;
  VoxelStateMap::Accessor state(map);
  const VoxelStateMap::Grid& grid = map.grid();

  const std::array<double, 3> angles = {0.0, options.spread, -options.spread};
  const double stride = 0.5 * step;
  for (const IncompleteElement& e : elements) {
    const auto frame = frames(map, state, e.voxel, options.window);
    if (!frame) continue;
    int main_axis = 0;
    frame->normal.cwiseAbs().maxCoeff(&main_axis);
    const auto side =
        static_cast<std::size_t>(2 * main_axis + (frame->normal[main_axis] > 0.0 ? 0 : 1));
    const Eigen::Vector3d across = frame->normal.cross(frame->tangent);
    const std::size_t lanes = options.spread > 0.0 ? 3 : 1;
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const Eigen::Vector3d along =
          std::cos(angles[lane]) * frame->tangent + std::sin(angles[lane]) * across;
      bool entered = false;
      for (double s = 0.0; s <= options.reach; s += stride) {
        const Point3 p = frame->point + s * along;
        if (state(grid.index_of(p)) != VoxelState::unknown) {
          if (entered || s > (options.window + 1) * voxel) break;
          continue;
        }
        entered = true;
        if (!options.region.isEmpty() && !options.region.contains(p)) break;
        std::int32_t& id = cells.ensure(lattice.index_of(p)).patch[side];
        if (id < 0) {
          id = static_cast<std::int32_t>(sums.size());
          sums.push_back({p, frame->normal, 1.0});
        } else {
          Sum& sum = sums[static_cast<std::size_t>(id)];
          sum.position += p;
          sum.normal += frame->normal;
          sum.count += 1.0;
        }
      }
    }
  }
  frames.end_turn(elements.size());
  std::vector<PredictedPatch> patches;
  patches.reserve(sums.size());
  for (const Sum& sum : sums) {
    const Eigen::Vector3d normal = sum.normal.normalized();
    patches.push_back({sum.position / sum.count, normal, step * step / normal.lpNorm<1>()});
  }
  return patches;
}
inline std::vector<PredictedPatch> predict_surface(std::span<const IncompleteElement> elements,
                                                   const VoxelStateMap& map,
                                                   const PredictionOptions& options = {}) {
  SurfaceFrameMemory frames;
  return predict_surface(elements, map, options, frames);
}
template <NeighborhoodPolicy U, NeighborhoodPolicy O, NeighborhoodPolicy D>
std::vector<PredictedPatch> predict_surface(const BasicIncompleteSurface<U, O, D>& incomplete,
                                            const VoxelStateMap& map,
                                            const PredictionOptions& options = {}) {
  const std::vector<IncompleteElement> elements = incomplete.elements();
  return predict_surface(std::span<const IncompleteElement>(elements), map, options);
}
}  // namespace surfleet
