// SPDX-License-Identifier: MIT
/// @file
/// @brief The assertion for what only a bug can break. Define `SURFLEET_ASSERT` before inclusion to
/// send failures elsewhere.
#pragma once

#ifndef SURFLEET_ASSERT
#include <cassert>
#define SURFLEET_ASSERT(condition, why) assert((condition) && (why))
#endif
