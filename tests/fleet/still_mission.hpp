// SPDX-License-Identifier: MIT
/// @file
/// @brief What planners are asked with in tests.
#pragma once

#include <span>
#include <vector>

#include <surfleet/fleet/plan.hpp>

namespace surfleet {
/// All that a planner is asked with, of a map that stands still.
struct StillMission {
  StillMission(const TsdfMap& map, const FreeSpaceOptions& body, PinholeCamera c, const Box3& box)
      : states(map), free(states, body), camera(c), region(box) {
    incomplete.update(states);
    work = incomplete.elements();
  }
  StillMission(const StillMission&) = delete;
  StillMission& operator=(const StillMission&) = delete;

  PlanRequest request(std::span<const RobotRequest> robots) {
    return {.work = work,
            .incomplete = incomplete,
            .known = states,
            .observed = states,
            .ledger = ledger,
            .free_space = free,
            .roadmap = roadmap,
            .camera = camera,
            .T_body_camera = mount,
            .headings = headings,
            .region = region,
            .robots = robots};
  }

  const VoxelStateMap states;
  const FreeSpace free;
  LazyPrmStar roadmap{free};
  IncompleteSurface incomplete;
  std::vector<IncompleteElement> work;
  const PinholeCamera camera;
  const Pose mount = forward_camera_mount();
  const HeadingTable headings{camera, mount};
  const LookLedger ledger;
  const Box3 region;
};
}  // namespace surfleet
