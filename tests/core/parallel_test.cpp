// SPDX-License-Identifier: MIT
#include <surfleet/core/parallel.hpp>

#include <chrono>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "check.hpp"

namespace {
using namespace surfleet;

TEST(every_index_is_called_once_however_short_the_loops) {
  for (std::size_t round = 0; round < 3000; ++round) {
    const std::size_t n = round % 37;
    std::vector<int> calls(n, 0);
    parallel_for(
        n, 1 + static_cast<int>(round % 4), [&](std::size_t i) { ++calls[i]; }, 1 + round % 5);
    CHECK(calls == std::vector<int>(n, 1));
  }
}

TEST(helpers_that_have_fallen_asleep_wake_up) {
  for (int round = 0; round < 3; ++round) {
    std::this_thread::sleep_for(std::chrono::milliseconds(3));
    std::vector<std::thread::id> threads(4);
    parallel_for(threads.size(), 2, [&](std::size_t i) {
      threads[i] = std::this_thread::get_id();
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    });
    CHECK(threads != std::vector<std::thread::id>(threads.size(), std::this_thread::get_id()));
  }
}

TEST(loops_inside_loops_and_from_several_threads_are_whole) {
  std::vector<std::thread> callers;
  std::vector<std::size_t> sums(3, 0);
  for (std::size_t t = 0; t < sums.size(); ++t)
    callers.emplace_back([&sums, t] {
      for (int round = 0; round < 200; ++round) {
        std::vector<std::size_t> inner(8, 0);
        parallel_for(inner.size(), 3, [&](std::size_t i) {
          std::vector<std::size_t> parts(5, 0);
          parallel_for(parts.size(), 3, [&](std::size_t k) { parts[k] = i * k; });
          for (const std::size_t p : parts) inner[i] += p;
        });
        for (const std::size_t p : inner) sums[t] += p;
      }
    });
  for (std::thread& t : callers) t.join();
  for (const std::size_t sum : sums) CHECK(sum == std::size_t{200} * 28 * 10);
}

TEST(an_exception_comes_back_to_the_caller) {
  for (int round = 0; round < 200; ++round) {
    bool caught = false;
    try {
      parallel_for(50, 3, [&](std::size_t i) {
        if (i == 17) throw std::runtime_error("seventeen");
      });
    } catch (const std::runtime_error& e) {
      caught = std::string(e.what()) == "seventeen";
    }
    CHECK(caught);
  }
}
}  // namespace
