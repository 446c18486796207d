// SPDX-License-Identifier: MIT
/// @file
/// @brief Whether the few functions that take the compiler long are compiled here or once for all.
///
/// The library is header-only. Where `SURFLEET_COMPILED` is defined, as by the CMake target
/// `surfleet::compiled`, functions marked `SURFLEET_INLINE` are declared alone, and come from that
/// target's static library.
#pragma once

#ifdef SURFLEET_COMPILED
#define SURFLEET_INLINE
#else
#define SURFLEET_INLINE inline
#endif
