// SPDX-License-Identifier: MIT
/// @file
/// @brief The whole library but the adapters.
#pragma once

#include <surfleet/allocation.hpp>
#include <surfleet/core.hpp>
#include <surfleet/coverage.hpp>
#include <surfleet/evaluation.hpp>
#include <surfleet/fleet.hpp>
#include <surfleet/geometry.hpp>
#include <surfleet/localization.hpp>
#include <surfleet/mapping.hpp>
#include <surfleet/motion.hpp>
#include <surfleet/planning.hpp>
#include <surfleet/simulation.hpp>
#include <surfleet/surface.hpp>
#include <surfleet/viewpoint.hpp>
