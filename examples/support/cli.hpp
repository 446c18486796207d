// SPDX-License-Identifier: MIT
/// @file  What every binary does alike: option parsing, refusals, exit status, output folder,
///        progress line and Ctrl-C.
///
/// @code
/// int main(int argc, char** argv) {
///   return surfleet::cli::run("my_tool", [&] {
///     CLI::App app{"Does this and that."};
///     std::string out = "out";
///     app.add_option("--out", out, "Output folder")->capture_default_str();
///     surfleet::cli::parse(app, argc, argv);            // --help ends here with status 0
///     const auto folder = surfleet::cli::prepare_output_folder(out);
///     ...
///     return surfleet::cli::interrupted() ? surfleet::cli::kIncomplete : surfleet::cli::kDone;
///   });
/// }
/// @endcode
#pragma once

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <new>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <surfleet/core/error.hpp>
#include <surfleet/core/types.hpp>

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

/// Parses the command line. Help and version are printed and leave `run` with status 0; a wrong
/// option is an `Error`.
inline void parse(CLI::App& app, int argc, const char* const* argv) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& e) {
    app.exit(e, std::cout, std::cerr);
    std::cout.flush();
    throw Exit{kDone};
  } catch (const CLI::ParseError& e) {
    throw Error(std::string(e.what()) + " (--help lists the options)");
  }
}

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
  } catch (const CLI::Error& e) {
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
  const bool writable = !failure && std::ofstream(probe).put('\n').good();
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
