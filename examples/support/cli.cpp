// SPDX-License-Identifier: MIT
#include "support/cli.hpp"

#include <CLI/CLI.hpp>
#include <iostream>

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

Options::Options(const std::string& description) : app_(std::make_unique<CLI::App>(description)) {}
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
        return Option(*option);
      },
      variable);
}
void Options::add_flag(const std::string& names, bool& variable, const std::string& help) {
  app_->add_flag(names, variable, help);
}
void Options::add_config_file() {
  app_->set_config("--config", "", "settings from a TOML file: option names without dashes");
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
}
void Options::parse_config(std::istream& file) {
  try {
    app_->parse_from_stream(file);
  } catch (const CLI::Error& e) {
    throw Error(e.what());
  }
}
bool Options::was_given(const std::string& name) const {
  return app_->get_option(name)->count() > 0;
}
}  // namespace surfleet::cli
