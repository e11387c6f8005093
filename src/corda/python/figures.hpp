#pragma once

#include "py_film.hpp"

namespace corda::python {

/// Adds what corda.plot and corda.report need of films: numbers of all frames, facts and texts of the plan,
/// pictures of given width in print; and the words of other languages.
void add_figures(py::module_& module, py::class_<PyFilm>& film);

}  // namespace corda::python
