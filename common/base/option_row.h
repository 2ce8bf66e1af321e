#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/base/error.h"
#include "common/base/named.h"
#include "common/base/number_text.h"

namespace shadowcache {

// A table of options: what each is called, takes and does, stated once for every way in. A way in
// (a command line, a request, a call of Python, a property of Blender) brings the value as the text
// that a command line would have for it, and has its own spelling of the name.

/// What the text of a value is made of.
enum class OptionForm {
    flag,     ///< "true" or "false"
    whole,    ///< a whole number
    number,   ///< any number
    numbers,  ///< some numbers, joined by commas
    fields,   ///< KEY=NUMBER, joined by commas
    word,     ///< one of the choices
    words,    ///< any of the choices, a text each
    text,     ///< any text
    texts,    ///< any texts
};

/// Who gives the value of an option.
enum class Door : unsigned { commandLine = 1, serve = 2, python = 4, blender = 8 };

/// The numbers that an option takes.
struct NumberRange {
    double least = -std::numeric_limits<double>::infinity();
    double most = std::numeric_limits<double>::infinity();
    bool isLeastOut = false, isMostOut = false;  ///< whether the end itself is out of range

    bool contains(double value) const;
    /// As messages have it: "0 to below 1".
    std::string text() const;
};

/// A text that is not of its option's form, as letters in place of a number.
class FormError : public Error {
public:
    using Error::Error;
};

/// One option. Its text goes where the row was told to put it.
struct OptionRow {
    std::string name;  ///< as the command line has it, without dashes
    std::string help;
    OptionForm form = OptionForm::text;
    NumberRange range{};
    std::vector<std::string> choices{};   ///< of words
    std::vector<std::size_t> counts{};    ///< how many numbers there may be
    std::vector<std::string> fields{};    ///< their keys
    std::optional<std::string> orWord{};  ///< that a number may be in place of one
    std::string standard{};  ///< the value that stands unless another is given; empty: none
    std::string type{};      ///< what help calls the value; empty: by the form

    std::string group{};  ///< of the help
    /// Names, joined by spaces: wanted, or refused, beside it; a|b: one of two is wanted.
    std::string needs{}, excludes{};
    unsigned doors = 7;              ///< that have it: bits of Door
    bool isCompared = true;          ///< whether a picture of another value is another picture
    bool isKept = true;              ///< whether settings files hold it
    bool isPositional = false;       ///< on a command line
    bool isRequired = false;         ///< there
    char letter = 0;                 ///< its short name
    std::string otherName{};         ///< at all doors but the command line; empty: by rule
    bool isNegatedInPython = false;  ///< a flag that takes away: True does not
    std::string pythonName{};        ///< in Python; empty: as at the other doors

    /// Puts the text of a value, or of each of several, where it belongs.
    ///
    /// @throws FormError, or Error for a value that is refused: "--NAME TEXT: expected ..."
    std::function<void(std::span<const std::string> texts)> read{};

    bool isAt(Door door) const { return (doors & static_cast<unsigned>(door)) != 0; }
    bool takesSeveral() const { return form == OptionForm::words || form == OptionForm::texts; }
    /// Its name at a door.
    std::string nameAt(Door door) const;

    // What most rows are not; each returns the row.
    OptionRow& named(std::string elsewhere, std::string inPython = "");
    OptionRow& needing(std::string names);
    OptionRow& excluding(std::string names);
    OptionRow& typed(std::string name);
    OptionRow& onlyAt(std::initializer_list<Door> those);
    OptionRow& inBlender();
    OptionRow& required();
    OptionRow& notCompared();
    OptionRow& notKept();
};

// The rows of the kinds of values. What they refer to has its standard value, and must live as long
// as the row is read.

OptionRow flagRow(const std::string& name, bool& value, std::string help);
OptionRow seedRow(const std::string& name, std::uint64_t& value, std::string help);
OptionRow textRow(std::string name, std::string& value, std::string help);
OptionRow textRow(std::string name, std::filesystem::path& value, std::string help);
/// Any of the words in `choices`.
OptionRow wordsRow(const std::string& name, std::vector<std::string>& value,
                   std::vector<std::string> choices, std::string help);
/// An option whose text is read by `read`, which throws Error on what it refuses.
OptionRow ownRow(std::string name, OptionForm form, std::function<void(const std::string&)> read,
                 std::string help);
/// The same of several texts.
OptionRow ownTextsRow(std::string name, std::function<void(std::span<const std::string>)> read,
                      std::string help);

namespace option_row {
OptionRow whole(const std::string& name, std::function<void(std::int64_t)> put,
                const NumberRange& range, std::string help);
OptionRow number(const std::string& name, std::function<void(double)> put, const NumberRange& range,
                 std::string help);
OptionRow word(const std::string& name, std::function<void(std::size_t)> put,
               std::vector<std::string> choices, std::string help);
template <class T>
std::string standardOf(const T& value) {
    return numberText(static_cast<double>(value));
}
template <class T>
std::string standardOf(const std::optional<T>&) {
    return "";
}
}  // namespace option_row

/// A whole number within [least, most]. T: int or std::optional<int>.
template <class T>
OptionRow wholeRow(const std::string& name, T& value, int least, int most,
                   const std::string& help) {
    const auto put = [&value](std::int64_t n) { value = static_cast<int>(n); };
    const NumberRange range{static_cast<double>(least), static_cast<double>(most)};
    OptionRow row = option_row::whole(name, put, range, help);
    row.standard = option_row::standardOf(value);
    return row;
}

/// A number within a range. T: float, double or std::optional<double>.
template <class T>
OptionRow numberRow(const std::string& name, T& value, const NumberRange& range,
                    const std::string& help) {
    const auto put = [&value](double n) { value = static_cast<T>(n); };
    OptionRow row = option_row::number(name, put, range, help);
    row.standard = option_row::standardOf(value);
    return row;
}

/// One of the names in `table`, which must live as long.
template <class T, std::size_t n>
OptionRow wordRow(const std::string& name, T& value, const Named<T> (&table)[n],
                  const std::string& help) {
    const auto put = [&value, &table](std::size_t i) { value = table[i].value; };
    OptionRow row = option_row::word(name, put, namesOf(table), help);
    for (const Named<T>& entry : table)
        if (entry.value == value) row.standard = entry.name;
    return row;
}

/// The row of this name, or none.
const OptionRow* findRow(std::span<const OptionRow> rows, const std::string& name);

/// Refuses options that were given without what they need, or beside what they exclude.
///
/// @param given  names of options
/// @throws FormError
void requireTogether(std::span<const OptionRow> rows, const std::vector<std::string>& given);

/// A message in which options are called by their names at a door, in place of the command line's.
std::string inWordsOf(Door door, std::span<const OptionRow> rows, const std::string& message);

}  // namespace shadowcache
