// SPDX-License-Identifier: MIT
/// Runs every case, or those whose name contains the argument; status 1 if a check failed.
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <string>
#include <vector>

#include "check.hpp"

namespace check {
namespace {
struct Case {
  const char* name;
  void (*run)();
};
std::vector<Case>& cases() {
  static std::vector<Case> list;
  return list;
}
int failures = 0;
int checks = 0;
}  // namespace

bool add(const char* name, void (*run)()) {
  cases().push_back({name, run});
  return true;
}

void report(bool ok, const char* file, int line, const char* what) {
  ++checks;
  if (ok) return;
  ++failures;
  if (failures <= 50) std::printf("%s:%d: failed: %s\n", file, line, what);
}

void report_near(double a, double b, double tolerance, const char* file, int line,
                 const char* what_a, const char* what_b) {
  const bool ok = std::abs(a - b) <= tolerance;
  std::string what;
  if (!ok)
    what =
        std::string(what_a) + " = " + std::to_string(a) + ", " + what_b + " = " + std::to_string(b);
  report(ok, file, line, what.c_str());
}
}  // namespace check

int main(int argc, char** argv) {
  using namespace check;
  for (const Case& c : cases()) {
    if (argc > 1 && std::strstr(c.name, argv[1]) == nullptr) continue;
    const int before = failures;
    try {
      c.run();
    } catch (const std::exception& e) {
      report(false, c.name, 0, (std::string("threw ") + e.what()).c_str());
    }
    if (failures != before) std::printf("FAILED %s\n", c.name);
  }
  std::printf("%d checks, %d failed\n", checks, failures);
  return failures == 0 ? 0 : 1;
}
