// SPDX-License-Identifier: MIT
/// @file
/// @brief Numbers from text, whatever the locale, with any standard library.
#pragma once

#include <locale.h>
#if defined(__APPLE__)
#include <xlocale.h>
#endif

#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <version>

namespace surfleet {
namespace detail {
#if defined(__cpp_lib_to_chars)
inline constexpr bool kLibraryReadsReals = true;
#else
inline constexpr bool kLibraryReadsReals = false;
#endif

/// The number that `text` begins with and how much of it that is, by the C library in the "C"
/// locale; by the grammar of `std::from_chars`: no blanks, plus or hexadecimal. Nothing if there is
/// none or if a double cannot hold it.
template <typename Real>
std::optional<std::size_t> real_prefix_by_strtod(std::string_view text, Real& value) {
  static const locale_t c_locale = ::newlocale(LC_ALL_MASK, "C", nullptr);
  const std::string_view bare = text.substr(text.starts_with('-') ? 1 : 0);
  if (bare.empty() || !((bare[0] >= '0' && bare[0] <= '9') || bare[0] == '.' || bare[0] == 'i' ||
                        bare[0] == 'I' || bare[0] == 'n' || bare[0] == 'N'))
    return std::nullopt;
  if (bare.size() > 1 && bare[0] == '0' && (bare[1] == 'x' || bare[1] == 'X')) {
    value = text[0] == '-' ? Real(-0.0) : Real(0.0);  // the zero before the x
    return text.size() - bare.size() + 1;
  }
  // The text ends in no zero; a number is as good as never longer than this.
  constexpr std::size_t kLongest = 2000;
  const std::string copy(text.substr(0, kLongest));
  char* end = nullptr;
  Real parsed{};
  if constexpr (std::is_same_v<Real, float>)
    parsed = ::strtof_l(copy.c_str(), &end, c_locale);
  else
    parsed = ::strtod_l(copy.c_str(), &end, c_locale);
  const auto used = static_cast<std::size_t>(end - copy.c_str());
  if (used == 0) return std::nullopt;
  const std::string_view number = std::string_view(copy).substr(0, used);
  const bool infinite_by_name = number.find_first_of("iI") != std::string_view::npos;
  if (std::isinf(parsed) && !infinite_by_name) return std::nullopt;
  // So small that nothing is left of it, though it has a digit other than 0 before the exponent.
  if (parsed == Real(0) &&
      number.substr(0, number.find_first_of("eE")).find_first_of("123456789") !=
          std::string_view::npos)
    return std::nullopt;
  value = parsed;
  return used;
}
}  // namespace detail

/// The number that `text` begins with goes to `value`; the answer is how many characters it took.
/// Nothing, and `value` left alone, if there is none or if it does not fit the type. Text is read
/// as `std::from_chars` does, which not every standard library has for floating point.
template <typename Number>
std::optional<std::size_t> parse_prefix(std::string_view text, Number& value) {
  if constexpr (std::is_floating_point_v<Number> && !detail::kLibraryReadsReals) {
    return detail::real_prefix_by_strtod(text, value);
  } else {
    Number parsed{};
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), parsed);
    if (status != std::errc{}) return std::nullopt;
    value = parsed;
    return static_cast<std::size_t>(end - text.data());
  }
}

/// The whole word as a number, with or without a plus; nothing if it is not one.
template <typename Number>
std::optional<Number> parse_number(std::string_view word) {
  if (word.starts_with('+')) {
    word.remove_prefix(1);
    if (word.starts_with('-')) return std::nullopt;
  }
  Number value{};
  const auto used = parse_prefix(word, value);
  if (!used || *used != word.size()) return std::nullopt;
  return value;
}
}  // namespace surfleet
