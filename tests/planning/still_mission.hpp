// SPDX-License-Identifier: MIT
/// @file
/// @brief What planners are asked in tests.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include <surfleet/planning/plan.hpp>
#include <surfleet/planning/surface_belief.hpp>

namespace surfleet {
/// A robot of a team in tests.
struct Teammate {
  Configuration configuration;
  bool idle = true;  ///< It is asked for.
  Stops remaining;
};

/// A team's robots by their places in a list, and those of them that are asked for.
struct Team {
  explicit Team(std::span<const Teammate> mates) {
    for (const Teammate& m : mates) {
      const auto id = static_cast<RobotId>(robots.size());
      robots.push_back({.id = id, .at = m.configuration, .route = m.remaining, .idle = m.idle});
      if (m.idle) asked.push_back(id);
    }
  }
  std::vector<RobotState> robots;
  std::vector<RobotId> asked;
};

/// A belief in a map that stands still.
struct StillMission {
  StillMission(TsdfMap map, const FreeSpaceOptions& body, const PinholeCamera& c, const Box3& box)
      : StillMission(std::move(map), kind_of(body, c), box) {}
  StillMission(TsdfMap map, RobotKind kind, const Box3& box)
      : belief({.voxel_size = map.voxel_size(), .observed_share = 1.0, .region = box},
               std::span<const RobotKind>(&kind, 1), std::move(map)) {}
  StillMission(const StillMission&) = delete;
  StillMission& operator=(const StillMission&) = delete;

  /// Holds until it is asked for again.
  SurfaceSituation situation(std::span<const Teammate> mates) {
    team = Team(mates);
    return {.belief = belief, .goals = belief.goals(), .asked = team.asked, .team = team.robots};
  }

  static RobotKind kind_of(const FreeSpaceOptions& body, const PinholeCamera& c) {
    RobotKind kind;
    kind.camera = c;
    kind.body_radius = body.radius;
    kind.margin = body.margin;
    kind.unknown_margin = body.unknown_margin;
    kind.bounds = body.bounds;
    kind.keep_out = body.keep_out;
    return kind;
  }

  SurfaceBelief belief;
  Team team{{}};
  const VoxelStateMap& states = belief.known();
  const FreeSpace& free = belief.space(0).free;
  const LazyPrmStar& roadmap = belief.space(0).roadmap;
  const std::vector<IncompleteElement>& work = belief.goals();
  const PinholeCamera& camera = belief.space(0).kind.camera;
  const Pose& mount = belief.space(0).kind.T_body_camera;
};
}  // namespace surfleet
