#pragma once

#include <pybind11/pybind11.h>

#include <span>
#include <string>

#include "common/base/option_row.h"

namespace shadowcache::python {

/// Reads the keyword arguments of a call that are options, None being as good as nothing.
///
/// @param call  the name of the call in messages
/// @throws TypeError of a keyword that is no option, or a value of another kind; Error of one that
/// is refused
void readKeywords(const char* call, const pybind11::kwargs& keywords,
                  std::span<const OptionRow> rows);

/// Reads one option. @throws TypeError, Error
void readOption(const OptionRow& row, const pybind11::handle& value);

/// A message in which options are called by their names in Python.
std::string inPythonsWords(const std::string& message);

/// What the options are, a paragraph each, for the help of a call.
std::string helpOf(std::span<const OptionRow> rows);

}  // namespace shadowcache::python
