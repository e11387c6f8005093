#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <corda/film/film.hpp>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "labels.hpp"

namespace corda::python {

namespace py = pybind11;

/// Calls in progress, and the end of the interpreter. Python before 3.14 ends threads that ask for its lock
/// after Py_Finalize by pthread_exit, whose unwinding C++ does not survive, and a driver that still draws
/// does not survive exit(). So an atexit function calls begin_end(): it stops the calls of all other threads
/// and waits for them, and these threads never return to Python.
class Calls {
  public:
    /// Releases the interpreter's lock during one call, which counts from before the release until the lock
    /// is held again.
    class Scope : NonCopyable {
      public:
        Scope() {
            if (has_ended()) never_return();
            ++count_;
            state_ = PyEval_SaveThread();
        }
        ~Scope() {
            while (has_given_up_ && has_ended()) sleep_long();
            PyEval_RestoreThread(state_);
            --count_;
            if (has_ended()) never_return();
        }

      private:
        PyThreadState* state_;
    };

    /// True if another thread is ending the interpreter.
    static bool has_ended() { return is_ending_.load() && std::this_thread::get_id() != ending_thread_; }

    static void begin_end() {
        constexpr std::chrono::seconds kPatience{5};  // an encoder that hangs must not keep the process alive
        constexpr std::chrono::milliseconds kPause{1};
        ending_thread_ = std::this_thread::get_id();
        is_ending_ = true;
        const py::gil_scoped_release release;
        const auto end = std::chrono::steady_clock::now() + kPatience;
        while (count_ > 0 && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(kPause);
        has_given_up_ = count_ > 0;
    }

    /// To be called in a forked child, where the calls of the parent's other threads do not exist.
    static void forget() { count_ = 0; }

  private:
    static void sleep_long() { std::this_thread::sleep_for(std::chrono::hours(1)); }

    /// Gives up the interpreter's lock for good.
    [[noreturn]] static void never_return() {
        PyEval_SaveThread();
        while (true) sleep_long();
    }

    inline static std::atomic<int> count_ = 0;
    inline static std::atomic<bool> is_ending_ = false;
    /// True if a call did not end in time, so that the interpreter ends without it.
    inline static std::atomic<bool> has_given_up_ = false;
    inline static std::thread::id ending_thread_;
};

/// Runs work without the interpreter's lock, and asks Python now and then: for Ctrl-C, and for the answer of
/// `on_progress`. What those raise ends the work and is raised.
class Asking {
  public:
    explicit Asking(py::object on_progress = py::none()) : on_progress_(std::move(on_progress)) {}

    /// An OnProgress, at most every 50 ms and for the last frame.
    bool operator()(std::int64_t done, std::int64_t total) {
        const bool is_last = done == total && !std::exchange(has_told_last_, true);
        if (on_progress_.is_none() || !(is_last || is_due(told_))) return true;
        const auto ask = [&] {
            const py::object answer = on_progress_(done, total);
            return !(py::isinstance<py::bool_>(answer) && !answer.cast<bool>());
        };
        return hold_and_ask(ask, told_);
    }

    /// To be called with the lock.
    void raise() const {
        if (raised_) std::rethrow_exception(raised_);
    }

    /// Calls `work`, which signals can cancel.
    template <class Work>
    auto run(const Work& work) {
        try {
            const Calls::Scope call;
            const CancelScope signals([this] {
                if (raised_ || Calls::has_ended()) return false;
                return !is_due(checked_) || hold_and_ask(check_signals, checked_);
            });
            return work();
        } catch (const Error& error) {
            raise();
            if (error.code() == ExitCode::kInterrupted) check_signals();
            throw;
        }
    }

  private:
    using Time = std::chrono::steady_clock::time_point;

    static bool is_due(Time last) {
        return std::chrono::steady_clock::now() - last >= std::chrono::milliseconds(50);
    }

    static bool check_signals() { return PyErr_CheckSignals() == 0 ? true : throw py::error_already_set(); }

    /// Calls `ask` with the interpreter's lock. False if that raises, too.
    template <class Ask>
    bool hold_and_ask(const Ask& ask, Time& last) {
        if (raised_ || Calls::has_ended()) return false;
        const py::gil_scoped_acquire hold;
        try {
            const bool goes_on = ask();
            last = std::chrono::steady_clock::now();  // a callback that takes long has its pause, too
            return goes_on;
        } catch (py::error_already_set&) {
            raised_ = std::current_exception();
            return false;
        }
    }

    py::object on_progress_;
    bool has_told_last_ = false;
    Time told_ = std::chrono::steady_clock::now();
    Time checked_ = told_;
    std::exception_ptr raised_;
};

/// A film whose states have all fields that Python's properties show.
class PyFilm : NonCopyable {
  public:
    PyFilm(const Scene& scene, const std::string& backend, bool require_gpu)
        : film_(Asking().run([&] {
              return Film(scene,
                          {.backend = backend,
                           .require_gpu = require_gpu,
                           .readings = {.velocities = true, .tensions = true, .unknown_tensions = true}});
          })) {}

    [[nodiscard]] const Film& film() const { return film_; }

    /// Calls `work` with the film and without the interpreter's lock; Python can cancel it.
    template <class Work>
    auto with_film(const Work& work) const {
        Asking asking;
        return with_film(work, asking);
    }

    template <class Work>
    auto with_film(const Work& work, Asking& asking) const {
        auto result = asking.run([&] { return work(film_); });
        asking.raise();
        return result;
    }

  private:
    Film film_;
};

/// Hands the numbers of an array to numpy, which frees them.
template <class Number>
py::array_t<Number> to_numpy(Array array) {
    auto owned = std::make_unique<std::string>(std::move(array.data));
    const std::vector<py::ssize_t> shape(array.shape.begin(), array.shape.end());
    const auto* const numbers = reinterpret_cast<const Number*>(owned->data());
    const py::capsule owner(owned.get(), [](void* kept) { delete static_cast<std::string*>(kept); });
    static_cast<void>(owned.release());
    return py::array_t<Number>(shape, numbers, owner);
}

/// Hands the pixels of a picture to numpy, which frees them.
[[nodiscard]] py::array_t<std::uint8_t> to_numpy(Image image);

/// A message as Python's text. It holds names of files as they are, in any encoding.
[[nodiscard]] inline py::str text_of(const char* message) {
    return py::reinterpret_steal<py::str>(PyUnicode_DecodeFSDefault(message));
}

/// Adds the class `Film`.
void add_film(py::module_& module);

/// Adds what the Python class `Sweep` is made of: the painter of samples, their facts and labels.
void add_sweep(py::module_& module);

}  // namespace corda::python
