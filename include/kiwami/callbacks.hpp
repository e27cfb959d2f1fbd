// SPDX-License-Identifier: Apache-2.0
//
// Kiwami for C++20: functions that the library calls back. No exception may cross C: what they throw
// is kept, has the call fail, and comes out of it. Use kiwami.hpp.
#ifndef KIWAMI_CALLBACKS_HPP
#define KIWAMI_CALLBACKS_HPP

#include <atomic>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <new>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

#include "geometries.hpp"

namespace kiwami {

using FilterCandidate = kiwami_filter_candidate;
using UserHit = kiwami_user_hit;

/// Decides whether a hit counts: true or false, or one of KIWAMI_FILTER_*. Called from several
/// threads at once.
template <typename F>
concept Filter = std::invocable<F&, const FilterCandidate&> &&
    std::convertible_to<std::invoke_result_t<F&, const FilterCandidate&>, std::int32_t>;

namespace detail {

/// The first exception of a call whose callbacks run on several threads.
class FirstException {
 public:
  bool is_set() const noexcept { return is_set_.load(std::memory_order_acquire); }
  void keep(std::exception_ptr thrown) noexcept {
    const std::lock_guard lock(mutex_);
    if (thrown_) return;
    thrown_ = std::move(thrown);
    is_set_.store(true, std::memory_order_release);
  }
  void rethrow() const {
    if (thrown_) std::rethrow_exception(thrown_);
  }

 private:
  std::mutex mutex_;
  std::exception_ptr thrown_;
  std::atomic<bool> is_set_{false};
};

/// What callbacks of user geometries throw. The library does not say for which call they run, so it
/// is kept for all that run: one that fails throws the first since it began.
class UserExceptions {
 public:
  static UserExceptions& of_process() {
    static UserExceptions exceptions;
    return exceptions;
  }

  void keep(std::exception_ptr thrown) noexcept {
    const std::lock_guard lock(mutex_);
    if (!kept_.empty() && kept_.back().when > last_begin_) return;
    try {
      kept_.push_back({++clock_, std::move(thrown)});
    } catch (const std::bad_alloc&) {
      // The call fails all the same, with the library's sentence.
    }
  }

  /// How many user geometries live; without any no call need be counted.
  std::atomic<std::size_t> geometry_count{0};

  /// A call that may run callbacks of user geometries.
  class Call {
   public:
    explicit Call(UserExceptions& exceptions)
        : exceptions_(exceptions.geometry_count.load() != 0 ? &exceptions : nullptr) {
      if (!exceptions_) return;
      const std::lock_guard lock(exceptions_->mutex_);
      ++exceptions_->running_;
      begin_ = exceptions_->last_begin_ = ++exceptions_->clock_;
    }
    Call(const Call&) = delete;
    Call& operator=(const Call&) = delete;
    ~Call() {
      if (!exceptions_) return;
      const std::lock_guard lock(exceptions_->mutex_);
      if (--exceptions_->running_ == 0) exceptions_->kept_.clear();
    }
    void rethrow() const {
      if (!exceptions_) return;
      std::exception_ptr thrown;
      {
        const std::lock_guard lock(exceptions_->mutex_);
        for (const Kept& each : exceptions_->kept_) {
          if (each.when > begin_ && !thrown) thrown = each.thrown;
        }
      }
      if (thrown) std::rethrow_exception(thrown);
    }

   private:
    UserExceptions* exceptions_;
    std::uint64_t begin_ = 0;
  };

 private:
  struct Kept {
    std::uint64_t when;
    std::exception_ptr thrown;
  };
  std::mutex mutex_;
  std::size_t running_ = 0;
  std::uint64_t clock_ = 0, last_begin_ = 0;
  std::vector<Kept> kept_;
};

/// Runs a call that may run callbacks of user geometries, and throws what they have thrown; own is
/// what other callbacks of the call have, or null.
template <typename Body>
kiwami_result run_call(Body&& body, const FirstException* own = nullptr) {
  const UserExceptions::Call call(UserExceptions::of_process());
  const kiwami_result result = body();
  if (own) own->rethrow();
  // Other results have other reasons.
  if (result == KIWAMI_ERROR_CALLBACK) call.rethrow();
  return result;
}

/// A callable as the progress function of a commit.
template <typename Progress>
struct ProgressReport {
  Progress& progress;
  std::exception_ptr thrown;

  static kiwami_progress function() {
    return [](void* user, double fraction) -> std::int32_t {
      auto& report = *static_cast<ProgressReport*>(user);
      if (report.thrown) return 1;
      try {
        return report.progress(fraction) ? 1 : 0;
      } catch (...) {
        report.thrown = std::current_exception();
        return 1;
      }
    };
  }
};

}  // namespace detail

/// What a trace call is told beyond the rays: a query of the C interface, a filter, or both. It
/// refers to them, and is made for one call: scene.closest_hit(rays, [](const auto& candidate) {...})
class Query {
 public:
  Query() = default;
  Query(std::nullptr_t) {}
  Query(const kiwami_query* query) : query_(query) {}
  template <typename F>
  requires Filter<std::remove_reference_t<F>> Query(F&& filter, const kiwami_query* query = nullptr)
      : query_(query),
        filter_(const_cast<void*>(static_cast<const void*>(std::addressof(filter)))),
        function_(&decide<std::remove_reference_t<F>>) {}

  /// Calls body(query) with a query of the C interface; throws what a callback has thrown.
  template <typename Body>
  kiwami_result run(Body&& body) const {
    if (!function_) return detail::run_call([&] { return body(query_); });
    Running running{filter_, {}};
    kiwami_query query = query_ ? *query_ : detail::defaults(kiwami_query_init);
    query.filter = function_;
    query.filter_user = &running;
    return detail::run_call([&] { return body(&query); }, &running.exception);
  }

 private:
  struct Running {
    void* filter;
    detail::FirstException exception;
  };

  template <typename F>
  static std::int32_t decide(void* user, const kiwami_filter_candidate* candidate) {
    auto& running = *static_cast<Running*>(user);
    if (running.exception.is_set()) return -1;
    try {
      return static_cast<std::int32_t>((*static_cast<F*>(running.filter))(*candidate));
    } catch (...) {
      running.exception.keep(std::current_exception());
      return -1;
    }
  }

  const kiwami_query* query_ = nullptr;
  void* filter_ = nullptr;
  kiwami_filter_function function_ = nullptr;
};

/// A box around a primitive.
struct Bounds {
  Vertex lower, upper;
};
static_assert(sizeof(Bounds) == 6 * sizeof(float));

/// One ray and the primitives that it may meet.
class Intersection {
 public:
  explicit Intersection(kiwami_user_intersection& asked) : asked_(asked) {}
  /// In the geometry's space; its tmax may be nearer than the traced ray's.
  const Ray& ray() const noexcept { return *asked_.ray; }
  std::uint32_t geometry_id() const noexcept { return asked_.geometry_id; }
  std::span<const std::uint32_t> primitive_ids() const noexcept {
    return {asked_.primitive_ids, asked_.primitive_count};
  }
  /// Adds a hit of one of the primitives, of which each has at most four. Where ray.tmin <= t <=
  /// ray.tmax does not hold it is ignored.
  void add(const UserHit& hit) {
    if (asked_.hit_count == asked_.hit_capacity) {
      throw std::length_error("an intersect callback adds more than four hits a primitive");
    }
    asked_.hits[asked_.hit_count++] = hit;
  }

 private:
  kiwami_user_intersection& asked_;
};

/// Primitives of the caller's own kind. bounds() writes a box for each of the primitives from first
/// on; intersect() adds the hits of a ray, as user_geometry.h says. Both are called from several
/// threads at once.
template <typename T>
concept UserPrimitives = requires(const T& primitives, std::uint32_t first,
                                  std::span<Bounds> bounds, Intersection& intersection) {
  primitives.bounds(first, bounds);
  primitives.intersect(intersection);
};

/// A geometry of such primitives. It owns them until the last scene lets go of it.
class UserGeometry : public Geometry {
 public:
  template <UserPrimitives T>
  UserGeometry(const Device& device, std::uint64_t count, T primitives,
               std::uint32_t mask = kAllMasks)
      : Geometry(create(device, count, std::make_unique<T>(std::move(primitives)), mask)) {}

 private:
  template <typename Body>
  static std::int32_t guard(Body&& body) {
    try {
      body();
      return 0;
    } catch (...) {
      detail::UserExceptions::of_process().keep(std::current_exception());
      return -1;
    }
  }

  template <typename T>
  static kiwami_geometry* create(const Device& device, std::uint64_t count,
                                 std::unique_ptr<T> primitives, std::uint32_t mask) {
    auto desc = detail::defaults(kiwami_user_geometry_desc_init);
    desc.count = count;
    desc.mask = mask;
    desc.user = primitives.get();
    desc.bounds = [](void* user, std::uint32_t first, std::uint32_t number, float* bounds) {
      return guard([&] {
        static_cast<const T*>(user)->bounds(
            first, std::span(reinterpret_cast<Bounds*>(bounds), std::size_t{number}));
      });
    };
    desc.intersect = [](void* user, kiwami_user_intersection* asked) {
      return guard([&] {
        Intersection intersection(*asked);
        static_cast<const T*>(user)->intersect(intersection);
      });
    };
    desc.destroy = [](void* user) {
      delete static_cast<T*>(user);
      --detail::UserExceptions::of_process().geometry_count;
    };
    kiwami_geometry* const made =
        detail::create_geometry(device, desc, kiwami_user_geometry_create);
    ++detail::UserExceptions::of_process().geometry_count;
    static_cast<void>(primitives.release());
    return made;
  }
};

}  // namespace kiwami

#endif
