#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <corda/film/film.hpp>

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
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
            {
                const std::lock_guard lock(mutex_);
                ++count_;
            }
            state_ = PyEval_SaveThread();
        }
        ~Scope() {
            while (has_given_up_ && has_ended()) sleep_long();
            PyEval_RestoreThread(state_);
            {
                const std::lock_guard lock(mutex_);
                --count_;
            }
            ended_.notify_all();
            if (has_ended()) never_return();
        }

      private:
        PyThreadState* state_;
    };

    /// True if another thread is ending the interpreter.
    static bool has_ended() { return is_ending_.load() && std::this_thread::get_id() != ending_thread_; }

    static void begin_end() {
        constexpr std::chrono::seconds kPatience{5};  // an encoder that hangs must not keep the process alive
        ending_thread_ = std::this_thread::get_id();
        is_ending_ = true;
        const py::gil_scoped_release release;
        std::unique_lock lock(mutex_);
        has_given_up_ = !ended_.wait_for(lock, kPatience, [] { return count_ <= 0; });
    }

    /// To be called in a forked child, where the calls of the parent's other threads do not exist.
    static void forget() {
        new (&mutex_) std::mutex;
        new (&ended_) std::condition_variable;
        count_ = 0;
    }

  private:
    static void sleep_long() { std::this_thread::sleep_for(std::chrono::hours(1)); }

    /// Gives up the interpreter's lock for good.
    [[noreturn]] static void never_return() {
        PyEval_SaveThread();
        while (true) sleep_long();
    }

    // The first two are never destroyed: blocked threads outlive the static objects.
    inline static std::mutex& mutex_ = *new std::mutex;
    inline static std::condition_variable& ended_ = *new std::condition_variable;
    inline static int count_ = 0;
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

/// A film that any thread of Python may use; calls of several threads wait for each other.
class PyFilm : NonCopyable {
  public:
    /// `has_fields`: its states have velocities and tensions from the start, so that with_fields() needs no
    /// other film.
    PyFilm(const Scene& scene, const std::string& backend, bool require_gpu, bool has_fields = false)
        : has_fields_(has_fields) {
        FilmDef def{.backend = backend, .require_gpu = require_gpu};
        if (has_fields) def.readings = kFields;
        Asking().run([&] { film_ = std::make_unique<Film>(scene, def); });
    }
    ~PyFilm() {
        const Calls::Scope call;
        const std::unique_lock lock(mutex_, std::try_to_lock);
        // Leaks a film that a thread which never returns is using.
        if (!lock.owns_lock() || is_cut_off()) leak();
        with_fields_.reset();
        film_.reset();
    }

    /// For `const` functions, which several threads may call at once.
    [[nodiscard]] const Film& constant() const { return *film_; }

    /// Calls `work` with the film; Python can cancel it. Throws Error (kUsage) inside of a callback of
    /// another call.
    template <class Work>
    auto with_film(const Work& work) {
        Asking asking;
        return with_film(work, asking);
    }

    template <class Work>
    auto with_film(const Work& work, Asking& asking) {
        if (is_cut_off()) {
            throw Error(ExitCode::kUsage,
                        "the parent process was using this film when it forked, so its state is "
                        "unfinished here; make another Film, or start processes by spawn");
        }
        if (thread_ == std::this_thread::get_id()) {
            throw Error(ExitCode::kUsage,
                        "on_progress used the film whose progress it reports; "
                        "draw and read the film after the call that reports progress, or make another Film");
        }
        auto result = asking.run([&] {
            const std::lock_guard lock(mutex_);
            const Use use(*this);
            return work(*film_);
        });
        asking.raise();
        return result;
    }

    /// As with_film(), with a film of the same motion whose states have velocities and tensions. The first
    /// call simulates the motion once more, unless the film has them.
    template <class Work>
    auto with_fields(const Work& work) {
        return with_film([&](Film& film) {
            if (has_fields_) return work(film);
            if (!with_fields_)
                with_fields_ = std::make_unique<Film>(frozen_scene(film), FilmDef{.readings = kFields});
            return work(*with_fields_);
        });
    }

  private:
    static constexpr StateFields kFields{.velocities = true, .tensions = true, .unknown_tensions = true};

    void leak() {
        static_cast<void>(film_.release());
        static_cast<void>(with_fields_.release());
    }

    /// Marks the film as used by this thread.
    class Use : NonCopyable {
      public:
        explicit Use(PyFilm& film) : film_(&film) {
            film.process_ = getpid();
            film.thread_ = std::this_thread::get_id();
        }
        ~Use() {
            film_->thread_ = std::thread::id();
            film_->process_ = 0;
        }

      private:
        PyFilm* film_;
    };

    /// True in a process that was forked while a thread of its parent used the film: the child lacks that
    /// thread, so the work never ends and the lock stays taken.
    [[nodiscard]] bool is_cut_off() const {
        const pid_t process = process_;
        return process != 0 && process != getpid();
    }

    std::mutex mutex_;
    std::atomic<pid_t> process_ = 0;         ///< the process that is using the film; 0: none
    std::atomic<std::thread::id> thread_{};  ///< the thread that is using the film
    std::unique_ptr<Film> film_;
    bool has_fields_;
    std::unique_ptr<Film> with_fields_;
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

// Arrays of a film's frames: see the properties of the same names in corda/__init__.py.

/// A label of float64 (see labels.hpp). `needs_fields`: it needs velocities or tensions.
[[nodiscard]] py::array_t<double> label(PyFilm& film, const char* name, bool needs_fields);
[[nodiscard]] py::array_t<double> times(const PyFilm& film);
[[nodiscard]] py::array_t<std::uint8_t> mask(PyFilm& film, std::int64_t k);
using Points = py::array_t<double, py::array::c_style | py::array::forcecast>;
[[nodiscard]] py::array_t<double> to_pixels(PyFilm& film, const Points& points_m);

/// A message as Python's text. It holds names of files as they are, in any encoding.
[[nodiscard]] inline py::str text_of(const char* message) {
    return py::reinterpret_steal<py::str>(PyUnicode_DecodeFSDefault(message));
}

/// Adds what the Python class `Sweep` is made of: the painter of samples, their facts and labels.
void add_sweep(py::module_& module);

}  // namespace corda::python
