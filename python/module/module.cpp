// SPDX-License-Identifier: BSD-3-Clause
// The module _jink: what python/jink/__init__.py makes the package of.
#include <nanobind/stl/string.h>

#include <exception>
#include <stdexcept>
#include <string>
#include <string_view>

#include "config/error.hpp"
#include "config/settings.hpp"
#include "planner/base/version.hpp"
#include "python/module/types.hpp"
#include "tools/base/exit_code.hpp"

namespace jink::python {
namespace {

/// The words of the command's line on stderr, whatever bytes a file's name has.
void raise(void* type, std::string_view words) {
  PyObject* const text = PyUnicode_DecodeUTF8(words.data(), static_cast<Py_ssize_t>(words.size()), "replace");
  PyErr_SetObject(static_cast<PyObject*>(type), text);
  Py_XDECREF(text);
}

void translate(const std::exception_ptr& thrown, void* type) {
  try {
    std::rethrow_exception(thrown);
  } catch (const config::ConfigError& error) {
    raise(type, error.what());
  } catch (const tools::base::UsageError& error) {
    raise(type, error.what());
  } catch (const std::invalid_argument& error) {  // settings that no range check of a single key can refuse
    raise(type, error.what());
  }
}

}  // namespace
}  // namespace jink::python

NB_MODULE(_jink, module) {
  using namespace jink::python;
  module.doc() = "The compiled half of the package jink.";
  module.def("version", [] { return JINK_VERSION; });
  const std::string name = nb::cast<std::string>(nb::object(module.attr("__name__"))) + ".Error";
  const nb::object error = nb::steal(PyErr_NewExceptionWithDoc(
      name.c_str(),
      "A file, key, value or option that is not as it should be; the text is that of the command's error.",
      PyExc_ValueError, nullptr));
  module.attr("Error") = error;
  nb::register_exception_translator(translate, error.inc_ref().ptr());
  module.def("config_folder", [] { return jink::config::config_folder().string(); });
  module.def(
      "set_config_folder", [](const std::string& folder) { jink::config::set_config_folder(folder); },
      nb::arg("folder"));
  add_values(module);
  add_planner(module);
  add_optimizer(module);
  add_runs(module);
}
