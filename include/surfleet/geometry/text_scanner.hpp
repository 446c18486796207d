// SPDX-License-Identifier: MIT
/// @file
/// @brief Lines, words and numbers from a text in memory, for the readers of text formats.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string_view>

#include <surfleet/core/parse_number.hpp>

namespace surfleet {
/// Walks through a text by words or by lines. Never reads past the end; keeps the line number for
/// messages.
class TextScanner {
 public:
  explicit TextScanner(std::string_view text) : text_(text) {}

  std::size_t line() const { return line_; }
  std::size_t remaining() const { return text_.size() - at_; }

  /// The rest of the present line without its end; nothing at the end of the text.
  std::optional<std::string_view> next_line() {
    if (at_ >= text_.size()) return std::nullopt;
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    std::string_view found = text_.substr(at_, end - at_);
    at_ = std::min(end + 1, text_.size());
    ++line_;
    if (!found.empty() && found.back() == '\r') found.remove_suffix(1);
    return found;
  }

  /// The next word, across line ends; nothing at the end of the text.
  std::optional<std::string_view> next_word() {
    while (at_ < text_.size() && is_space(text_[at_])) {
      if (text_[at_] == '\n') ++line_;
      ++at_;
    }
    if (at_ >= text_.size()) return std::nullopt;
    const std::size_t start = at_;
    while (at_ < text_.size() && !is_space(text_[at_])) ++at_;
    return text_.substr(start, at_ - start);
  }

  static bool is_space(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f';
  }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t line_ = 0;
};
}  // namespace surfleet
