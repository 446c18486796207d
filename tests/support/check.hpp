// SPDX-License-Identifier: MIT
/// @file  The tests' whole framework: cases that register themselves and checks that count.
#pragma once

#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace check {
struct Case {
  const char* name;
  void (*run)();
};
inline std::vector<Case>& cases() {
  static std::vector<Case> list;
  return list;
}
inline int failures = 0;
inline int checks = 0;
inline bool add(const char* name, void (*run)()) {
  cases().push_back({name, run});
  return true;
}
inline void report(bool ok, const char* file, int line, const std::string& what) {
  ++checks;
  if (ok) return;
  ++failures;
  if (failures <= 50) std::printf("%s:%d: failed: %s\n", file, line, what.c_str());
}
/// Runs every case, or those whose name contains `filter`; the number of failed checks as status.
inline int run_all(const char* filter) {
  for (const Case& c : cases()) {
    if (filter != nullptr && std::strstr(c.name, filter) == nullptr) continue;
    const int before = failures;
    try {
      c.run();
    } catch (const std::exception& e) {
      report(false, c.name, 0, std::string("threw ") + e.what());
    }
    if (failures != before) std::printf("FAILED %s\n", c.name);
  }
  std::printf("%d checks, %d failed\n", checks, failures);
  return failures == 0 ? 0 : 1;
}
}  // namespace check

/// `TEST(name) { … }` defines a case of the executable; the name must be unique in its room.
#define TEST(name)                                                                        \
  static void test_##name();                                                              \
  [[maybe_unused]] static const bool registered_##name = check::add(#name, &test_##name); \
  static void test_##name()
#define CHECK(...) check::report(static_cast<bool>(__VA_ARGS__), __FILE__, __LINE__, #__VA_ARGS__)
#define CHECK_NEAR(a, b, tolerance)                                                              \
  do {                                                                                           \
    const double check_a = static_cast<double>(a), check_b = static_cast<double>(b);             \
    check::report(std::abs(check_a - check_b) <= (tolerance), __FILE__, __LINE__,                \
                  #a " = " + std::to_string(check_a) + ", " #b " = " + std::to_string(check_b)); \
  } while (false)
#define CHECK_THROWS(type, ...)                                                     \
  do {                                                                              \
    bool check_thrown = false;                                                      \
    try {                                                                           \
      static_cast<void>(__VA_ARGS__);                                               \
    } catch (const type&) {                                                         \
      check_thrown = true;                                                          \
    }                                                                               \
    check::report(check_thrown, __FILE__, __LINE__, #__VA_ARGS__ " throws " #type); \
  } while (false)
