// SPDX-License-Identifier: MIT
/// @file
/// @brief How the planners that have names are made.
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include <surfleet/core/compiled.hpp>
#include <surfleet/planning/default_planner.hpp>
#include <surfleet/planning/named_planners.hpp>

namespace surfleet {
SURFLEET_INLINE AnyPlanner make_planner(std::string_view name, const PlannerSettings& settings) {
  const TourPlannerOptions tours =
      published_tours(settings, planner_by_name(name).bounded_clusters);
  TourPlannerOptions asynchronous = tours;
  asynchronous.asynchronous = true;
  const auto made = [&](auto planner) {
    if constexpr (requires { planner.select.merge; }) planner.select.merge = settings.merge;
    return AnyPlanner(
        WithSpaceLooks(std::move(planner), SpaceLooksOptions{.distance = settings.standoff}));
  };
  if (name == "surfleet") return default_planner(settings);
  if (name == "tsga") return made(TsgaPlanner(tours));
  if (name == "nnb-exclusive") return made(NnbPlanner(asynchronous));
  if (name == "nnb") {
    // As printed: every robot chooses for itself, and two may choose the same cluster.
    asynchronous.exclusive = false;
    // It chooses anew "every time the ISE map is updated" [000 §3.6.1].
    asynchronous.replan.utility_share = settings.utility_share.value_or(0.1);
    NnbPlanner planner(asynchronous);
    planner.allocate.rule.exclusive = false;
    return made(std::move(planner));
  }
  if (name == "tsga-async") return made(TsgaPlanner(asynchronous));
  if (name == "tsga-improved") return made(ImprovedTsgaPlanner(tours));
  if (name == "makespan") return made(MakespanPlanner(tours));
  if (name == "tours") return made(CoverPlanner(reordered_tours(settings)));
  if (name == "rate") return made(RatePlanner(rate_options(settings)));
  throw Error("planner " + std::string(name) + ": named, but not made");
}
}  // namespace surfleet
