// SPDX-License-Identifier: MIT
/// @file
/// @brief The frames of a recording, read one ahead of their use.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <type_traits>

#include "support/ahead.hpp"
#include "support/cli.hpp"
#include "support/frame_folder.hpp"
#include "support/fusion.hpp"
#include "support/stopwatch.hpp"

#include <surfleet/core/error.hpp>

namespace surfleet::examples {
/// Calls `use(what, frame)` for what `read(frame)` gives of each frame, in order, until the user
/// interrupts; a frame for which it throws `Error` is skipped as a bad `noun`. On more than one
/// thread, reading is one frame ahead.
template <typename Read, typename Use>
void for_each_read(std::span<const RecordedFrame> frames, const FusionSettings& settings,
                   const std::string& noun, SkippedFrames& skipped, FusionTimes& times,
                   const Read& read, const Use& use) {
  struct Reading {
    std::optional<std::invoke_result_t<const Read&, const RecordedFrame&>> what;
    std::string why;
    double seconds = 0.0;
  };
  cli::watch_interrupts();
  cli::ProgressLine line(!settings.quiet);
  Ahead<Reading> ahead(frames.size(), settings.threads == 1, [&](std::size_t i) {
    const auto before = Clock::now();
    Reading r;
    try {
      r.what = read(frames[i]);
    } catch (const Error& e) {
      r.why = e.what();
    }
    r.seconds = seconds_since(before);
    return r;
  });
  for (std::size_t i = 0; !ahead.done() && !cli::interrupted(); ++i) {
    const Reading r = ahead.next();
    times.read += r.seconds;
    if (r.what)
      use(*r.what, frames[i]);
    else
      skipped.add("bad_" + noun, r.why);
    line(noun + " " + std::to_string(i + 1) + " of " + std::to_string(frames.size()));
  }
}
}  // namespace surfleet::examples
