// SPDX-License-Identifier: MIT
/// @file
/// @brief Views from the nodes of a flight lattice, taken when they are first asked for.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/motion/flight_lattice.hpp>
#include <surfleet/motion/free_space.hpp>
#include <surfleet/planning/team_tour.hpp>
#include <surfleet/viewpoint/gain_bound.hpp>
#include <surfleet/viewpoint/sight_targets.hpp>

namespace surfleet {
/// What was left in view where a robot has viewed already: no reason for another view there.
class ViewsInVain {
 public:
  /// `gain` is left in a view from a node after one was taken; says whether that is new.
  bool note(std::size_t node, int view, double gain) {
    return left_.insert_or_assign({node, view}, gain).second;
  }
  bool contains(std::size_t node, int view, double gain) const {
    const auto it = left_.find({node, view});
    return it != left_.end() && gain <= kMore * it->second;
  }

 private:
  static constexpr double kMore = 1.1;                  ///< Times what was left, for another view.
  std::map<std::pair<std::size_t, int>, double> left_;  // [m²]
};

/// Views of one set of targets from nodes of a lattice. All that is handed over must outlive it.
class LatticeViews {
 public:
  LatticeViews(const SightTargets<>& targets, FlightLattice<FreeSpace>& lattice,
               const HeadingTable& headings, const ViewsInVain& vain, double unknown_gain)
      : targets_(&targets),
        lattice_(&lattice),
        vain_(&vain),
        most_(targets.all(), lattice, headings, targets.reach()),
        unknown_gain_(unknown_gain),
        done_(targets.size(), 0) {}

  /// A site in the order they are added.
  struct Site {
    VoxelIndex cell;
    bool known = true;  ///< To be free; views from elsewhere pass through unknown space.
  };
  void add(const Site& site) { places_.push_back({site}); }
  const Site& operator[](std::size_t s) const { return places_[s].site; }
  std::size_t size() const { return places_.size(); }
  std::size_t node(std::size_t s) const { return lattice_->index(places_[s].site.cell); }
  /// Whether anything could be in view from a node.
  bool any(const VoxelIndex& cell) const { return most_.in_any_view(cell) > 0.0; }

  // A model of `ViewsFromSites`.
  double most(std::size_t s) const {
    const Site& site = places_[s].site;
    return share_of(site) * (any(site.cell) ? most_(site.cell).most() : 0.0);
  }
  double evaluate(std::size_t s, double enough, GainByView& gain) {
    Place& place = places_[s];
    const double share = share_of(place.site);
    View& view = view_of(place);
    gain = gain_by_view(*targets_, view.seen, done_);
    if (const double most = share * gain.most(); most <= enough) return most;
    // Lines of sight are told for views that may yet be enough.
    const auto may_do = [&] {
      ViewBits views = 0;
      for (std::size_t k = 0; k < gain.size(); ++k)
        if (share * gain[k] + kRounding > enough) views |= ViewBits{1} << k;
      return views;
    };
    ViewBits wanted = may_do();
    cast(place.site, view, wanted, [&](const Sighting& hidden) {
      for (ViewBits bits = hidden.views; bits != 0; bits &= bits - 1)
        gain[static_cast<std::size_t>(std::countr_zero(bits))] -=
            (*targets_)[static_cast<std::size_t>(hidden.target)].gain;
      return wanted = may_do();
    });
    if (wanted == 0) return share * gain.most() + kRounding;
    gain = gain_by_view(*targets_, view.seen, done_);
    const std::size_t n = node(s);
    for (std::size_t k = 0; k < gain.size(); ++k)
      gain[k] = vain_->contains(n, static_cast<int>(k), gain[k]) ? 0.0 : share * gain[k];
    return gain.most();
  }
  void take(std::size_t s, int view_taken) {
    Place& place = places_[s];
    View& view = view_of(place);
    const ViewBits wanted = ViewBits{1} << view_taken;
    cast(place.site, view, wanted, [&](const Sighting&) { return wanted; });
    mark_in_view(view.seen, view_taken, done_, [](std::size_t) {});
  }

  /// Counts no more what is seen from a place.
  void mark(const Configuration& at) {
    mark_in_view(targets_->seen_from(at.position), targets_->headings().nearest_view(at), done_,
                 [](std::size_t) {});
  }
  std::span<const char> done() const { return done_; }

 private:
  struct View {
    std::vector<Sighting> seen;  ///< All that may be in sight.
    std::vector<char> sure;      ///< Those that are.
  };
  struct Place {
    Site site;
    std::optional<View> view{};
  };
  static constexpr double kRounding = 1e-9;  ///< Of sums of gain [m²].

  double share_of(const Site& site) const { return site.known ? 1.0 : unknown_gain_; }
  View& view_of(Place& place) const {
    if (!place.view) {
      thread_local std::vector<Sighting> buffer;
      const auto view = targets_->in_view(lattice_->position(place.site.cell), buffer);
      place.view = View{{view.begin(), view.end()}, std::vector<char>(view.size(), 0)};
    }
    return *place.view;
  }
  /// Leaves of what wanted views of a place may show what is in sight and counts yet, in its order.
  /// `still_wanted` is told of each target that is not in sight, and says which views are from then
  /// on.
  template <typename StillWanted>
  void cast(const Site& site, View& view, ViewBits wanted, StillWanted&& still_wanted) const {
    MapSight sees = targets_->sight();
    if (!site.known) sees.see_through_unknown();
    const Point3 position = lattice_->position(site.cell);
    std::size_t left = 0;
    for (std::size_t k = 0; k < view.seen.size(); ++k) {
      const Sighting s = view.seen[k];
      const auto target = static_cast<std::size_t>(s.target);
      if (done_[target] != 0) continue;
      char sure = view.sure[k];
      if (sure == 0 && (s.views & wanted) != 0) {
        if (!sees(position, (*targets_)[target])) {
          wanted = still_wanted(s);
          continue;
        }
        sure = 1;
      }
      view.seen[left] = s;
      view.sure[left++] = sure;
    }
    view.seen.resize(left);
    view.sure.resize(left);
  }

  const SightTargets<>* targets_;
  FlightLattice<FreeSpace>* lattice_;
  const ViewsInVain* vain_;
  GainBound most_;
  double unknown_gain_;
  std::vector<char> done_;  // by target
  std::vector<Place> places_;
};
static_assert(ViewsFromSites<LatticeViews>);
}  // namespace surfleet
