// SPDX-License-Identifier: MIT
#include "support/cli.hpp"

#include <CLI/CLI.hpp>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include <surfleet/core/version.hpp>

namespace surfleet::cli {
namespace {
/// Holds numbers to what `holds` says; others are refused with what is `expected`. `name` stands in
/// the help.
template <typename Holds>
CLI::Validator in_words(const std::string& name, const std::string& expected, Holds holds) {
  return CLI::Validator(
      [=](std::string& text) {
        double value = 0.0;
        const bool good =
            CLI::detail::lexical_cast(text, value) && std::isfinite(value) && holds(value);
        return good ? std::string() : "'" + text + "': expected " + expected;
      },
      name);
}
}  // namespace

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
  const std::string range = std::to_string(least) + " to " + std::to_string(most);
  option_->check(
      in_words("[" + range + "]", range, [=](double v) { return v >= least && v <= most; }));
  return *this;
}
Option& Option::positive() {
  option_->check(in_words("POSITIVE", "more than 0", [](double v) { return v > 0.0; }));
  return *this;
}
Option& Option::zero_or_more() {
  option_->check(in_words("NONNEGATIVE", "0 or more", [](double v) { return v >= 0.0; }));
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

namespace {
/// TOML as the parser reads it, but that a # in quotes begins no comment.
class SettingsFile : public CLI::ConfigTOML {
 public:
  SettingsFile() { comment('\n'); }  // which begins no line
  std::vector<CLI::ConfigItem> from_config(std::istream& input) const override {
    std::stringstream bare;
    for (std::string line; std::getline(input, line);) {
      char quote = '\0';
      std::size_t end = 0;
      for (; end < line.size() && (quote != '\0' || line[end] != '#'); ++end)
        if (quote != '\0')
          quote = line[end] == quote ? '\0' : quote;
        else if (line[end] == '"' || line[end] == '\'')
          quote = line[end];
      bare << line.substr(0, end) << '\n';
    }
    return CLI::ConfigTOML::from_config(bare);
  }
};
}  // namespace

Options::Options(const std::string& description) : app_(std::make_unique<CLI::App>(description)) {
  app_->config_formatter(std::make_shared<SettingsFile>());
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
  return std::visit(
      [&](auto* value) {
        CLI::Option* option = app_->add_option(name, *value, help);
        bool shown = true;
        if constexpr (requires { value->empty(); }) shown = !value->empty();
        if constexpr (requires { value->has_value(); }) shown = value->has_value();
        if (shown) option->capture_default_str();
        if (name.starts_with("--")) variables_.push_back({name.substr(2), variable, !shown});
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
std::string in_toml(const std::string& value) {
  const char quote = value.find('"') == value.npos ? '"' : '\'';
  require(value.find(quote) == value.npos && value.find_first_of("\r\n") == value.npos,
          "'" + value + "': no settings file can hold both kinds of quotes, or more than a line");
  return quote + value + quote;
}
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
  const auto left_out = [this](const std::string& name) {
    return omit_ && omit_(name) && !was_given("--" + name);
  };
  for (const auto& [name, variable, begins_empty] : variables_) {
    const std::string value = std::visit([](const auto* v) { return in_toml(*v); }, variable);
    const bool unset = value.empty() || (begins_empty && value == in_toml(std::string()));
    if (!unset && !left_out(name)) text += name + " = " + value + '\n';
  }
  for (const auto& [name, value] : flags_)
    if (!left_out(name)) text += name + (*value ? " = true\n" : " = false\n");
  return text;
}

void Options::parse(int argc, const char* const* argv) {
  add_config_file();
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
