// The C++ half of the Python module `corda`: what corda/__init__.py wraps.
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <corda/corda.hpp>
#include <corda/golden/check_golden.hpp>

#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

namespace {

namespace py = pybind11;
using Pixels = py::array_t<std::uint8_t, py::array::c_style>;

/// Hands the pixels of a picture to numpy, which frees them.
py::array_t<std::uint8_t> to_array(corda::Image image) {
    auto owned = std::make_unique<corda::Image>(std::move(image));
    const std::vector<py::ssize_t> shape{owned->height(), owned->width(), 4};
    std::uint8_t* const data = owned->data();
    const py::capsule owner(owned.release(), [](void* kept) { delete static_cast<corda::Image*>(kept); });
    return py::array_t<std::uint8_t>(shape, data, owner);
}

/// A copy of an array of shape (height, width, 3 or 4).
corda::Image to_image(const py::object& picture) {
    // Other numbers are refused: 0.0 .. 1.0 as bytes would all be black, and equal.
    if (!py::isinstance<py::array_t<std::uint8_t>>(picture))
        throw py::type_error(
            "a picture is a numpy array of uint8; scale it to 0 .. 255, then convert it by "
            ".astype(numpy.uint8)");
    const Pixels pixels(picture);
    if (pixels.ndim() != 3 || (pixels.shape(2) != 3 && pixels.shape(2) != 4))
        throw py::value_error(
            "a picture is an array of uint8 of shape (height, width, 4), or (height, width, 3)");
    const py::ssize_t most = corda::kMaxSidePx;
    if (pixels.shape(0) < 1 || pixels.shape(1) < 1 || pixels.shape(0) > most || pixels.shape(1) > most)
        throw py::value_error("each side of a picture has 1 to " + std::to_string(most) + " pixels");
    corda::Image image(static_cast<int>(pixels.shape(1)), static_cast<int>(pixels.shape(0)));
    const bool has_alpha = pixels.shape(2) == 4;
    if (has_alpha) {
        std::memcpy(image.data(), pixels.data(), image.size_bytes());
        return image;
    }
    const std::uint8_t* from = pixels.data();
    for (std::uint8_t* to = image.data(); to != image.data() + image.size_bytes(); to += 4, from += 3) {
        std::copy(from, from + 3, to);
        to[3] = 255;
    }
    return image;
}

/// Calls in progress, and the end of the interpreter. Python before 3.14 ends threads that ask for its lock
/// after Py_Finalize by pthread_exit, whose unwinding C++ does not survive, and a driver that still draws
/// does not survive exit(). So an atexit function calls begin_end(): it stops the calls of all other threads
/// and waits for them, and these threads never return to Python.
class Calls {
  public:
    /// Releases the interpreter's lock during one call, which counts from before the release until the lock
    /// is held again.
    class Scope {
      public:
        Scope() {
            if (has_ended()) never_return();
            {
                const std::lock_guard lock(mutex());
                ++count();
            }
            state_ = PyEval_SaveThread();
        }
        Scope(const Scope&) = delete;
        Scope& operator=(const Scope&) = delete;
        ~Scope() {
            while (has_given_up() && has_ended()) sleep_long();
            PyEval_RestoreThread(state_);
            {
                const std::lock_guard lock(mutex());
                --count();
            }
            ended().notify_all();
            if (has_ended()) never_return();
        }

      private:
        PyThreadState* state_;
    };

    /// True if another thread is ending the interpreter.
    static bool has_ended() { return is_ending().load() && std::this_thread::get_id() != ending_thread(); }

    static void begin_end() {
        constexpr std::chrono::seconds kPatience{5};  // an encoder that hangs must not keep the process alive
        ending_thread() = std::this_thread::get_id();
        is_ending() = true;
        const py::gil_scoped_release release;
        std::unique_lock lock(mutex());
        has_given_up() = !ended().wait_for(lock, kPatience, [] { return count() <= 0; });
    }

    /// To be called in a forked child, where the calls of the parent's other threads do not exist.
    static void forget() {
        new (&mutex()) std::mutex;
        new (&ended()) std::condition_variable;
        count() = 0;
    }

  private:
    static void sleep_long() { std::this_thread::sleep_for(std::chrono::hours(1)); }

    /// Gives up the interpreter's lock for good.
    [[noreturn]] static void never_return() {
        PyEval_SaveThread();
        while (true) sleep_long();
    }

    // Never destroyed: blocked threads outlive the static objects.
    static std::mutex& mutex() {
        static auto& mutex = *new std::mutex;
        return mutex;
    }
    static std::condition_variable& ended() {
        static auto& ended = *new std::condition_variable;
        return ended;
    }
    static int& count() {
        static int count = 0;
        return count;
    }
    static std::atomic<bool>& is_ending() {
        static std::atomic<bool> is_ending{false};
        return is_ending;
    }
    /// True if a call did not end in time, so that the interpreter ends without it.
    static std::atomic<bool>& has_given_up() {
        static std::atomic<bool> has_given_up{false};
        return has_given_up;
    }
    static std::thread::id& ending_thread() {
        static std::thread::id thread;
        return thread;
    }
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
            const corda::CancelScope signals([this] {
                if (raised_ || Calls::has_ended()) return false;
                return !is_due(checked_) || hold_and_ask(check_signals, checked_);
            });
            return work();
        } catch (const corda::Error& error) {
            raise();
            if (error.code() == corda::ExitCode::kInterrupted) check_signals();
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
class PyFilm {
  public:
    PyFilm(const corda::Scene& scene, const std::string& backend, bool require_gpu) {
        const corda::FilmDef def{.backend = backend, .require_gpu = require_gpu};
        Asking().run([&] { film_ = std::make_unique<corda::Film>(scene, def); });
    }
    PyFilm(const PyFilm&) = delete;
    PyFilm& operator=(const PyFilm&) = delete;
    ~PyFilm() {
        const Calls::Scope call;
        const std::unique_lock lock(mutex_, std::try_to_lock);
        // Leaks a film that a thread which never returns is using.
        if (!lock.owns_lock() || is_cut_off()) static_cast<void>(film_.release());
        film_.reset();
    }

    /// For `const` functions, which several threads may call at once.
    [[nodiscard]] const corda::Film& constant() const { return *film_; }

    /// Calls `work` with the film; Python can cancel it. Throws corda::Error (kUsage) inside of a callback of
    /// another call.
    template <class Work>
    auto with_film(const Work& work) {
        Asking asking;
        return with_film(work, asking);
    }

    template <class Work>
    auto with_film(const Work& work, Asking& asking) {
        if (is_cut_off()) {
            throw corda::Error(corda::ExitCode::kUsage,
                               "the parent process was using this film when it forked, so its state is "
                               "unfinished here; make another Film, or start processes by spawn");
        }
        if (thread_ == std::this_thread::get_id()) {
            throw corda::Error(
                corda::ExitCode::kUsage,
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

  private:
    /// Marks the film as used by this thread.
    class Use {
      public:
        explicit Use(PyFilm& film) : film_(&film) {
            film.process_ = getpid();
            film.thread_ = std::this_thread::get_id();
        }
        Use(const Use&) = delete;
        Use& operator=(const Use&) = delete;
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
    std::unique_ptr<corda::Film> film_;
};

py::array_t<double> positions(PyFilm& film) {
    const std::int64_t frames = film.constant().frame_count();
    const std::size_t particles = film.constant().system().particle_count();
    py::array_t<double> all(
        {static_cast<py::ssize_t>(frames), static_cast<py::ssize_t>(particles), py::ssize_t{2}});
    double* to = all.mutable_data();
    film.with_film([&](corda::Film& its) {
        const corda::Vec2 origin_m = its.system().origin_m;
        for (std::int64_t k = 0; k < frames; ++k) {
            corda::check_cancelled();
            const corda::State& state = its.state(k);
            for (std::size_t i = 0; i < particles; ++i) {
                *to++ = origin_m.x + state.x_m[i];
                *to++ = origin_m.y + state.y_m[i];
            }
        }
        return true;
    });
    return all;
}

py::array_t<double> times(const PyFilm& film) {
    const corda::Film& its = film.constant();
    std::vector<double> all;
    for (std::int64_t k = 0; k < its.frame_count(); ++k) all.push_back(its.time_s(k));
    return py::array_t<double>(static_cast<py::ssize_t>(all.size()), all.data());
}

py::dict plan(PyFilm& film) {
    return film.with_film([](corda::Film& its) {
        const corda::Plan& chosen = its.plan();
        const auto bound_px = its.error_bound_px();
        const py::gil_scoped_acquire hold;
        py::list methods;
        for (const corda::BodyPlan& body : chosen.bodies)
            methods.append(std::string(corda::method_name(body.method)));
        py::dict all;
        all["methods"] = methods;
        all["error_bound_m"] = chosen.error_bound_m;
        all["error_bound_px"] = bound_px;
        all["horizon_s"] = chosen.horizon_s;
        all["notes"] = chosen.notes;
        return all;
    });
}

py::dict camera(PyFilm& film) {
    return film.with_film([](corda::Film& its) {
        const corda::CameraDef& def = its.camera();
        const py::gil_scoped_acquire hold;
        py::dict all;
        all["center"] = py::make_tuple(def.center_m->x, def.center_m->y);
        all["height"] = *def.height_m;
        all["margin"] = def.margin;
        return all;
    });
}

std::int64_t save(PyFilm& film, const std::string& path, bool force, bool resume, py::object on_progress) {
    Asking asking(std::move(on_progress));
    corda::RenderDef def{.force = force, .resume = resume};
    def.on_progress = [&](std::int64_t done, std::int64_t total) { return asking(done, total); };
    const corda::Rendered rendered =
        film.with_film([&](corda::Film& its) { return corda::render_video(its, path, def); }, asking);
    if (!rendered.complete) {
        throw corda::Error(corda::ExitCode::kInterrupted,
                           rendered.kept_part.empty() ? "stopped by on_progress; there is no frame yet"
                                                      : "stopped by on_progress; the frames so far are in '" +
                                                            rendered.kept_part + "', which plays");
    }
    return rendered.frames;
}

/// The ending of a video that browsers play, and the film that it is to be made of if `film` does not fit it:
/// with even sides, as render --pad makes them, and the default encoder.
std::pair<std::string, std::unique_ptr<PyFilm>> for_browser(const PyFilm& film, const std::string& backend,
                                                            bool require_gpu) {
    corda::Scene scene = film.constant().scene();
    const bool is_opaque = !scene.style.background || scene.style.background->is_opaque();
    const corda::EncoderDef encoder = scene.video.encoder;
    const bool is_default =
        encoder.codec.empty() && encoder.preset.empty() && encoder.pix == corda::PixelChoice::kAuto;
    const bool is_even = scene.video.width_px % 2 == 0 && scene.video.height_px % 2 == 0;
    const char* const ending = is_opaque ? ".mp4" : ".webm";
    if (is_default && is_even) return {ending, nullptr};
    scene.video.width_px += scene.video.width_px % 2;
    scene.video.height_px += scene.video.height_px % 2;
    scene.video.encoder = {};
    scene.video.encoder.threads = encoder.threads;
    scene.video.encoder.jobs = encoder.jobs;
    return {ending, std::make_unique<PyFilm>(scene, backend, require_gpu)};
}

void add_errors(py::module_& module) {
    static py::exception<corda::Error> error(module, "Error");
    py::register_exception_translator(
        [](std::exception_ptr thrown) {  // NOLINT(performance-unnecessary-value-param): pybind11 wants it so
            try {
                if (thrown) std::rethrow_exception(thrown);
            } catch (const corda::Error& raised) {
                // A message holds names of files as they are, in any encoding.
                const auto what = py::reinterpret_steal<py::str>(PyUnicode_DecodeFSDefault(raised.what()));
                const py::object instance = py::reinterpret_borrow<py::object>(error.ptr())(what);
                instance.attr("code") = static_cast<int>(raised.code());
                PyErr_SetObject(error.ptr(), instance.ptr());
            }
        });
}

void add_film(py::module_& module) {
    using corda::Film;
    py::class_<PyFilm>(module, "Film")
        .def(py::init([](const std::string& text, const std::string& source, bool is_path,
                         const std::vector<std::string>& settings, const std::string& backend,
                         bool require_gpu) {
            const auto [scene, notice] = Asking().run([&] {
                corda::Scene read = is_path ? corda::load_scene(source, settings)
                                            : corda::parse_scene(text, source, settings);
                std::string cost = corda::cost_notice(read);
                return std::pair(std::move(read), std::move(cost));
            });
            if (!notice.empty() && PyErr_WarnEx(PyExc_UserWarning, notice.c_str(), 2) != 0)
                throw py::error_already_set();
            return std::make_unique<PyFilm>(scene, backend, require_gpu);
        }))
        .def("frame_count", [](const PyFilm& film) { return film.constant().frame_count(); })
        .def("size",
             [](const PyFilm& film) {
                 const corda::VideoDef& video = film.constant().scene().video;
                 return std::pair(video.width_px, video.height_px);
             })
        .def("fps",
             [](const PyFilm& film) {
                 const corda::Rational fps = film.constant().scene().video.fps.rational();
                 return std::pair(fps.num, fps.den);
             })
        .def("frame",
             [](PyFilm& film, std::int64_t k) {
                 return to_array(film.with_film([k](Film& its) { return its.frame(k); }));
             })
        .def("still",
             [](PyFilm& film, double time_s, double shutter) {
                 return to_array(film.with_film([=](Film& its) { return its.still(time_s, shutter); }));
             })
        .def("for_browser", &for_browser)
        .def("positions", &positions)
        .def("times", &times)
        .def("plan", &plan)
        .def("camera", &camera)
        .def("save", &save);
}

}  // namespace

PYBIND11_MODULE(_corda, module) {
    module.attr("__version__") = CORDA_VERSION;
    add_errors(module);
    add_film(module);
    module.def("begin_end", &Calls::begin_end);
    module.def("forget_calls", &Calls::forget);
    module.def("compare", [](const py::object& a, const py::object& b) {
        const auto picture_of = [](const py::object& given) {
            if (!py::isinstance<py::bytes>(given)) return corda::Picture{.image = to_image(given)};
            return Asking().run([path = given.cast<std::string>()] { return corda::read_picture(path); });
        };
        const std::pair pictures(picture_of(a), picture_of(b));
        const corda::Difference found =
            Asking().run([&] { return corda::compare(pictures.first, pictures.second); });
        return py::make_tuple(found.same_size, found.equal, found.max, found.mean, found.share);
    });
    module.def("write_png", [](const std::string& path, const py::object& picture, bool force) {
        Asking().run([&, image = to_image(picture)] { corda::write_png(path, image, {}, {.force = force}); });
    });
    module.def("check_golden",
               [](const py::object& picture, const std::string& name, const std::string& folder,
                  const std::array<std::optional<double>, 5>& limits) {
                   const corda::testing::GoldenOptions options{
                       .folder = folder, .limits = {limits[0], limits[1], limits[2], limits[3], limits[4]}};
                   const auto outcome = Asking().run([&, image = to_image(picture)] {
                       return corda::testing::check_golden(image, name, options);
                   });
                   return std::tuple(outcome.matches, outcome.written, outcome.message);
               });
    module.def("read_png", [](const std::string& path) {
        return to_array(Asking().run([&] { return corda::read_png(path); }));
    });
}
