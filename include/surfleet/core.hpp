// SPDX-License-Identifier: MIT
/// @file
/// @brief Everything of the core room.
#pragma once

#include <surfleet/core/fwd.hpp>

#include <surfleet/core/assert.hpp>
#include <surfleet/core/binary_io.hpp>
#include <surfleet/core/compiled.hpp>
#include <surfleet/core/disjoint_sets.hpp>
#include <surfleet/core/error.hpp>
#include <surfleet/core/pace.hpp>
#include <surfleet/core/parallel.hpp>
#include <surfleet/core/parse_number.hpp>
#include <surfleet/core/random.hpp>
#include <surfleet/core/rotation.hpp>
#include <surfleet/core/transport.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/core/version.hpp>
