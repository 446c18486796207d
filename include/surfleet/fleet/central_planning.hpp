// SPDX-License-Identifier: MIT
/// @file
/// @brief One planner for a whole fleet on one belief: the single and the centralised architecture.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include <surfleet/fleet/agent.hpp>
#include <surfleet/fleet/plan_requests.hpp>
#include <surfleet/planning/plan.hpp>

namespace surfleet {
/// Asks the planner when a robot asks for work, and knows when there is none left [000 ch. 2, 3].
template <FleetPlanner Planner>
class CentralPlanning {
 public:
  PlanRequests<Planner> requests;

  explicit CentralPlanning(Planner p = {}) : requests(std::move(p)) {}

  /// Plans if that is due, hands out the routes, and lets all set out. `agents` are the team's, by
  /// ascending id. Nothing while any robot still turns for its first views.
  template <typename Agents>
  void operator()(Agents& agents, const SurfaceBelief& belief, double time) {
    bool ask = all_at_rest(agents) || requests.is_due(belief);
    for (const auto& a : agents) {
      if (a->scanning()) return;
      ask = ask || a->asks(time);
    }
    if (ask) request(agents, belief, time);
    for (auto& a : agents) a->set_out(time);
  }
  /// Done when no robot has anything to do and the planner, asked on this very map, found nothing,
  /// or time after time nothing that can be reached.
  template <typename Agents>
  bool finished(const Agents& agents, const SurfaceBelief& belief) const {
    return all_at_rest(agents) && requests.exhausted(belief);
  }

 private:
  template <typename Agents>
  static bool all_at_rest(const Agents& agents) {
    for (const auto& a : agents)
      if (!a->at_rest()) return false;
    return true;
  }
  template <typename Agents>
  void request(Agents& agents, const SurfaceBelief& belief, double time) {
    std::vector<RobotState> team;
    std::vector<RobotId> asked;
    std::size_t departures = 0;
    const bool all = requests.is_due(belief);
    for (const auto& a : agents) {
      team.push_back(a->state(time));
      if (a->is_free() || (all && !a->stop_reason())) asked.push_back(team.back().id);
      departures += a->departures();
    }
    Plan plan = requests(belief, asked, team, departures, all_at_rest(agents), time);
    for (std::size_t k = 0; k < team.size(); ++k)
      if (const auto route = plan.routes.find(team[k].id); route != plan.routes.end())
        agents[k]->accept(std::move(route->second), plan.replan, time);
  }
};
}  // namespace surfleet
