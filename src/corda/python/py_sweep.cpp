// Samples of a sweep, for corda.sweep() of corda/__init__.py.
#include <corda/sweep/sample.hpp>

#include <optional>
#include <string>
#include <utility>

#include "py_film.hpp"

namespace corda::python {
namespace {

/// A sweep whose pictures are arrays. One thread at a time may use it.
class PySweep : NonCopyable {
  public:
    explicit PySweep(const std::string& path)
        : sweep_(Asking().run([&] { return sweep::load_sweep(path); })), maker_(std::in_place, sweep_) {
        if (sweep_.pictures != sweep::Pictures::kNone) sweep_.pictures = sweep::Pictures::kNpz;
    }
    ~PySweep() {
        const Calls::Scope call;
        maker_.reset();
    }

    [[nodiscard]] std::int64_t samples() const { return sweep_.samples; }
    [[nodiscard]] std::int64_t shard_samples() const { return sweep_.shard_samples; }

    /// The key of a sample, its .json as text, its arrays by name, and the reason if there is no sample.
    py::tuple sample(std::int64_t number) {
        sweep::Sample made = Asking().run([&] { return maker_->make(number); });
        if (made.failure)
            return py::make_tuple(made.key, py::none(), py::none(), text_of(made.failure->message.c_str()));
        py::dict arrays;
        for (sweep::Array& array : made.arrays) {
            const py::str name(array.name);
            if (array.is_bytes)
                arrays[name] = to_numpy<std::uint8_t>(std::move(array));
            else
                arrays[name] = to_numpy<double>(std::move(array));
        }
        return py::make_tuple(made.key, made.info.dump(), arrays, py::none());
    }

  private:
    sweep::SweepDef sweep_;
    std::optional<sweep::SampleMaker> maker_;
};

}  // namespace

void add_sweep(py::module_& module) {
    py::class_<PySweep>(module, "Sweep")
        .def(py::init<const std::string&>())
        .def("samples", &PySweep::samples)
        .def("shard_samples", &PySweep::shard_samples)
        .def("sample", &PySweep::sample);
}

}  // namespace corda::python
