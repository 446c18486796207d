// SPDX-License-Identifier: MIT
#include "support/cli.hpp"

#include <CLI/CLI.hpp>
#include <array>
#include <charconv>
#include <cstdint>
#include <iostream>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include <surfleet/core/version.hpp>

namespace surfleet::cli {
Option& Option::required() {
  option_->required();
  return *this;
}
Option& Option::expected(int count) {
  option_->expected(count);
  return *this;
}
Option& Option::one_of(const std::vector<std::string>& words) {
  option_->check(CLI::IsMember(words));
  return *this;
}
Option& Option::within(int least, int most) {
  option_->check(CLI::Range(least, most));
  return *this;
}
Option& Option::positive() {
  option_->check(CLI::PositiveNumber);
  return *this;
}
Option& Option::zero_or_more() {
  option_->check(CLI::NonNegativeNumber);
  return *this;
}
Option& Option::separated_by(char mark) {
  option_->delimiter(mark);
  return *this;
}

namespace {
/// What a value of an option must look like.
template <typename T>
constexpr const char* kExpected = "a word";
template <>
constexpr const char* kExpected<int> = "a whole number";
template <>
constexpr const char* kExpected<std::int64_t> = kExpected<int>;
template <>
constexpr const char* kExpected<std::uint64_t> = "a whole number of 0 or more";
template <>
constexpr const char* kExpected<double> = "a number";

template <typename T>
struct ValueOf {
  using type = T;
};
template <typename T>
struct ValueOf<std::optional<T>> : ValueOf<T> {};
template <typename T>
struct ValueOf<std::vector<T>> : ValueOf<T> {};

/// Refuses what is no such value, for a reason that says what would be.
template <typename T>
std::string check_value(const std::string& text) {
  T value{};
  const bool negative = std::is_unsigned_v<T> && text.find('-') != text.npos;
  if (!negative && CLI::detail::lexical_cast(text, value)) return "";
  return "'" + text + "': expected " + kExpected<T>;
}
}  // namespace

Options::Options(const std::string& description) : app_(std::make_unique<CLI::App>(description)) {
  // A setting in a file that is not read would be a mistake that is not seen.
  app_->allow_config_extras(CLI::config_extras_mode::error);
  app_->set_version_flag("--version", "Surfleet " + std::to_string(SURFLEET_VERSION_MAJOR) + "." +
                                          std::to_string(SURFLEET_VERSION_MINOR) + "." +
                                          std::to_string(SURFLEET_VERSION_PATCH))
      ->configurable(false);
}
Options::~Options() = default;

Option Options::declare(const std::string& name, const Variable& variable,
                        const std::string& help) {
  if (name.starts_with("--")) variables_.emplace_back(name.substr(2), variable);
  return std::visit(
      [&](auto* value) {
        CLI::Option* option = app_->add_option(name, *value, help);
        bool shown = true;
        if constexpr (requires { value->empty(); }) shown = !value->empty();
        if constexpr (requires { value->has_value(); }) shown = value->has_value();
        if (shown) option->capture_default_str();
        using Value = typename ValueOf<std::decay_t<decltype(*value)>>::type;
        option->check([](const std::string& text) { return check_value<Value>(text); });
        if (!group_.empty()) option->group(group_);
        return Option(*option);
      },
      variable);
}
void Options::add_flag(const std::string& names, bool& variable, const std::string& help) {
  CLI::Option* flag = app_->add_flag(names, variable, help);
  flags_.emplace_back(flag->get_single_name(), &variable);
  if (!group_.empty()) flag->group(group_);
}
void Options::begin_group(const std::string& title) { group_ = title; }
void Options::add_examples(const std::string& lines) { app_->footer("Examples:\n" + lines); }
void Options::add_config_file() {
  app_->set_config("--config", "", "settings from a TOML file: option names without dashes");
  app_->add_flag("--print-config", print_config_, "print what holds as such a file, and end")
      ->configurable(false);
}

namespace {
/// As TOML has it; nothing for what is not set.
std::string in_toml(const std::string& value) { return value.empty() ? "" : '"' + value + '"'; }
template <typename Number>
requires std::is_arithmetic_v<Number> std::string in_toml(Number value) {
  std::array<char, 40> text;
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}
template <typename T>
std::string in_toml(const std::optional<T>& value) {
  return value ? in_toml(*value) : "";
}
template <typename T>
std::string in_toml(const std::vector<T>& values) {
  std::string list;
  for (const T& v : values) list += (list.empty() ? "[" : ", ") + in_toml(v);
  return list.empty() ? "" : list + "]";
}
}  // namespace

std::string Options::as_config() const {
  std::string text;
  for (const auto& [name, variable] : variables_) {
    const std::string value = std::visit([](const auto* v) { return in_toml(*v); }, variable);
    if (!value.empty()) text += name + " = " + value + '\n';
  }
  for (const auto& [name, value] : flags_)
    if (*value) text += name + " = true\n";
  return text;
}

void Options::parse(int argc, const char* const* argv) {
  try {
    app_->parse(argc, argv);
  } catch (const CLI::Success& e) {
    app_->exit(e, std::cout, std::cerr);
    std::cout.flush();
    throw Exit{kDone};
  } catch (const CLI::ParseError& e) {
    throw Error(std::string(e.what()) + " (--help lists the options)");
  }
  if (!print_config_) return;
  if (settle_) settle_();
  std::cout << as_config();
  std::cout.flush();
  throw Exit{kDone};
}
void Options::parse_config(std::istream& file) {
  try {
    app_->parse_from_stream(file);
  } catch (const CLI::Error& e) {
    throw Error(e.what());
  }
}
bool Options::was_given(const std::string& name) const {
  const CLI::Option* option = app_->get_option_no_throw(name);
  return option != nullptr && option->count() > 0;
}
std::map<std::string, std::vector<std::string>> Options::given() const {
  std::map<std::string, std::vector<std::string>> values;
  for (const CLI::Option* option : app_->get_options())
    if (option->count() > 0) values[option->get_single_name()] = option->results();
  return values;
}
}  // namespace surfleet::cli
