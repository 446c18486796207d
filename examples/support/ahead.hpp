// SPDX-License-Identifier: MIT
/// @file
/// @brief Work that is done one item ahead, on a second thread.
#pragma once

#include <cstddef>
#include <functional>
#include <future>
#include <utility>

namespace surfleet::examples {
/// Gives `make(0)`, `make(1)`, … in order. While the caller works on one, the next is made on
/// another thread, unless `serial`. What `make` throws, `next` throws.
template <typename T>
class Ahead {
 public:
  Ahead(std::size_t count, bool serial, std::function<T(std::size_t)> make)
      : count_(count), serial_(serial), make_(std::move(make)) {
    start();
  }
  bool done() const { return at_ == count_; }
  /// Not to be called once done.
  T next() {
    T item = pending_.get();
    ++at_;
    start();
    return item;
  }

 private:
  void start() {
    if (at_ < count_)
      pending_ = std::async(serial_ ? std::launch::deferred : std::launch::async, make_, at_);
  }
  std::size_t count_, at_ = 0;
  bool serial_;
  std::function<T(std::size_t)> make_;
  std::future<T> pending_;
};
}  // namespace surfleet::examples
