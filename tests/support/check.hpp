// SPDX-License-Identifier: MIT
/// @file
/// @brief The tests' whole framework: cases that register themselves and checks that count.
///
/// What a check does is compiled once, in `main.cpp`: there are thousands, and the sanitizers'
/// build would pay for each.
#pragma once

namespace check {
bool add(const char* name, void (*run)());
void report(bool ok, const char* file, int line, const char* what);
void report_near(double a, double b, double tolerance, const char* file, int line,
                 const char* what_a, const char* what_b);
}  // namespace check

/// `TEST(name) { … }` defines a case of the executable; the name must be unique in its room.
#define TEST(name)                                                                        \
  static void test_##name();                                                              \
  [[maybe_unused]] static const bool registered_##name = check::add(#name, &test_##name); \
  static void test_##name()
#define CHECK(...) check::report(static_cast<bool>(__VA_ARGS__), __FILE__, __LINE__, #__VA_ARGS__)
#define CHECK_NEAR(a, b, tolerance)                                                       \
  check::report_near(static_cast<double>(a), static_cast<double>(b), tolerance, __FILE__, \
                     __LINE__, #a, #b)
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
