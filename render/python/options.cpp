#include "render/python/options.h"

#include <pybind11/numpy.h>

#include <algorithm>
#include <vector>

#include "bake/library/bake_rows.h"
#include "common/base/suggestion.h"
#include "common/base/text_streams.h"
#include "render/library/option_table.h"

namespace shadowcache::python {

namespace py = pybind11;

namespace {

/// What a value of an option is in Python.
std::string kindOf(const OptionRow& row) {
    switch (row.form) {
        case OptionForm::flag:
            return "True or False";
        case OptionForm::whole:
            return "a whole number" + (row.orWord ? ", or '" + *row.orWord + "'" : "");
        case OptionForm::number:
            return "a number";
        case OptionForm::numbers: {
            std::string counts;
            for (const std::size_t count : row.counts)
                counts += (counts.empty() ? "" : " or ") + std::to_string(count);
            return counts + (counts == "1" ? " number" : " numbers");
        }
        case OptionForm::fields:
            return "a dict of numbers";
        case OptionForm::word:
        case OptionForm::text:
            return "a str";
        case OptionForm::words:
        case OptionForm::texts:
            break;
    }
    return "a list of str";
}

[[noreturn]] void refuse(const OptionRow& row, const py::handle& value) {
    throw py::type_error(row.nameAt(Door::python) + ": expected " + kindOf(row) + ", found " +
                         std::string(py::repr(value)).substr(0, 80));
}

bool isText(const py::handle& value) {
    return py::isinstance<py::str>(value) || py::hasattr(value, "__fspath__");
}

std::string textOf(const py::handle& value) {
    return py::str(py::module_::import("os").attr("fspath")(value));
}

/// A number as a command line has it.
std::string numberOf(const OptionRow& row, const py::handle& value) {
    if (py::isinstance<py::str>(value)) refuse(row, value);
    const double number = PyFloat_AsDouble(value.ptr());
    if (PyErr_Occurred()) {
        PyErr_Clear();
        refuse(row, value);
    }
    return numberText(number);
}

std::string wholeOf(const OptionRow& row, const py::handle& value) {
    if (row.orWord && py::isinstance<py::str>(value)) return textOf(value);
    const auto number = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
    if (!number) {
        PyErr_Clear();
        refuse(row, value);
    }
    return py::str(number);
}

std::string numbersOf(const OptionRow& row, const py::handle& value) {
    if (row.form == OptionForm::numbers && isText(value)) refuse(row, value);
    const py::array array = py::module_::import("numpy").attr("ravel")(value);
    const auto count = static_cast<std::size_t>(array.size());
    const char kind = array.dtype().kind();
    if (std::ranges::find(row.counts, count) == row.counts.end() ||
        (kind != 'f' && kind != 'i' && kind != 'u') ||
        py::module_::import("numpy").attr("ma").attr("is_masked")(value).cast<bool>())
        refuse(row, value);
    std::string all;
    for (const py::handle number : array) all += (all.empty() ? "" : ",") + numberOf(row, number);
    return all;
}

std::string fieldsOf(const OptionRow& row, const py::handle& value) {
    if (!py::isinstance<py::dict>(value)) refuse(row, value);
    std::string all;
    for (const auto& [key, number] : py::reinterpret_borrow<py::dict>(value))
        all += (all.empty() ? "" : ",") + std::string(py::str(key)) + "=" + numberOf(row, number);
    return all;
}

std::vector<std::string> listOf(const OptionRow& row, const py::handle& value) {
    if (isText(value)) return {textOf(value)};
    if (!py::isinstance<py::sequence>(value)) refuse(row, value);
    std::vector<std::string> all;
    for (const py::handle part : py::reinterpret_borrow<py::sequence>(value)) {
        if (!isText(part)) refuse(row, value);
        all.push_back(textOf(part));
    }
    return all;
}

std::vector<std::string> textsOf(const OptionRow& row, const py::handle& value) {
    switch (row.form) {
        case OptionForm::flag:
            if (!py::isinstance<py::bool_>(value) &&
                !py::isinstance(value, py::dtype::of<bool>().attr("type")))
                refuse(row, value);
            return {(PyObject_IsTrue(value.ptr()) != 0) != row.isNegatedInPython ? "true"
                                                                                 : "false"};
        case OptionForm::whole:
            return {wholeOf(row, value)};
        case OptionForm::number:
            return {numberOf(row, value)};
        case OptionForm::numbers:
            return {numbersOf(row, value)};
        case OptionForm::fields:
            return {fieldsOf(row, value)};
        case OptionForm::word:
        case OptionForm::text:
            if (!isText(value)) refuse(row, value);
            return {textOf(value)};
        case OptionForm::words:
        case OptionForm::texts:
            break;
    }
    return listOf(row, value);
}

/// Lines of at most so many letters, indented but for the first.
std::string wrapped(const std::string& text) {
    constexpr std::size_t kWidth = 90;
    TextReader words(text);
    std::string out;
    std::size_t column = 0;
    for (std::string word; words >> word;) {
        if (column + word.size() > kWidth) {
            out += "\n    ";
            column = 4;
        } else if (!out.empty()) {
            out += ' ';
            ++column;
        }
        out += word;
        column += word.size();
    }
    return out + "\n";
}

/// Words of which any may be given.
std::string choicesOf(const OptionRow& row) {
    std::string all;
    if (row.form == OptionForm::words)
        for (const std::string& choice : row.choices) all += (all.empty() ? ": " : ", ") + choice;
    return all;
}

}  // namespace

void readOption(const OptionRow& row, const py::handle& value) {
    row.read(textsOf(row, value));
}

void readKeywords(const char* call, const py::kwargs& keywords, std::span<const OptionRow> rows) {
    std::vector<std::string> given, names;
    for (const OptionRow& row : rows)
        if (row.isAt(Door::python)) names.push_back(row.nameAt(Door::python));
    for (const auto& [key, value] : keywords) {
        const std::string name = py::str(key);
        const auto row = std::ranges::find_if(rows, [&](const OptionRow& each) {
            return each.isAt(Door::python) && each.nameAt(Door::python) == name;
        });
        if (row == rows.end())
            throw py::type_error(std::string(call) + "() got an unexpected keyword argument '" +
                                 name + "'" + suggestion(name, names));
        if (value.is_none()) continue;
        given.push_back(row->name);
        readOption(*row, value);
    }
    requireTogether(rows, given);
}

std::string inPythonsWords(const std::string& message) {
    static BakeOptions bake;
    static std::optional<double> none;
    static int margin = 0;
    static const std::vector<OptionRow> kBakeRows = [] {
        std::vector<OptionRow> rows = bakeRows(bake, none);
        rows.push_back(marginRow(margin));
        return rows;
    }();
    return inWordsOf(Door::python, kBakeRows, inWordsOf(Door::python, message));
}

std::string helpOf(std::span<const OptionRow> rows) {
    std::string text;
    for (const OptionRow& row : rows) {
        if (!row.isAt(Door::python) || row.isPositional) continue;
        const std::string standard = row.standard.empty() ? "" : " [" + row.standard + "]";
        text += wrapped(row.nameAt(Door::python) + ": " + inPythonsWords(row.help) +
                        choicesOf(row) + standard);
    }
    return text;
}

}  // namespace shadowcache::python
