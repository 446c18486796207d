// SPDX-License-Identifier: MIT
/// @file
/// @brief The exception for everything a caller can cause.
#pragma once

#include <stdexcept>
#include <string>

namespace surfleet {
/// A bad file, a setting out of range, a message that cannot be trusted.
///
/// The text is one line that says what was wrong, where, and what would be accepted. What only a
/// bug can cause is asserted instead (`SURFLEET_ASSERT`).
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws `Error{message}` unless `ok`.
inline void require(bool ok, const char* message) {
  if (!ok) throw Error(message);
}
inline void require(bool ok, const std::string& message) {
  if (!ok) throw Error(message);
}
}  // namespace surfleet
