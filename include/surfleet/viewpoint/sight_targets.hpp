// SPDX-License-Identifier: MIT
/// @file
/// @brief Sight targets, and which of them a camera at a given place would see.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/geometry/pinhole_camera.hpp>
#include <surfleet/geometry/ray_caster.hpp>
#include <surfleet/mapping/voxel_grid.hpp>
#include <surfleet/mapping/voxel_state_map.hpp>
#include <surfleet/mapping/voxel_traversal.hpp>

namespace surfleet {
/// A point of the surface, observed or predicted, that is to be viewed.
struct SightTarget {
  Point3 position = Point3::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< Side to view it from; zero if any.
  double gain = 0.0;                                 ///< Area it stands for [m²].
  int unknown_before = 0;  ///< How many unknown voxels the line of sight may pass.
};

/// Headings are tried in steps of a turn's sixteenth.
constexpr int kHeadings = 16;
inline double heading_angle(int k) { return wrap_angle(2.0 * kPi * k / kHeadings); }
/// The step nearest to a yaw angle.
inline int nearest_heading(double yaw) {
  const int k = static_cast<int>(std::lround(yaw / (2.0 * kPi) * kHeadings)) % kHeadings;
  return k < 0 ? k + kHeadings : k;
}

/// A place has a view for each heading and each pitch of a gimbal: those of the first pitch by
/// heading, then those of the next.
constexpr int kMostPitches = 4;
constexpr int kMostViews = kHeadings * kMostPitches;
using ViewBits = std::uint64_t;  ///< Views of a place, a bit each.
inline bool has_view(ViewBits views, int view) { return (views >> view & 1U) != 0; }

/// The gain of each view of a place; at first 0.
class GainByView {
 public:
  explicit GainByView(int views = kHeadings) : views_(static_cast<std::size_t>(views)) {
    fill(0.0);
  }
  std::size_t size() const { return views_; }
  double& operator[](std::size_t view) { return gain_[view]; }
  double operator[](std::size_t view) const { return gain_[view]; }
  const double* begin() const { return gain_.data(); }
  const double* end() const { return gain_.data() + views_; }
  double most() const { return *std::max_element(begin(), end()); }
  void fill(double gain) { std::fill_n(gain_.begin(), views_, gain); }

 private:
  std::array<double, kMostViews> gain_;
  std::size_t views_;
};

/// A target in view, and the views that have it.
struct Sighting {
  std::int32_t target = 0;
  ViewBits views = 0;
};

/// The views in which a mounted camera has a direction in its image, looked up in octahedral maps
/// of directions with cells of about a degree. The camera is taken to sit where the body is: how
/// far from its middle it is mounted is neglected.
///
/// A camera's range is a depth, so it sees farther towards the corners of its image than ahead. The
/// table has a map for each of some shells of distance: the s-th has the views in which all that is
/// no farther than `shell_end(s)` times a depth is no deeper than that. 192 KiB a pitch.
class HeadingTable {
  static constexpr int kSide = 128;

 public:
  static constexpr int kShells = 6;

  /// By the pitches of `Configuration` that a gimbal can take [rad]; throws `Error` unless there
  /// are 1 to 4, of a quarter turn at the most.
  HeadingTable(const PinholeCamera& camera, const Pose& T_body_camera,
               std::vector<double> pitches = {0.0})
      : pitches_(std::move(pitches)) {
    require(!pitches_.empty() && pitches_.size() <= static_cast<std::size_t>(kMostPitches),
            "pitches of a gimbal: expected 1 to " + std::to_string(kMostPitches));
    for (const double p : pitches_)
      require(std::abs(p) <= 0.5 * kPi, "pitches of a gimbal: expected a quarter turn at the most");
    std::vector<Eigen::Matrix3d> R_camera_world;
    for (int v = 0; v < views(); ++v)
      R_camera_world.push_back(
          camera_pose(at(Point3::Zero(), v), T_body_camera).linear().transpose());
    stretch_ = Eigen::Vector3d(std::max(camera.cx, camera.width - 1 - camera.cx) / camera.fx,
                               std::max(camera.cy, camera.height - 1 - camera.cy) / camera.fy, 1.0)
                   .norm();
    nearest_ = camera.min_range * stretch_;
    range_ = camera.max_range;
    headings_.assign(pitches_.size() * kMap, 0);
    directions_.resize(R_camera_world.size());
    for (int v = 0; v < kSide; ++v)
      for (int u = 0; u < kSide; ++u) {
        const Eigen::Vector3d d =
            unfold((u + 0.5) * 2.0 / kSide - 1.0, (v + 0.5) * 2.0 / kSide - 1.0);
        const double length = d.norm();
        for (std::size_t k = 0; k < R_camera_world.size(); ++k) {
          const Eigen::Vector3d in_camera = R_camera_world[k] * d;
          if (!camera.project(in_camera)) continue;
          const std::size_t map = k / kHeadings * kMap, bit = k % kHeadings;
          for (int s = 0; s < kShells; ++s)
            if (s == 0 || shell_end(s) * in_camera.z() <= length)
              headings_[map + static_cast<std::size_t>(s * kCells + v * kSide + u)] |=
                  static_cast<std::uint16_t>(1U << bit);
          for (const int du : {0, 1})
            for (const int dv : {0, 1})
              directions_[k].extend(
                  unfold((u + du) * 2.0 / kSide - 1.0, (v + dv) * 2.0 / kSide - 1.0).normalized());
        }
      }
  }

  int views() const { return kHeadings * static_cast<int>(pitches_.size()); }
  Configuration at(const Point3& place, int view) const {
    return {place, heading_angle(view % kHeadings),
            pitches_[static_cast<std::size_t>(view / kHeadings)]};
  }
  int nearest_view(const Configuration& q) const {
    const auto off = [&](double pitch) { return std::abs(pitch - q.pitch); };
    const auto pitch = std::min_element(pitches_.begin(), pitches_.end(),
                                        [&](double a, double b) { return off(a) < off(b); });
    return nearest_heading(q.yaw) + kHeadings * static_cast<int>(pitch - pitches_.begin());
  }

  /// Where a shell ends, over the depth.
  double shell_end(int shell) const {
    return 1.0 + (stretch_ - 1.0) * shell / static_cast<double>(kShells - 1);
  }
  /// The views of a direction in the world of any length; that of zero is up.
  ViewBits operator()(const Eigen::Vector3d& d) const { return (*this)[cell(d.x(), d.y(), d.z())]; }
  /// The views of a cell of the first shell; `kCells` on is that of the next.
  ViewBits operator[](int cell) const {
    ViewBits bits = 0;
    for (std::size_t p = 0; p < pitches_.size(); ++p)
      bits |= ViewBits{headings_[p * kMap + static_cast<std::size_t>(cell)]} << (kHeadings * p);
    return bits;
  }
  /// The cell of a direction. Without branches, so that a loop over it becomes one over vectors.
  static int cell(double x, double y, double z) {
    const double scale = 1.0 / (std::abs(x) + std::abs(y) + std::abs(z) + 1e-30);
    const double u0 = x * scale, v0 = y * scale;
    // The lower half is folded outwards, by as much as it is below.
    const double below = 0.5 * (std::abs(z) - z) * scale;
    const double u = u0 + std::copysign(below, u0), v = v0 + std::copysign(below, v0);
    const int i = std::min(kSide - 1, static_cast<int>((u + 1.0) * (0.5 * kSide)));
    const int j = std::min(kSide - 1, static_cast<int>((v + 1.0) * (0.5 * kSide)));
    return j * kSide + i;
  }
  static constexpr int kCells = kSide * kSide;       ///< Of a shell.
  static constexpr int kNowhere = kShells * kCells;  ///< A cell without views.
  /// The box around the unit directions in a view, cells by their corners.
  const Box3& directions(int view) const { return directions_[static_cast<std::size_t>(view)]; }
  /// How far the corners of the image see, over the depth.
  double stretch() const { return stretch_; }
  /// From this distance on, the nearest depth is kept all over the image [m].
  double nearest() const { return nearest_; }
  /// The camera's farthest depth [m].
  double range() const { return range_; }

 private:
  static Eigen::Vector3d unfold(double u, double v) {
    Eigen::Vector3d d(u, v, 1.0 - std::abs(u) - std::abs(v));
    if (d.z() < 0.0) {
      d.x() = (1.0 - std::abs(v)) * (u < 0.0 ? -1.0 : 1.0);
      d.y() = (1.0 - std::abs(u)) * (v < 0.0 ? -1.0 : 1.0);
    }
    return d;
  }

  static constexpr std::size_t kMap = kNowhere + 1;

  std::vector<double> pitches_;
  std::vector<std::uint16_t> headings_;  // by pitch, shell and cell
  std::vector<Box3> directions_;         // by view
  double nearest_ = 0.0, range_ = 0.0, stretch_ = 1.0;
};

/// What ends a line of sight: `sees(p, target)` is true if the target shows from `p`. Copied for
/// every place that is asked about, so it may cache the last voxel block.
template <typename S>
concept TargetSight = std::copy_constructible<S> &&
    requires(S& sees, const Point3& p, const SightTarget& target) {
  { sees(p, target) } -> std::convertible_to<bool>;
};

/// Sight through a map: occupied voxels end it, and more unknown ones than the target allows.
/// O(voxels and clear cubes on the line).
class MapSight {
 public:
  explicit MapSight(const VoxelStateMap& map) : map_(&map), states_(map) {}
  /// From now on unknown voxels are taken for empty, whatever targets say.
  void see_through_unknown() { through_unknown_ = true; }
  bool operator()(const Point3& p, const SightTarget& t) {
    const VoxelIndex goal = map_->grid().index_of(t.position);
    int unknown = 0;
    return traverse_voxels(p, t.position, map_->voxel_size(), [&](const VoxelIndex& v) {
      if (const int side = states_.clear_cube(v, through_unknown_)) return side;
      if (v == goal) return 1;
      const VoxelState s = states_(v);
      return static_cast<int>(
          s == VoxelState::empty ||
          (s == VoxelState::unknown && (through_unknown_ || ++unknown <= t.unknown_before)));
    });
  }

 private:
  const VoxelStateMap* map_;
  VoxelStateMap::Accessor states_;
  bool through_unknown_ = false;
};

/// Sight past triangles that are known. A ray cast each.
template <RayCaster Caster>
class MeshSight {
 public:
  explicit MeshSight(const Caster& caster) : caster_(&caster) {}
  bool operator()(const Point3& p, const SightTarget& t) {
    const Eigen::Vector3d d = t.position - p;
    const double distance = d.norm();
    return !caster_->cast(p, d / distance, distance - kSkin);
  }

 private:
  static constexpr double kSkin = 1e-3;  ///< The target's own surface does not hide it [m].
  const Caster* caster_;
};

struct TargetSightOptions {
  /// Of the farthest useful view [m]; nothing: the camera's range.
  std::optional<double> max_range{};
  double max_incidence = 1.4;  ///< Greatest angle between the normal and the line of sight [rad].
  bool by_depth = false;       ///< `max_range` is a depth, as the camera's range is.
};

/// Finds what is in view from a position, by rows of targets along x and a line of sight to each
/// candidate.
template <TargetSight Sight = MapSight>
class SightTargets {
 public:
  /// The table must outlive this object. O(targets · log targets).
  SightTargets(std::vector<SightTarget> targets, Sight sight, const HeadingTable& headings,
               TargetSightOptions options = {})
      : targets_(std::move(targets)),
        sight_(std::move(sight)),
        headings_(&headings),
        reach_(options.max_range.value_or(headings.range()) *
               (options.by_depth ? headings.stretch() : 1.0)),
        rows_({.voxel_size = reach_ / kRows}) {
    for (int k = 0; options.by_depth && k + 1 < HeadingTable::kShells; ++k) {
      const double end = reach_ * headings.shell_end(k) / headings.stretch();
      shell_ends_.push_back(end * end);
    }
    const double least = std::cos(options.max_incidence);
    std::vector<std::uint32_t> slots;  // of the targets' rows
    slots.reserve(targets_.size());
    for (const SightTarget& t : targets_) {
      slots.push_back(rows_.ensure_slot(row_of(t.position)));
      ++row(slots.back()).end;
    }
    std::size_t next = 0;
    for (std::uint32_t slot = 0; slot < rows_.block_count(); ++slot) {
      const std::size_t count = row(slot).end;
      row(slot) = {next, next};
      next += count;
    }
    std::vector<std::pair<double, std::int32_t>> order(targets_.size());  // x and target
    for (std::size_t i = 0; i < targets_.size(); ++i)
      order[row(slots[i]).end++] = {targets_[i].position.x(), static_cast<std::int32_t>(i)};
    const auto at = [&](std::size_t k) { return order.begin() + static_cast<std::ptrdiff_t>(k); };
    for (std::uint32_t slot = 0; slot < rows_.block_count(); ++slot)
      std::sort(at(row(slot).begin), at(row(slot).end));
    // A loop over lanes may read on beyond the last one.
    for (auto* lanes : {&position_[0], &position_[1], &position_[2], &normal_[0], &normal_[1],
                        &normal_[2], &least_cosine_})
      lanes->reserve(targets_.size() + kLanes);
    ids_.reserve(targets_.size());
    for (const auto& [x, id] : order) {
      const SightTarget& t = targets_[static_cast<std::size_t>(id)];
      ids_.push_back(id);
      for (std::size_t i = 0; i < 3; ++i) {
        const auto axis = static_cast<Eigen::Index>(i);
        position_[i].push_back(t.position[axis]);
        normal_[i].push_back(t.normal[axis]);
      }
      const double cosine = t.normal.isZero() ? -1.0 : least;
      least_cosine_.push_back(cosine * std::abs(cosine));
    }
    for (auto* lanes : {&position_[0], &position_[1], &position_[2], &normal_[0], &normal_[1],
                        &normal_[2], &least_cosine_})
      lanes->resize(ids_.size() + kLanes, 0.0);
  }

  std::size_t size() const { return targets_.size(); }
  const SightTarget& operator[](std::size_t i) const { return targets_[i]; }
  std::span<const SightTarget> all() const { return targets_; }
  /// Range of views [m].
  double reach() const { return reach_; }

  /// The targets that would be in view from `p` if nothing occluded them, in the buffer, which
  /// grows as needed: one a thread, for all places. O(targets within reach).
  std::span<const Sighting> in_view(const Point3& p, std::vector<Sighting>& buffer) const {
    std::size_t count = 0;
    const double width = rows_.voxel_size();
    const VoxelIndex home = row_of(p);
    const auto gap = [&](double at, int cell) {  // from a coordinate to a row's
      return std::max({0.0, cell * width - at, at - (cell + 1) * width});
    };
    for (int z = home.z() - kRows; z <= home.z() + kRows; ++z)
      for (int y = home.y() - kRows; y <= home.y() + kRows; ++y) {
        const double dy = gap(p.y(), y), dz = gap(p.z(), z);
        const double rest = reach_ * reach_ - dy * dy - dz * dz;
        const Row* row = rest < 0.0 ? nullptr : rows_.find({0, y, z});
        if (row == nullptr) continue;
        const double half = std::sqrt(rest);
        const auto xs = position_[0].begin();
        const auto at = [&](std::size_t k) { return xs + static_cast<std::ptrdiff_t>(k); };
        const auto low = std::lower_bound(at(row->begin), at(row->end), p.x() - half);
        const auto high = std::upper_bound(low, at(row->end), p.x() + half);
        const auto last = static_cast<std::size_t>(high - xs);
        buffer.resize(std::max(buffer.size(), count + static_cast<std::size_t>(high - low)));
        for (auto k = static_cast<std::size_t>(low - xs); k < last; k += kLanes) {
          const std::array<int, kLanes> cells = cells_from(p, k);
          // Whether one is in view is as good as random, so it is written in any case.
          for (std::size_t i = 0; i < std::min(kLanes, last - k); ++i) {
            const ViewBits bits = (*headings_)[cells[i]];
            buffer[count] = {ids_[k + i], bits};
            count += bits != 0 ? 1 : 0;
          }
        }
      }
    return std::span<const Sighting>(buffer).first(count);
  }
  const HeadingTable& headings() const { return *headings_; }
  /// What tells whether a target shows from a place.
  Sight sight() const { return sight_; }
  /// The targets in view from `p` and in sight, those of a row beside each other. A line of sight
  /// for each in view.
  std::vector<Sighting> seen_from(const Point3& p) const {
    std::vector<Sighting> buffer, seen;
    Sight sees = sight_;
    for (const Sighting& s : in_view(p, buffer))
      if (sees(p, targets_[static_cast<std::size_t>(s.target)])) seen.push_back(s);
    return seen;
  }

 private:
  /// Where the targets of a row are in the lanes.
  struct Row {
    std::size_t begin = 0, end = 0;
  };
  static constexpr int kRows = 3;  // to the reach
  static constexpr std::size_t kLanes = 8;

  Row& row(std::uint32_t slot) { return rows_.block(slot).voxels[0]; }
  VoxelIndex row_of(const Point3& p) const {
    VoxelIndex row = rows_.index_of(p);
    row.x() = 0;
    return row;
  }
  /// The cells of the directions from `p` to the targets from the k-th on; of those too far, too
  /// near or turned away a cell without views.
  std::array<int, kLanes> cells_from(const Point3& p, std::size_t k) const {
    const double farthest = reach_ * reach_, nearest = headings_->nearest() * headings_->nearest();
    std::array<int, kLanes> cells;
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double x = position_[0][k + i] - p.x(), y = position_[1][k + i] - p.y(),
                   z = position_[2][k + i] - p.z();
      const double squared = x * x + y * y + z * z;
      const double towards =
          -(x * normal_[0][k + i] + y * normal_[1][k + i] + z * normal_[2][k + i]);
      const bool in_view = (squared <= farthest) & (squared >= nearest) &
                           (towards * std::abs(towards) >= squared * least_cosine_[k + i]);
      const int mask = -static_cast<int>(in_view);
      cells[i] = (HeadingTable::cell(x, y, z) & mask) | (HeadingTable::kNowhere & ~mask);
    }
    if (!shell_ends_.empty()) enter_shells(p, k, cells);
    return cells;
  }
  /// Moves cells on to the shells that the targets are in.
  void enter_shells(const Point3& p, std::size_t k, std::array<int, kLanes>& cells) const {
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double x = position_[0][k + i] - p.x(), y = position_[1][k + i] - p.y(),
                   z = position_[2][k + i] - p.z();
      const double squared = x * x + y * y + z * z;
      int shell = 0;
      for (const double end : shell_ends_) shell += static_cast<int>(squared > end);
      cells[i] = std::min(cells[i] + shell * HeadingTable::kCells, HeadingTable::kNowhere);
    }
  }

  std::vector<SightTarget> targets_;
  Sight sight_;
  const HeadingTable* headings_;
  double reach_;
  std::vector<double> shell_ends_;  // squared; none where distances count
  VoxelGrid<Row, 1> rows_;
  // Of the targets by row, along x:
  std::vector<std::int32_t> ids_;
  std::array<std::vector<double>, 3> position_, normal_;
  std::vector<double> least_cosine_;  // between normal and line of sight, squared with its sign
};

/// Marks in `done` the targets in a view; `fn(id)` is told of those not marked before.
template <typename Fn>
void mark_in_view(std::span<const Sighting> seen, int view, std::vector<char>& done, Fn&& fn) {
  for (const Sighting& s : seen) {
    const auto id = static_cast<std::size_t>(s.target);
    if (!has_view(s.views, view) || done[id] != 0) continue;
    done[id] = 1;
    fn(id);
  }
}

/// What every view shows; targets marked in `done` count nothing.
template <typename Sight>
GainByView gain_by_view(const SightTargets<Sight>& targets, std::span<const Sighting> seen,
                        std::span<const char> done) {
  GainByView gain(targets.headings().views());
  for (const Sighting& s : seen) {
    const auto id = static_cast<std::size_t>(s.target);
    if (done[id] != 0) continue;
    for (ViewBits bits = s.views; bits != 0; bits &= bits - 1)
      gain[static_cast<std::size_t>(std::countr_zero(bits))] += targets[id].gain;
  }
  return gain;
}
}  // namespace surfleet
