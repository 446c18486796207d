// SPDX-License-Identifier: MIT
/// @file
/// @brief What every binary does alike: option parsing, refusals, exit status, output folder,
/// progress line and Ctrl-C.
///
/// @code
/// int main(int argc, char** argv) {
///   return surfleet::cli::run("my_tool", [&] {
///     surfleet::cli::Options options("Does this and that.");
///     std::string out = "out";
///     options.add("--out", out, "output folder");
///     options.parse(argc, argv);                        // --help ends here with status 0
///     const auto folder = surfleet::cli::prepare_output_folder(out);
///     ...
///     return surfleet::cli::interrupted() ? surfleet::cli::kIncomplete : surfleet::cli::kDone;
///   });
/// }
/// @endcode
#pragma once

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iosfwd>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace surfleet::cli {
constexpr int kDone = 0;        ///< The job is done.
constexpr int kRefused = 2;     ///< The input was refused; one line says why; nothing was written.
constexpr int kIncomplete = 3;  ///< Ended early, with everything it had so far written.

/// Thrown to leave `run` at once with `status`, saying nothing more.
struct Exit {
  int status = kDone;
};

/// `text` on one line: line breaks become "; ", other control characters spaces.
inline std::string one_line(const std::string& text) {
  std::string line;
  for (const char c : text) {
    if (c == '\n' || c == '\r') {
      if (!line.empty() && !line.ends_with("; ")) line += "; ";
    } else {
      line += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
  }
  if (line.ends_with("; ")) line.resize(line.size() - 2);
  return line;
}

/// A declared option, to say more of it. Wrong values are refused while parsing.
class Option {
 public:
  explicit Option(CLI::Option& option) : option_(&option) {}
  Option& required();
  /// So many values, no more and no less.
  Option& expected(int count);
  Option& one_of(const std::vector<std::string>& words);
  Option& within(int least, int most);
  Option& positive();
  Option& zero_or_more();
  /// A list in one word, as in a,b,c.
  Option& separated_by(char mark);

 private:
  CLI::Option* option_;
};

/// The options of a program. The parser behind it is compiled once, in cli.cpp.
class Options {
 public:
  /// What an option can set.
  using Variable = std::variant<std::string*, int*, std::int64_t*, std::uint64_t*, double*,
                                std::optional<int>*, std::optional<double>*,
                                std::vector<std::string>*, std::vector<int>*, std::vector<double>*>;

  explicit Options(const std::string& description);
  ~Options();
  Options(const Options&) = delete;
  Options& operator=(const Options&) = delete;

  /// Declares an option, or without leading dashes an argument by its place. `variable` must stay
  /// where it is until parsed; what it holds is the default, and shown as such if not empty.
  template <typename T>
  Option add(const std::string& name, T& variable, const std::string& help) {
    return declare(name, Variable(&variable), help);
  }
  /// "--name", or "--name,!--no-name" for one that can be taken back.
  void add_flag(const std::string& names, bool& variable, const std::string& help);
  /// What is declared from here on stands under this title in the help.
  void begin_group(const std::string& title);
  /// Command lines that the help ends with, one a line.
  void add_examples(const std::string& lines);
  /// Called before --print-config prints, to set what follows from other options.
  void settle_before_printing(std::function<void()> settle) { settle_ = std::move(settle); }
  /// Which options --print-config leaves out unless they were given: what others stand in place of.
  /// Asked by names without dashes, once all is parsed.
  void leave_out_of_config(std::function<bool(const std::string& name)> omit) {
    omit_ = std::move(omit);
  }
  /// --config FILE sets what the command line leaves. Help, version and --print-config, which says
  /// what holds in the form of such a file, leave `run` with status 0; a wrong option is an
  /// `Error`.
  void parse(int argc, const char* const* argv);
  /// Takes the options from the text of such a file alone. Throws `Error`.
  void parse_config(std::istream& file);
  /// Whether the command line or the file gave this option; false of one that was not declared.
  bool was_given(const std::string& name) const;
  /// What was given: values by option, without dashes, in order of the names.
  std::map<std::string, std::vector<std::string>> given() const;

 private:
  void add_config_file();
  Option declare(const std::string& name, const Variable& variable, const std::string& help);
  /// All that has a value, as a file for --config. Throws `Error` for text that no file can hold.
  std::string as_config() const;
  std::unique_ptr<CLI::App> app_;
  std::string group_;  ///< Of what is declared next; empty: the parser's own.
  struct Declared {
    std::string name;  ///< Without dashes.
    Variable variable;
    bool begins_empty;
  };
  std::vector<Declared> variables_;
  std::vector<std::pair<std::string, const bool*>> flags_;
  std::function<void()> settle_;
  std::function<bool(const std::string&)> omit_;
  bool print_config_ = false;
};

/// Runs a program's body and turns what it throws into one line on stderr and an exit status.
template <typename Body>
int run(const char* program, Body&& body) {
  const auto refuse = [&](const std::string& why, int status) {
    std::fflush(stdout);
    std::fprintf(stderr, "%s: %s\n", program, one_line(why).c_str());
    return status;
  };
  try {
    return std::forward<Body>(body)();
  } catch (const Exit& e) {
    return e.status;
  } catch (const Error& e) {
    return refuse(e.what(), kRefused);
  } catch (const std::filesystem::filesystem_error& e) {
    return refuse(e.what(), kRefused);
  } catch (const std::bad_alloc&) {
    return refuse("not enough memory for these settings; expected a coarser or smaller input",
                  kRefused);
  } catch (const std::exception& e) {
    return refuse(std::string("internal error: ") + e.what(), 1);
  }
}

/// Makes sure that files can be written to the folder `path`, creating it and its parents if need
/// be, and returns it. Throws `Error`, leaving nothing behind, when they cannot. Call it after all
/// other input has been accepted and before the work begins.
inline std::filesystem::path prepare_output_folder(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  require(!path.empty(), "output folder: empty path; expected a folder that can be written");
  const auto refused = [&](const std::string& why) {
    return Error("output folder " + path.string() + ": " + why +
                 "; expected a folder that can be written");
  };
  std::error_code ec;
  std::vector<fs::path> missing;  // innermost first
  fs::path at = fs::absolute(path, ec).lexically_normal();
  if (ec) throw refused(ec.message());
  if (at.filename().empty()) at = at.parent_path();
  while (!fs::exists(at, ec)) {
    if (ec || !at.has_relative_path()) throw refused(ec ? ec.message() : "not found");
    missing.push_back(at);
    at = at.parent_path();
  }
  if (!fs::is_directory(at, ec)) throw refused(at.string() + " is not a folder");
  if (::access(at.c_str(), W_OK | X_OK) != 0) throw refused(at.string() + " is read-only");
  const auto undo = [&] {
    for (const fs::path& folder : missing) fs::remove(folder, ec);
  };
  std::error_code failure;
  for (auto it = missing.rbegin(); it != missing.rend() && !failure; ++it)
    fs::create_directory(*it, failure);
  const fs::path probe = path / (".surfleet-probe-" + std::to_string(::getpid()));
  const auto has_room = [&] {
    std::ofstream file(probe);
    return file.put('\n').flush().good();
  };
  const bool writable = !failure && has_room();
  fs::remove(probe, ec);
  if (!writable) {
    undo();
    throw refused(failure ? failure.message() : "no file can be created in it");
  }
  return path;
}

namespace detail {
inline volatile std::sig_atomic_t interrupt_count = 0;
inline void on_interrupt(int signal) {
  interrupt_count = interrupt_count + 1;
  if (interrupt_count > 1) std::signal(signal, SIG_DFL);  // the next one ends the process
}
}  // namespace detail

/// From here on Ctrl-C and SIGTERM only set `interrupted()`; a third one ends the process.
inline void watch_interrupts() {
  std::signal(SIGINT, detail::on_interrupt);
  std::signal(SIGTERM, detail::on_interrupt);
}
inline bool interrupted() { return detail::interrupt_count > 0; }

/// A status line on stderr: rewritten in place on a terminal, a new line every ten seconds
/// elsewhere.
class ProgressLine {
 public:
  explicit ProgressLine(bool enabled = true)
      : enabled_(enabled), terminal_(::isatty(STDERR_FILENO) != 0) {}
  ~ProgressLine() { finish(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void operator()(const std::string& text) {
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::duration<double> waited = now - last_;
    if (!enabled_ || (shown_ && waited.count() < (terminal_ ? 0.1 : 10.0))) return;
    last_ = now;
    const std::string line = one_line(text);
    if (terminal_)
      std::fprintf(stderr, "\r%s\x1b[K", line.c_str());
    else
      std::fprintf(stderr, "%s\n", line.c_str());
    std::fflush(stderr);
    shown_ = true;
  }
  /// Ends the line, so that ordinary output may follow.
  void finish() {
    if (shown_ && terminal_) std::fputc('\n', stderr);
    shown_ = false;
  }

 private:
  bool enabled_, terminal_, shown_ = false;
  std::chrono::steady_clock::time_point last_{};
};

/// The box of six numbers `x0 y0 z0 x1 y1 z1` [m], as options give it. Throws `Error` if it is
/// empty or not finite.
inline Box3 box_from_numbers(const std::vector<double>& n, const std::string& option) {
  const bool finite = std::all_of(n.begin(), n.end(), [](double v) { return std::isfinite(v); });
  require(n.size() == 6 && finite && n[0] < n[3] && n[1] < n[4] && n[2] < n[5],
          option + ": expected six numbers x0 y0 z0 x1 y1 z1 with each minimum below its maximum");
  return Box3(Point3(n[0], n[1], n[2]), Point3(n[3], n[4], n[5]));
}
}  // namespace surfleet::cli
