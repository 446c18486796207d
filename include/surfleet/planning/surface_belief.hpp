// SPDX-License-Identifier: MIT
/// @file
/// @brief What a robot or a fleet holds to be true of an unknown surface, and of the space around
/// it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/mapping/any_integrator.hpp>
#include <surfleet/mapping/surface_mesh.hpp>
#include <surfleet/mapping/voxel_state_map.hpp>
#include <surfleet/motion/free_space.hpp>
#include <surfleet/motion/lazy_prm.hpp>
#include <surfleet/planning/robot_kind.hpp>
#include <surfleet/viewpoint/coverage_estimate.hpp>
#include <surfleet/viewpoint/incomplete_surface.hpp>
#include <surfleet/viewpoint/sight_targets.hpp>
#include <surfleet/viewpoint/view_frustum.hpp>
#include <surfleet/viewpoint/view_ledger.hpp>

namespace surfleet {
struct SurfaceBeliefOptions {
  double voxel_size = 0.3;       ///< [m]
  double known_weight = 0.3;     ///< W_th: a voxel of at least this weight is known.
  double observed_share = 0.15;  ///< Share of W_th from which a voxel serves flight and sight.
  std::optional<double> truncation{};  ///< µ in place of that in `tsdf` [m]; nothing: three voxels.
  TsdfOptions tsdf{};
  /// Folds what is seen into the map, with the options above in place of its own; nothing: the
  /// projective one, whose weight 1/z² drops off behind the surface (`drop_off_by_voxels`).
  std::optional<AnyIntegrator> integrator{};
  ViewLedgerOptions ledger{};  ///< When an element is given up.
  Box3 region;                 ///< Where surface is to be reconstructed [m].
  std::uint64_t seed = 1;      ///< Of the roadmaps.
};

/// Space and views as robots of one kind have them.
struct KindSpace {
  RobotKind kind;
  FreeSpace free;
  LazyPrmStar roadmap;    ///< Not for concurrent use.
  HeadingTable headings;  ///< Of the kind's camera on its mount.
  ViewFrustum frustum;

  KindSpace(RobotKind k, const VoxelStateMap& flyable, double voxel, std::uint64_t seed)
      : kind(std::move(k)),
        free(flyable, {.radius = kind.body_radius,
                       .bounds = kind.bounds,
                       .margin = kind.margin.value_or(voxel),
                       .unknown_margin = kind.unknown_margin.value_or(kind.margin.value_or(voxel)),
                       .keep_out = kind.keep_out,
                       .shape = kind.shape}),
        roadmap(free, {.seed = seed}),
        headings(kind.camera, kind.T_body_camera, kind.pitches),
        frustum(kind.camera, kind.T_body_camera) {}
  KindSpace(const KindSpace&) = delete;
  KindSpace& operator=(const KindSpace&) = delete;
};

/// Map, voxel states, incomplete surface, free space and roadmap for each kind of robot, and what
/// was viewed in vain. Fed by images and scans at poses; everything follows the change with
/// `update`, at a cost by what has changed.
class SurfaceBelief {
 public:
  using Goal = IncompleteElement;

  /// Throws `Error` on options out of range or no kinds.
  SurfaceBelief(SurfaceBeliefOptions options, std::span<const RobotKind> kinds)
      : SurfaceBelief(options, kinds, TsdfMap({.voxel_size = options.voxel_size})) {}
  /// Goes on from what an earlier mission has left. Also throws if the voxels are of another size.
  SurfaceBelief(SurfaceBeliefOptions options, std::span<const RobotKind> kinds, TsdfMap map)
      : SurfaceBelief(std::move(options), kinds, std::move(map), nullptr) {}
  /// Follows a map that is made elsewhere, as of patches, and outlives it; takes no images.
  SurfaceBelief(SurfaceBeliefOptions options, std::span<const RobotKind> kinds, const TsdfMap* map)
      : SurfaceBelief(options, kinds, TsdfMap({.voxel_size = options.voxel_size}), map) {}
  SurfaceBelief(const SurfaceBelief&) = delete;
  SurfaceBelief& operator=(const SurfaceBelief&) = delete;

  /// The options with what nothing stands for. Throws `Error` on those out of range.
  static SurfaceBeliefOptions checked(SurfaceBeliefOptions o) {
    require(o.voxel_size > 0.0 && std::isfinite(o.voxel_size),
            "voxel size: expected a positive length");
    require(o.known_weight > 0.0 && o.observed_share > 0.0 && o.observed_share <= 1.0,
            "known weight: expected a positive weight and a share in (0, 1]");
    o.tsdf.truncation = o.truncation.value_or(3.0 * o.voxel_size);
    require(o.tsdf.truncation > 0.0 && std::isfinite(o.tsdf.truncation),
            "truncation: expected a positive length");
    if (!o.integrator) o.integrator = TsdfIntegrator(o.tsdf, drop_off_by_voxels(o.voxel_size));
    o.integrator->options = o.tsdf;
    return o;
  }

 private:
  SurfaceBelief(SurfaceBeliefOptions options, std::span<const RobotKind> kinds, TsdfMap own,
                const TsdfMap* followed)
      : options_(checked(std::move(options))),
        own_(std::move(own)),
        map_(followed != nullptr ? *followed : own_),
        known_(map_, {.known_weight = options_.known_weight}),
        observed_(map_, {.known_weight = options_.known_weight * options_.observed_share}),
        flyable_(map_, {.known_weight = options_.known_weight * options_.observed_share,
                        .occupied_below = 0.5 * options_.voxel_size}),
        incomplete_({.known_weight = options_.known_weight, .region = options_.region}),
        ledger_(options_.ledger) {
    require(!kinds.empty(), "kinds of robots: expected at least one");
    require(map_.voxel_size() == options_.voxel_size,
            "map: expected voxels of " + std::to_string(options_.voxel_size) + " m");
    incomplete_.update(known_);
    for (const RobotKind& kind : kinds)
      spaces_.push_back(
          std::make_unique<KindSpace>(kind, flyable_, options_.voxel_size, options_.seed));
  }

 public:
  // -- what comes in -----------------------------------------------------------------------------
  /// Takes what is unknown in `ball` for empty, for robots of this kind: where one starts.
  void add_known_free(RobotKindId kind, const Sphere& ball) {
    spaces_[kind]->free.add_known_free(ball);
  }
  /// An image or a scan, or whichever of them a sensor has given, from a pose of that sensor. Takes
  /// effect with the next `update`.
  template <typename Seen, typename Sensor>
  void integrate(const Seen& seen, const Sensor& sensor, const Pose& T_world_sensor) {
    require(&map_ == &own_, "belief: follows a map; expected images to go into that");
    (*options_.integrator)(seen, sensor, T_world_sensor, own_);
  }
  void update() {
    known_.update(map_);
    observed_.update(map_);
    flyable_.update(map_);
    incomplete_.update(known_);
    for (const auto& space : spaces_) {
      space->free.update();
      space->roadmap.update();
    }
    goals_stale_ = true;
  }
  /// See `ViewLedger`.
  void viewed_in_vain(const VoxelIndex& v, const Eigen::Vector3d& direction) {
    ledger_.viewed_in_vain(v, direction);
    goals_stale_ = true;
  }
  void not_reached(std::span<const VoxelIndex> voxels) {
    ledger_.not_reached(voxels);
    goals_stale_ = true;
  }

  /// What another robot of the same kind has noted.
  void add_notes(const ViewNotes& notes) {
    if (notes.empty()) return;
    ledger_.add(notes);
    goals_stale_ = true;
  }
  ViewNotes take_notes() { return ledger_.take_news(); }  ///< See `ViewLedger::take_news`.

  // -- what is held ------------------------------------------------------------------------------
  const SurfaceBeliefOptions& options() const { return options_; }
  const Box3& region() const { return options_.region; }
  double voxel_size() const { return options_.voxel_size; }
  const TsdfMap& map() const { return map_; }
  const VoxelStateMap& known() const { return known_; }        ///< States at W_th.
  const VoxelStateMap& observed() const { return observed_; }  ///< For lines of sight.
  const IncompleteSurface& incomplete() const { return incomplete_; }
  const ViewLedger& ledger() const { return ledger_; }
  std::size_t kinds() const { return spaces_.size(); }
  const KindSpace& space(RobotKindId kind) const { return *spaces_[kind]; }

  /// The elements still to be planned for, in voxel order; made when first asked for after a
  /// change. Not for concurrent use.
  const std::vector<Goal>& goals() const {
    if (goals_stale_) {
      goals_ = incomplete_.elements();
      std::erase_if(goals_, [&](const Goal& e) { return ledger_.given_up(e.voxel); });
      goals_stale_ = false;
    }
    return goals_;
  }
  /// Whether an element is incomplete and not given up.
  bool is_open(const VoxelIndex& v) const {
    return incomplete_.contains(v) && !ledger_.given_up(v);
  }
  /// Images or scans from `at` that make the surface in a voxel known: W_th over the integrator's
  /// weight, and no less than hits need, which weigh 1/z² whatever that is. Two more, as some err.
  std::size_t images_needed(const Point3& at, const VoxelIndex& v) const {
    constexpr double kMost = 1e9;
    const double z2 = (known_.grid().center(v) - at).squaredNorm();
    const double weight = options_.integrator->weight(0.0, std::sqrt(z2));
    const double images =
        options_.known_weight * std::max(1.0 / weight, SurfaceHit::kFaceShare * z2);
    return static_cast<std::size_t>(std::ceil(std::min(images, kMost))) + 2;
  }
  /// How complete the surface is by this belief's own account. O(surface).
  CoverageEstimate estimate_coverage() const {
    const TriangleMesh mesh = extract_surface(
        map_, {.min_weight = options_.known_weight, .threads = options_.tsdf.threads});
    return surfleet::estimate_coverage(map_, mesh, incomplete_, options_.known_weight,
                                       options_.region);
  }
  /// The map, when all is over; nothing else of the belief may be used after.
  TsdfMap take_map() { return std::move(own_); }

 private:
  SurfaceBeliefOptions options_;
  TsdfMap own_;
  const TsdfMap& map_;  // own_, unless it follows another
  VoxelStateMap known_, observed_, flyable_;
  IncompleteSurface incomplete_;
  ViewLedger ledger_;
  std::vector<std::unique_ptr<KindSpace>> spaces_;
  mutable std::vector<Goal> goals_;
  mutable bool goals_stale_ = true;
};
}  // namespace surfleet
