// SPDX-License-Identifier: MIT
/// @file
/// @brief A parallel loop over indices, on threads that stay alive between calls.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace surfleet {
namespace detail {
/// The process's helper threads, started when first asked for and joined at exit.
class WorkerPool {
 public:
  static WorkerPool& instance() {
    static WorkerPool pool;
    return pool;
  }

  /// Runs `job` on the caller and on up to `helpers` threads at once and waits for all of them.
  /// Helpers that have not begun when the caller is done are not waited for.
  /// False if the pool is busy, which a nested call finds: the caller then works alone. With fewer
  /// helpers than asked for where the system gives no more threads.
  bool run(int helpers, const std::function<void()>& job) {
    if (inside_) return false;
    std::unique_lock<std::mutex> owner(owner_, std::try_to_lock);
    if (!owner.owns_lock()) return false;
    {
      std::lock_guard<std::mutex> lock(mutex_);
      try {
        while (static_cast<int>(threads_.size()) < helpers)
          threads_.emplace_back([this] { work(); });
      } catch (const std::system_error&) {
      }
      job_ = &job;
      wanted_ = std::min(helpers, static_cast<int>(threads_.size()));
    }
    wake_.notify_all();
    inside_ = true;
    job();
    inside_ = false;
    {
      std::lock_guard<std::mutex> lock(mutex_);
      wanted_ = 0;
    }
    if (soon([this] { return at_work_ == 0; })) return true;
    std::unique_lock<std::mutex> lock(mutex_);
    done_.wait(lock, [this] { return at_work_ == 0; });
    return true;
  }

  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

 private:
  WorkerPool() = default;
  ~WorkerPool() {
    {
      std::lock_guard<std::mutex> lock(mutex_);
      stop_ = true;
    }
    wake_.notify_all();
    for (std::thread& t : threads_) t.join();
  }
  void work() {
    inside_ = true;
    for (;;) {
      soon([this] { return wanted_ > 0; });
      std::unique_lock<std::mutex> lock(mutex_);
      wake_.wait(lock, [this] { return stop_ || wanted_ > 0; });
      if (stop_) return;
      --wanted_;
      ++at_work_;
      const std::function<void()>* job = job_;
      lock.unlock();
      (*job)();
      lock.lock();
      if (--at_work_ == 0) done_.notify_all();
    }
  }
  /// Waits without sleep, a little: waking up takes longer than many a loop does.
  template <typename Condition>
  static bool soon(Condition&& condition) {
    const auto start = std::chrono::steady_clock::now();
    do {
      for (int i = 0; i < 16; ++i) {
        if (condition()) return true;
        std::this_thread::yield();
      }
    } while (std::chrono::steady_clock::now() - start < kPatience);
    return false;
  }
  static constexpr std::chrono::microseconds kPatience{200};
  static inline thread_local bool inside_ = false;  ///< This thread runs a job.

  std::mutex owner_, mutex_;
  std::condition_variable wake_, done_;
  std::vector<std::thread> threads_;
  const std::function<void()>* job_ = nullptr;
  std::atomic<int> wanted_ = 0, at_work_ = 0;  // written under the mutex
  bool stop_ = false;
};
}  // namespace detail

/// Calls `body(i)` for every i in [0, n), on up to `threads` threads, in chunks of `grain`.
///
/// The order of calls is unspecified, so a body that writes only to what belongs to its index
/// gives the same result for any number of threads. The first exception thrown is rethrown here.
/// Nested calls run on the calling thread.
template <typename Body>
void parallel_for(std::size_t n, int threads, Body&& body, std::size_t grain = 1) {
  grain = std::max<std::size_t>(grain, 1);
  const std::size_t chunks = (n + grain - 1) / grain;
  const int helpers =
      static_cast<int>(std::min<std::size_t>(static_cast<std::size_t>(std::max(threads, 1)),
                                             std::max<std::size_t>(chunks, 1))) -
      1;
  const auto serial = [&] {
    for (std::size_t i = 0; i < n; ++i) body(i);
  };
  if (helpers <= 0) return serial();
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex failure_mutex;
  const std::function<void()> job = [&] {
    try {
      for (std::size_t c = next++; c < chunks; c = next++)
        for (std::size_t i = c * grain; i < std::min(n, (c + 1) * grain); ++i) body(i);
    } catch (...) {
      std::lock_guard<std::mutex> lock(failure_mutex);
      if (!failure) failure = std::current_exception();
      next = chunks;
    }
  };
  if (!detail::WorkerPool::instance().run(helpers, job)) return serial();
  if (failure) std::rethrow_exception(failure);
}
}  // namespace surfleet
