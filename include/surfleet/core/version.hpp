// SPDX-License-Identifier: MIT
/// @file
/// @brief The library's version, stated here and nowhere else; the build reads it from this file.
#pragma once

#define SURFLEET_VERSION_MAJOR 0
#define SURFLEET_VERSION_MINOR 1
#define SURFLEET_VERSION_PATCH 0
