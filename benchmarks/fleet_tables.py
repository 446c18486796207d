# SPDX-License-Identifier: MIT
"""Missions of distributed fleets and runs of fleets of processes, as tables of RESULTS.md."""
import math

# Of distributed missions, in the order they are shown.
ROWS = ("centralized", "perfect", "wifi", "poor", "sight", "parted", "killed", "restarted",
        "images10", "images20", "images40")


def mean(numbers):
    return sum(numbers) / len(numbers) if numbers else None


def text(value, digits=0, scale=1.0):
    return "–" if value is None else f"{scale * value:.{digits}f}"


def ratio(pairs, of):
    """The mean of what `of` says of the second over what it says of the first."""
    logs = [math.log(of(b) / of(a)) for a, b in pairs if of(a) and of(b)]
    return None if not logs else math.exp(mean(logs))


def difference(pairs, key):
    found = [b[key] - a[key] for a, b in pairs if a.get(key) is not None and b.get(key) is not None]
    return mean(found)


def sent(metrics):
    """Of all robots, without what a centre tells them [bytes]."""
    return sum(metrics.get("bytes_sent") or [])


def catching_up(all_of):
    """Worst time until all held what anybody held [s]; nothing if one never came to that."""
    took = [c["took_s"] for m in all_of for c in m.get("caught_up", [])]
    return None if not took or None in took else max(took)


def missions(files):
    """A table over the centralised missions of the same scene, team and seed."""
    flown = {}
    for f in files:
        flown.setdefault((f["scene"], f["robots"], f["row"]), {})[f["seed"]] = f["metrics"]
    teams = sorted({(scene, robots) for scene, robots, _ in flown})
    for scene, robots in teams:
        base = flown.get((scene, robots, "centralized"), {})
        for row in ROWS:
            seeds = flown.get((scene, robots, row))
            if not seeds:
                continue
            all_of = list(seeds.values())
            pairs = [(base[s], m) for s, m in seeds.items() if s in base]
            stops = [m["redundant_stops"] for m in all_of if "redundant_stops" in m]
            equal = [m["maps_equal"] for m in all_of if m.get("maps_equal") is not None]
            same = row == "centralized"
            yield (f"{scene}×{robots}", row, str(len(seeds)),
                   text(mean([m["completion_time_s"] for m in all_of])) + " s" if same else
                   text(ratio(pairs, lambda m: m["completion_time_s"]), 2),
                   text(mean([m["total_path_length_m"] for m in all_of])) + " m" if same else
                   text(ratio(pairs, lambda m: m["total_path_length_m"]), 2),
                   text(mean([m["surface_coverage"] for m in all_of]), 1, 100) + " %" if same else
                   text(difference(pairs, "surface_coverage"), 1, 100),
                   text(mean([m["rmse_m"] for m in all_of]), 2, 100) + " cm" if same else
                   text(ratio(pairs, lambda m: m["rmse_m"]), 2),
                   text(mean([sent(m) / robots for m in all_of]), 1, 1e-6),
                   "–" if same else text(ratio(pairs, sent), 3),
                   "–" if not stops else text(mean(stops), 1),
                   "–" if not equal else f"{sum(equal)}/{len(equal)}",
                   text(catching_up(all_of), 1),
                   text(sum(m["collisions"] for m in all_of)),
                   text(mean([m["wall_time_s"] for m in all_of])) + " s" if same else
                   text(ratio(pairs, lambda m: m["wall_time_s"]), 1))


MISSION_COLUMNS = ("scene×drones", "network", "n", "time", "path", "coverage", "RMSE", "MB each",
                   "bytes", "stops left", "equal", "caught up, s", "collisions", "wall")
RUN_COLUMNS = ("variant", "runs", "complete, maps equal", "found in, s", "most MB sent",
               "idle B/s", "idle growth, MB", "collisions")


def runs(data):
    for variant, v in data["variants"].items():
        s, each = v["summary"], v["runs"]
        idle = [r["idle_bytes_per_s"] for r in each if r.get("idle_bytes_per_s") is not None]
        growth = [r["idle_memory_growth_bytes"] for r in each
                  if r.get("idle_memory_growth_bytes") is not None]
        yield (variant, str(s["runs"]), str(s["complete_and_maps_equal"]),
               text(s["found_team_s"], 2), text(s["most_bytes_sent"], 1, 1e-6),
               text(max(idle, default=None)), text(max(growth, default=None), 1, 1e-6),
               text(s["collisions"]))
