// SPDX-License-Identifier: MIT
/// @file
/// @brief Lists of files by time, a line `time file` for each, and which of them go together.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <surfleet/core/binary_io.hpp>
#include <surfleet/core/error.hpp>
#include <surfleet/geometry/text_scanner.hpp>

namespace surfleet {
/// A file and the moment that it shows.
struct StampedFile {
  double time = 0.0;  ///< [s]
  std::string file;   ///< As the list has it: beside the list, as a rule.
};

/// Reads the text of such a list, as `depth.txt` of the TUM RGB-D data sets; `name` stands for the
/// file in errors. Blank lines and lines that begin with `#` are passed over. A line that is not a
/// finite time and one file name is passed over too if `skip` takes the reason; else throws
/// `Error`. O(text).
inline std::vector<StampedFile> parse_stamped_files(
    std::string_view text, const std::string& name = "list",
    const std::function<void(const std::string& why)>& skip = {}) {
  std::vector<StampedFile> files;
  TextScanner lines(text);
  while (const auto line = lines.next_line()) {
    TextScanner words(*line);
    const auto first = words.next_word();
    if (!first || first->front() == '#') continue;
    const auto time = parse_number<double>(*first);
    const auto file = words.next_word();
    if (time && std::isfinite(*time) && file && !words.next_word()) {
      files.push_back({*time, std::string(*file)});
      continue;
    }
    const std::string why =
        name + ": line " + std::to_string(lines.line()) + ": expected a time and a file";
    if (!skip) throw Error(why);
    skip(why);
  }
  return files;
}
inline std::vector<StampedFile> read_stamped_files(
    const std::filesystem::path& path,
    const std::function<void(const std::string& why)>& skip = {}) {
  const Bytes bytes = read_file(path);
  return parse_stamped_files(text_of(bytes), path.string(), skip);
}

/// The index of the time nearest to `time`, the earlier of two as near; nothing if that is more
/// than `tolerance` off. `times` are ascending. O(log times).
inline std::optional<std::size_t> nearest_in_time(std::span<const double> times, double time,
                                                  double tolerance) {
  const auto after = std::lower_bound(times.begin(), times.end(), time);
  std::optional<std::size_t> best;
  double least = tolerance;
  const auto consider = [&](auto it) {
    const double off = std::abs(*it - time);
    if (!(off < least || (off == least && !best))) return;
    least = off;
    best = static_cast<std::size_t>(it - times.begin());
  };
  if (after != times.begin()) consider(after - 1);
  if (after != times.end()) consider(after);
  return best;
}
}  // namespace surfleet
