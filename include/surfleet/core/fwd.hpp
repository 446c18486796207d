// SPDX-License-Identifier: MIT
/// @file
/// @brief Declarations of the core room, for headers that only name its types.
#pragma once

namespace surfleet {
class ByteReader;
class ByteWriter;
struct Configuration;
class Error;
struct EuclideanDistance;
}  // namespace surfleet
