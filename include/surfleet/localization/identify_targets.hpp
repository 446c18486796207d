// SPDX-License-Identifier: MIT
/// @file
/// @brief Several targets in one image, told apart by their distances alone [004 §9.3.2].
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include <surfleet/localization/identify.hpp>

namespace surfleet {
/// One identification a target, of which no two take the same blob.
///
/// Every target is sought among all blobs. Of the choices that give each one of its fits, or none,
/// those with the most matches are kept whose summed scores are within the likelihood bound; the
/// fits of a target are those that occur in them. O(b³ m³) for each target and at most 8ⁿ choices.
/// Throws `Error` as `identify`, and on more than eight targets.
template <P3pSolver Solver = LambdaTwistP3p>
std::vector<Identification> identify_targets(std::span<const Observation> blobs,
                                             std::span<const MarkerTarget> targets,
                                             const IdentifyOptions& options = {},
                                             const Solver& solver = {}) {
  constexpr std::size_t kMostFits = 7;
  require(targets.size() <= 8, "identification: expected at most eight targets");
  std::vector<Identification> all;
  for (const MarkerTarget& t : targets) {
    all.push_back(identify(blobs, t, options, solver));
    if (all.back().fits.size() > kMostFits) all.back().fits.resize(kMostFits);
  }
  struct Choice {
    std::vector<std::size_t> fit;  ///< Of each target; as many as it has: none.
    std::size_t matches = 0;
    double score = 0.0;
  };
  std::vector<Choice> choices{Choice{}};
  for (const Identification& found : all) {
    std::vector<Choice> longer;
    for (const Choice& choice : choices) {
      std::vector<bool> taken(blobs.size(), false);
      for (std::size_t t = 0; t < choice.fit.size(); ++t)
        if (choice.fit[t] < all[t].fits.size())
          for (const int b : all[t].fits[choice.fit[t]].blob_of_marker)
            if (b != TargetFit::kUnseen) taken[static_cast<std::size_t>(b)] = true;
      for (std::size_t f = 0; f <= found.fits.size(); ++f) {
        Choice next = choice;
        next.fit.push_back(f);
        if (f < found.fits.size()) {
          const auto& labels = found.fits[f].blob_of_marker;
          if (std::any_of(labels.begin(), labels.end(), [&](int b) {
                return b != TargetFit::kUnseen && taken[static_cast<std::size_t>(b)];
              }))
            continue;
          next.matches += found.fits[f].matches;
          next.score += found.fits[f].score;
        }
        longer.push_back(std::move(next));
      }
    }
    choices = std::move(longer);
  }
  std::size_t most = 0;
  for (const Choice& w : choices) most = std::max(most, w.matches);
  double least = std::numeric_limits<double>::infinity();
  for (const Choice& w : choices)
    if (w.matches == most) least = std::min(least, w.score);
  for (std::size_t t = 0; t < all.size(); ++t) {
    std::vector<TargetFit> kept;
    for (std::size_t f = 0; f < all[t].fits.size(); ++f)
      if (std::any_of(choices.begin(), choices.end(), [&](const Choice& w) {
            return w.fit[t] == f && w.matches == most &&
                   w.score <= least + options.likelihood_bound;
          }))
        kept.push_back(all[t].fits[f]);
    all[t].fits = std::move(kept);
  }
  return all;
}
}  // namespace surfleet
