// SPDX-License-Identifier: MIT
/// @file
/// @brief Choices that do not keep a loop from becoming vector code.
#pragma once

namespace surfleet::detail {
// By value: references would.
inline float smaller(float a, float b) { return b < a ? b : a; }
inline float larger(float a, float b) { return a < b ? b : a; }
/// A factor in place of a branch.
inline float one_if(int condition) { return static_cast<float>(condition); }
}  // namespace surfleet::detail
