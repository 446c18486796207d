// SPDX-License-Identifier: MIT
/// @file
/// @brief Everything of the fleet room: what robots do with plans, alone and together.
#pragma once

#include <surfleet/fleet/fwd.hpp>

#include <surfleet/fleet/agent.hpp>
#include <surfleet/fleet/agent_options.hpp>
#include <surfleet/fleet/as_traffic.hpp>
#include <surfleet/fleet/central_planning.hpp>
#include <surfleet/fleet/coverage_goal.hpp>
#include <surfleet/fleet/distributed_agent.hpp>
#include <surfleet/fleet/distributed_options.hpp>
#include <surfleet/fleet/endurance.hpp>
#include <surfleet/fleet/impaired.hpp>
#include <surfleet/fleet/message_drops.hpp>
#include <surfleet/fleet/message_guard.hpp>
#include <surfleet/fleet/network_conditions.hpp>
#include <surfleet/fleet/packet.hpp>
#include <surfleet/fleet/patch_ids.hpp>
#include <surfleet/fleet/patch_sync.hpp>
#include <surfleet/fleet/plan_requests.hpp>
#include <surfleet/fleet/redundancy.hpp>
#include <surfleet/fleet/robot_body.hpp>
#include <surfleet/fleet/robot_news.hpp>
#include <surfleet/fleet/single_agent.hpp>
#include <surfleet/fleet/stall_watch.hpp>
#include <surfleet/fleet/team_agreement.hpp>
#include <surfleet/fleet/team_end.hpp>
#include <surfleet/fleet/team_relay.hpp>
#include <surfleet/fleet/way_home.hpp>
