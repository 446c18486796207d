// SPDX-License-Identifier: MIT
#include <surfleet/core/parse_number.hpp>

#include <array>
#include <bit>
#include <clocale>
#include <cstdint>
#include <cstdio>
#include <limits>

#include <surfleet/core/random.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
std::optional<double> by_strtod(std::string_view word) {
  double value = 0.0;
  const auto used = detail::real_prefix_by_strtod(word, value);
  if (!used || *used != word.size()) return std::nullopt;
  return value;
}
/// The same bits by either way.
void both_give(const char* word, double expected) {
  const auto a = parse_number<double>(word), b = by_strtod(word);
  CHECK(a && std::bit_cast<std::uint64_t>(*a) == std::bit_cast<std::uint64_t>(expected));
  CHECK(b && std::bit_cast<std::uint64_t>(*b) == std::bit_cast<std::uint64_t>(expected));
}
void both_refuse(std::string_view word) {
  CHECK(!parse_number<double>(word));
  CHECK(!by_strtod(word));
}
void all_of_it() {
  Random random(4);
  std::array<char, 64> text{};
  for (int i = 0; i < 20000; ++i) {
    const double x = std::bit_cast<double>(random());
    if (!std::isfinite(x)) continue;
    // to_chars never asks the locale, as printf does.
    const auto end = std::to_chars(text.data(), text.data() + text.size() - 1, x).ptr;
    *end = '\0';
    both_give(text.data(), x);
  }
  both_give("0", 0.0);
  both_give("-0.0", -0.0);
  both_give("-.5e1", -5.0);
  both_give("7.", 7.0);
  both_give("0.1", 0.1);
  both_give("9007199254740993", 9007199254740992.0);  // a tie, to even
  both_give("4.9e-324", std::numeric_limits<double>::denorm_min());
  both_give("1.7976931348623157e308", std::numeric_limits<double>::max());
  both_give("0e999999", 0.0);
  for (const char* word : {"", "-", "+-1", "x", " 1", "1 ", "1,5", "1e", "--1", "0x10", "1e400",
                           "-1e400", "1e-400", ".", "e5", "1.2.3"})
    both_refuse(word);
  CHECK(std::isinf(*parse_number<double>("inf")) && std::isinf(*by_strtod("-inf")));
  CHECK(std::isnan(*parse_number<double>("nan")) && std::isnan(*by_strtod("nan")));
  // Only what belongs to it, within what is given.
  double value = 3.0;
  const std::string_view row = "1.25 2.5";
  CHECK(parse_prefix(row, value) == std::size_t{4} && value == 1.25);
  CHECK(detail::real_prefix_by_strtod(row.substr(0, 3), value) == std::size_t{3} && value == 1.2);
  CHECK(!parse_prefix(std::string_view("z"), value) && value == 1.2);
}
}  // namespace

TEST(numbers_come_back_to_the_last_bit_by_either_way) { all_of_it(); }

TEST(numbers_do_not_depend_on_the_locale) {
  for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "C.UTF-8"})
    if (std::setlocale(LC_ALL, name) != nullptr) break;
  all_of_it();
  std::setlocale(LC_ALL, "C");
}

TEST(other_types_of_numbers) {
  CHECK(parse_number<int>("+17") == 17 && parse_number<int>("-3") == -3);
  CHECK(!parse_number<int>("1.5") && !parse_number<int>("99999999999"));
  CHECK(!parse_number<std::uint64_t>("-1"));
  CHECK(parse_number<float>("0.1") == 0.1F && !parse_number<float>("1e39"));
  float value = 0.0F;
  CHECK(detail::real_prefix_by_strtod("16777217", value) && value == 16777216.0F);
}
